//! Rate: eight computers with eight skins each, 100 frames a second, without boards: what network and merging can do alone.
//!
//! `DERMATOME_SECONDS=60 cargo bench -p dermatome-zenoh --bench rate`

use dermatome_body::{
    Body,
    file::BodyFile,
    keeper::{Phase, State, Told},
    surface,
};
use dermatome_link::ScanFrame;
use dermatome_messages::clock::now_ns;
use dermatome_shared::{
    contact::Contact,
    frame::FrameFlags,
    protocol::{FrameSource, FrameStamp},
};
use dermatome_zenoh::{Heard, Listener, Merge, Robot, Settings};
use std::{
    fmt::Write as _,
    net::TcpListener,
    path::Path,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

const SKIN: &str = include_str!("../../tests/data/tiny.toml");
const COMPUTERS: usize = 8;
const SKINS: usize = 8;
const PERIOD: Duration = Duration::from_millis(10);
/// So long all of them come to know each other, all at once on one computer.
const START: Duration = Duration::from_secs(3);

fn body_file(folder: &Path, computer: usize) -> BodyFile {
    let mut text = "name = \"arm\"\n".to_owned();
    for skin in 0..SKINS {
        write!(
            text,
            "[[patches]]\nname = \"skin{computer}_{skin}\"\nskin = \"skin.toml\"\nport = \"tcp:127.0.0.1:{}\"\n\
             link = \"palm\"\nposition = [\"0 mm\", \"0 mm\", \"40 mm\"]\norientation = [0, 0, 0, 1]\n",
            skin + 1
        )
        .unwrap();
    }
    BodyFile::parse(&folder.join(format!("computer{computer}.toml")), &text).unwrap()
}

fn pressed() -> Contact {
    Contact {
        position: [0.01, 0.0, 0.0],
        normal: [0.0, 0.0, 1.0],
        area: 1e-4,
        strength: 0.5,
        peak: 1.0,
        pressure: Some(2e3),
        load_area: Some(1e-4),
        evidence: None,
        identity: None,
    }
}

/// A computer that serves its skins until it is to stop.
fn serve(file: &BodyFile, settings: &Settings, is_over: &AtomicBool) {
    let texts = vec![SKIN.to_owned(); SKINS];
    let mut robot = Robot::start(file, &texts, settings, false).unwrap();
    let mut body = Body::new(&file.patches);
    let tables = surface::of_skin(&file.patches[0].skin.clone().made().unwrap()).unwrap().unwrap();
    let mut tell = |robot: &mut Robot, index, told: &Told| {
        body.take(index, told);
        robot.tell(&body, index, told);
        robot.attend(&body);
    };
    for index in 0..SKINS {
        let tables = Box::new(tables.clone());
        let (board, firmware, frame_source) = (String::new(), String::new(), FrameSource::Synthetic);
        tell(&mut robot, index, &Told::Patch { bytes: Vec::new(), tables, board, firmware, frame_source });
        tell(&mut robot, index, &Told::State(State { phase: Phase::Live, text: String::new() }));
    }
    let begun = Instant::now();
    for sequence in 0.. {
        thread::sleep((begun + PERIOD * sequence).saturating_duration_since(Instant::now()));
        if is_over.load(Ordering::Relaxed) {
            break;
        }
        for index in 0..SKINS {
            let received_ns = now_ns();
            let at = FrameStamp { sequence, timestamp_us: received_ns / 1000, flags: FrameFlags::default() };
            let contacts = Some([pressed()].into_iter().collect());
            let frame = Box::new(ScanFrame { at: Some(at), contacts, ..ScanFrame::default() });
            tell(&mut robot, index, &Told::Frame { frame, received_ns, missing: 0 });
        }
    }
    // What is under way arrives.
    thread::sleep(Duration::from_millis(300));
    robot.end();
}

/// The middle of these, and what 99 of 100 do not exceed, ms.
fn median_and_most(mut latencies: Vec<f64>) -> (f64, f64) {
    latencies.sort_by(f64::total_cmp);
    let last = latencies.len() - 1;
    (latencies[last / 2], latencies[last * 99 / 100])
}

fn main() {
    let seconds =
        std::env::var("DERMATOME_SECONDS").map_or(20, |text| text.parse().expect("a number of seconds"));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("skin.toml"), SKIN).unwrap();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let endpoint = vec![format!("tcp/127.0.0.1:{port}")];
    let listening = Settings { listen: endpoint.clone(), ..Settings::default() };
    let connecting = Settings { connect: endpoint, ..Settings::default() };
    let mut listener = Listener::open(Some("arm"), &listening, || false).unwrap().unwrap();
    let (is_over, mut merge) = (AtomicBool::new(false), Merge::default());
    let mut latencies = Vec::new();
    thread::scope(|scope| {
        for computer in 0..COMPUTERS {
            let (file, connecting, is_over) = (body_file(folder.path(), computer), &connecting, &is_over);
            scope.spawn(move || serve(&file, connecting, is_over));
        }
        let begun = Instant::now();
        while begun.elapsed() < START + Duration::from_secs(seconds) {
            let Some(heard) = listener.next(Duration::from_millis(20)) else { continue };
            // One clock for all: the computers are threads.
            if let Heard::Contacts { contacts, received_ns, .. } = &heard
                && begun.elapsed() > START
            {
                latencies.push(received_ns.saturating_sub(contacts.ended_ns) as f64 * 1e-6);
            }
            merge.take(heard, Instant::now());
        }
        is_over.store(true, Ordering::Relaxed);
    });
    let totals = merge.totals();
    assert_eq!(totals.len(), COMPUTERS * SKINS, "all skins are heard");
    let lost: u64 = totals.iter().map(|totals| totals.frames_lost).sum();
    let rate = latencies.len() as f64 / seconds as f64;
    let (median, most) = median_and_most(latencies);
    println!(
        "{} skins: {rate:.0} frames/s came, {lost} lost on the way, {} dropped here; end of scan to here: median {median:.2} ms, \
         99 % {most:.2} ms",
        totals.len(),
        listener.dropped(),
    );
    assert_eq!((lost, listener.dropped()), (0, 0), "none is lost");
    listener.end();
}

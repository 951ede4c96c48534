//! Rate: eight computers with eight skins each, 100 frames a second, without boards: what network and merging can do alone.
//!
//! `DERMATOME_SECONDS=30 cargo test -p dermatome-zenoh --test rate -- --nocapture`

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
use dermatome_zenoh::{Listener, Merge, Robot, Settings};
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

#[test]
fn sixty_four_skins_at_100_frames_a_second_are_merged_without_loss() {
    let seconds = std::env::var("DERMATOME_SECONDS").map_or(3, |text| text.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("skin.toml"), SKIN).unwrap();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let endpoint = vec![format!("tcp/127.0.0.1:{port}")];
    let listening = Settings { listen: endpoint.clone(), ..Settings::default() };
    let connecting = Settings { connect: endpoint, ..Settings::default() };
    let mut listener = Listener::open(Some("arm"), &listening, || false).unwrap().unwrap();
    let (is_over, mut merge) = (AtomicBool::new(false), Merge::default());
    let (begun, mut frames_at_once) = (Instant::now(), None);
    thread::scope(|scope| {
        for computer in 0..COMPUTERS {
            let (file, connecting, is_over) = (body_file(folder.path(), computer), &connecting, &is_over);
            scope.spawn(move || serve(&file, connecting, is_over));
        }
        while begun.elapsed() < Duration::from_secs(seconds + 2) {
            if let Some(heard) = listener.next(Duration::from_millis(20)) {
                merge.take(heard, Instant::now());
            }
            let senses = merge.body().senses();
            if frames_at_once.is_none() && senses.len() == COMPUTERS * SKINS {
                let frames: u64 = senses.iter().map(|sense| sense.frames).sum();
                frames_at_once = Some((Instant::now(), frames));
            }
        }
        is_over.store(true, Ordering::Relaxed);
    });
    let totals = merge.totals();
    let (since, before) = frames_at_once.expect("all skins are heard");
    let frames: u64 = totals.iter().map(|totals| totals.frames).sum();
    let rate = (frames - before) as f64 / (begun + Duration::from_secs(seconds + 2) - since).as_secs_f64();
    let lost: u64 = totals.iter().map(|totals| totals.frames_lost).sum();
    let mut latency: Vec<(f64, f64)> =
        totals.iter().map(|totals| totals.latency.map(|it| (it.median_ms, it.most_ms)).unwrap()).collect();
    latency.sort_by(|a, b| a.0.total_cmp(&b.0));
    let most = latency.iter().map(|it| it.1).fold(0.0, f64::max);
    println!(
        "{} skins: {rate:.0} frames/s, {frames} came, {lost} lost, {} dropped; until they are merged: median {:.2} ms, 99 % of \
         the worst skin {most:.2} ms",
        totals.len(),
        listener.dropped(),
        latency[latency.len() / 2].0
    );
    // Of 6,400: a busy machine is slower.
    assert!(rate > 1000.0, "{rate}");
    assert_eq!((totals.len(), lost, listener.dropped()), (COMPUTERS * SKINS, 0, 0));
    listener.end();
}

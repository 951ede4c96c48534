//! `serve --zenoh` and `body`: a robot's skins over several computers.
//!
//! Boards are simulated, and so are computers: processes at 127.0.0.1, or in network namespaces (`networks`). So many
//! computers and boards with `DERMATOME_COMPUTERS=8 DERMATOME_BOARDS=8 DERMATOME_SECONDS=60 cargo test --release
//! -p dermatome --features zenoh --test zenoh -- --nocapture many`.

mod hearing;
mod networks;
mod orders;
#[path = "../program/mod.rs"]
mod program;
mod strangers;
#[path = "../testbench/mod.rs"]
mod testbench;

use dermatome::simulate::{
    board::{BoardOptions, SimulatedBoard},
    instrument::{Instrument, ScanTable},
};
use dermatome_shared::frame::Frame;
use hearing::{Hearing, free_port};
use program::{Desk, Running, TINY, number, with, within};
use std::{
    fmt::Write as _,
    net::Ipv4Addr,
    thread,
    time::{Duration, Instant},
};
use testbench::{Pressed, UNTOUCHED};

/// Contacts again after a computer is back, and none any more after one is gone, at most, with `DERMATOME_BOUNDS=1`.
const RECOVERY: Duration = Duration::from_secs(2);
/// Until all that has been started is heard, on a busy machine.
const START: Duration = Duration::from_secs(60);

/// A body file of skins with these names, all on one link, each with a port.
fn body(skins: &[(String, String)]) -> String {
    let mut text = "name = \"arm\"\n".to_owned();
    for (name, port) in skins {
        write!(
            text,
            "[[patches]]\nname = \"{name}\"\nskin = \"skin.toml\"\nport = \"{port}\"\nlink = \"palm\"\n\
             position = [\"0 mm\", \"0 mm\", \"40 mm\"]\norientation = [0, 0, 0, 1]\n"
        )
        .unwrap();
    }
    text
}

/// A folder in which a computer serves one simulated skin of its own name: `left.toml` serves `left`.
fn desk_of(computers: &[&str]) -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    for computer in computers {
        let skin = ((*computer).to_owned(), "sim:skin.toml".to_owned());
        desk.write(&format!("{computer}.toml"), body(&[skin]));
    }
    desk
}

fn serve(desk: &Desk, file: &str, endpoint: &str) -> Running {
    let mut serve = desk.start(&["serve", file, "--zenoh-connect", endpoint]);
    serve.read_output();
    serve
}

#[test]
fn skins_of_two_computers_are_one_body_and_one_that_is_killed_takes_its_contacts_along() {
    let desk = desk_of(&["left", "right"]);
    let endpoint = format!("tcp/127.0.0.1:{}", free_port());
    let left = serve(&desk, "left.toml", &endpoint);
    let _right = serve(&desk, "right.toml", &endpoint);
    // It comes later than they do, and is not told which robot there is.
    let mut hearing =
        Hearing::start(desk.command(&["body", "--zenoh-listen", &endpoint, "--json", "report.json"]));
    for skin in ["left", "right"] {
        hearing.wait(skin, START, |said| said.phase == "live" && said.frames > 20);
    }
    drop(left);
    let gone = hearing.wait("left", within(RECOVERY), |said| said.phase == "lost");
    let text = hearing.said("left").text;
    assert!(text.starts_with("its computer `") && text.ends_with("` is gone"), "{text}");
    let frames = hearing.said("right").frames;
    hearing.wait("right", within(RECOVERY), |said| said.frames > frames + 10);
    let _left = serve(&desk, "left.toml", &endpoint);
    hearing.wait("left", START, |said| said.phase == "live");
    println!("a killed computer's contacts are over after {gone:.2?}");
    hearing.end();
    let report = desk.report("report.json");
    assert_eq!(report["body"], "arm");
    assert_eq!(report["findings"], serde_json::json!([]), "{report:#}");
    for patch in report["patches"].as_array().unwrap() {
        assert_eq!((&patch["frames_lost"], &patch["unreadable"]), (&0.into(), &0.into()), "{report:#}");
        assert!(patch["latency"]["median_ms"].as_f64().is_some(), "{report:#}");
        // Both programs have one clock.
        let ms = |key: &str| patch[key].as_f64().unwrap();
        assert!(ms("clock_ahead_ms").abs() <= ms("clock_doubt_ms") + 1e-5, "{report:#}");
    }
}

#[test]
fn a_skin_that_two_computers_claim_is_found() {
    let desk = desk_of(&["left"]);
    let endpoint = format!("tcp/127.0.0.1:{}", free_port());
    let mut hearing = Hearing::start(desk.command(&["body", "arm", "--zenoh-listen", &endpoint]));
    let _first = serve(&desk, "left.toml", &endpoint);
    hearing.wait("left", START, |said| said.frames > 0);
    let _second = serve(&desk, "left.toml", &endpoint);
    hearing.wait("left", START, |said| said.finding.contains("it is served twice, by `"));
    // An order would reach both boards.
    let refused = desk.run(&["body", "arm", "--tare", "left", "--zenoh-connect", &endpoint]).refused();
    assert!(refused.contains("2 programs say that they serve `dermatome/arm/"), "{refused}");
    hearing.end();
}

#[test]
fn what_is_wrong_with_the_network_is_said_in_words() {
    let desk = desk_of(&["left"]);
    for (arguments, words) in [
        (&["body", "arm", "--zenoh-connect", "pigeon/nowhere:1"][..], "pigeon"),
        (&["body", "arm", "--zenoh-config", "none.json5"], "Zenoh's configuration `none.json5`"),
        (&["body", "arm", "--zenoh-config", "skin.toml"], "Zenoh's configuration `skin.toml`"),
        (&["body", "an arm"], "`NAME` is \"an arm\"; allowed"),
        (
            &["body", "--zenoh-listen", "tcp/127.0.0.1:0", "--duration", "1"],
            "no computer serves a robot's skins",
        ),
        (&["serve", "left.toml", "--zenoh-listen", "tcp/8.8.8.8:1"], "`--zenoh`"),
    ] {
        let error = desk.run(arguments).refused();
        assert!(error.contains(words), "{arguments:?}: {error}");
    }
}

/// A skin that a finger holds in each frame that is streamed.
struct Held(Pressed);

impl Instrument for Held {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let mut frame = self.0.scan(table, None);
        if script_time.is_some() {
            frame.codes.iter_mut().take(5).for_each(|code| code.0 -= UNTOUCHED / 5);
        }
        frame
    }
}

#[test]
fn many_computers_with_many_boards_are_merged_without_loss() {
    let (computers, boards) = (number("DERMATOME_COMPUTERS", 2), number("DERMATOME_BOARDS", 2));
    let seconds = number("DERMATOME_SECONDS", 3);
    let desk = Desk::empty();
    desk.write("skin.toml", with(TINY, "frame_rate = \"50 Hz\"", "frame_rate = \"100 Hz\""));
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    let board = |seed: u64| {
        let patch = Some(desk.read("skin.dermatome"));
        let options =
            BoardOptions { listen: (Ipv4Addr::LOCALHOST, 0).into(), patch, ..BoardOptions::default() };
        SimulatedBoard::start(options, Held(Pressed::new(seed))).unwrap()
    };
    let endpoint = format!("tcp/127.0.0.1:{}", free_port());
    let mut hearing =
        Hearing::start(desk.command(&["body", "arm", "--zenoh-listen", &endpoint, "--json", "report.json"]));
    let mut simulated = Vec::new();
    let _serving: Vec<Running> = (0..computers)
        .map(|computer| {
            let skins = (0..boards).map(|index| {
                let board = board(computer * boards + index);
                let skin = (format!("skin{computer}_{index}"), format!("tcp:{}", board.address()));
                simulated.push(board);
                skin
            });
            let file = format!("computer{computer}.toml");
            desk.write(&file, body(&skins.collect::<Vec<_>>()));
            let arguments = ["serve", &file, "--no-images", "--zenoh-connect", &endpoint];
            let mut serve = desk.start(&arguments);
            serve.read_output();
            serve
        })
        .collect();
    for (computer, index) in
        (0..computers).flat_map(|computer| (0..boards).map(move |index| (computer, index)))
    {
        hearing.wait(&format!("skin{computer}_{index}"), START, |said| said.frames > 0);
    }
    thread::sleep(Duration::from_secs(seconds));
    hearing.end();
    let report = desk.report("report.json");
    let patches = report["patches"].as_array().unwrap();
    let of = |key: &str| -> Vec<u64> { patches.iter().map(|patch| patch[key].as_u64().unwrap()).collect() };
    let latency = |key: &str| {
        let mut all: Vec<f64> = patches.iter().map(|it| it["latency"][key].as_f64().unwrap()).collect();
        all.sort_by(f64::total_cmp);
        (all[all.len() / 2], all[all.len() - 1])
    };
    let (frames, lost) = (of("frames"), of("frames_lost"));
    println!(
        "{computers} computers x {boards} boards: {} to {} frames each, {} lost on the way, {} missing before; end of scan to \
         `body`: median {:.2} ms (worst skin {:.2}), 99 % {:.2} ms (worst skin {:.2})",
        frames.iter().min().unwrap(),
        frames.iter().max().unwrap(),
        lost.iter().sum::<u64>(),
        of("frames_missing").iter().sum::<u64>(),
        latency("median_ms").0,
        latency("median_ms").1,
        latency("most_ms").0,
        latency("most_ms").1,
    );
    assert_eq!(patches.len() as u64, computers * boards, "{report:#}");
    assert!(frames.iter().all(|frames| *frames > 10 * seconds), "{report:#}");
    assert_eq!(lost.iter().sum::<u64>(), 0, "{report:#}");
    assert_eq!((&report["messages_dropped"], &report["lines_dropped"]), (&0.into(), &0.into()), "{report:#}");
}

/// The time until `is_so`, at most `limit`.
fn until(limit: Duration, mut is_so: impl FnMut() -> bool) -> Option<Duration> {
    let begun = Instant::now();
    while !is_so() {
        if begun.elapsed() > limit {
            return None;
        }
        thread::sleep(Duration::from_millis(5));
    }
    Some(begun.elapsed())
}

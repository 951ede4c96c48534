//! `serve`: many boards at once, and what becomes of them when cables are pulled.
//!
//! A few cables are pulled in `./test`; a thousand times, over eight boards, with
//! `DERMATOME_BOUNDS=1 DERMATOME_PULLS=1000 cargo test --release -p dermatome --test serve -- --nocapture cables`; so many boards with
//! `DERMATOME_BOARDS=32 DERMATOME_SECONDS=60 cargo test --release -p dermatome --test serve -- --nocapture many`.

mod program;
mod testbench;

use dermatome::simulate::{
    board::{BoardOptions, SimulatedBoard},
    instrument::{Instrument, ScanTable},
};
use dermatome_shared::frame::Frame;
#[cfg(target_os = "linux")]
use program::memory;
use program::{Desk, TINY, number, transcript, with, within};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::Value;
use std::{
    fmt::Write as _,
    io::{BufRead, BufReader},
    net::{Ipv4Addr, SocketAddr},
    process::{ChildStdout, Command},
    sync::{Arc, Mutex},
    thread,
    time::{Duration, Instant},
};
use testbench::{Pressed, UNTOUCHED, cable::Cable};

/// Where a skin lies on its link, as a body file says it.
const PLACE: &str = "position = [\"0 mm\", \"0 mm\", \"40 mm\"]\norientation = [0, 0, 0, 1]\n";

/// Contacts again after a cable was plugged in, at most, with `DERMATOME_BOUNDS=1`.
const RECOVERY: Duration = Duration::from_secs(2);

/// A skin that a finger holds in each frame that is streamed.
struct Held(Pressed);

impl Instrument for Held {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let mut frame = self.0.scan(table, None);
        if script_time.is_some() {
            // What a drive between its first two electrodes senses falls where the sheet beside them conducts better.
            frame.codes.iter_mut().take(5).for_each(|code| code.0 -= UNTOUCHED / 5);
        }
        frame
    }
}

fn board(desk: &Desk, seed: u64) -> SimulatedBoard {
    let patch = Some(desk.read("skin.dermatome"));
    let options = BoardOptions { listen: (Ipv4Addr::LOCALHOST, 0).into(), patch, ..BoardOptions::default() };
    SimulatedBoard::start(options, Held(Pressed::new(seed))).unwrap()
}

/// A body file of skins with these names and ports, all on one link.
fn body(skins: &[(String, String)]) -> String {
    let mut text = "name = \"arm\"\n".to_owned();
    for (name, port) in skins {
        write!(text, "[[patches]]\nname = \"{name}\"\nskin = \"skin.toml\"\nport = \"{port}\"\nlink = \"palm\"\n{PLACE}").unwrap();
    }
    text
}

fn port(address: SocketAddr) -> String {
    format!("tcp:{address}")
}

/// What `serve` has last said of a skin.
#[derive(Clone, Debug, Default)]
struct Said {
    phase: String,
    /// When a frame with contacts came last.
    touched: Option<Instant>,
    sequence: Option<u64>,
    frames: u64,
}

/// Reads lines until they end; checks that nothing stale is among them.
fn read(out: ChildStdout, said: &Mutex<std::collections::HashMap<String, Said>>) {
    for line in BufReader::new(out).lines().map(Result::unwrap) {
        let line: Value = serde_json::from_str(&line).unwrap();
        assert_eq!(line["frames_dropped"], Value::Null, "{line}");
        let mut said = said.lock().unwrap();
        let skin = said.entry(line["patch"].as_str().unwrap().to_owned()).or_default();
        if let Some(phase) = line["state"]["phase"].as_str() {
            phase.clone_into(&mut skin.phase);
            if phase != "live" {
                skin.touched = None;
            }
            continue;
        }
        let sequence = line["sequence"].as_u64();
        assert_eq!(skin.phase, "live", "stale: {line}");
        assert!(sequence > skin.sequence, "stale: {line}");
        (skin.sequence, skin.frames) = (sequence, skin.frames + 1);
        if !line["contacts"].as_array().unwrap().is_empty() {
            skin.touched = Some(Instant::now());
        }
    }
}

#[test]
fn contacts_come_on_their_links_and_one_bad_board_stops_no_other() {
    let desk = Desk::with_patch();
    desk.write("other.toml", with(TINY, "name = \"tiny\"", "name = \"other\""));
    let (good, other) = (board(&desk, 1), board(&desk, 2));
    let (address, other) = (port(good.address()), port(other.address()));
    desk.write(
        "robot.toml",
        format!(
            "name = \"arm\"\n\
             [[patches]]\nname = \"palm\"\nskin = \"skin.toml\"\nport = \"{address}\"\nlink = \"palm\"\n{PLACE}\
             [[patches]]\nname = \"gone\"\nskin = \"skin.toml\"\nport = \"tcp:127.0.0.1:1\"\nlink = \"palm\"\n{PLACE}\
             [[patches]]\nname = \"wrong\"\nskin = \"other.toml\"\nport = \"{other}\"\nlink = \"palm\"\n{PLACE}\
             [[patches]]\nname = \"unreadable\"\nskin = \"skin.toml\"\nport = \"replay:none.mcap\"\nlink = \"palm\"\n{PLACE}"
        ),
    );
    let done = desk.run(&["serve", "robot.toml", "--duration", "3", "--json", "report.json"]).success();
    let lines: Vec<Value> = done.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let state = |patch: &str| {
        let of = |line: &&Value| line["patch"] == patch && line["state"].is_object();
        lines.iter().rfind(of).unwrap_or_else(|| panic!("{patch}: {}", done.out))["state"].clone()
    };
    assert_eq!(state("palm")["phase"], "live");
    assert_eq!(state("gone")["phase"], "no_board");
    assert_eq!(state("wrong")["phase"], "other_patch");
    assert!(state("wrong")["text"].as_str().unwrap().contains("for `tiny`"), "{}", state("wrong"));
    assert_eq!(state("unreadable")["phase"], "ended");
    let frames: Vec<&Value> = lines.iter().filter(|line| line["contacts"].is_array()).collect();
    assert!(frames.iter().all(|line| line["patch"] == "palm" && line["link"] == "palm"), "{}", done.out);
    let mut touched = frames.iter().filter(|line| !line["contacts"].as_array().unwrap().is_empty());
    let contact = &touched.next_back().unwrap()["contacts"][0];
    // The skin's height on its link.
    assert!((contact["position_m"][2].as_f64().unwrap() - 0.04).abs() < 1e-6, "{contact}");
    assert!(!contact["pixels"].as_array().unwrap().is_empty(), "{contact}");
    let report = desk.report("report.json");
    assert_eq!(report["patches"][0]["frames"], frames.len() as u64, "{report:#}");
    assert_eq!(report["patches"][0]["frames_missing"], 0, "{report:#}");
    let mut times = frames.iter().map(|line| line["time_s"].as_f64().unwrap());
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap().as_secs_f64();
    assert!(
        times.clone().is_sorted() && times.next_back().is_some_and(|time| (now - 60.0..now).contains(&time))
    );
}

#[cfg(target_os = "linux")]
#[test]
fn cables_are_pulled_at_random_and_contacts_come_back_each_time() {
    let (boards, pulls) = (8, number("DERMATOME_PULLS", 24));
    let desk = Desk::with_patch();
    let boards: Vec<SimulatedBoard> = (0..boards).map(|seed| board(&desk, seed)).collect();
    let cables: Vec<Cable> = boards.iter().map(|board| Cable::to(board.address())).collect();
    let names = (0..cables.len()).map(|index| format!("skin{index}"));
    let skins: Vec<_> = names.zip(&cables).map(|(name, cable)| (name, port(cable.address()))).collect();
    desk.write("robot.toml", body(&skins));
    let mut serve = desk.command(&["serve", "robot.toml"]).spawn().unwrap();
    let said = Arc::<Mutex<std::collections::HashMap<String, Said>>>::default();
    let reader = {
        let (out, said) = (serve.stdout.take().unwrap(), said.clone());
        thread::spawn(move || read(out, &said))
    };
    let skin = |name: &str| said.lock().unwrap().get(name).cloned().unwrap_or_default();
    // Contacts that came after `since`, at most so long after.
    let touched_after = |name: &str, since: Instant, limit: Duration| loop {
        if skin(name).touched.is_some_and(|touched| touched > since) {
            return since.elapsed();
        }
        assert!(
            since.elapsed() < limit && !reader.is_finished(),
            "{name} after {:?}: {:?}",
            since.elapsed(),
            skin(name)
        );
        thread::sleep(Duration::from_millis(1));
    };
    let begun = Instant::now();
    for (name, _) in &skins {
        touched_after(name, begun, Duration::from_secs(30));
    }
    let before = memory(serve.id());
    let slowest = thread::scope(|scope| {
        let pullers = skins.iter().zip(&cables).enumerate().map(|(index, ((name, _), cable))| {
            scope.spawn(move || {
                let mut random = Pcg64::seed_from_u64(index as u64);
                let mut slowest = Duration::ZERO;
                for _ in 0..pulls.div_ceil(8) {
                    thread::sleep(Duration::from_millis(random.random_range(0..300)));
                    cable.pull();
                    thread::sleep(Duration::from_millis(random.random_range(0..600)));
                    cable.plug_in();
                    let again = Instant::now();
                    slowest = slowest.max(touched_after(name, again, within(RECOVERY)));
                }
                slowest
            })
        });
        let pullers: Vec<_> = pullers.collect();
        pullers.into_iter().map(|puller| puller.join().unwrap()).max().unwrap()
    });
    let after = memory(serve.id());
    assert!(Command::new("kill").args(["-INT", &serve.id().to_string()]).status().unwrap().success());
    assert!(serve.wait().unwrap().success());
    reader.join().unwrap();
    println!(
        "{pulls} times pulled: contacts again after {:.2} s at most; memory {before} kB, then {after} kB",
        slowest.as_secs_f64()
    );
    assert!(after < before + 4000, "{before} kB, then {after} kB");
}

#[cfg(target_os = "linux")]
#[test]
fn many_boards_are_served_at_once() {
    let (count, seconds) = (number("DERMATOME_BOARDS", 8), number("DERMATOME_SECONDS", 3));
    let desk = Desk::empty();
    let skin = with(TINY, "frame_rate = \"50 Hz\"", "frame_rate = \"100 Hz\"");
    let skin = std::env::var("DERMATOME_SKIN").map_or(skin, |path| std::fs::read_to_string(path).unwrap());
    desk.write("skin.toml", skin);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    let boards: Vec<SimulatedBoard> = (0..count).map(|seed| board(&desk, seed)).collect();
    let skins: Vec<_> = boards
        .iter()
        .enumerate()
        .map(|(index, board)| (format!("skin{index}"), port(board.address())))
        .collect();
    desk.write("robot.toml", body(&skins));
    let mut serve = desk.start(&[
        "serve",
        "robot.toml",
        "--duration",
        &(seconds + 4).to_string(),
        "--json",
        "report.json",
    ]);
    serve.read_output();
    let ticks = |id: u32| {
        let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).unwrap();
        let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
        fields[11].parse::<u64>().unwrap() + fields[12].parse::<u64>().unwrap()
    };
    // Until all are tared.
    thread::sleep(Duration::from_secs(3));
    let (before, begun) = (ticks(serve.id()), Instant::now());
    thread::sleep(Duration::from_secs(seconds));
    let share = (ticks(serve.id()) - before) as f64 / begun.elapsed().as_secs_f64();
    serve.finish().success();
    let report = desk.report("report.json");
    let of = |key: &str| -> Vec<u64> {
        report["patches"].as_array().unwrap().iter().map(|patch| patch[key].as_u64().unwrap()).collect()
    };
    let (frames, missing) = (of("frames"), of("frames_missing"));
    println!(
        "{count} boards: {} to {} frames each, {} missing, {} dropped, {} lines dropped; CPU of serve {share:.0} %",
        frames.iter().min().unwrap(),
        frames.iter().max().unwrap(),
        missing.iter().sum::<u64>(),
        report["frames_dropped"],
        report["lines_dropped"]
    );
    assert!(frames.iter().all(|frames| *frames > 10 * seconds), "{report:#}");
    assert_eq!((&report["frames_dropped"], &report["lines_dropped"]), (&0.into(), &0.into()), "{report:#}");
}

#[test]
fn what_is_wrong_with_a_body_file_is_said_in_words() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk.write("empty.toml", "name = \"arm\"\npatches = []\n");
    desk.write("unplaced.toml", "name = \"arm\"\n[[patches]]\nskin = \"skin.toml\"\nport = \"COM5\"\n");
    desk.write("colour.toml", "name = \"arm\"\ncolour = 3\n");
    insta::assert_snapshot!(transcript(
        &desk,
        &[
            &["serve", "none.toml"],
            &["serve", "empty.toml"],
            &["serve", "unplaced.toml"],
            &["serve", "colour.toml"],
            &["serve", "skin.toml"],
            &["serve", "empty.toml", "--duration", "-1"],
        ],
    ));
}

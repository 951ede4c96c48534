//! `serve --record`: all boards of a body in one file, and what is made of it again; and what `serve` says of reflexes.

mod program;
mod testbench;

use assert_cmd::cargo::cargo_bin;
use dermatome::{
    recording::{
        frames::{Frames, Item},
        read::{Ending, Recording},
    },
    simulate::board::{BoardOptions, SimulatedBoard},
};
use program::{Desk, Done, Running, TINY};
use serde_json::Value;
use std::{
    fmt::Write as _,
    net::Ipv4Addr,
    process::{Command, Stdio},
    thread,
    time::Duration,
};
use testbench::{Pressed, cable::Cable};

/// A place on a link that turns a skin about all axes.
const PLACE: &str =
    "position = [\"10 mm\", \"0 mm\", \"40 mm\"]\norientation = [0.1, 0.2, 0.3, 0.9273618495495703]\n";

/// A body file of skins with these names and ports.
fn body(skins: &[(&str, &str)]) -> String {
    let mut text = "name = \"arm\"\n".to_owned();
    for (name, port) in skins {
        write!(text, "[[patches]]\nname = \"{name}\"\nskin = \"skin.toml\"\nport = \"{port}\"\nlink = \"{name}_link\"\n{PLACE}").unwrap();
    }
    text
}

/// Two boards that are there, and one that is not, recorded for so many seconds.
fn recorded(seconds: &str) -> (Desk, Done) {
    let desk = Desk::with_patch();
    let skins = [("palm", "sim:skin.toml"), ("back", "sim:skin.toml"), ("gone", "tcp:127.0.0.1:1")];
    desk.write("robot.toml", body(&skins));
    let serve = ["serve", "robot.toml", "--record", "run.mcap", "--duration", seconds];
    let done = desk.run(&serve).success();
    (desk, done)
}

#[test]
fn all_boards_are_in_one_file_and_each_is_replayed_bit_for_bit_on_its_link() {
    let (desk, served) = recorded("5");
    let lines: Vec<Value> = served.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    for patch in ["palm", "back"] {
        let done = desk.run(&["replay", &format!("run.mcap:{patch}"), "--json", "replay.json"]).success();
        assert!(done.err.contains("the same as simulated sent, bit for bit"), "{}", done.err);
        let report = desk.report("replay.json");
        let same = &report["same"];
        let shown = lines.iter().filter(|line| line["patch"] == patch && line["contacts"].is_array()).count();
        assert!(shown > 50, "{}", served.out);
        // Of those that were shown before the new reference nobody knows what the board knew.
        assert!(same["images_compared"].as_u64() > Some(shown as u64 / 2), "{shown}: {report}");
        assert_eq!((&same["images_differ"], &same["contacts_differ"]), (&0.into(), &0.into()));
        assert_eq!((&report["is_whole"], &same["frames_missing"]), (&true.into(), &0.into()));
        assert!(report["frames_with_contacts"].as_u64() > Some(10), "{report}");
        assert_eq!(report["recorded_at"], "sim:skin.toml");
    }
    assert!(served.err.contains("frames to run.mcap"), "{}", served.err);
    // The skin file in the recording lies where the body has it.
    let recording = Recording::open(&desk.path("run.mcap:palm")).unwrap();
    let text = recording.session().skin_file.clone().unwrap();
    assert!(text.contains("link = \"palm_link\"") && text.starts_with("# A coarse skin"), "{text}");
    let streamed = desk.run(&["stream", "--port", "replay:run.mcap:back", "--frames", "30"]).success();
    assert!(streamed.err.contains("30 frames received, 0 lost"), "{}", streamed.err);
    let cut = &desk.read("run.mcap")[..desk.read("run.mcap").len() * 2 / 3];
    desk.write("cut.mcap", cut);
    let done = desk.run(&["replay", "cut.mcap:palm"]).success();
    assert!(done.err.contains("was cut off") && done.err.contains("bit for bit"), "{}", done.err);
    for (arguments, words) in [
        (["replay", "run.mcap"], "`:palm`, `:back`, `:gone`"),
        (["replay", "run.mcap:foot"], "not of a skin `foot`"),
        (["replay", "run.mcap:gone"], "nothing of `arm/gone`"),
        (["replay", "none.mcap:palm"], "none.mcap"),
        (["stream", "--port=replay:run.mcap"], "`:palm`, `:back`, `:gone`"),
    ] {
        let told = desk.run(&arguments).refused();
        assert!(told.contains(words), "{arguments:?}: {told}");
    }
    let before = desk.read("run.mcap");
    let again = ["serve", "robot.toml", "--duration", "1", "--record", "run.mcap"];
    let told = desk.run(&again).refused();
    assert!(told.contains("run.mcap") && told.contains("--force"), "{told}");
    let onto = ["replay", "run.mcap:palm", "--record", "run.mcap", "--force"];
    let told = desk.run(&onto).refused();
    assert!(told.contains("would overwrite"), "{told}");
    let played = "name = \"arm\"\n[[patches]]\nskin = \"skin.toml\"\nlink = \"palm\"\n\
        port = \"replay:run.mcap:palm\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 1]\n";
    desk.write("played.toml", played);
    let told = desk.run(&["serve", "played.toml", "--record", "run.mcap", "--force"]).refused();
    assert!(told.contains("would overwrite"), "{told}");
    assert_eq!(desk.read("run.mcap"), before);
}

/// Until so many more frames of a patch have been printed.
fn wait_for_frames(serve: &mut Running, count: usize, patch: &str) {
    let (patch, mut seen) = (format!("\"patch\":\"{patch}\""), 0);
    while seen < count {
        let line = serve.line();
        seen += usize::from(line.contains(&patch) && line.contains("\"sequence\""));
    }
}

/// Sequence of each frame, and when it came, s since 1970; how many references there are, and how it ends.
fn frames(desk: &Desk, name: &str) -> (Vec<(u32, f64)>, usize, Ending) {
    let mut frames = Frames::of(Recording::open(&desk.path(name)).unwrap());
    let (mut found, mut references) = (Vec::new(), 0);
    while let Some(item) = frames.next_item().unwrap() {
        match item {
            Item::Frame(frame) => found.push((frame.at.sequence, frame.log_time as f64 * 1e-9)),
            Item::Reference(_) => references += 1,
        }
    }
    (found, references, frames.recording().ending().clone())
}

#[cfg(target_os = "linux")]
#[test]
fn a_board_that_comes_back_and_one_that_comes_later_go_on_in_the_same_file_until_ctrl_c() {
    let desk = Desk::with_patch();
    let board = |seed| {
        let patch = Some(desk.read("skin.dermatome"));
        let listen = (Ipv4Addr::LOCALHOST, 0).into();
        SimulatedBoard::start(BoardOptions { listen, patch, ..BoardOptions::default() }, Pressed::new(seed))
            .unwrap()
    };
    let boards = [board(1), board(2)];
    let cables = boards.each_ref().map(|board| Cable::to(board.address()));
    let ports = cables.each_ref().map(|cable| format!("tcp:{}", cable.address()));
    desk.write("robot.toml", body(&[("palm", &ports[0]), ("back", &ports[1])]));
    cables[1].pull();
    let mut serve = desk.start(&["serve", "robot.toml", "--record", "run.mcap"]);
    wait_for_frames(&mut serve, 100, "palm");
    // `back` comes at least a second later.
    thread::sleep(Duration::from_secs(1));
    cables[0].pull();
    cables[1].plug_in();
    wait_for_frames(&mut serve, 100, "back");
    cables[0].plug_in();
    wait_for_frames(&mut serve, 100, "palm");
    assert!(serve.is_running());
    serve.interrupt();
    let done = serve.finish().success();
    assert!(done.err.contains("frames to run.mcap") && done.err.contains("lost 1 times"), "{}", done.err);
    let (palm, references, ending) = frames(&desk, "run.mcap:palm");
    assert_eq!((references, ending), (1, Ending::Whole), "it keeps its reference");
    assert!(palm.is_sorted_by(|a, b| a.0 < b.0), "{palm:?}");
    let gap = palm.windows(2).position(|pair| pair[1].1 - pair[0].1 > 0.5).unwrap();
    assert!(gap > 50 && palm.len() - gap > 50, "{gap} of {}", palm.len());
    let (back, references, ending) = frames(&desk, "run.mcap:back");
    assert_eq!((references, ending), (1, Ending::Whole));
    assert!(
        back.len() > 50 && back[0].1 - palm[0].1 > 1.0,
        "{} after {} s",
        back.len(),
        back[0].1 - palm[0].1
    );
    let done = desk.run(&["replay", "run.mcap:back"]).success();
    assert!(done.err.contains("bit for bit"), "{}", done.err);
}

#[test]
fn a_board_that_starts_anew_gets_a_new_reference_and_is_replayed_through_both() {
    let desk = Desk::with_patch();
    let (board, port) = desk.board("skin.toml", &["--store", "flash.dermatome"]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    desk.write("robot.toml", body(&[("palm", &port)]));
    let mut serve = desk.start(&["serve", "robot.toml", "--record", "run.mcap"]);
    wait_for_frames(&mut serve, 100, "palm");
    drop(board);
    let _board = desk.start(&["simulate", "skin.toml", "--store", "flash.dermatome", "--listen", &port]);
    while !serve.line().contains("\"taring\"") {}
    wait_for_frames(&mut serve, 100, "palm");
    serve.interrupt();
    serve.finish().success();
    let (found, references, _) = frames(&desk, "run.mcap:palm");
    let restart = found.windows(2).position(|pair| pair[1].0 < pair[0].0).unwrap();
    assert!(references == 2 && restart > 50 && found.len() - restart > 50, "{references}, {restart}");
    let done = desk.run(&["replay", "run.mcap:palm", "--json", "replay.json"]).success();
    assert!(done.err.contains("bit for bit"), "{}", done.err);
    let report = desk.report("replay.json");
    assert!(report["frames_with_contacts"].as_u64() > Some(50), "{report}");
}

#[cfg(target_os = "linux")]
#[test]
fn where_the_disk_is_full_serve_goes_on_says_so_once_and_ends_with_an_error() {
    let desk = Desk::with_patch();
    desk.write("robot.toml", body(&[("palm", "sim:skin.toml"), ("back", "sim:skin.toml")]));
    let told = desk.run(&["serve", "robot.toml", "--record", "/dev/full"]).refused();
    assert!(told.contains("cannot record to `/dev/full`") && told.contains("space"), "{told}");
    // No file may grow beyond 600 blocks, as on a disk that is full.
    let script = format!(
        "trap '' XFSZ; ulimit -f 600; exec '{}' serve robot.toml --record run.mcap --duration 7 --json report.json",
        cargo_bin("dermatome").display()
    );
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(desk.path("")).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut serve = Running::start(&mut command);
    serve.read_output();
    let words = serve.finish().refused();
    assert_eq!(words.matches("the recording `run.mcap` has ended").count(), 1, "{words}");
    assert!(words.contains("all else goes on") && words.contains("cannot record to `run.mcap`"), "{words}");
    let served = desk.report("report.json")["patches"][0]["frames"].as_u64().unwrap();
    let (palm, _, ending) = frames(&desk, "run.mcap:palm");
    assert_eq!(ending, Ending::Cut);
    assert!(palm.len() > 10 && (palm.len() as u64) < served, "{} of {served}", palm.len());
}

#[test]
fn a_reflex_that_trips_and_is_released_is_a_line_as_stream_has_it() {
    let desk = Desk::empty();
    let rule = "\n[[reflexes]]\nname = \"bumper\"\npin = 2\nstrength = 1.0\ncentre = [\"25 mm\", \"0 mm\"]\nradius = \"20 mm\"\n";
    desk.write("skin.toml", TINY.to_owned() + rule);
    // A finger that goes from the region to the other side.
    let path = "time_s,finger,x_m,y_m,radius_m,depth\n0,1,0.025,0,0.012,0.9\n2,1,0.025,0,0.012,0.9\n\
                2.5,1,-0.025,0,0.012,0.9\n60,1,-0.025,0,0.012,0.9\n";
    desk.write("path.csv", path);
    let (_board, port) = desk.board("skin.toml", &["--path", "path.csv"]);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    desk.write("robot.toml", body(&[("palm", &port)]));
    let done = desk.run(&["serve", "robot.toml", "--duration", "6"]).success();
    let lines: Vec<Value> = done.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let said: Vec<&Value> = lines.iter().filter(|line| line["reflexes"].is_object()).collect();
    assert!(said.iter().all(|line| line["patch"] == "palm" && line["link"] == "palm_link"), "{}", done.out);
    let tripped: Vec<(&Value, &Value)> =
        said.iter().map(|line| (&line["reflexes"]["tripped"], &line["reflexes"]["blind"])).collect();
    let is = |rules: Value| move |(tripped, blind): &(&Value, &Value)| **tripped == rules && **blind == false;
    let first = tripped.iter().position(is(serde_json::json!([1]))).unwrap_or_else(|| panic!("{said:#?}"));
    assert!(tripped[first..].iter().any(is(serde_json::json!([]))), "{said:#?}");
    assert!(tripped.is_sorted_by(|before, now| before != now), "only what changes is said: {said:#?}");
    assert_eq!(said[0]["reflexes"]["values"].as_array().unwrap().len(), 1);
}

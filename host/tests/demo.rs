//! The commands together, as a user runs them: the demo, and a session with a simulated board in a
//! process of its own.

mod program;

use program::{Desk, Done, TINY, shape, within};
use serde_json::Value;
use std::time::Duration;

/// A reconstruction must be this good: the thesis' figure for saline, % of the diameter.
const POSITION_ERROR_PERCENT: f64 = 4.0;
/// Largest difference between fixed point and f64, % of the image's peak.
const FIXED_POINT_ERROR_PERCENT: f64 = 0.5;

fn number(report: &Value, at: &str) -> f64 {
    report.pointer(at).and_then(Value::as_f64).unwrap_or_else(|| panic!("{at} in {report:#}"))
}

#[test]
fn the_demo_shows_what_it_promises() {
    let desk = Desk::empty();
    let done = desk.run(&["demo", "--json", "demo.json", "--png", "shown.png"]).success();
    assert_eq!(done.err, "", "no progress where there is no terminal");
    assert_eq!(desk.files(), ["demo.json", "shown.png"]);
    let report = desk.report("demo.json");
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("demo_json", shape(&report)));
    assert!(number(&report, "/frames_received") >= 200.0, "{report:#}");
    assert_eq!(number(&report, "/frames_lost"), 0.0);
    assert!(number(&report, "/images_per_second") > 0.0, "{report:#}");
    assert!(number(&report, "/position_error_percent/mean") <= POSITION_ERROR_PERCENT, "{report:#}");
    assert!(number(&report, "/fixed_point_error_percent/max") <= FIXED_POINT_ERROR_PERCENT, "{report:#}");
    let share = |seen: &str, of: &str| number(&report, seen) / number(&report, of);
    assert!(share("/single_press_frames_with_one_contact", "/single_press_frames") > 0.9, "{report:#}");
    assert!(share("/two_press_frames_with_two_contacts", "/two_press_frames") > 0.9, "{report:#}");
    for words in ["frames received / lost", "images per second", "position error", "RES", "RNG", "patch"] {
        assert!(done.out.contains(words), "{words} is missing in:\n{}", done.out);
    }
    assert_is_a_picture(&desk.read("shown.png"));
}

/// Three boards on one processor: what an arm feels does not depend on how fast they are.
#[test]
fn an_arm_feels_where_it_is_touched_on_each_of_its_links() {
    let desk = Desk::empty();
    let done = desk.run(&["demo", "--robot", "--json", "demo.json"]).success();
    assert_eq!(done.err, "", "no progress where there is no terminal");
    assert_eq!(desk.files(), ["demo.json"]);
    let report = desk.report("demo.json");
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("demo_robot_json", shape(&report)));
    assert_eq!(number(&report, "/frames_missing"), 0.0, "{report:#}");
    assert_eq!(number(&report, "/contacts_of_nothing"), 0.0, "{report:#}");
    let touches = report["touches"].as_array().unwrap();
    let links: std::collections::BTreeSet<_> =
        touches.iter().map(|touch| touch["link"].as_str().unwrap()).collect();
    assert_eq!((touches.len(), links.len()), (8, 3), "{report:#}");
    for touch in touches {
        assert_eq!(number(touch, "/frames_felt"), number(touch, "/frames"), "{report:#}");
        assert!(number(touch, "/frames") >= 25.0 && number(touch, "/error_mm_max") <= 3.0, "{report:#}");
    }
    assert!(done.out.contains("touches felt            8 of 8"), "{}", done.out);
}

/// The PNG decodes, is as large as a picture of eight moments must be, and shows something.
fn assert_is_a_picture(bytes: &[u8]) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    assert!(frame.width >= 400 && frame.height >= 400, "{} x {}", frame.width, frame.height);
    let sample = frame.color_type.samples();
    let pixels = &pixels[..frame.buffer_size()];
    let colours: std::collections::HashSet<_> = pixels.chunks_exact(sample).collect();
    assert!(colours.len() > 50, "only {} colours", colours.len());
    let background = pixels.chunks_exact(sample).filter(|pixel| *pixel == &pixels[..sample]).count();
    let share = background as f64 / (pixels.len() / sample) as f64;
    assert!((0.05..0.98).contains(&share), "the background covers {share:.3}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_the_demo_soon_with_a_report_of_what_it_saw() {
    let desk = Desk::empty();
    let mut demo = desk.start(&["demo", "--json", "demo.json"]);
    while !demo.line().contains("watch the fingers") {}
    std::thread::sleep(Duration::from_millis(1500));
    let done = interrupted(demo);
    assert!(done.out.contains("stopped after ") && done.out.contains(" of 300 frames"), "{}", done.out);
    let report = desk.report("demo.json");
    assert!((10.0..200.0).contains(&number(&report, "/frames_received")), "{report:#}");
    assert_eq!(number(&report, "/frames_lost"), 0.0);
    assert!(number(&report, "/position_error_percent/mean") <= POSITION_ERROR_PERCENT, "{report:#}");
    assert_eq!(desk.files(), ["demo.json", "demo.png"]);
    assert!(!done.out.contains("NaN"), "{}", done.out);
}

#[cfg(unix)]
#[test]
fn ctrl_c_before_the_first_frame_ends_the_demo_at_that_frame() {
    let desk = Desk::empty();
    let mut demo = desk.start(&["demo", "--json", "demo.json"]);
    demo.line();
    let done = interrupted(demo);
    assert!(!done.out.contains("NaN") && !done.out.contains("-0.00"), "{}", done.out);
    let report = desk.report("demo.json");
    assert_eq!(number(&report, "/frames_received"), 1.0, "{report:#}");
    let rings = report["position_error_by_radius"].as_array().unwrap();
    assert_eq!(rings.len(), 1, "figures only of what was seen: {report:#}");
    assert_eq!(desk.files(), ["demo.json", "demo.png"]);
}

/// Ctrl-C ends a program soon, without an error.
#[cfg(unix)]
fn interrupted(program: program::Running) -> Done {
    program.interrupt();
    program.finish_within(within(Duration::from_secs(2))).success()
}

#[test]
fn stream_starts_a_simulated_board_of_its_own() {
    let desk = Desk::empty();
    let skin = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/disc-210mm/skin.toml");
    std::fs::copy(skin, desk.path("skin.toml")).unwrap();
    let stream = ["stream", "--port", "sim:skin.toml", "--frames", "20", "--json", "stream.json"];
    let done = desk.run(&stream).success();
    assert!(done.err.contains("20 frames received, 0 lost"), "{}", done.err);
    let report = desk.report("stream.json");
    assert_eq!((&report["frames_received"], &report["frames_lost"]), (&20.into(), &0.into()));
    assert_eq!((&report["skin"], &report["ended"]), (&"disc-210mm".into(), &"frames".into()));
    // The finger goes round at half of the way to the rim; every line is one contact.
    let rows = contacts(&done);
    assert!(rows.len() >= 15, "{}", done.out);
    for row in &rows {
        let radius = row[2].hypot(row[3]);
        assert!((radius - 52.5).abs() < 0.04 * 210.0, "{row:?}");
    }
}

/// Lines of `stream`: sequence, time in s, x, y and z in mm, area in mm2, strength.
fn contacts(done: &Done) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split('\t').take(7).map(|field| field.parse().unwrap()).collect();
    done.out.lines().map(row).collect()
}

fn stream(desk: &Desk, port: &str, frames: &str) -> (Done, Value) {
    let done = desk.run(&["stream", "--port", port, "--frames", frames, "--json", "stream.json"]).success();
    let report = desk.report("stream.json");
    assert_eq!(report["frames_received"].to_string(), frames);
    for lost in ["frames_lost", "events_lost", "packets_damaged"] {
        assert_eq!(report[lost], 0, "{report:#}");
    }
    (done, report)
}

#[test]
fn flash_tare_and_stream_and_the_board_still_has_its_patch_after_a_restart() {
    let desk = Desk::with_patch();
    let options = ["--store", "board.dermatome", "--press", "0.02,-0.01,0.012,1"];
    let (board, port) = desk.board("skin.toml", &options);
    assert!(desk.run(&["stream", "--port", &port]).refused().contains("dermatome flash"));

    let flashed = desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    assert!(flashed.out.contains("now uses patch `tiny`"), "{}", flashed.out);
    desk.run(&["tare", "--port", &port]).success();
    let (done, report) = stream(&desk, &port, "30");
    assert_eq!(report["tared_first"], false);
    assert_rests_at(&done, [20.0, -10.0]);
    drop(board);
    assert_eq!(desk.read("board.dermatome"), desk.read("skin.dermatome"));

    let (_board, port) = desk.board("skin.toml", &options);
    let (done, report) = stream(&desk, &port, "30");
    assert_eq!((&report["skin"], &report["tared_first"]), (&"tiny".into(), &true.into()));
    assert_rests_at(&done, [20.0, -10.0]);
}

/// The finger that rests there, mm, is seen in every frame, within the promised error of the 100 mm disc.
fn assert_rests_at(done: &Done, [x, y]: [f64; 2]) {
    let rows = contacts(done);
    assert_eq!(rows.len(), 30, "{}", done.out);
    for row in &rows {
        assert!((row[2] - x).hypot(row[3] - y) < POSITION_ERROR_PERCENT, "{row:?}");
    }
}

#[test]
fn a_patch_for_more_electrodes_is_refused_with_both_counts_and_the_old_one_stays() {
    let desk = Desk::with_patch();
    desk.write("sixteen.toml", TINY.replace("count = 8", "count = 16").replace("tiny", "sixteen"));
    desk.run(&["build", "sixteen.toml", "-o", "sixteen.dermatome"]).success();
    let (_board, port) = desk.board("skin.toml", &["--store", "board.dermatome"]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();

    let words = desk.run(&["flash", "sixteen.dermatome", "--port", &port]).refused();
    assert!(words.contains("16 electrodes") && words.contains("has 8"), "{words}");
    assert_eq!(desk.read("board.dermatome"), desk.read("skin.dermatome"));
    let (_, report) = stream(&desk, &port, "3");
    assert_eq!(report["skin"], "tiny");
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_simulate_without_an_error_even_while_it_streams() {
    let desk = Desk::with_patch();
    let (board, port) = desk.board("skin.toml", &[]);
    interrupted(board);
    let (board, port_of_busy) = desk.board("skin.toml", &[]);
    assert_ne!(port, port_of_busy);
    desk.run(&["flash", "skin.dermatome", "--port", &port_of_busy]).success();
    let mut stream = desk.start(&["stream", "--port", &port_of_busy, "--give-up-after", "0"]);
    stream.line();
    interrupted(board);
    let words = stream.finish_within(Duration::from_secs(10)).refused();
    assert!(words.contains("cut") || words.contains("closed"), "{words}");
}

#[test]
fn simulate_ends_after_its_frames() {
    let desk = Desk::with_patch();
    let (board, port) = desk.board("skin.toml", &["--frames", "12", "--json", "board.json"]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let done = desk.run(&["stream", "--port", &port]).success();
    assert!(done.err.contains("12 frames received, 0 lost"), "{}", done.err);
    assert!(done.err.contains("the board ended its stream"), "{}", done.err);
    board.finish_within(Duration::from_secs(10)).success();
    let report = desk.report("board.json");
    assert_eq!((&report["port"], &report["skin"]), (&port.into(), &"tiny".into()));
    assert!(report["simulated_elements"].as_u64() > Some(100));
}

#[cfg(unix)]
#[test]
fn a_board_that_other_machines_reach_is_meant_and_warns() {
    let desk = Desk::with_patch();
    let words = desk.run(&["simulate", "skin.toml", "--listen", "tcp:0.0.0.0:0"]).refused();
    assert!(words.contains("--allow-remote"), "{words}");
    let mut board = desk.start(&["simulate", "skin.toml", "--listen", "tcp:0.0.0.0:0", "--allow-remote"]);
    board.line();
    let done = interrupted(board);
    assert!(done.err.contains("warning: other machines may reach this board at 0.0.0.0:"), "{}", done.err);
}

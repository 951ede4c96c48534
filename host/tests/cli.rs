//! The program's words: help, output, errors and reports, as a user sees them.
//!
//! Review changes with `cargo insta review`, or accept them all with `INSTA_UPDATE=always`.
#![cfg(unix)]

mod program;

use insta::{Settings, assert_snapshot};
use program::{Desk, TINY, row, shape, tiny_voltages, transcript};
use std::{
    fs::File,
    net::{SocketAddr, TcpListener},
    time::{Duration, Instant},
};

/// Snapshots with everything that changes from run to run replaced.
fn filtered(check: impl FnOnce()) {
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    settings.add_filter(r" +\d+\.\d ms", " [TIME] ms");
    settings.add_filter(r"\d+\.\d+ %", "[PERCENT] %");
    settings.add_filter(r"127\.0\.0\.1:\d{5}", "127.0.0.1:[PORT]");
    settings.add_filter(r"0x[0-9a-f]{8}", "0x[CRC]");
    settings.bind(check);
}

/// A port that was free a moment ago.
fn nobody_listens() -> SocketAddr {
    TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap()
}

#[test]
fn help_of_the_program_and_of_every_command() {
    let desk = Desk::empty();
    let program = desk.run(&["--help"]).success().out;
    filtered(|| assert_snapshot!("help", program));
    let commands = dermatome_command::command();
    for command in commands.get_subcommands() {
        let command = command.get_name();
        assert!(program.contains(&format!("\n  {command} ")), "{command} is not in the program's help");
        let help = desk.run(&[command, "--help"]).success().out;
        assert!(help.contains("Examples:"), "{command}");
        filtered(|| assert_snapshot!(format!("help_{command}"), help));
    }
    for [command, inner] in [["experiment", "trust"], ["urdf", "add"], ["urdf", "check"], ["mjcf", "add"]] {
        let help = desk.run(&[command, inner, "--help"]).success().out;
        filtered(|| assert_snapshot!(format!("help_{command}-{inner}"), help));
    }
}

#[test]
fn the_version_is_that_of_the_package() {
    let version = format!("dermatome {}\n", env!("CARGO_PKG_VERSION"));
    assert_eq!(Desk::empty().run(&["--version"]).success().out, version);
}

#[test]
fn no_command_shows_the_help() {
    assert_eq!(Desk::empty().run(&[]).status.code(), Some(2));
}

#[test]
fn what_build_and_inspect_print() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let built = desk.run(&["build", "skin.toml"]).success();
    assert_eq!(built.err, "", "no progress where there is no terminal");
    filtered(|| assert_snapshot!("build", built.out));
    let inspected = desk.run(&["inspect", "tiny.dermatome"]).success();
    assert_eq!(inspected.err, "");
    filtered(|| assert_snapshot!("inspect", inspected.out));
    let id = |text: &str| text.split("id ").nth(1).unwrap()[..10].to_owned();
    assert_eq!(id(&built.out), id(&inspected.out));
}

#[test]
fn reports_of_build_and_inspect_hold_the_promised_keys() {
    let desk = Desk::with_patch();
    desk.run(&["build", "skin.toml", "--json", "build.json"]).success();
    desk.run(&["inspect", "skin.dermatome", "--json", "inspect.json"]).success();
    let (build, inspect) = (desk.report("build.json"), desk.report("inspect.json"));
    filtered(|| assert_snapshot!("build_json", shape(&build)));
    filtered(|| assert_snapshot!("inspect_json", shape(&inspect)));
    assert_eq!(build["patch_bytes"], desk.read("tiny.dermatome").len());
    assert_eq!(build["patch_crc"], inspect["patch_crc"]);
    assert_eq!(build["patch"], "tiny.dermatome");
    assert_eq!(inspect["header"]["skin"], "tiny");
}

/// A reference, and a frame in which one measurement differs by half.
fn measured(desk: &Desk) {
    let untouched = tiny_voltages();
    let mut pressed = untouched.clone();
    pressed.iter_mut().take(5).for_each(|voltage| *voltage *= 0.5);
    desk.write("idle.csv", row(&untouched));
    desk.write("press.csv", row(&untouched) + &row(&pressed));
}

#[test]
fn reconstruct_prints_a_row_per_frame_and_reports_the_promised_keys() {
    let desk = Desk::with_patch();
    measured(&desk);
    let files = ["reconstruct", "skin.toml", "--reference", "idle.csv", "--frames", "press.csv"];
    let done = desk.run(&[&files[..], &["--json", "r.json", "--png", "r.png"]].concat()).success();
    assert_eq!(done.err, "", "the model's own voltages are in order");
    assert_eq!(done.out.lines().count(), 3, "{}", done.out);
    assert!(done.out.ends_with('\n') && done.out.contains("no change"), "{}", done.out);
    let report = desk.report("r.json");
    filtered(|| assert_snapshot!("reconstruct_json", shape(&report)));
    assert_eq!((&report["reference_frames"], &report["measurements"]), (&1.into(), &40.into()));
    assert_eq!((&report["picture"], &report["complex"]), (&"r.png".into(), &false.into()));
    assert_eq!(report["frames"].as_array().unwrap().len(), 2);
    assert!(desk.read("r.png").starts_with(b"\x89PNG"));
}

#[test]
fn reconstruct_warns_where_the_electrodes_are_numbered_the_other_way_round() {
    let desk = Desk::with_patch();
    measured(&desk);
    let files = ["reconstruct", "skin.toml", "--reference", "idle.csv", "--frames", "press.csv"];
    // The disc looks the same from behind; the order of the sense pairs does not.
    let done = desk.run(&[&files[..], &["--order", "relative"]].concat()).success();
    assert!(done.err.starts_with("warning: "), "{}", done.err);
}

#[test]
fn build_warns_where_the_image_leaves_few_places_and_says_what_leaves_more() {
    let desk = Desk::empty();
    let build = |pixels: &str| {
        let skin = include_str!("../../models/hemisphere-210mm-designed/skin.toml");
        desk.write("skin.toml", skin.replace("\npixels = 700", &format!("\npixels = {pixels}")));
        let words = desk.run(&["build", "skin.toml", "--json", "b.json"]).success().err;
        (words, desk.report("b.json")["places"].as_u64().unwrap())
    };
    let (words, places) = build("1000");
    assert!(words.contains(&format!("the image leaves the patch room for {places} places")), "{words}");
    let advice = |words: &str| words.split_once("about ").unwrap().1.split_once(' ').unwrap().0.to_owned();
    // What it says is about right: whoever follows it twice has room.
    let (words, some) = build(&advice(&words));
    let (words, more) = if words.is_empty() { (words, some) } else { build(&advice(&words)) };
    assert!(words.is_empty() && some > 2 * places && more >= 230, "{some} and {more} places, {words}");
}

#[test]
fn errors_of_arguments() {
    let desk = Desk::empty();
    let words = transcript(
        &desk,
        &[
            &["frobnicate"],
            &["build"],
            &["build", "a.toml", "b.toml"],
            &["tare", "--port", "nonsense"],
            &["stream", "--port", "tcp:127.0.0.1"],
            &["stream", "--port", "sim:"],
            &["stream", "--port", "/dev/null", "--frames", "0"],
            &["tare", "--port", "/dev/null", "--frames", "1001"],
            &["reconstruct", "skin.toml", "--frames", "press.csv"],
            &["evaluate", "skin.toml", "--noise", "loud"],
            &["evaluate", "skin.toml", "--diameter", "12"],
            &["evaluate", "skin.toml", "--contrast", "0"],
            &["evaluate", "skin.toml", "--spacing", "-3%"],
            &["evaluate", "skin.toml", "--electrode-error", "2 volts"],
            &["evaluate", "skin.toml", "--impedance-error", "-1"],
        ],
    );
    filtered(|| assert_snapshot!("errors_arguments", words));
}

#[test]
fn errors_of_skin_files() {
    let desk = Desk::empty();
    desk.write("tiny.toml", TINY);
    let broken = [
        ("not-toml.toml", "name = ".to_owned()),
        ("no-drive.toml", TINY.replace("[drive]", "[drives]")),
        ("negative.toml", TINY.replace("100 mm", "-100 mm")),
        ("unit.toml", TINY.replace("50 kHz", "50 kg")),
        ("overlap.toml", TINY.replace("\"8 mm\"\ncontact", "\"80 mm\"\ncontact")),
        ("electrodes.toml", TINY.replace("count = 8", "count = 17")),
        ("pixels.toml", TINY.replace("columns = 16", "columns = 0")),
        ("many-pixels.toml", TINY.replace("columns = 16", "columns = 64")),
        ("name.toml", TINY.replace("\"tiny\"", "\"a name of more than thirty-two bytes\"")),
    ];
    for (name, text) in &broken {
        assert_ne!(text, TINY, "{name} is not broken");
        desk.write(name, text);
    }
    desk.write("bytes.toml", [0xFF, 0xFE, 0x00]);
    std::fs::create_dir(desk.path("folder.toml")).unwrap();
    std::fs::create_dir(desk.path("skin")).unwrap();
    desk.write("skin/skin.toml", TINY);
    let mut commands =
        vec![["build", "missing.toml"], ["build", "bytes.toml"], ["build", "folder.toml"], ["build", "skin"]];
    commands.extend(broken.iter().map(|(name, _)| ["build", name]));
    commands.push(["simulate", "missing.toml"]);
    let commands: Vec<&[&str]> = commands.iter().map(|arguments| &arguments[..]).collect();
    let words = transcript(&desk, &commands);
    filtered(|| assert_snapshot!("errors_skin", words));
    assert!(!desk.files().iter().any(|name| name.ends_with(".dermatome")));
}

#[test]
fn errors_of_patches() {
    let desk = Desk::with_patch();
    let good = desk.read("skin.dermatome");
    let mut damaged = good.clone();
    damaged[good.len() / 2] ^= 1;
    let mut newer = good.clone();
    newer[4] = 99;
    desk.write("truncated", &good[..good.len() / 2]);
    desk.write("long", [&good[..], b"more"].concat());
    desk.write("damaged", damaged);
    desk.write("newer", newer);
    desk.write("text", "a shopping list");
    desk.write("empty", "");
    let names = ["missing", "truncated", "long", "damaged", "newer", "text", "empty", "."];
    let inspect = names.map(|name| ["inspect", name]);
    let mut commands: Vec<&[&str]> = inspect.iter().map(|arguments| &arguments[..]).collect();
    let (_board, port) = desk.board("skin.toml", &[]);
    let flash = names.map(|name| ["flash", name, "--port", &port]);
    commands.extend(flash.iter().map(|arguments| &arguments[..]));
    let words = transcript(&desk, &commands);
    filtered(|| assert_snapshot!("errors_patch", words));
    let info = desk.run(&["tare", "--port", &port]).refused();
    assert!(info.contains("holds no patch"), "nothing must have been flashed: {info}");
}

#[test]
fn errors_of_ports() {
    let desk = Desk::with_patch();
    let free = nobody_listens();
    let nobody = format!("tcp:{free}");
    let words = transcript(
        &desk,
        &[
            &["tare", "--port", &nobody],
            &["flash", "skin.dermatome", "--port", &nobody],
            &["stream", "--port", "sim:missing.toml"],
            &["stream", "--port", "/dev/no-such-port"],
            &["stream", "--port", "tcp:no-such-host.invalid:7000"],
        ],
    );
    // What a resolver says differs between machines.
    let words = words.split("tcp:no-such-host.invalid:7000").collect::<Vec<_>>();
    assert!(words.len() >= 3, "the host is not named: {words:?}");
    filtered(|| assert_snapshot!("errors_port", words[0]));
}

#[test]
fn a_port_where_nobody_listens_is_given_up_soon() {
    let desk = Desk::empty();
    let free = nobody_listens();
    let started = Instant::now();
    desk.run(&["tare", "--port", &format!("tcp:{free}")]).refused();
    assert!(started.elapsed() < Duration::from_secs(5), "{:?}", started.elapsed());
}

#[test]
fn errors_of_simulate() {
    let desk = Desk::with_patch();
    let taken = TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = format!("tcp:{}", taken.local_addr().unwrap());
    let header = "time_s,finger,x_m,y_m,radius_m,depth\n";
    desk.write("words.csv", format!("{header}0,one,0,0,0.01,1\n"));
    desk.write("columns.csv", "time_s,x_m\n0,0\n");
    desk.write("outside.csv", format!("{header}0,1,0.2,0,0.01,1\n"));
    desk.write("order.csv", format!("{header}1,1,0,0,0.01,1\n0,1,0,0,0.01,1\n"));
    desk.write("nan.csv", format!("{header}NaN,1,0,0,0.01,1\n0,1,0,0,0.01,1\n"));
    desk.write("infinite.csv", format!("{header}0,1,0,0,0.01,1\ninf,1,0,0,0.01,1\n"));
    desk.write("short.csv", format!("{header}0,1,0\n"));
    desk.write("empty.csv", "");
    desk.write("header.csv", header);
    let cases: [&[&str]; 24] = [
        &["--listen", &taken],
        &["--listen", "tcp:192.0.2.1:7000"],
        &["--listen", "/dev/ttyACM0"],
        &["--frames", "0"],
        &["--path", "missing.csv"],
        &["--path", "words.csv"],
        &["--path", "columns.csv"],
        &["--path", "outside.csv"],
        &["--path", "order.csv"],
        &["--path", "nan.csv"],
        &["--path", "infinite.csv"],
        &["--path", "short.csv"],
        &["--path", "empty.csv"],
        &["--path", "header.csv"],
        &["--press", "0.06,0,0.01,1"],
        &["--press", "nan,0,0.01,1"],
        &["--press", "0,0,0,1"],
        &["--press", "0,0,0.01"],
        &["--press", "0,0,0.01,-2"],
        &["--press", "0,0,0.01,1", "--path", "order.csv"],
        &["--noise-db", "nan"],
        &["--noise-db", "inf"],
        &["--noise-db=-5"],
        &["--store", "skin.toml"],
    ];
    let commands: Vec<Vec<&str>> =
        cases.iter().map(|case| [&["simulate", "skin.toml"], *case].concat()).collect();
    let commands: Vec<&[&str]> = commands.iter().map(|arguments| &arguments[..]).collect();
    let words = transcript(&desk, &commands);
    filtered(|| assert_snapshot!("errors_simulate", words));
}

#[test]
fn errors_of_check_scope_and_drive() {
    let desk = Desk::with_patch();
    let (_board, port) = desk.board("skin.toml", &[]);
    let at = ["--port", port.as_str()];
    let empty = ["check", "scope", "drive"].map(|command| [&[command][..], &at].concat());
    let mut words = transcript(&desk, &empty.each_ref().map(|command| &command[..]));
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let cases: [&[&str]; 18] = [
        &["check", "--frames", "0"],
        &["scope", "--slot", "48"],
        &["scope", "--slot", "-1"],
        &["scope", "--png", "missing/slot.png"],
        &["drive", "--frequency", "51 kHz"],
        &["drive", "--frequency", "50 kg"],
        &["drive", "--frequency", "0"],
        &["drive", "--amplitude", "2 mA"],
        &["drive", "--amplitude", "-5%"],
        &["drive", "--amplitude", "1"],
        &["drive", "--gain", "3"],
        &["drive", "--gain", "loud"],
        &["drive", "--phase", "361"],
        &["drive", "--settling", "-1"],
        &["drive", "--settling", "200"],
        &["drive", "--integration", "300"],
        &["drive", "--component", "both"],
        &["drive", "--patch", "--gain", "2"],
    ];
    let cases = cases.map(|case| [case, &at].concat());
    words += "\n";
    words += &transcript(&desk, &cases.each_ref().map(|command| &command[..]));
    filtered(|| assert_snapshot!("errors_sensing", words));
    let drive = desk.run(&["drive", "--port", &port]).success().out;
    assert!(drive.contains("as the patch says"), "nothing must have changed: {drive}");
}

#[test]
fn errors_of_the_demos_noise() {
    let words = transcript(
        &Desk::empty(),
        &[&["demo", "--noise-db", "nan"], &["demo", "--noise-db=-5"], &["demo", "--seed", "-1"]],
    );
    filtered(|| assert_snapshot!("errors_demo", words));
}

/// A `.npy` file of one frame.
fn npy(values: &[f64]) -> Vec<u8> {
    let header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({},), }}", values.len());
    let header = format!("{header:<117}\n");
    let prefix = [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes()].concat();
    let data = values.iter().flat_map(|value| value.to_le_bytes());
    prefix.into_iter().chain(data).collect()
}

#[test]
fn errors_of_measured_frames() {
    let desk = Desk::with_patch();
    measured(&desk);
    let untouched = tiny_voltages();
    let whole = npy(&untouched);
    desk.write("whole.npy", &whole);
    desk.write("truncated.npy", &whole[..whole.len() - 3]);
    desk.write("header.npy", &whole[..20]);
    desk.write("nan.npy", npy(&[&untouched[..39], &[f64::NAN]].concat()));
    desk.write(
        "nan.csv",
        row(&untouched) + &row(&untouched).replacen("e", "e9", 1).replacen(',', ",NaN,", 1),
    );
    desk.write("length.csv", row(&untouched[..39]));
    desk.write("ragged.csv", row(&untouched) + &row(&untouched[..7]));
    desk.write("word.csv", row(&untouched) + "1,2,three\n");
    desk.write("zero.csv", row(&[0.0; 40]));
    desk.write("empty.csv", "");
    desk.write("text.npz", "not an archive");
    desk.write("frames.mat", "");
    let reconstruct = |reference, frames, more: &[&'static str]| {
        [&["reconstruct", "skin.toml", "--reference", reference, "--frames", frames], more].concat()
    };
    desk.run(&reconstruct("whole.npy", "press.csv", &[])).success();
    let mut commands: Vec<_> = [
        "missing.npy",
        "truncated.npy",
        "header.npy",
        "nan.npy",
        "nan.csv",
        "length.csv",
        "ragged.csv",
        "word.csv",
        "empty.csv",
        "text.npz",
        "text.npz:key",
        "frames.mat",
        "skin.toml",
    ]
    .map(|file| reconstruct("idle.csv", file, &[]))
    .to_vec();
    commands.push(reconstruct("zero.csv", "press.csv", &[]));
    commands.push(reconstruct("length.csv", "press.csv", &[]));
    commands.push(reconstruct("idle.csv", "press.csv", &["--rotation", "8"]));
    commands.push(reconstruct("idle.csv", "press.csv", &["--order", "sideways"]));
    commands.push(reconstruct("idle.csv", "press.csv", &["--png", "missing/out.png"]));
    let commands: Vec<&[&str]> = commands.iter().map(Vec::as_slice).collect();
    let words = transcript(&desk, &commands);
    filtered(|| assert_snapshot!("errors_frames", words));
}

/// An archive of two arrays, which only NumPy's own library can write here.
#[test]
fn a_missing_key_is_answered_with_the_keys_there_are() {
    let desk = Desk::with_patch();
    measured(&desk);
    let mut archive = npyz::npz::NpzWriter::new(File::create(desk.path("run.npz")).unwrap());
    for name in ["empty", "pressed"] {
        use npyz::WriterBuilder;
        let array = archive.array(name, Default::default()).unwrap().default_dtype().shape(&[40]);
        let mut array = array.begin_nd().unwrap();
        array.extend(tiny_voltages()).unwrap();
        array.finish().unwrap();
    }
    drop(archive);
    let words = transcript(
        &desk,
        &[
            &["reconstruct", "skin.toml", "--reference", "run.npz", "--frames", "press.csv"],
            &["reconstruct", "skin.toml", "--reference", "run.npz:idle", "--frames", "press.csv"],
        ],
    );
    filtered(|| assert_snapshot!("errors_npz", words));
    desk.run(&["reconstruct", "skin.toml", "--reference", "run.npz:empty", "--frames", "run.npz:pressed"])
        .success();
}

#[test]
fn errors_of_places_to_write_to() {
    let desk = Desk::with_patch();
    std::fs::create_dir(desk.path("folder")).unwrap();
    let before = desk.files();
    let words = transcript(
        &desk,
        &[
            &["build", "skin.toml", "-o", "missing/patch"],
            &["build", "skin.toml", "-o", "folder"],
            &["inspect", "skin.dermatome", "--json", "missing/report.json"],
            &["inspect", "skin.dermatome", "--json", "skin.toml/report.json"],
        ],
    );
    filtered(|| assert_snapshot!("errors_output", words));
    assert_eq!(desk.files(), before, "nothing is left behind");
}

/// Through links, so that a mistake replaces the link and not a device of this machine.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named_and_devices_stay_devices() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let desk = Desk::with_patch();
    symlink("/dev/full", desk.path("full")).unwrap();
    symlink("/dev/null", desk.path("null")).unwrap();
    let commands: [&[&str]; 2] =
        [&["build", "skin.toml", "-o", "full"], &["inspect", "skin.dermatome", "--json", "full"]];
    let words = transcript(&desk, &commands);
    filtered(|| assert_snapshot!("errors_full_disk", words));
    desk.run(&["build", "skin.toml", "-o", "null", "--json", "null"]).success();
    for name in ["full", "null"] {
        assert!(desk.path(name).symlink_metadata().unwrap().is_symlink(), "{name}");
        assert!(desk.path(name).metadata().unwrap().file_type().is_char_device(), "{name}");
    }
}

//! Every option of every command with values that it does not take.

use super::case::Case;

/// Each command with all that it needs, so that only the option that is tried is wrong.
const COMMANDS: &[&[&str]] = &[
    &["demo"],
    &["build", "skin.toml"],
    &["evaluate", "skin.toml"],
    &["experiment", "divider"],
    &["experiment trust", "skin.toml"],
    &["experiment check", "skin.toml"],
    &["experiment presses", "skin.toml"],
    &["inspect", "skin.dermatome"],
    &["setup", "--port=sim:skin.toml", "--skin=skin.toml", "--yes"],
    &["flash", "skin.dermatome", "--port=sim:skin.toml"],
    &["tare", "--port=sim:skin.toml"],
    &["stream", "--port=sim:skin.toml", "--frames=1"],
    // Ends at the wrong value, or because its port is no board.
    &["view", "--port=replay:notes.txt", "--no-browser", "--listen=127.0.0.1:0"],
    &["serve", "robot.toml", "--no-browser"],
    &["body", "arm"],
    &["calibrate", "skin.dermatome", "--readings=readings.csv", "--out=new.dermatome"],
    &["check", "--port=sim:skin.toml"],
    &["scope", "--port=sim:skin.toml"],
    &["drive", "--port=sim:skin.toml"],
    &["trim", "--port=tcp:127.0.0.1:1"],
    &["simulate", "skin.toml", "--listen=tcp:127.0.0.1:0"],
    &["devices"],
    &["firmware"],
    &["reconstruct", "skin.toml", "--reference=reference.csv", "--frames=frames.csv"],
    &["replay", "frames.csv", "--patch=skin.dermatome"],
    &["check-data", "skin.toml", "frames.csv"],
    &["cut", "skin.stl", "--unit=mm", "--around=0,0,0", "--radius=30", "--out=new"],
    &["urdf add", "robot.urdf", "posed.toml"],
    &["urdf check", "robot.urdf"],
    &["mjcf add", "robot.xml", "posed.toml"],
    &["design", "skin.toml"],
    &["learn", "skin.toml", "--presses=presses.csv", "--reference=reference.csv"],
    &["export", "skin.toml", "--out=new"],
    &["forward", "skin.toml"],
    &["completions", "bash"],
    &["man", "--out=new"],
];

/// Options that name a file to read: host/tests/hostile/files.rs tries them.
const READ: &[&str] = &[
    "preserve-calibration",
    "loads",
    "recording",
    "readings",
    "path",
    "material",
    "reference",
    "good",
    "frames of a file",
    "times",
    "presses",
    "conductivity",
    "skin",
    "patch",
    "link-mesh",
    "elf",
];
/// Options that name a file to write.
const WRITTEN: &[&str] =
    &["png", "json", "output", "corrected", "hyperparameter-plot", "plot", "save", "store", "record", "mesh"];

/// No number, of whatever kind.
const NUMBERS: &[&str] = &["", "x", "nan", "inf", "1e999", "1,5", "0x10", "1 2"];
/// No whole number.
const WHOLE: &[&str] = &["", "x", "nan", "1.5", "-1", "99999999999999999999999", "1e3"];
/// No length, for an option that needs one.
const LENGTHS: &[&str] = &["", "x", "nan", "inf", "5 furlong", "-5mm", "1e999"];
const WORDS: &[&str] = &["", "x", "REAL\u{7}", "ä"];
const PORTS: &[&str] = &[
    "",
    "abc",
    "tcp:",
    "tcp:127.0.0.1",
    "tcp:127.0.0.1:99999",
    "tcp:127.0.0.1:1",
    "rs485:",
    "rs485:/dev/ttyNOTTHERE7",
    "rs485:/dev/ttyNOTTHERE7#16",
    "rs485:/dev/ttyNOTTHERE7#1",
    "rs485:tcp:127.0.0.1:1#1",
    "can:",
    "can:nosuchcan",
    "can:nosuchcan#16",
    "can:nosuchcan#1",
    "can:/dev/ttyNOTTHERE7#1",
    "can:tcp:127.0.0.1:1#1",
    "sim:",
    "sim:none.toml",
    "sim:notes.txt",
    "sim:folder",
    "replay:",
    "replay:none.mcap",
    "replay:notes.txt",
    "/dev/none",
    "/dev/null",
    "COM99",
];
const DB: &[&str] = &["", "x", "nan", "-1", "201", "inf"];

/// Values that an option does not take; `None` for those that are tried elsewhere.
fn wrong(command: &str, option: &str) -> Option<&'static [&'static str]> {
    Some(match (command, option) {
        ("replay" | "reconstruct", "frames") => return None,
        (_, name) if READ.contains(&name) => return None,
        ("cut" | "export" | "experiment" | "man", "out") => &["", "notes.txt", "notes.txt/new"],
        ("calibrate" | "design" | "forward", "out") => &["", "-", "folder", "none/x", "notes.txt"],
        (_, name) if WRITTEN.contains(&name) => &["", "-", "folder", "none/x", "notes.txt", "notes.txt/x"],
        // A board that is not there is waited for.
        ("view", "port") => {
            &["", "abc", "tcp:", "sim:none.toml", "replay:", "replay:none.mcap", "replay:notes.txt"]
        }
        (_, "port") => PORTS,
        ("devices", "bus") => &[
            "",
            "abc",
            "tcp:",
            "tcp:127.0.0.1:1",
            "rs485:tcp:127.0.0.1:1",
            "rs485:tcp:127.0.0.1:1#1",
            "rs485:nosuchcan",
            "can:",
            "can:nosuchcan",
            "can:tcp:127.0.0.1:1",
            "can:/dev/ttyNOTTHERE7",
            "/dev/ttyNOTTHERE7",
            "notes.txt",
        ],
        ("view" | "serve" | "demo", "listen") => {
            &["", "abc", "127.0.0.1", "127.0.0.1:99999", "localhost:1", "8.8.8.8:1"]
        }
        ("view" | "serve", "token") => &["", "short", "with space", "a&b=cdefgh"],
        ("view" | "serve", "allow-origin") => {
            &["", "x", "*", "ftp://x", "https://", "https://a/b", "https://*"]
        }
        ("view", "unit") => &["", "x", "MM", "furlong", "mm "],
        ("replay", "listen") | ("simulate", "listen") => {
            &["", "abc", "tcp:", "tcp:1", "tcp:127.0.0.1:99999", "tcp:8.8.8.8:1", "COM1"]
        }
        (_, "noise-db") | ("evaluate" | "design", "noise") => DB,
        (_, "snr") => &["", "x", "60,x", "-1", "nan", "201", "60,,50"],
        (_, "seed" | "presses" | "slot") => WHOLE,
        (_, "frames") => &["", "x", "nan", "1.5", "-1", "0", "99999999999999999999999"],
        (_, "rows") => &["", "x", "one,x", "One"],
        (_, "found-in") => &["", "x", "Image", "image,x"],
        ("evaluate", "contrast") => &["", "x", "nan", "0", "-1", "1001", "inf"],
        ("evaluate", "impedance-error") => &["", "x", "nan", "-1", "201"],
        ("evaluate", "threshold") => &["", "x", "nan", "-1", "1001"],
        ("evaluate", "electrode-error") => &["", "x", "nan", "5 furlong", "-5%", "1e999"],
        ("evaluate", _) | ("design", "radius") => {
            &["", "x", "nan", "0", "0mm", "5 furlong", "-5%", "1e999", "1e30m"]
        }
        ("design", "electrodes") => &["", "x", "5", "17", "-1", "8.5"],
        ("cut", "electrodes") => &["", "x", "3", "251", "-1", "8.5"],
        ("design" | "cut", "name") => {
            &["", "a b", "ä", "../x", "abcdefghijklmnopqrstuvwxyzabcdefg", "a\u{1b}[2J"]
        }
        ("urdf add" | "mjcf add", "name" | "mesh-uri") => &[""],
        ("urdf add", "link") | ("mjcf add", "body") => &["", "none", "Palm", "a\u{1b}[2J"],
        ("urdf add" | "mjcf add", "thickness") => {
            &["", "x", "nan", "0", "0mm", "-1mm", "5 furlong", "1 m", "1e999"]
        }
        ("mjcf add", "taxels") => &["", "x", "-1", "1.5", "1025"],
        ("cut", "frame") => &["", "a b", "ä", "a\nb"],
        ("stream" | "reconstruct", "fit") => LENGTHS,
        ("serve", "domain") => &["", "x", "-1", "233", "1.5"],
        // Only a program that is built with Zenoh reads it (host/tests/zenoh).
        ("serve" | "body", "zenoh-config") => &[],
        ("serve" | "body", "zenoh-connect" | "zenoh-listen") => &["", "x", "tcp/", "/127.0.0.1:1"],
        // What a skin's name may be, the robot says.
        ("body", "tare" | "drive") => &[],
        ("body", "frequency") => &["", "x", "nan", "0", "-1", "5 furlong", "inf", "1 mA"],
        ("body", "amplitude") => &["", "x", "nan", "0", "-1 mA", "5 furlong", "1", "50%"],
        ("body", "frame-rate") => &["", "x", "nan", "0", "-1", "5 furlong", "inf", "1 mA"],
        ("body", "gain") => &["", "x", "-1", "0.5", "Automatic"],
        ("serve" | "body" | "demo", "duration") => &["", "x", "nan", "-1", "1e30"],
        (_, "give-up-after") => &["", "x", "nan", "-1", "1e30"],
        ("calibrate", "start") => NUMBERS,
        ("experiment check", "amplitudes") => &["", "x", "0", "-1", "101", "nan", "50,x"],
        ("experiment presses", "count") => &["", "x", "0", "-1", "10001", "1.5"],
        ("setup", "press-within") => &["", "x", "nan", "-1", "1e30"],
        ("simulate", "fault") => {
            &["", "open", "open:0", "open:17", "short:3-3", "contact:3+nan", "boom:3", "open:3@x"]
        }
        ("calibrate", "indenter-area") => &["", "x", "nan", "0", "-1", "4 furlong", "4", "inf"],
        ("drive", "frequency") => &["", "x", "nan", "0", "-1", "5 furlong", "inf", "1 mA"],
        ("drive", "amplitude") => &["", "x", "nan", "-1", "-5%", "5 furlong", "inf", "1 kHz"],
        (_, "amplitude") => &["", "x", "-1", "AUTO", "0.5 mA"],
        ("drive", "gain") => &["", "x", "0", "3", "128", "-1", "1.5"],
        ("drive", "phase") => &["", "x", "nan", "-1", "361", "inf"],
        ("drive", "settling") => &["", "x", "nan", "-1", "101", "inf"],
        ("drive", "integration") => &["", "x", "0", "65", "-1", "1.5"],
        ("drive", "component") => WORDS,
        ("trim", _) => &["", "x", "nan", "0", "-1", "5 furlong", "inf"],
        ("simulate", "press") => {
            &["", "1,2,3", "x,0,0.01,1", "0,0,0,1", "0,0,-1,1", "0,0,0.01,nan", "0,0,0.01,-2", "9,9,0.01,1"]
        }
        // Only a program that is built for probes has one.
        ("firmware", "probe") => &[],
        (_, "order" | "weights" | "polarity" | "strength") => WORDS,
        (_, "rotation") => &["", "x", "-1", "256", "1.5", "8"],
        (_, "offset") => NUMBERS,
        ("replay", "tare") => &["", "x", "0", "-1", "1.5", "99999999999999999999999"],
        ("replay", "rate") => &["", "x", "nan", "0", "-1", "inf"],
        ("learn", "test") => &["", "x", "nan", "-1", "0.51", "inf"],
        ("cut", "unit") => &["", "x", "MM", "furlong", "mm "],
        ("cut", "around") => {
            &["", "1,2", "1,2,3,4", "x,0,0", "nan,0,0", "1;2;3", "1e999,0,0", "0,0,5 furlong"]
        }
        ("cut", "up") => &["", "1,2", "x,0,0", "nan,0,0", "0,0,0", "0,0,1"],
        ("cut", "between-planes") => {
            &["", "0,0,1,5", "0,0,0,1,2", "0,0,1,2,1", "x,0,0,1,2", "0,0,1,nan,2", "0,0,1,900,901"]
        }
        ("cut", "polygon") => {
            &["", "0,0,0", "0,0,0 1,0,0", "0,0,0 1,0,0 2,0,0", "0,0 1,1 2,2", "x,0,0 1,0,0 0,1,0"]
        }
        ("cut", "weld") => &["", "x", "nan", "-1", "1", "inf"],
        ("cut", "radius") => &["", "x", "nan", "0", "-5", "inf", "5 furlong"],
        ("cut", _) => &["", "x", "nan", "0", "-5", "inf", "1e9", "5 furlong"],
        _ => panic!("no wrong values for --{option} of {command}: add some"),
    })
}

pub(crate) fn cases() -> Vec<Case> {
    let program = dermatome_command::command();
    let mut cases = Vec::new();
    for words in COMMANDS {
        let command = words[0];
        let path: Vec<&str> = command.split(' ').collect();
        let found = path.iter().fold(&program, |at, name| at.find_subcommand(name).unwrap());
        for arg in found.get_arguments().filter(|arg| arg.get_action().takes_values()) {
            let Some(option) = arg.get_long() else { continue };
            for value in wrong(command, option).into_iter().flatten() {
                cases.push(with(&path, &words[1..], option, value));
            }
        }
        cases.extend(misspelled(&path, &words[1..]));
    }
    check_all_are_tried(&program.get_subcommands().map(|it| it.get_name().to_owned()).collect::<Vec<_>>());
    cases.extend(pairs());
    cases
}

/// What else an option needs, and what it does not go with: `[option, needs, goes without]`.
const COMPANY: &[(&str, &[&str], &[&str])] = &[
    ("fit", &["--skin=posed.toml"], &[]),
    ("start", &["--recording=recording.txt", "--loads=loads.csv"], &["--readings=readings.csv"]),
    ("save", &["--recording=recording.txt", "--loads=loads.csv"], &["--readings=readings.csv"]),
    ("port", &["--loads=loads.csv"], &["--readings=readings.csv"]),
    ("threshold", &["--found-in=image"], &[]),
    ("between-planes", &[], &["--radius=30"]),
    ("polygon", &[], &["--radius=30"]),
];

fn with(path: &[&str], rest: &[&str], option: &str, value: &str) -> Case {
    let given = format!("--{option}={value}");
    // A board's frames need its skin beside them; recorded ones come with it.
    let alone = (path, option) == (&["reconstruct"], "fit");
    let company = COMPANY.iter().filter(|(name, ..)| *name == option && !alone);
    let (_, needs, without) = company.fold(("", &[][..], &[][..]), |_, found| *found);
    let goes = without.is_empty() || rest.iter().any(|word| without.contains(word));
    let needs = if goes { needs } else { &[] };
    let same = format!("--{option}=");
    let kept = rest.iter().filter(|word| !word.starts_with(&same) && !without.contains(word));
    let arguments: Vec<&str> =
        path.iter().chain(kept).chain(needs).copied().chain([given.as_str()]).collect();
    // A port or a file is named by itself.
    let is_place = ["port", "listen", "out"].contains(&option) || WRITTEN.contains(&option);
    let name = if is_place && !value.is_empty() { told(value) } else { format!("--{option}|{option} is") };
    Case::refused(&arguments, &[&name, &told(value)])
}

/// How a value is told: whole, or the piece that is wrong; numbers as numbers.
fn told(value: &str) -> String {
    // What cannot be printed is told by its number.
    let shown = value.split(['\u{1b}', '\n', '\u{7}']).next().unwrap_or_default();
    match shown {
        "" => "none was supplied|\"\"|``|''|empty|0 corners".to_owned(),
        "inf" | "1e999" => "inf|1e999".to_owned(),
        "nan" => "nan|NaN".to_owned(),
        "0mm" => "0.00 mm|0mm".to_owned(),
        "1e9" => "1000000000|1e9".to_owned(),
        _ => {
            let file = shown.strip_prefix("sim:").or_else(|| shown.strip_prefix("replay:"));
            let whole = file.filter(|file| !file.is_empty()).unwrap_or(shown);
            let pieces = shown.split([',', ' ']).map(|piece| if piece.is_empty() { "''" } else { piece });
            [whole].into_iter().chain(pieces).collect::<Vec<_>>().join("|")
        }
    }
}

/// Options, and a command, that are not there; an argument too many.
fn misspelled(path: &[&str], rest: &[&str]) -> Vec<Case> {
    let all = [path, rest].concat();
    let mut cases = vec![Case::refused(&[&all[..], &["--jsno=x"]].concat(), &["--jsno"])];
    cases.push(Case::refused(&[&all[..], &["--force=yes"]].concat(), &["--force", "yes"]));
    if path != ["experiment", "trust"] {
        cases.push(Case::refused(&[&all[..], &["too", "many"]].concat(), &["too|many"]));
    }
    cases
}

/// Options that do not go together, or need each other.
fn pairs() -> Vec<Case> {
    let cases: &[(&[&str], &[&str])] = &[
        (&["no-such-command"], &["no-such-command"]),
        (&["--jsno"], &["--jsno"]),
        (&["build"], &["<SKIN>"]),
        (&["flash", "skin.dermatome"], &["--port"]),
        (&["tare"], &["--port"]),
        (&["stream"], &["--port"]),
        (&["cut", "skin.stl", "--unit=mm", "--around=0,0,0", "--out=new"], &["--radius"]),
        (
            &[
                "cut",
                "skin.stl",
                "--unit=mm",
                "--around=0,0,0",
                "--radius=9",
                "--polygon=0,0,0 1,0,0 0,1,0",
                "--out=new",
            ],
            &["--polygon"],
        ),
        (&["calibrate", "skin.dermatome"], &["--readings"]),
        (&["calibrate", "skin.dermatome", "--recording=recording.txt"], &["--loads"]),
        (&["calibrate", "skin.dermatome", "--port=sim:skin.toml"], &["--loads"]),
        (
            &["calibrate", "skin.dermatome", "--readings=readings.csv", "--recording=recording.txt"],
            &["--recording"],
        ),
        (&["stream", "--port=sim:skin.toml", "--fit=5mm"], &["--skin"]),
        (&["drive", "--port=sim:skin.toml", "--patch", "--gain=1"], &["--patch", "--gain"]),
        (&["trim", "--port=tcp:127.0.0.1:1", "--forget", "--first=1"], &["--forget", "--first"]),
        (&["simulate", "skin.toml", "--press=0,0,0.01,1", "--path=path.csv"], &["--press", "--path"]),
        (&["simulate", "skin.toml", "--live", "--path=path.csv"], &["--live", "--path"]),
        (&["simulate", "skin.toml", "--live", "--press=0,0,0.01,1"], &["--live", "--press"]),
        (&["urdf", "remove"], &["remove"]),
        (&["urdf", "add", "robot.urdf"], &["<SKIN>"]),
        (&["urdf", "add", "robot.urdf", "skin.toml"], &["`skin.toml`", "pose"]),
        (&["urdf", "add", "robot.xml", "posed.toml"], &["robot.xml", "<mujoco>", "<robot>"]),
        (&["urdf", "check", "robot.urdf", "posed.toml"], &["robot.urdf"]),
        (&["mjcf", "add", "robot.urdf", "posed.toml"], &["robot.urdf", "<robot>", "<mujoco>"]),
        (&["build", "skin.toml", "--no-patch", "--output=x"], &["--no-patch", "--output"]),
        (&["build", "skin.toml", "--seed=1"], &["--seed"]),
        (&["build", "skin.toml", "--json=a", "--json=b"], &["--json"]),
        (&["replay", "frames.csv", "--patch=skin.dermatome", "--each"], &["--reference"]),
        (&["replay", "frames.csv", "--patch=skin.dermatome", "--tare=25"], &["25", "24"]),
        (
            &["replay", "frames.csv", "--patch=skin.dermatome", "--listen=tcp:127.0.0.1:0", "--tare=25"],
            &["25", "24"],
        ),
        (
            &[
                "replay",
                "frames.csv",
                "--patch=skin.dermatome",
                "--listen=tcp:127.0.0.1:0",
                "--record=new.mcap",
            ],
            &["--listen", "--record"],
        ),
        (&["learn", "skin.toml", "--presses=presses.csv", "--each"], &["--reference"]),
        (&["experiment", "dividers"], &["dividers"]),
        (&["completions"], &["<SHELL>"]),
        (&["completions", "tcsh"], &["tcsh", "fish"]),
        (&["man"], &["--out"]),
        (&["cut", "skin.stl", "--around=0,0,0", "--radius=30", "--out=new"], &["--unit", "skin.stl", "inch"]),
        (
            &["cut", "skin.dae", "--unit=mm", "--around=0,0,0", "--radius=30mm", "--out=new"],
            &["--unit", "skin.dae", "1 m"],
        ),
        (&["experiment", ""], &["''|NAME"]),
        (&["trim", "--port=sim:skin.toml"], &["sim:skin.toml|simulated"]),
        (&["scope", "--port=sim:skin.toml", "--slot=48"], &["slots 0 to 47"]),
    ];
    cases.iter().map(|(arguments, words)| Case::refused(arguments, words)).collect()
}

/// A command that is new is tried too.
fn check_all_are_tried(commands: &[String]) {
    let is_tried = |name: &&String| {
        name.as_str() == "help"
            || COMMANDS.iter().any(|words| words[0].split(' ').next() == Some(name.as_str()))
    };
    let missing: Vec<_> = commands.iter().filter(|name| !is_tried(name)).collect();
    assert!(missing.is_empty(), "commands that are not tried: {missing:?}");
}

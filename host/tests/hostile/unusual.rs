//! Unusual files and names that are right: the result is that of the usual ones.

use super::{
    case::{Case, Desks},
    program::TINY,
};

pub(crate) fn cases(desks: &Desks) -> Vec<Case> {
    let forward = || Some(desks.forward.clone());
    let windows = TINY.replace('\n', "\r\n");
    let inline = TINY.replace("[mesh]\nedge_length = \"8 mm\"\n", "mesh = { edge_length = 0.008 }\n");
    let (top, tables) = inline.split_once("mesh = {").unwrap_or_default();
    let (mesh, tables) = tables.split_once('\n').unwrap_or_default();
    let (name, shape) = top.split_once("[shape]").unwrap_or_default();
    let inline = format!("{name}mesh = {{{mesh}\n[shape]{shape}{tables}");
    let skins: [(&str, String); 9] = [
        ("windows.toml", windows),
        ("with a space.toml", TINY.to_owned()),
        ("\u{68af}\u{5b50}-\u{e4}.toml", TINY.to_owned()),
        ("no-ending", TINY.to_owned()),
        ("inline.toml", inline),
        ("comment.toml", format!("# \u{1f980}\n{TINY}# the end, without a new line")),
        (
            "SI.toml",
            TINY.replace("\"100 mm\"", "0.1").replace("\"8 mm\"", "8e-3").replace("\"50 kHz\"", "5_0000"),
        ),
        ("spaces.toml", TINY.replace("8 mm", "8mm").replace(" = ", "=")),
        ("bom.toml", format!("\u{feff}{TINY}")),
    ];
    let mut cases: Vec<Case> = skins
        .iter()
        .map(|(file, text)| Case::done(&["forward", file], forward()).with(file, text.as_str()))
        .collect();
    cases.push(Case::done(&["forward", "./folder/../skin.toml"], forward()));
    cases.push(Case::done(&["forward", "--", "-skin.toml"], forward()).with("-skin.toml", TINY));
    let frames = String::from_utf8_lossy(desks.file("frames.csv")).into_owned();
    let tables = [
        frames.replace('\n', "\r\n"),
        frames.replace(',', ", "),
        frames.replace(',', ";"),
        frames.replace(',', "\t"),
        format!("\u{feff}{frames}"),
        frames.trim_end().to_owned(),
        format!("# a comment\n{frames}\n\n"),
    ];
    let reads = |text: &String| {
        Case::done(&["check-data", "skin.toml", "odd.csv"], None).with("odd.csv", text.as_str())
    };
    cases.extend(tables.iter().map(reads));
    cases.extend(SOUND.iter().map(|words| Case::done(words, None)));
    cases
}

/// The files that the other lists spoil are sound.
const SOUND: &[&[&str]] = &[
    &["build", "skin.toml", "-o", "new.dermatome"],
    &["export", "skin.toml", "--out", "new"],
    &["inspect", "skin.dermatome"],
    &["urdf", "add", "robot.urdf", "posed.toml"],
    &["urdf", "check", "robot.urdf"],
    &["mjcf", "add", "robot.xml", "posed.toml"],
    &["flash", "skin.dermatome", "--port=sim:skin.toml"],
    &["tare", "--port=sim:skin.toml", "--frames=1"],
    &["devices", "--port=sim:skin.toml"],
    &["scope", "--port=sim:skin.toml"],
    &["drive", "--port=sim:skin.toml", "--gain=2"],
    &["stream", "--port=sim:skin.toml", "--frames=1", "--skin=posed.toml", "--fit=5mm"],
    &["forward", "skin.toml", "--conductivity=conductivity.npy"],
    &["reconstruct", "skin.toml", "--reference=reference.csv", "--frames=frames.csv"],
    &["replay", "frames.csv", "--patch=skin.dermatome", "--times=times.csv", "--skin=posed.toml"],
    &["replay", "frames.csv", "--patch=skin.dermatome", "--record=new.mcap"],
    &["check-data", "skin.toml", "frames.csv"],
    &["learn", "skin.toml", "--presses=presses.csv", "--reference=reference.csv", "-o", "new.dermatome"],
    &[
        "learn",
        "skin.toml",
        "--presses=presses.csv",
        "--reference=reference.csv",
        "-o",
        "new.dermatome",
        "--record=new.mcap",
    ],
    &["calibrate", "skin.dermatome", "--readings=readings.csv", "--out=new.dermatome"],
    &["calibrate", "skin.dermatome", "--recording=recording.txt", "--loads=loads.csv", "--out=new.dermatome"],
    &["cut", "skin.stl", "--unit=mm", "--around=0,0,0", "--radius=30", "--out=new"],
    &["cut", "skin.ply", "--unit=m", "--around=0,0,0", "--radius=30mm", "--out=new"],
    &["cut", "skin.dae", "--around=0,0,0", "--radius=30mm", "--out=new", "--png=new.png"],
    &["cut", "skin.dae", "--unit=m", "--around=0,0,0", "--radius=0.03", "--out=new", "--json=new/cut.json"],
    &["completions", "zsh"],
    &["man", "--out=new"],
    &["-v", "forward", "skin.toml"],
    &["cut", "skin.msh", "--unit=m", "--around=0,0,0", "--radius=30mm", "--out=new"],
];

//! Every file that a command reads: not there, a folder, empty, cut off, garbled, of another kind.

use super::case::{Case, DAE, Desks};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

/// Commands that read `@`, and a sound file of that kind.
const READERS: &[(&[&str], &str)] = &[
    (&["build", "@"], "skin.toml"),
    (&["evaluate", "@"], "skin.toml"),
    (&["forward", "@"], "skin.toml"),
    (&["design", "@"], "skin.toml"),
    (&["export", "@", "--out", "new"], "skin.toml"),
    (&["simulate", "@", "--listen", "tcp:127.0.0.1:0"], "skin.toml"),
    (&["experiment", "trust", "@"], "skin.toml"),
    (&["reconstruct", "@", "--reference", "reference.csv", "--frames", "frames.csv"], "skin.toml"),
    (&["check-data", "@", "frames.csv"], "skin.toml"),
    (&["learn", "@", "--presses", "presses.csv", "--reference", "reference.csv"], "skin.toml"),
    (&["replay", "frames.csv", "--patch", "skin.dermatome", "--skin", "@"], "skin.toml"),
    (&["stream", "--port", "sim:skin.toml", "--frames", "1", "--skin", "@"], "skin.toml"),
    (&["check", "--port", "sim:skin.toml", "--skin", "@"], "skin.toml"),
    (&["devices", "--port", "sim:@"], "skin.toml"),
    (&["tare", "--port", "sim:@"], "skin.toml"),
    (&["flash", "skin.dermatome", "--port", "sim:@"], "skin.toml"),
    (&["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--material", "@"], "material.toml"),
    (&["inspect", "@"], "skin.dermatome"),
    (&["flash", "@", "--port", "sim:skin.toml"], "skin.dermatome"),
    (&["calibrate", "@", "--readings", "readings.csv", "--out", "new.dermatome"], "skin.dermatome"),
    (&["replay", "frames.csv", "--patch", "@"], "skin.dermatome"),
    (&["build", "skin.toml", "-o", "new.dermatome", "--preserve-calibration", "@"], "skin.dermatome"),
    (&["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--store", "@"], "skin.dermatome"),
    (&["reconstruct", "skin.toml", "--reference", "reference.csv", "--frames", "@"], "frames.csv"),
    (&["reconstruct", "skin.toml", "--reference", "@", "--frames", "frames.csv"], "frames.csv"),
    (&["replay", "@", "--patch", "skin.dermatome"], "frames.csv"),
    (&["replay", "frames.csv", "--patch", "skin.dermatome", "--reference", "@"], "frames.csv"),
    (&["replay", "frames.csv", "--patch", "skin.dermatome", "--times", "@"], "times.csv"),
    (&["check-data", "skin.toml", "@"], "frames.csv"),
    (&["check-data", "skin.toml", "frames.csv", "--good", "@"], "frames.csv"),
    (&["learn", "skin.toml", "--presses", "@", "--reference", "reference.csv"], "presses.csv"),
    (&["learn", "skin.toml", "--presses", "presses.csv", "--reference", "@"], "frames.csv"),
    (&["forward", "skin.toml", "--conductivity", "@"], "conductivity.npy"),
    (&["calibrate", "skin.dermatome", "--readings", "@", "--out", "new.dermatome"], "readings.csv"),
    (
        &["calibrate", "skin.dermatome", "--recording", "@", "--loads", "loads.csv", "--out", "new"],
        "recording.txt",
    ),
    (
        &["calibrate", "skin.dermatome", "--recording", "recording.txt", "--loads", "@", "--out", "new"],
        "loads.csv",
    ),
    (&["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--path", "@"], "path.csv"),
    (&["firmware", "--elf", "@"], "firmware.elf"),
    (&["cut", "@", "--unit", "mm", "--around", "0,0,0", "--radius", "30", "--out", "new"], "skin.stl"),
    (&["cut", "@", "--unit", "mm", "--around", "0,0,0", "--radius", "30", "--out", "new"], "skin.ply"),
    (&["cut", "@", "--unit", "mm", "--around", "0,0,0", "--radius", "30", "--out", "new"], "skin.msh"),
    (&["cut", "@", "--around", "0,0,0", "--radius", "30mm", "--out", "new"], "skin.dae"),
    (&["urdf", "add", "@", "posed.toml"], "robot.urdf"),
    (&["urdf", "add", "robot.urdf", "@"], "posed.toml"),
    (&["urdf", "check", "@"], "robot.urdf"),
    (&["urdf", "check", "robot.urdf", "@"], "posed.toml"),
    (&["mjcf", "add", "@", "posed.toml"], "robot.xml"),
    (&["mjcf", "add", "robot.xml", "@"], "posed.toml"),
];

pub(crate) fn cases(desks: &Desks) -> Vec<Case> {
    let mut cases: Vec<Case> =
        READERS.iter().flat_map(|(command, sound)| of_reader(desks, command, sound)).collect();
    cases.extend(arrays(desks));
    cases.extend(meshes());
    cases
}

fn of_reader(desks: &Desks, command: &[&str], sound: &str) -> Vec<Case> {
    let (_, ending) = sound.rsplit_once('.').unwrap_or(("", sound));
    let bad = format!("bad.{ending}");
    let reads = |file: &str| -> Vec<String> { command.iter().map(|word| word.replace('@', file)).collect() };
    let case = |file: &str| {
        let words = reads(file);
        Case::refused(&words.iter().map(String::as_str).collect::<Vec<_>>(), &[file])
    };
    let is_store = command.contains(&"--store");
    let mut cases = vec![case("folder")];
    if !is_store {
        cases.push(case(&format!("none.{ending}")));
        cases.push(case("none/none"));
    }
    let mut garble = |name: &str, bytes: Vec<u8>| cases.push(case(name).with(name, bytes));
    let mut random = Pcg32::seed_from_u64(command.len() as u64);
    if !is_store {
        garble(&bad, Vec::new());
    }
    garble(&bad, vec![0; 5000]);
    garble(&bad, (0..5000).map(|_| random.random()).collect());
    garble(&bad, b"\xff\xfe\x00m\x00i\x00n\x00e".to_vec());
    garble(&bad, b"\x7fELF\x01\x01\x01".to_vec());
    garble(&bad, b"PK\x03\x04\x14\x00\x00\x00".to_vec());
    garble(&bad, "<html><body>404 Not Found</body></html>\n".into());
    garble(&bad, "{\"name\": \"tiny\"}\n".into());
    if matches!(ending, "dermatome" | "toml" | "npy" | "ply" | "msh" | "dae") {
        let whole = desks.file(sound);
        for share in [0.1, 0.5, 0.97] {
            garble(&bad, whole[..(whole.len() as f64 * share) as usize].to_vec());
        }
    }
    if ending == "dermatome" {
        let whole = desks.file(sound);
        for _ in 0..4 {
            let mut bytes = whole.to_vec();
            let at = random.random_range(0..bytes.len());
            bytes[at] ^= 1 << random.random_range(0..8);
            garble(&bad, bytes);
        }
        garble(&bad, [whole, b"more"].concat());
        garble(&bad, [b"DSKP", &[0xff; 3000][..]].concat());
    }
    cases
}

/// Arrays of NumPy whose headings lie.
fn arrays(desks: &Desks) -> Vec<Case> {
    let headings: &[&str] = &[
        "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999, 99999999999), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (492, 492), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (-1,), }",
        "{'descr': '|O', 'fortran_order': False, 'shape': (2,), }",
        "{'descr': '|S5', 'fortran_order': False, 'shape': (2,), }",
        "{'descr': '<f8', 'shape': (2,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (0,), }",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, 4, 5), }",
        "not a heading",
        "",
    ];
    let readers: [&[&str]; 3] = [
        &["forward", "skin.toml", "--conductivity", "bad.npy"],
        &["replay", "bad.npy", "--patch", "skin.dermatome"],
        &["check-data", "skin.toml", "bad.npy"],
    ];
    let mut cases = Vec::new();
    for command in readers {
        for heading in headings {
            let length = u16::try_from(heading.len()).unwrap_or(0).to_le_bytes();
            let bytes = [b"\x93NUMPY\x01\x00", &length[..], heading.as_bytes(), &[0; 64]].concat();
            cases.push(Case::refused(command, &["bad.npy"]).with("bad.npy", bytes));
        }
        let mut nan = desks.file("conductivity.npy").to_vec();
        let end = nan.len() - 8;
        nan[end..].copy_from_slice(&f64::NAN.to_le_bytes());
        cases.push(Case::refused(command, &["bad.npy"]).with("bad.npy", nan));
    }
    for key in ["none.npz:v", "notes.txt:v", "conductivity.npy:v", "skin.dermatome:"] {
        let (file, _) = key.rsplit_once(':').unwrap_or((key, ""));
        cases.push(Case::refused(&["check-data", "skin.toml", key], &[file]));
    }
    cases
}

/// Meshes that say what cannot be.
fn meshes() -> Vec<Case> {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n90 0 0\n0 90 0\n3 0 1 2\n";
    let stl = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 90 0 0\nvertex 0 90 0\nendloop\nendfacet\nendsolid a\n";
    let obj = "v 0 0 0\nv 90 0 0\nv 0 90 0\nf 1 2 3\n";
    let texts: Vec<(&str, String)> = vec![
        ("bad.ply", ply.replace("0 1 2", "0 1 3")),
        ("bad.ply", ply.replace("0 1 2", "0 1 -2")),
        ("bad.ply", ply.replace("90 0 0", "nan 0 0")),
        ("bad.ply", ply.replace("90 0 0", "1e999 0 0")),
        ("bad.ply", ply.replace("vertex 3", "vertex 99999999999")),
        ("bad.ply", ply.replace("face 1", "face 99999999999999999999")),
        ("bad.ply", ply.replace("ascii", "klingon")),
        ("bad.ply", ply.replace("float x", "string x")),
        ("bad.ply", ply.replace("end_header\n", "")),
        ("bad.stl", stl.replace("vertex 90", "vertex nan")),
        ("bad.stl", stl.replace("vertex 90", "vertex x")),
        ("bad.stl", stl.replace("vertex 0 90 0\n", "")),
        ("bad.stl", stl.replace("endfacet\n", "")),
        ("bad.stl", stl.replace("vertex 90 0 0", "vertex 0 0 0")),
        ("bad.stl", "solid a\nendsolid a\n".to_owned()),
        ("bad.obj", obj.replace("1 2 3", "1 2 4")),
        ("bad.obj", obj.replace("1 2 3", "0 1 2")),
        ("bad.obj", obj.replace("1 2 3", "-9 1 2")),
        ("bad.obj", obj.replace("1 2 3", "1 2 99999999999999999999")),
        ("bad.obj", obj.replace("v 90 0 0", "v nan 0 0")),
        ("bad.obj", obj.replace("v 90 0 0", "v 90 0")),
        ("bad.obj", obj.replace("f 1 2 3\n", "")),
        ("bad.dae", DAE.replace("0 1 2 3</p>", "0 1 2 4</p>")),
        ("bad.dae", DAE.replace("meter=\"1\"", "meter=\"0\"")),
        ("bad.dae", DAE.replace("Z_UP", "up")),
        ("bad.dae", DAE.replace("-5 5 0<", "-5 nan 0<")),
        ("bad.dae", DAE.replace("count=\"4\"", "count=\"99999999999\"")),
        ("bad.dae", DAE.replace("#g", "file:///etc/passwd#g")),
        ("bad.dae", DAE.replace("<node>", "<node id=\"n\"><instance_node url=\"#n\"/>")),
        ("bad.dae", DAE.replace("</COLLADA>", "")),
        ("bad.dae", format!("<!DOCTYPE a [<!ENTITY b SYSTEM \"file:///etc/passwd\">]>{DAE}")),
        ("bad.xyz", obj.to_owned()),
        ("bad.step", "ISO-10303-21;\nHEADER;\n".to_owned()),
    ];
    let command = |file: &str| {
        ["cut", file, "--unit=mm", "--around=20,20,0", "--radius=15", "--out=new"].map(str::to_owned)
    };
    let case = |(file, text): (&str, String)| {
        let words = command(file);
        Case::refused(&words.each_ref().map(String::as_str), &[file]).with(file, text)
    };
    texts.into_iter().map(case).collect()
}

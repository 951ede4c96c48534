//! Contacts in the frame of the robot's link, as programs read them; and poses that will not do.
#![cfg(unix)]

mod program;

use nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use program::{Desk, TINY, transcript};
use serde_json::Value;

/// A third of a turn about the diagonal (x goes to y, y to z, z to x), and a shift.
const POSE: &str = "[pose]\nlink = \"wrist_3\"\nposition = [\"120 mm\", -0.03, \"0.5 m\"]\n\
                    orientation = [0.5, 0.5, 0.5, 0.5]\n";

fn link_from_skin() -> Isometry3<f64> {
    let turn = UnitQuaternion::from_quaternion(Quaternion::new(0.5, 0.5, 0.5, 0.5));
    Isometry3::from_parts(Translation3::new(0.12, -0.03, 0.5), turn)
}

fn numbers(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|axis| value[axis].as_f64().unwrap())
}

#[test]
fn a_press_on_a_turned_and_shifted_skin_is_given_in_the_links_frame() {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}{POSE}"));
    let (_board, port) = desk.board("skin.toml", &["--press", "0.02,-0.01,0.012,1"]);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let stream = ["stream", "--port", &port, "--frames", "3", "--json", "stream.json"];
    let plain = desk.run(&stream).success().out;
    assert_eq!(desk.report("stream.json")["link"], Value::Null);
    let plain: Vec<f64> =
        plain.lines().next().unwrap().split('\t').take(7).map(|field| field.parse().unwrap()).collect();
    let in_skin = Point3::new(plain[2], plain[3], plain[4]) * 1e-3;
    assert!((in_skin - Point3::new(0.02, -0.01, 0.0)).norm() < 4e-3, "{in_skin}");

    let out = desk.run(&[&stream[..], &["--skin", "skin.toml"]].concat()).success().out;
    assert_eq!(desk.report("stream.json")["link"], "wrist_3");
    let frames: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(frames.len(), 3);
    for frame in &frames {
        assert_eq!((&frame["link"], &frame["flags"]), (&"wrist_3".into(), &Value::Array(vec![])));
        let [contact] = frame["contacts"].as_array().unwrap().as_slice() else { panic!("{frame:#}") };
        assert_eq!(contact["id"], 1);
        let found = Point3::from(numbers(&contact["position_m"]));
        assert!((found - link_from_skin() * in_skin).norm() < 5e-4, "{found} {in_skin}");
        // The skin's z is the link's x.
        let normal = Vector3::from(numbers(&contact["normal"]));
        assert!((normal - Vector3::x()).norm() < 1e-6, "{normal}");
        assert!(contact["area_mm2"].as_f64().unwrap() > 50.0 && contact["strength"].as_f64().unwrap() > 0.1);
        assert_eq!((&contact["pressure_kpa"], &contact["force_n"]), (&Value::Null, &Value::Null));
    }
}

#[test]
fn two_fingers_are_resolved_from_the_voltages_in_the_links_frame() {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}{POSE}"));
    let presses = ["--press", "0.014,0,0.008,1", "--press", "-0.014,0,0.008,1"];
    let (_board, port) = desk.board("skin.toml", &presses);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let mut stream = desk.start(&["stream", "--port", &port, "--skin", "skin.toml", "--resolve", "8 mm"]);
    let mut lines = std::iter::from_fn(|| Some(serde_json::from_str::<Value>(&stream.line()).unwrap()));
    // A computer that is slower than the board, as a busy one is, lets frames pass: they hold no fingers.
    let first = lines.next().unwrap();
    assert!(first["fingers"].is_array(), "nothing came before the first frame: {first:#}");
    let minute = 60 * 50;
    let later: Vec<Value> =
        lines.take(minute).filter(|frame| frame.get("fingers").is_some()).take(2).collect();
    assert_eq!(later.len(), 2, "of {minute} frames");
    stream.interrupt();
    stream.finish().success();
    for frame in std::iter::once(&first).chain(&later) {
        let [a, b] = frame["fingers"].as_array().unwrap().as_slice() else { panic!("{frame:#}") };
        for finger in [a, b] {
            let found = link_from_skin().inverse() * Point3::from(numbers(&finger["position_m"]));
            let truth = Point3::new(0.014_f64.copysign(found.x), 0.0, 0.0);
            assert!((found - truth).norm() < 4e-3, "{found}");
            assert!(finger["strength"].as_f64().unwrap() > 0.1, "{finger}");
        }
        let x = |finger: &Value| numbers(&finger["position_m"])[1];
        assert!((x(a) - x(b)).abs() > 0.02, "{frame:#}");
    }
}

#[test]
fn a_radius_that_is_none_is_refused() {
    let desk = Desk::with_patch();
    for wrong in ["0", "-3 mm", "8 kg", "nan"] {
        let option = format!("--fit={wrong}");
        let error =
            desk.run(&["stream", "--port", "tcp:127.0.0.1:1", "--skin", "skin.toml", &option]).refused();
        assert!(error.contains("--fit") && error.contains("above zero"), "{error}");
    }
    let alone = desk.run(&["stream", "--port", "tcp:127.0.0.1:1", "--resolve", "8 mm"]).refused();
    assert!(alone.contains("--skin"), "{alone}");
}

#[test]
fn a_frame_without_contact_is_a_line_too_and_a_calibrated_one_has_its_force() {
    let desk = Desk::empty();
    let calibration = "[calibration]\nstrength = [0.5]\npressure = [\"10 kPa\"]\nload_share = 0.25\n";
    desk.write("skin.toml", format!("{TINY}{calibration}{POSE}"));
    // The finger comes after half a second.
    let path =
        "time_s,finger,x_m,y_m,radius_m,depth\n0,1,0,0,0.012,0\n0.5,1,0,0,0.012,0\n0.6,1,0,0,0.012,1\n";
    desk.write("path.csv", path);
    let (_board, port) = desk.board("skin.toml", &["--path", "path.csv"]);
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let out = desk.run(&["stream", "--port", &port, "--frames", "30", "--skin", "skin.toml"]).success().out;
    let frames: Vec<Value> = out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(frames.len(), 30);
    assert_eq!(frames[0]["contacts"], Value::Array(Vec::new()));
    let last = &frames[29]["contacts"][0];
    let number = |key: &str| last[key].as_f64().unwrap();
    assert!((number("pressure_kpa") - 20.0 * number("strength")).abs() < 1e-3, "{last:#}");
    assert!(
        (number("force_n") - 0.25 * number("pressure_kpa") * number("area_mm2") * 1e-3).abs() < 1e-5,
        "{last:#}"
    );
}

#[test]
fn a_skin_file_that_is_not_that_of_the_boards_patch_is_refused() {
    let desk = Desk::with_patch();
    let (_board, port) = desk.board("skin.toml", &[]);
    desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
    let posed = format!("{TINY}{POSE}");
    desk.write("other.toml", posed.replace("\"tiny\"", "\"palm\""));
    desk.write("finer.toml", posed.replace("columns = 16", "columns = 17"));
    desk.write("larger.toml", posed.replace("\"100 mm\"", "\"101 mm\""));
    let refused =
        |file: &str| desk.run(&["stream", "--port", &port, "--frames", "1", "--skin", file]).refused();
    let missing = refused("missing.toml");
    assert!(missing.contains("cannot read skin file `missing.toml`"), "{missing}");
    let without = refused("skin.toml");
    assert!(without.contains("`skin.toml`: `pose` is missing") && without.contains("cut"), "{without}");
    let other = refused("other.toml");
    assert!(other.contains("`name` is \"palm\"; allowed: \"tiny\""), "{other}");
    for file in ["finer.toml", "larger.toml"] {
        let moved = refused(file);
        assert!(moved.contains(file) && moved.contains("pixels do not lie where"), "{moved}");
    }
}

#[test]
fn errors_of_poses() {
    let desk = Desk::empty();
    let good = "link = \"l\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 1]\n";
    let change = |from: &str, to: &str| good.replace(from, to);
    let broken = [
        ("long-quaternion", change("[0, 0, 0, 1]", "[0.5, 0.5, 0.5, 0.6]")),
        ("zero-quaternion", change("[0, 0, 0, 1]", "[0, 0, 0, 0]")),
        ("nan-quaternion", change("[0, 0, 0, 1]", "[nan, 0, 0, 1]")),
        ("roll-pitch-yaw", change("[0, 0, 0, 1]", "[0, 0, 0]")),
        ("five", change("[0, 0, 0, 1]", "[0, 0, 0, 1, 0]")),
        ("text-quaternion", change("[0, 0, 0, 1]", "[\"0\", 0, 0, 1]")),
        ("two-lengths", change("position = [0, 0, 0]", "position = [0, 0]")),
        ("nan-length", change("position = [0, 0, 0]", "position = [0, nan, 0]")),
        ("infinite", change("position = [0, 0, 0]", "position = [0, 0, -inf]")),
        ("far", change("position = [0, 0, 0]", "position = [0, \"2000 m\", 0]")),
        ("unit", change("position = [0, 0, 0]", "position = [0, \"2 kg\", 0]")),
        ("no-link", change("link = \"l\"\n", "")),
        ("link-name", change("\"l\"", "\"left palm\"")),
        ("four-lengths", change("position = [0, 0, 0]", "position = [0, 0, 0, 0]")),
        ("unknown", format!("{good}parent = \"base\"\n")),
    ];
    for (name, pose) in &broken {
        assert_ne!(pose, good, "{name} is not broken");
        desk.write(&format!("{name}.toml"), format!("{TINY}[pose]\n{pose}"));
    }
    let files: Vec<String> = broken.iter().map(|(name, _)| format!("{name}.toml")).collect();
    let commands: Vec<[&str; 2]> = files.iter().map(|file| ["build", file]).collect();
    let commands: Vec<&[&str]> = commands.iter().map(|arguments| &arguments[..]).collect();
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("errors_pose", transcript(&desk, &commands)));
}

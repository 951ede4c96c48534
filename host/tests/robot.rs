//! Skins on robots: what `urdf` and `mjcf` write and say, and presses that a simulated board is told as they happen.
#![cfg(unix)]

mod program;

use dermatome::body::file::BodyFile;
use program::{Desk, TINY, shape, transcript};
use serde_json::Value;
use std::{io::Write, process::Command};

const POSE: &str =
    "[pose]\nlink = \"palm\"\nposition = [0.01, -0.02, 0.3]\norientation = [0.5, 0.5, 0.5, 0.5]\n";
const ROBOT: &str = "<?xml version=\"1.0\"?>\n<!-- by hand -->\n<robot name=\"hand\">\n  <link name='arm'/>\n  \
                     <link name=\"palm\" />\n  <joint name=\"wrist\" type=\"revolute\">\n    <parent link=\"arm\"/> <child \
                     link=\"palm\"/>\n    <limit effort=\"1\" velocity=\"1\"/>\n  </joint>\n</robot>\n";
const MODEL: &str = "<mujoco>\n  <compiler meshdir=\"assets\"/>\n  <worldbody>\n    <body name=\"palm\">\n      <geom \
                     size=\"0.1\"/>\n    </body>\n  </worldbody>\n</mujoco>\n";

fn desk() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}{POSE}"));
    desk.write("plain.toml", TINY);
    desk.write("hand.urdf", ROBOT);
    desk.write("hand.xml", MODEL);
    std::fs::create_dir(desk.path("assets")).unwrap();
    desk
}

fn snapshot(name: &str, text: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, text));
}

fn text(desk: &Desk, name: &str) -> String {
    String::from_utf8(desk.read(name)).unwrap()
}

/// `with` is `without` and something put into it.
fn assert_kept(without: &str, with: &str) {
    let mut lines = with.lines();
    assert!(without.lines().all(|line| lines.any(|it| it == line)), "{with}");
}

#[test]
fn a_skin_becomes_a_link_and_the_rest_of_the_robot_stays() {
    let desk = desk();
    let added = desk
        .run(&["urdf", "add", "hand.urdf", "skin.toml", "-o", "out.urdf", "--json", "add.json"])
        .success();
    assert_eq!(added.err, "");
    assert_eq!(text(&desk, "hand.urdf"), ROBOT);
    let out = text(&desk, "out.urdf");
    assert_kept(ROBOT, &out);
    snapshot("urdf", &format!("{}\n{out}", added.out));
    snapshot("urdf_json", &shape(&desk.report("add.json")));
    assert!(desk.read("tiny.stl").starts_with(b"Dermatome: a skin's mesh, metres\0"));
    // In place, again, and with a mesh elsewhere.
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml"]).success();
    assert_eq!(text(&desk, "hand.urdf"), out);
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "--replace"]).success();
    assert_eq!(text(&desk, "hand.urdf"), out);
    let elsewhere = ["--mesh", "assets/tiny.stl", "--replace"];
    desk.run(&[&["urdf", "add", "hand.urdf", "skin.toml"], &elsewhere[..]].concat()).success();
    assert!(text(&desk, "hand.urdf").contains("<mesh filename=\"assets/tiny.stl\"/>"));
    // The mesh is replaced where it lies.
    std::fs::remove_file(desk.path("tiny.stl")).unwrap();
    let there = text(&desk, "hand.urdf");
    let thin = desk.read("assets/tiny.stl");
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "--replace", "--thickness", "2 mm"]).success();
    assert_eq!(text(&desk, "hand.urdf"), there);
    assert!(!desk.path("tiny.stl").exists() && desk.read("assets/tiny.stl") != thin);
    let uri = "package://hand&co/tiny.stl";
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "--replace", "--mesh-uri", uri]).success();
    assert!(text(&desk, "hand.urdf").contains("filename=\"package://hand&amp;co/tiny.stl\""));
}

#[test]
fn one_skin_file_is_on_a_robot_twice_under_names_of_their_own() {
    let desk = desk();
    let add = |name: &str, link: &str, more: &[&str]| {
        let words = ["urdf", "add", "hand.urdf", "skin.toml", "--name", name, "--link", link];
        desk.run(&[&words, more].concat())
    };
    add("left", "palm", &[]).success();
    add("right", "arm", &[]).success();
    let both = text(&desk, "hand.urdf");
    assert!(desk.path("left.stl").is_file() && desk.path("right.stl").is_file());
    let said = add("left", "palm", &[]).err;
    assert!(
        said.contains("skin \"left\" is there already; allowed: another `--name`, or `--replace`"),
        "{said}"
    );
    desk.run(&["urdf", "check", "hand.urdf", "skin.toml", "--json", "check.json"]).success();
    let checked = desk.report("check.json");
    let skins = [0, 1].map(|at| ["skin", "frame", "link"].map(|key| checked["skins"][at][key].clone()));
    assert_eq!(skins, [["tiny", "left", "palm"], ["tiny", "right", "arm"]]);
    let odd = "link \"palm\" moves and has no `inertial`: Gazebo leaves it out";
    assert_eq!(checked["findings"].as_array().unwrap().len(), 1, "{checked}");
    assert_eq!(checked["findings"][0]["message"], odd);
    read_by_urdfdom(&desk, &[":  right", ":  left"]);
    let body = |patches: &str| format!("name = \"r\"\nurdf = \"hand.urdf\"\n{patches}");
    let patch = |name: &str, link: &str| {
        format!(
            "[[patches]]\nname = {name:?}\nlink = {link:?}\nskin = \"skin.toml\"\nport = \"sim:skin.toml\"\n"
        )
    };
    desk.write("body.toml", body(&(patch("left", "palm") + &patch("right", "arm"))));
    BodyFile::load(&desk.path("body.toml")).unwrap();
    // It stays on its link, which is not that of the file.
    let replace = ["urdf", "add", "hand.urdf", "skin.toml", "--name", "right", "--replace"];
    desk.run(&[&replace[..], &["--thickness", "2 mm"]].concat()).success();
    assert_eq!(text(&desk, "hand.urdf"), both);
    assert!(desk.read("left.stl") != desk.read("right.stl"));
    // Neither lies where the file says.
    desk.write("hand.urdf", both.replace("0.01 -0.02 0.3", "0.02 -0.02 0.3"));
    let said = desk.run(&["urdf", "check", "hand.urdf", "skin.toml"]);
    assert!(said.err.contains("2 things are wrong"), "{} {}", said.out, said.err);
}

#[test]
fn one_skin_file_is_on_a_model_twice_under_names_of_their_own() {
    let desk = desk();
    for (name, body) in [("left", "palm"), ("right", "world")] {
        let add = ["mjcf", "add", "hand.xml", "skin.toml", "--taxels", "3", "--name", name, "--body", body];
        desk.run(&add).success();
        assert!(desk.path("assets").join(format!("{name}.stl")).is_file());
        let said = desk.run(&add).err;
        assert!(said.contains(&format!("skin {name:?} is there already")), "{said}");
    }
    let both = text(&desk, "hand.xml");
    assert_eq!(both.matches("<touch").count(), 8, "{both}");
    assert!(!both.contains("tiny"), "{both}");
    let replace = ["mjcf", "add", "hand.xml", "skin.toml", "--name", "left", "--replace"];
    desk.run(&replace).success();
    assert_eq!(text(&desk, "hand.xml").matches("right").count(), both.matches("right").count());
    let replace =
        ["mjcf", "add", "hand.xml", "skin.toml", "--name", "right", "--replace", "--json", "it.json"];
    desk.run(&replace).success();
    assert_eq!(desk.report("it.json")["link"], "world");
}

#[test]
fn the_mesh_of_one_skin_does_not_take_the_place_of_anothers() {
    let desk = desk();
    let add = |more: &[&str]| desk.run(&[&["urdf", "add", "hand.urdf", "skin.toml"], more].concat());
    add(&["--name", "a b"]).success();
    let (mesh, robot) = (desk.read("a_b.stl"), text(&desk, "hand.urdf"));
    // The same mesh can be both's.
    add(&["--name", "a_b", "-o", "two.urdf"]).success();
    let thick = ["--name", "a_b", "--thickness", "2 mm"];
    let said = add(&thick).err;
    assert!(said.contains("by default to `a_b.stl`, but that is there, and is of another skin"), "{said}");
    assert!(desk.read("a_b.stl") == mesh && text(&desk, "hand.urdf") == robot);
    add(&[&thick[..], &["--mesh", "b.stl"]].concat()).success();
    assert!(desk.read("a_b.stl") == mesh && desk.path("b.stl").is_file());
}

#[test]
fn a_robot_is_checked_with_its_skins() {
    let desk = desk();
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "--link", "arm"]).success();
    let check =
        |robot: &str| ["urdf", "check", robot, "skin.toml", "--json", "check.json"].map(str::to_owned);
    let other = desk.run(&check("hand.urdf").each_ref().map(|it| &**it)).success();
    assert!(
        other.out.contains("skin \"tiny\" lies on \"arm\", but its file says link = \"palm\""),
        "{}",
        other.out
    );
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "--replace"]).success();
    let robot = text(&desk, "hand.urdf");
    let links = "  <link name=\"palm\"/>\n  <link name=\"lost\"/>\n</robot>";
    for (name, from, to) in [
        ("moved", "0.01 -0.02 0.3", "0.011 -0.02 0.3"),
        ("turned", "rpy=\"1.570796327 0", "rpy=\"1.570796327 0.01"),
        ("words", "0.01 -0.02 0.3", "0.01 left"),
        ("no-limit", "<limit effort=\"1\" velocity=\"1\"/>", ""),
        ("kind", "\"revolute\"", "\"hinge\""),
        ("loose", "type=\"fixed\"", "type=\"continuous\""),
        ("no-mesh", "tiny.stl", "none.stl"),
        ("package", "tiny.stl", "package://none/tiny.stl"),
        ("nowhere", "<child link=\"tiny\"/>", "<child link=\"tyny\"/>"),
        ("no-skin", "sensor", "something"),
        ("parts", "</robot>", links),
        (
            "circle",
            "<parent link=\"arm\"/> <child link=\"palm\"/>",
            "<parent link=\"tiny\"/> <child link=\"palm\"/>",
        ),
    ] {
        assert!(robot.contains(from), "{from}");
        desk.write(&format!("{name}.urdf"), robot.replace(from, to));
    }
    // As it is where the size of a skin was changed since.
    desk.write("larger.toml", format!("{TINY}{POSE}").replace("\"100 mm\"", "\"104 mm\""));
    let names = [
        "hand", "moved", "turned", "words", "no-limit", "kind", "loose", "no-mesh", "package", "nowhere",
        "no-skin", "parts", "circle",
    ];
    let files = names.map(|name| format!("{name}.urdf"));
    let mut commands: Vec<_> = files.iter().map(|file| vec!["urdf", "check", file, "skin.toml"]).collect();
    commands.push(vec!["urdf", "check", "hand.urdf", "larger.toml"]);
    let mut said = String::new();
    for words in commands {
        let done = desk.run(&words);
        said += &format!(
            "$ dermatome {}\n{}{}(exit code {})\n\n",
            words.join(" "),
            done.out,
            done.err,
            done.status.code().unwrap()
        );
    }
    snapshot("urdf_check", &said);
    desk.run(&check("hand.urdf").each_ref().map(|it| &**it)).success();
    snapshot("urdf_check_json", &shape(&desk.report("check.json")));
}

#[test]
fn a_skin_that_was_cut_out_of_a_mesh_shown_elsewhere_is_told_its_place() {
    let desk = Desk::empty();
    let mesh = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/hemisphere-210mm/hemisphere.stl");
    std::fs::copy(mesh, desk.path("dome.stl")).unwrap();
    let cut =
        ["--unit", "mm", "--around", "0,-74,74", "--radius", "40", "--edge-length", "1.8", "--out", "skin"];
    desk.run(&[&["cut", "dome.stl"], &cut[..]].concat()).success();
    let robot = |origin: &str| {
        format!(
            "<robot name='r'>\n<link name='dome'><visual>{origin}<geometry><mesh filename='dome.stl' \
             scale='0.001 0.001 0.001'/></geometry></visual></link>\n</robot>"
        )
    };
    desk.write("r.urdf", robot(""));
    desk.run(&["urdf", "add", "r.urdf", "skin/skin.toml"]).success();
    let check = ["urdf", "check", "r.urdf", "skin/skin.toml", "--json", "c.json"];
    assert!(desk.run(&check).success().out.ends_with("all is well\n"));
    assert!(desk.report("c.json")["skins"][0]["off_link_mm"].as_f64().unwrap() < 0.2);
    let shown = "<origin xyz='0.05 0 0' rpy='0 0 1.5707963'/>";
    desk.write(
        "r.urdf",
        text(&desk, "r.urdf").replace(
            "<visual><geometry><mesh filename='dome",
            &format!("<visual>{shown}<geometry><mesh filename='dome"),
        ),
    );
    let said = desk.run(&check).success().out;
    assert!(said.contains("its pose is that in the mesh"), "{said}");
    let place = said.split("position = [").nth(1).unwrap().split(']').next().unwrap();
    let place: Vec<f64> = place.split(", ").map(|it| it.parse().unwrap()).collect();
    // A quarter turn about z takes -y to x.
    assert!(
        (place[0] - 0.124).abs() < 1e-3 && place[1].abs() < 1e-3 && (place[2] - 0.074).abs() < 1e-3,
        "{said}"
    );
}

#[test]
fn a_skin_becomes_a_body_with_sensors() {
    let desk = desk();
    let add =
        ["mjcf", "add", "hand.xml", "skin.toml", "--taxels", "3", "-o", "out.xml", "--json", "add.json"];
    let added = desk.run(&add).success();
    assert_eq!(added.err, "");
    let out = text(&desk, "out.xml");
    assert_kept(MODEL, &out);
    snapshot("mjcf", &format!("{}\n{out}", added.out));
    snapshot("mjcf_json", &shape(&desk.report("add.json")));
    assert!(desk.path("assets/tiny.stl").is_file());
    desk.run(&["mjcf", "add", "out.xml", "skin.toml", "--taxels", "3", "--replace"]).success();
    assert_eq!(text(&desk, "out.xml"), out);
    let world = desk.run(&["mjcf", "add", "hand.xml", "skin.toml", "--body", "world"]).success();
    assert!(world.err.contains("the skin file says link = \"palm\""), "{}", world.err);
}

#[test]
fn a_hollow_skins_hull_is_told() {
    let desk = desk();
    let star = "kind = \"polygon\"\npoints = [[0.1, 0], [0.02, 0.02], [0, 0.1], [-0.1, -0.1]]";
    let star = TINY.replace("kind = \"disc\"\ndiameter = \"100 mm\"", star).replace("\"8 mm\"", "\"5 mm\"");
    desk.write("star.toml", format!("{star}{POSE}"));
    let said = desk.run(&["mjcf", "add", "hand.xml", "star.toml"]).success().err;
    assert!(said.contains("convex hull, which reaches") && said.contains("mm beyond this skin"), "{said}");
}

#[test]
fn errors_of_robots() {
    let desk = desk();
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml", "-o", "there.urdf"]).success();
    desk.write(
        "arm.urdf.xacro",
        "<robot name=\"a\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n  <xacro:include filename=\"arm.xacro\"/>\n</robot>\n",
    );
    desk.write("cut.urdf", &ROBOT[..150]);
    desk.write("latin.urdf", b"<?xml version=\"1.0\" encoding=\"latin1\"?>\n<robot name=\"\xe4\"/>\n");
    desk.write("mine.stl", "solid mine\n");
    let add = |more: &[&'static str]| [&["urdf", "add"], more].concat();
    let commands = [
        add(&["none.urdf", "skin.toml"]),
        add(&["assets", "skin.toml"]),
        add(&["cut.urdf", "skin.toml"]),
        add(&["latin.urdf", "skin.toml"]),
        add(&["skin.toml", "skin.toml"]),
        add(&["hand.xml", "skin.toml"]),
        add(&["arm.urdf.xacro", "skin.toml"]),
        add(&["hand.urdf", "none.toml"]),
        add(&["hand.urdf", "plain.toml"]),
        add(&["hand.urdf", "skin.toml", "--link", "finger"]),
        add(&["hand.urdf", "skin.toml", "--name", "arm"]),
        add(&["hand.urdf", "skin.toml", "--name", ""]),
        add(&["hand.urdf", "skin.toml", "--thickness", "0"]),
        add(&["hand.urdf", "skin.toml", "--mesh", "mine.stl"]),
        add(&["hand.urdf", "skin.toml", "--mesh", "none/skin.stl"]),
        add(&["hand.urdf", "skin.toml", "--mesh-uri", ""]),
        add(&["hand.urdf", "skin.toml", "-o", "there.urdf"]),
        add(&["hand.urdf", "skin.toml", "-o", "none/out.urdf"]),
        add(&["hand.urdf", "skin.toml", "-o", "skin.toml", "--force"]),
        add(&["hand.urdf", "skin.toml", "-o", "/dev/null"]),
        add(&["/dev/stdin", "skin.toml"]),
        add(&["there.urdf", "skin.toml"]),
        vec!["urdf", "check", "none.urdf"],
        vec!["urdf", "check", "hand.xml"],
        vec!["urdf", "check", "there.urdf", "plain.toml"],
        vec!["mjcf", "add", "hand.urdf", "skin.toml"],
        vec!["mjcf", "add", "hand.xml", "skin.toml", "--body", "thumb"],
        vec!["mjcf", "add", "hand.xml", "skin.toml", "--taxels", "2000"],
    ];
    let commands: Vec<&[&str]> = commands.iter().map(Vec::as_slice).collect();
    let before = desk.files();
    snapshot("errors", &transcript(&desk, &commands));
    assert_eq!(desk.files(), before);
    assert_eq!(
        (text(&desk, "hand.urdf"), text(&desk, "mine.stl")),
        (ROBOT.to_owned(), "solid mine\n".to_owned())
    );
}

#[test]
fn urdfdom_reads_the_robot_with_its_skin() {
    let desk = desk();
    desk.run(&["urdf", "add", "hand.urdf", "skin.toml"]).success();
    read_by_urdfdom(&desk, &["child(1):  tiny"]);
}

fn read_by_urdfdom(desk: &Desk, wanted: &[&str]) {
    match Command::new("check_urdf").arg(desk.path("hand.urdf")).output() {
        Ok(read) => {
            let said = String::from_utf8_lossy(&read.stdout);
            assert!(read.status.success() && wanted.iter().all(|it| said.contains(it)), "{said}");
        }
        Err(error) => {
            println!("not run: check_urdf ({error}); ./test installs it, and has other programs read it too");
        }
    }
}

#[test]
fn a_simulated_board_is_pressed_as_its_standard_input_says() {
    let desk = desk();
    let mut board = desk.command(&["simulate", "skin.toml", "--listen", "tcp:127.0.0.1:0", "--live"]);
    let (mut board, mut input) = program::Running::with_input(&mut board);
    let said = board.line();
    let port = said.trim().split_once(" listens at ").unwrap().1;
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk.run(&["flash", "skin.dermatome", "--port", port]).success();
    let mut stream = desk.start(&["stream", "--port", port, "--skin", "skin.toml"]);
    let mut contacts = |wanted: usize| -> Vec<Value> {
        for _ in 0..1000 {
            let frame: Value = serde_json::from_str(&stream.line()).unwrap();
            match frame["contacts"].as_array() {
                Some(contacts) if contacts.len() == wanted => return contacts.clone(),
                _ => {}
            }
        }
        panic!("never {wanted} contacts in 1000 frames");
    };
    contacts(0);
    input
        .write_all(b"{\"presses\": [{\"x_m\": 0.02, \"y_m\": -0.01, \"radius_m\": 0.012, \"depth\": 1}]}\n")
        .unwrap();
    contacts(1);
    // While the average of the frames before fades, the place settles.
    let found = (0..20).map(|_| contacts(1)).next_back().unwrap();
    let place = [0, 1, 2].map(|axis| found[0]["position_m"][axis].as_f64().unwrap());
    // The pose takes x to y, y to z, z to x.
    let wanted = [0.01, 0.0, 0.29];
    let off = place.iter().zip(wanted).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    assert!(off < 4e-3, "{place:?}");
    input.write_all(b"{\"presses\": []}\n").unwrap();
    contacts(0);
    input
        .write_all(b"{\"presses\": [{\"x_m\": 0, \"y_m\": 0, \"radius_m\": 0.01, \"force_n\": 2}]}\n")
        .unwrap();
    let end = board.finish();
    assert!(
        !end.status.success()
            && end.err.contains("standard input, line 3: ")
            && end.err.contains("`--material`"),
        "{}",
        end.err
    );
}

//! Body files that are right, and that are not.

use super::*;

const SKIN: &str = include_str!("../../../../models/square-50mm/skin.toml");

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("skin.toml"), SKIN).unwrap();
    let posed = format!(
        "{SKIN}\n[pose]\nlink = \"palm\"\nposition = [\"1 mm\", \"2 mm\", \"3 mm\"]\norientation = [0, 0, 0, 1]\n"
    );
    std::fs::write(folder.path().join("posed.toml"), posed).unwrap();
    folder
}

fn parse(folder: &tempfile::TempDir, text: &str) -> Result<BodyFile, String> {
    BodyFile::parse(&folder.path().join("robot.toml"), text).map_err(|error| error.to_string())
}

#[test]
fn skins_lie_where_their_files_say_or_where_the_body_file_says() {
    let folder = folder();
    let body = parse(
        &folder,
        r#"
        name = "arm"
        [[patches]]
        skin = "posed.toml"
        port = "sim:posed.toml"
        [[patches]]
        name = "other"
        skin = "posed.toml"
        port = "tcp:127.0.0.1:7000"
        link = "palm_left"
        [[patches]]
        name = "third"
        skin = "skin.toml"
        port = "COM5"
        link = "forearm"
        position = ["0 mm", "1 cm", "-0.5 m"]
        orientation = [0.0, 0.0, 0.7071, 0.7071]
        "#,
    )
    .unwrap();
    let [a, b, c] = body.patches.as_slice() else { panic!("{body:?}") };
    assert_eq!(
        (a.name.as_str(), a.pose.link.as_str(), a.pose.position),
        ("square_50mm", "palm", [0.001, 0.002, 0.003])
    );
    assert_eq!(a.port, Port::Simulated(folder.path().join("posed.toml")));
    assert_eq!((b.pose.link.as_str(), b.pose.position), ("palm_left", a.pose.position));
    assert_eq!((c.pose.link.as_str(), c.pose.position), ("forearm", [0.0, 0.01, -0.5]));
    assert!((c.pose.orientation[2] - 0.5_f64.sqrt()).abs() < 1e-4);
}

#[test]
fn what_is_wrong_is_named_with_its_place_and_what_is_allowed() {
    let folder = folder();
    let patch = "[[patches]]\nskin = \"posed.toml\"\nport = \"COM5\"\n";
    let cases = [
        ("name = \"a b\"\n".to_owned() + patch, "`name` is \"a b\"; allowed: 1 to 32 letters"),
        ("name = \"a\"\npatches = []\n".to_owned(), "`patches` is a list of 0; allowed: 1 to 256"),
        (
            format!("name = \"a\"\n{patch}{patch}"),
            "`patches[1].name` is \"square_50mm\"; allowed: a name that no patch before has",
        ),
        (
            format!("name = \"a\"\n{patch}{patch}name = \"b\"\n"),
            "`patches[1].port` is \"COM5\"; allowed: a port that no",
        ),
        (format!("name = \"a\"\n{patch}link = \"a b\"\n"), "`patches[0].link` is \"a b\"; allowed: 1 to 64"),
        (
            format!("name = \"a\"\n{patch}position = [0, 0, 0]\n"),
            "`patches[0].link` is missing; allowed: `link` with `position`",
        ),
        (
            "name = \"a\"\n[[patches]]\nskin = \"skin.toml\"\nport = \"COM5\"\n".to_owned(),
            "`patches[0].link` is missing",
        ),
        (
            "name = \"a\"\n[[patches]]\nskin = \"skin.toml\"\nport = \"usb\"\n".to_owned(),
            "`patches[0].port` is \"usb\"; allowed: a port",
        ),
        (
            "name = \"a\"\n[[patches]]\nskin = \"none.toml\"\nport = \"COM5\"\n".to_owned(),
            "`patches[0].skin`:",
        ),
        (
            format!(
                "name = \"a\"\n{patch}link = \"l\"\nposition = [\"1 kg\", 0, 0]\norientation = [0, 0, 0, 1]\n"
            ),
            "`patches[0].position` is",
        ),
        (
            format!("name = \"a\"\n{patch}link = \"l\"\nposition = [0, 0, 0]\norientation = [0, 0, 0, 2]\n"),
            "`patches[0].orientation` is",
        ),
        (format!("name = \"a\"\ncolour = 3\n{patch}"), "colour"),
    ];
    for (text, words) in cases {
        let error = parse(&folder, &text).unwrap_err();
        assert!(error.contains(words) && error.contains("robot.toml"), "{error}\n{text}");
    }
}

#[test]
fn names_become_parts_of_topics() {
    assert_eq!(as_part_of_topic("disc-210mm"), "disc_210mm");
    assert!(is_part_of_topic(&as_part_of_topic("7 up")));
    assert!(!is_part_of_topic("") && !is_part_of_topic("a/b") && !is_part_of_topic("1a"));
}

const ROBOT: &str = "<robot name='r'>\n<link name='base'/>\n<link name='palm'/>\n<joint name='wrist' type='fixed'><parent \
                     link='base'/><child link='palm'/></joint>\n</robot>";

/// A skin of the robot, as `urdf add` writes one.
fn with_skin(link: &str, xyz: &str) -> String {
    let skin = format!(
        "<link name='skin'/><joint name='skin_mount' type='fixed'><parent link='{link}'/><child link='skin'/><origin \
         xyz='{xyz}' rpy='0 0 0'/></joint><sensor name='square-50mm'><parent link='skin'/><tactile/></sensor>\n</robot>"
    );
    ROBOT.replace("</robot>", &skin)
}

#[test]
fn boards_of_a_bus_are_counted_and_an_address_is_there_once() {
    let folder = folder();
    let body = |ports: &[&str]| {
        let patches = (0..).zip(ports).map(|(number, port)| {
            format!("[[patches]]\nname = \"p{number}\"\nskin = \"posed.toml\"\nport = \"{port}\"\n")
        });
        parse(&folder, &format!("name = \"arm\"\n{}", patches.collect::<String>()))
    };
    let ports = [
        "rs485:/dev/ttyUSB0#1",
        "rs485:/dev/ttyUSB1#1",
        "rs485:/dev/ttyUSB0#2",
        "/dev/ttyACM0",
        "can:/dev/ttyUSB0#1",
        "can:can0#1",
        "can:can0#0",
    ];
    let on_bus: Vec<_> = body(&ports).unwrap().patches.iter().map(|patch| patch.on_bus).collect();
    assert_eq!(on_bus, [2, 1, 2, 1, 1, 2, 2]);
    let twice = body(&["rs485:/dev/ttyUSB0#1", "rs485:/dev/ttyUSB0#1"]).unwrap_err();
    assert!(
        twice.contains("`patches[1].port` is \"rs485:/dev/ttyUSB0#1\"; allowed: a port that no"),
        "{twice}"
    );
    let far = body(&["rs485:/dev/ttyUSB0#16"]).unwrap_err();
    assert!(far.contains("ADDRESS is from 0 to 15"), "{far}");
}

#[test]
fn a_body_lies_on_the_links_of_its_robot_where_that_has_its_skins() {
    let folder = folder();
    let patch = |more: &str| format!("[[patches]]\nskin = \"posed.toml\"\nport = \"sim:posed.toml\"\n{more}");
    let two = patch("") + &patch("name = \"other\"\nlink = \"base\"\n");
    for (robot, patches, words) in [
        (ROBOT.to_owned(), two.clone(), None),
        (with_skin("palm", "0.001 0.002 0.00304"), two.clone(), None),
        // Worn twice on one link, of which the robot has one.
        (
            with_skin("palm", "0.001 0.002 0.003"),
            patch("")
                + &patch(
                    "name = \"other\"\nlink = \"palm\"\nposition = [0.1, 0, 0]\norientation = [0, 0, 0, 1]\n",
                ),
            None,
        ),
        // The robot has one of the two.
        (with_skin("base", "0.001 0.002 0.003"), two, None),
        (
            with_skin("palm", "0.001 0.002 0.004"),
            patch(""),
            Some("`patches[0].position` is [0.001, 0.002, 0.003] with orientation"),
        ),
        (
            with_skin("base", "0.001 0.002 0.003"),
            patch(""),
            Some("`patches[0].link` is \"palm\"; allowed: \"base\", on which"),
        ),
        (
            with_skin("palm", "0.001 0.002 0.003"),
            patch("link = \"hand\"\n"),
            Some("`patches[0].link` is \"hand\"; allowed: a link of"),
        ),
        (ROBOT.replace("fixed", "hinge"), patch(""), Some("`urdf`")),
        (ROBOT.replace("link='base'", "link='bas'"), patch(""), Some("line 4: the parent of joint")),
        ("none".to_owned(), patch(""), Some("it is no XML")),
    ] {
        std::fs::write(folder.path().join("robot.urdf"), robot).unwrap();
        let body = parse(&folder, &format!("name = \"arm\"\nurdf = \"robot.urdf\"\n{patches}"));
        match (body, words) {
            (Ok(body), None) => assert_eq!(body.urdf.unwrap().robot.links[1].name, "palm"),
            (Err(error), Some(words)) => {
                assert!(error.contains(words) && error.contains("robot.urdf"), "{error}");
            }
            (body, words) => panic!("{words:?}: {body:?}"),
        }
    }
    let missing =
        parse(&folder, &format!("name = \"arm\"\nurdf = \"none.urdf\"\n{}", patch(""))).unwrap_err();
    assert!(missing.contains("robot.toml`: `urdf`: `") && missing.contains("none.urdf`: "), "{missing}");
}

//! Strangers: who has no certificate, another authority's, or one that allows nothing, is not heard.
//!
//! With the files of docs/zenoh, but for addresses.

use crate::{
    START, body, desk_of,
    hearing::{Hearing, free_port},
    program::{Desk, Running, with},
};
use std::{path::Path, process::Command, thread, time::Duration};

/// Time in which a stranger would have been heard, had it been let in.
const PATIENCE: Duration = Duration::from_secs(4);

fn example(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/zenoh").join(name);
    std::fs::read_to_string(path).unwrap()
}

/// Makes certificates in a folder.
fn certify(desk: &Desk, folder: &str, computers: &[&str]) {
    std::fs::create_dir_all(desk.path(folder)).unwrap();
    desk.write("certificates.sh", example("certificates.sh"));
    let names = computers.iter().map(|computer| format!("{computer}=127.0.0.1"));
    let made = Command::new("sh")
        .arg(desk.path("certificates.sh"))
        .args(names)
        .current_dir(desk.path(folder))
        .output();
    let made = made.unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

/// A computer that serves `NAME.toml` with the certificate of another name.
fn serve(desk: &Desk, computer: &str, port: u16, config: &str) -> Running {
    let (file, settings) = (format!("{computer}.toml"), format!("{computer}.json5"));
    desk.write(&settings, config.replace("192.168.0.10:7447", &format!("127.0.0.1:{port}")));
    let mut serve = desk.start(&["serve", &file, "--zenoh-orders", "--zenoh-config", &settings]);
    serve.read_output();
    serve
}

#[test]
fn a_stranger_is_refused_and_a_computer_of_the_robot_is_heard() {
    let desk = desk_of(&["left_arm", "nobody", "forger", "guest"]);
    certify(&desk, ".", &["body", "left_arm", "guest"]);
    certify(&desk, "forged", &["left_arm"]);
    let port = free_port();
    desk.write("body.json5", example("body.json5").replace("0.0.0.0:7447", &format!("127.0.0.1:{port}")));
    let arguments = ["body", "arm", "--zenoh-config", "body.json5", "--json", "report.json"];
    let mut hearing = Hearing::start(desk.command(&arguments));
    let ours = example("left_arm.json5");
    // Nothing presses on its skin.
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    let (_board, address) = desk.board("skin.toml", &["--live"]);
    desk.run(&["flash", "skin.dermatome", "--port", &address]).success();
    desk.write("left_arm.toml", body(&[("left_arm".to_owned(), address)]));
    let _left = serve(&desk, "left_arm", port, &ours);
    hearing.wait("left_arm", START, |said| said.phase == "live" && said.frames > 20);

    let without = with(&ours, "connect_certificate: \"certificates/left_arm.pem\",", "");
    let without = with(&without, "connect_private_key: \"certificates/left_arm.key\",", "");
    let mut strangers = [
        serve(&desk, "nobody", port, &with(&without, "enable_mtls: true", "enable_mtls: false")),
        // Believes in the true authority and has the certificate of another one for the same name.
        serve(
            &desk,
            "forger",
            port,
            &ours.replace("certificates/left_arm.", "forged/certificates/left_arm."),
        ),
        // Is of the robot, but may not tell anything.
        serve(&desk, "guest", port, &ours.replace("certificates/left_arm.", "certificates/guest.")),
    ];
    thread::sleep(PATIENCE);
    assert!(strangers.iter_mut().all(Running::is_running), "all have tried the whole time");
    let frames = hearing.said("left_arm").frames;
    hearing.wait("left_arm", START, |said| said.frames > frames);
    hearing.end();
    let report = desk.report("report.json");
    let heard: Vec<&str> =
        report["patches"].as_array().unwrap().iter().map(|it| it["patch"].as_str().unwrap()).collect();
    assert_eq!(heard, ["left_arm"], "{report:#}");

    // Nobody but `left_arm` is there to be ordered either, once it is connected again.
    let drive = ["--drive", "all", "--gain", "8"];
    let ordered =
        desk.run(&[&["body", "arm", "--zenoh-config", "body.json5"], &drive[..]].concat()).success();
    assert!(
        ordered.out.starts_with("left_arm: 50000 Hz") && ordered.out.lines().count() == 1,
        "{}",
        ordered.out
    );
}

#[test]
fn the_same_computers_are_all_heard_where_nobody_is_refused() {
    let desk = desk_of(&["left_arm", "guest"]);
    certify(&desk, ".", &["body", "left_arm", "guest"]);
    let port = free_port();
    let open = example("body.json5").replace("0.0.0.0:7447", &format!("127.0.0.1:{port}"));
    desk.write(
        "body.json5",
        with(&open, "enabled: true,\n    default_permission", "enabled: false,\n    default_permission"),
    );
    let mut hearing = Hearing::start(desk.command(&["body", "arm", "--zenoh-config", "body.json5"]));
    let ours = example("left_arm.json5");
    let _serving = [
        serve(&desk, "left_arm", port, &ours),
        serve(&desk, "guest", port, &ours.replace("certificates/left_arm.", "certificates/guest.")),
    ];
    for computer in ["left_arm", "guest"] {
        hearing.wait(computer, START, |said| said.frames > 0);
    }
    hearing.end();
}

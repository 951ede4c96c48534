//! Orders: skins that another computer has tared and driven.

use crate::{
    body,
    hearing::free_port,
    program::{Desk, Done, Running, TINY},
};

/// A computer that serves `palm`, which nothing presses on, and `gone`, whose board is not there.
struct Computer {
    desk: Desk,
    _board: Running,
    serve: Running,
    endpoint: String,
}

impl Computer {
    fn start(options: &[&str]) -> Self {
        let desk = Desk::empty();
        desk.write("skin.toml", TINY);
        desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
        let (board, port) = desk.board("skin.toml", &["--live"]);
        desk.run(&["flash", "skin.dermatome", "--port", &port]).success();
        let skins = [("palm", port.as_str()), ("gone", "tcp:127.0.0.1:1")];
        desk.write("robot.toml", body(&skins.map(|(name, port)| (name.to_owned(), port.to_owned()))));
        let endpoint = format!("tcp/127.0.0.1:{}", free_port());
        let serve = ["serve", "robot.toml", "--zenoh-listen", &endpoint];
        let mut serve = desk.start(&[&serve, options].concat());
        // Of `palm`, once it is live.
        while !serve.line().contains("\"live\"") {}
        serve.read_output();
        Self { desk, _board: board, serve, endpoint }
    }

    /// What another computer is answered.
    fn ask(&self, options: &[&str]) -> Done {
        self.desk.run(&[&["body", "arm", "--zenoh-connect", &self.endpoint], options].concat())
    }
}

#[test]
fn a_skin_is_tared_and_driven_from_another_computer() {
    let computer = Computer::start(&["--zenoh-orders"]);
    let tared = computer.ask(&["--tare", "palm"]).success();
    assert_eq!(tared.out, "palm: the reference is made\n", "{}", tared.err);
    // The second may come while the first one's reference is made.
    for rate in ["40", "50 Hz"] {
        let driven = computer.ask(&["--drive", "palm", "--frame-rate", rate, "--gain", "8"]).success();
        let rate = rate.trim_end_matches(" Hz");
        let words = format!("palm: 50000 Hz, 0.001 A, {rate} frames a second, gain 8\n");
        assert_eq!(driven.out, words, "{}", driven.err);
    }
    let refused = computer.ask(&["--drive", "palm", "--frequency", "1 Hz"]).refused();
    assert!(refused.contains("palm: not done: `frequency` is 1 Hz; allowed: "), "{refused}");
    let all = computer.ask(&["--tare", "all"]);
    assert_eq!(all.out, "palm: the reference is made\n", "{}", all.err);
    let refused = all.refused();
    assert!(refused.contains("gone: not done: ") && refused.contains("127.0.0.1:1"), "{refused}");
    assert!(refused.contains("1 of 2 skins have not done it"), "{refused}");
    let unknown = computer.ask(&["--tare", "plam"]).refused();
    let words = "no computer serves a skin `plam` of the robot `arm`; there are: `gone`, `palm`";
    assert!(unknown.contains(words), "{unknown}");
    for nobody in [["body", "leg", "--tare", "all"], ["body", "leg", "--tare", "palm"]] {
        let at = ["--zenoh-connect", &computer.endpoint];
        let refused = computer.desk.run(&[&nobody[..], &at].concat()).refused();
        assert!(refused.contains("no computer serves a"), "{refused}");
    }
}

#[test]
fn a_computer_takes_no_orders_unless_it_is_told_to() {
    let mut computer = Computer::start(&[]);
    for order in [&["--tare", "palm"][..], &["--drive", "palm", "--gain", "8"]] {
        let refused = computer.ask(order).refused();
        let words = "palm: not done: its computer takes no orders: start `dermatome serve` there with `--zenoh-orders`";
        assert!(refused.contains(words), "{refused}");
    }
    assert!(computer.serve.is_running());
}

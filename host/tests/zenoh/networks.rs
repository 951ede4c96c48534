//! Networks: computers in network namespaces, one of which is cut off, and a router that is killed.
//!
//! Needs Linux, root and `ip`; where they are not there the test says that it has not run.

use crate::{
    RECOVERY, START, desk_of,
    hearing::Hearing,
    program::{Desk, has_bounds, within},
};
use std::{
    process::{Command, Stdio},
    sync::atomic::{AtomicU32, Ordering},
    thread,
    time::{Duration, Instant},
};

/// Namespaces on one bridge.
struct Network {
    name: String,
    computers: Vec<&'static str>,
}

fn ip(arguments: &str) -> Result<(), String> {
    let ran = Command::new("ip").args(arguments.split_whitespace()).output();
    let ran = ran.map_err(|error| format!("`ip`: {error}"))?;
    let words = String::from_utf8_lossy(&ran.stderr);
    if ran.status.success() { Ok(()) } else { Err(format!("`ip {arguments}`: {}", words.trim())) }
}

/// Of a computer, in networks that know nothing of each other.
fn address(index: usize) -> String {
    format!("10.77.0.{}", index + 1)
}

impl Network {
    /// None where this machine does not let us.
    fn of(computers: &[&'static str]) -> Option<Self> {
        static MADE: AtomicU32 = AtomicU32::new(0);
        let number = MADE.fetch_add(1, Ordering::Relaxed);
        let network =
            Self { name: format!("dz{}-{number}", std::process::id()), computers: computers.to_vec() };
        if let Err(why) = ip(&format!("netns add {}", network.space("hub"))) {
            println!("computers in network namespaces: *not run*, {why}");
            return None;
        }
        network.make().unwrap();
        Some(network)
    }

    fn make(&self) -> Result<(), String> {
        let bridge = self.space("hub");
        ip(&format!("-n {bridge} link add hub type bridge"))?;
        ip(&format!("-n {bridge} link set hub up"))?;
        for (index, computer) in self.computers.iter().enumerate() {
            let space = self.space(computer);
            ip(&format!("netns add {space}"))?;
            ip(&format!("-n {space} link set lo up"))?;
            ip(&format!("-n {bridge} link add port{index} type veth peer name eth0 netns {space}"))?;
            ip(&format!("-n {bridge} link set port{index} master hub up"))?;
            ip(&format!("-n {space} addr add {}/24 dev eth0", address(index)))?;
            ip(&format!("-n {space} link set eth0 up"))?;
        }
        Ok(())
    }

    fn space(&self, computer: &str) -> String {
        format!("{}-{computer}", self.name)
    }

    /// The computer's cable at the bridge.
    fn cable(&self, computer: &str, state: &str) {
        let index = self.computers.iter().position(|it| *it == computer).unwrap();
        ip(&format!("-n {} link set port{index} {state}", self.space("hub"))).unwrap();
    }

    /// The program on one of the computers.
    fn command(&self, desk: &Desk, computer: &str, arguments: &[&str]) -> Command {
        let program = desk.command(arguments);
        let mut command = Command::new("ip");
        command.args(["netns", "exec", &self.space(computer)]).arg(program.get_program());
        command.args(arguments).current_dir(desk.path("")).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn start(&self, desk: &Desk, computer: &str, arguments: &[&str]) -> crate::Running {
        let mut running = crate::Running::start(&mut self.command(desk, computer, arguments));
        running.read_output();
        running
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for computer in self.computers.iter().chain(&["hub"]) {
            let _ = ip(&format!("netns del {}", self.space(computer)));
        }
    }
}

#[test]
fn a_computer_is_cut_off_and_comes_back_while_the_other_goes_on() {
    let Some(network) = Network::of(&["head", "left", "right"]) else { return };
    let desk = desk_of(&["left", "right"]);
    let head = format!("tcp/{}:7447", address(0));
    let arguments = ["body", "arm", "--zenoh-listen", &head, "--json", "report.json"];
    let mut hearing = Hearing::start(network.command(&desk, "head", &arguments));
    let _serving = ["left", "right"].map(|computer| {
        network.start(&desk, computer, &["serve", &format!("{computer}.toml"), "--zenoh-connect", &head])
    });
    for skin in ["left", "right"] {
        hearing.wait(skin, START, |said| said.frames > 20);
    }
    let (mut slowest_end, mut slowest_start) = (Duration::ZERO, Duration::ZERO);
    // Too short to be noticed by anyone but TCP; noticed; and so long that TCP hardly tries any more.
    for seconds in [0.3, 3.0, 12.0] {
        network.cable("left", "down");
        let cut = Instant::now();
        if seconds > 1.0 {
            slowest_end =
                slowest_end.max(hearing.wait("left", within(RECOVERY), |said| said.phase == "lost"));
        }
        thread::sleep(Duration::from_secs_f64(seconds).saturating_sub(cut.elapsed()));
        // The other one goes on.
        let right = hearing.said("right").frames;
        hearing.wait("right", START, |said| said.frames > right);
        network.cable("left", "up");
        let frames = hearing.said("left").frames;
        let again =
            hearing.wait("left", within(RECOVERY), |said| said.phase == "live" && said.frames > frames);
        println!("cut off for {seconds} s: contacts again {:.2} s after", again.as_secs_f64());
        slowest_start = slowest_start.max(again);
    }
    println!(
        "contacts of who is cut off are over after {slowest_end:.2?}, and come again after {slowest_start:.2?} at most"
    );
    hearing.end();
    let report = desk.report("report.json");
    let lost = |index: usize| report["patches"][index]["frames_lost"].as_u64().unwrap();
    assert!(lost(0) > 0, "what was sent meanwhile is counted: {report:#}");
    // Where processes wait for a core for a second, Zenoh takes who is there for gone.
    assert!(lost(1) == 0 || !has_bounds(), "the other one was never lost: {report:#}");
}

#[test]
fn a_router_is_killed_and_who_speaks_through_it_comes_back_when_it_does() {
    let Some(network) = Network::of(&["head", "left", "hallway"]) else { return };
    let desk = desk_of(&["left"]);
    let hallway = format!("tcp/{}:7447", address(2));
    desk.write("router.json5", format!("{{mode: \"router\", listen: {{endpoints: [\"{hallway}\"]}}}}"));
    desk.write("client.json5", format!("{{mode: \"client\", connect: {{endpoints: [\"{hallway}\"]}}}}"));
    let route = || network.start(&desk, "hallway", &["body", "arm", "--zenoh-config", "router.json5"]);
    let router = route();
    thread::sleep(Duration::from_millis(500));
    let _left = network.start(&desk, "left", &["serve", "left.toml", "--zenoh-config", "client.json5"]);
    let mut hearing =
        Hearing::start(network.command(&desk, "head", &["body", "arm", "--zenoh-config", "client.json5"]));
    hearing.wait("left", START, |said| said.frames > 20);
    drop(router);
    let gone = hearing.wait("left", within(RECOVERY), |said| said.phase == "lost");
    thread::sleep(Duration::from_secs(3));
    let frames = hearing.said("left").frames;
    let _router = route();
    let again = hearing.wait("left", within(RECOVERY), |said| said.phase == "live" && said.frames > frames);
    println!("router killed: contacts over after {gone:.2?}, again {again:.2?} after it was started anew");
    hearing.end();
}

#[test]
fn a_router_is_killed_and_peers_that_know_each_other_by_it_go_on() {
    let Some(network) = Network::of(&["head", "left", "hallway"]) else { return };
    let desk = desk_of(&["left"]);
    let hallway = format!("tcp/{}:7447", address(2));
    desk.write("router.json5", format!("{{mode: \"router\", listen: {{endpoints: [\"{hallway}\"]}}}}"));
    let router = network.start(&desk, "hallway", &["body", "arm", "--zenoh-config", "router.json5"]);
    let _left = network.start(&desk, "left", &["serve", "left.toml", "--zenoh-connect", &hallway]);
    let arguments = ["body", "arm", "--zenoh-connect", &hallway];
    let mut hearing = Hearing::start(network.command(&desk, "head", &arguments));
    hearing.wait("left", START, |said| said.frames > 100);
    drop(router);
    let frames = hearing.said("left").frames;
    hearing.wait("left", START, |said| said.frames > frames + 100);
    assert_eq!(hearing.said("left").phase, "live");
    hearing.end();
}

#[test]
fn computers_that_are_told_nothing_find_each_other_by_multicast() {
    let Some(network) = Network::of(&["head", "left"]) else { return };
    let desk = desk_of(&["left"]);
    let _left = network.start(&desk, "left", &["serve", "left.toml", "--zenoh"]);
    let mut hearing = Hearing::start(network.command(&desk, "head", &["body"]));
    hearing.wait("left", START, |said| said.phase == "live" && said.frames > 20);
    hearing.end();
}

//! A line of RS-485: what goes over it, who waits for whom, and what happens where something is missing.

use super::{
    WAIT, a_patch_goes_beside_a_stream, board, contacts, each_answers_for_itself, images_are_thinned_out,
    power_comes_late,
    program::Desk,
    testbench::{empty_board, rs485::line},
    worn,
};
use dermatome::link::{self, Adapter, Bus, LinkErrorKind, Port, tare};
use dermatome::simulate::board::SimulatedBoard;
use dermatome_shared::protocol::{Request, Selection};
use serde_json::Value;
use std::{
    net::SocketAddr,
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

fn port(at: SocketAddr, address: u8) -> Port {
    Port::Bus(Bus::Rs485(Adapter::Tcp(at.to_string())), address)
}

#[test]
fn each_of_several_boards_answers_for_itself_and_loses_nothing() {
    let addresses = [0, 1, 7, 14, 15];
    let name = |address: u8| format!("skin-{address}");
    let boards = addresses.map(|address| board(&name(address), 40.0));
    let places: Vec<_> = addresses.into_iter().zip(boards.iter().map(SimulatedBoard::address)).collect();
    let (at, _line) = line(&places);
    assert_eq!(port(at, 7).to_string(), format!("rs485:tcp:{at}#7"));
    each_answers_for_itself(addresses.map(|address| (port(at, address), name(address))).into(), 300);
}

#[test]
fn a_patch_goes_over_the_line_while_others_stream() {
    let (empty, busy) = (empty_board(), board("busy", 100.0));
    let (at, _line) = line(&[(2, empty.address()), (3, busy.address())]);
    a_patch_goes_beside_a_stream(&port(at, 2), port(at, 3));
}

#[test]
fn a_board_without_power_holds_nobody_up_and_is_found_once_it_has_it() {
    let boards = [board("here", 100.0), board("away", 100.0)];
    let (at, line) = line(&[(4, boards[0].address()), (5, boards[1].address())]);
    line.off.store(1 << 5, Ordering::Relaxed);
    power_comes_late(&port(at, 4), &port(at, 5), || line.off.store(0, Ordering::Relaxed));
}

#[test]
fn however_many_boards_are_absent_the_others_have_most_of_the_line() {
    let here = board("here", 40.0);
    let (at, line) = line(&[(7, here.address())]);
    let absent: Vec<_> = (0..16).filter(|&address| address != 7).collect();
    let opening =
        absent.into_iter().map(|address| thread::spawn(move || link::open(&port(at, address)).is_err()));
    let opening: Vec<_> = opening.collect();
    let mut link = link::open(&port(at, 7)).unwrap();
    assert_eq!(contacts(&mut link, 100).len(), 100);
    assert_eq!(link.events_lost(), 0);
    assert!(opening.into_iter().all(|one| one.join().unwrap()));
    assert!(line.turns.lock().unwrap()[7] > 100);
}

#[test]
fn who_reads_late_does_not_stop_the_line() {
    let board = board("unread", 400.0);
    let (at, _line) = line(&[(1, board.address())]);
    let mut link = link::open(&port(at, 1)).unwrap();
    tare(&mut link, 3, WAIT).unwrap();
    let wanted = Selection { contacts: 1, measurements: 1, ..Selection::default() };
    let mut stream = link.subscribe(wanted).unwrap();
    thread::sleep(Duration::from_secs(5));
    for _ in 0..3000 {
        stream.next(WAIT).unwrap().expect("a frame");
    }
    stream.link().request(&Request::Info).unwrap();
    stream.stop().unwrap();
}

#[test]
fn noise_on_the_line_costs_packets_and_is_counted() {
    let board = board("noisy", 50.0);
    let (at, line) = line(&[(1, board.address())]);
    let mut link = link::open(&port(at, 1)).unwrap();
    tare(&mut link, 3, WAIT).unwrap();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() }).unwrap();
    // The start of a packet of this board, of another one, half a token, and noise.
    for noise in [
        &[0, 0x31, !0x31, 5, 5, 5, 0][..],
        &[0, 0x32, !0x32, 5, 0],
        &[0, 0x41, 0x41, 0],
        &[9; 700],
        &[0, 0x31, !0x31, 1],
    ] {
        *line.noise.lock().unwrap() = noise.to_vec();
        for _ in 0..20 {
            stream.next(WAIT).unwrap().expect("a frame");
        }
    }
    let (damaged, lost) = (stream.link().packets_damaged(), stream.link().events_lost());
    assert!((1..=5).contains(&damaged) && lost <= damaged, "{damaged} damaged, {lost} lost");
}

#[test]
fn a_line_that_is_cut_cuts_all_its_boards_and_can_be_opened_again() {
    let boards = [board("one", 100.0), board("other", 100.0)];
    let (at, line) = line(&[(0, boards[0].address()), (1, boards[1].address())]);
    let mut links = [0, 1].map(|address| link::open(&port(at, address)).unwrap());
    line.is_cut.store(true, Ordering::Relaxed);
    for link in &mut links {
        let error = (0..100).find_map(|_| link.info().err()).expect("the line is cut");
        assert!(matches!(error.kind, LinkErrorKind::Cut), "{error}");
    }
    line.is_cut.store(false, Ordering::Relaxed);
    let again = link::open(&port(at, 1)).unwrap();
    drop((links, again));
    assert!(link::open(&port(at, 0)).is_ok());
}

#[test]
fn an_address_is_open_once_and_a_line_as_long_as_somebody_uses_it() {
    let board = board("only", 100.0);
    let (at, line) = line(&[(9, board.address())]);
    let first = link::open(&port(at, 9)).unwrap();
    let error = link::open(&port(at, 9)).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::InUse), "{error}");
    drop(first);
    assert!(link::open(&port(at, 9)).is_ok());
    let turns = || line.turns.lock().unwrap()[9];
    let deadline = Instant::now() + WAIT;
    loop {
        let before = turns();
        thread::sleep(Duration::from_millis(50));
        if turns() == before {
            break;
        }
        assert!(Instant::now() < deadline, "nobody uses the line, and turns go on");
    }
}

#[test]
fn images_come_as_often_as_the_line_carries_them_and_contacts_always() {
    let boards = [board("left", 100.0), board("right", 100.0)];
    let (at, _line) = line(&[(0, boards[0].address()), (1, boards[1].address())]);
    images_are_thinned_out([port(at, 0), port(at, 1)]);
}

#[test]
fn what_the_line_cannot_carry_is_refused_before_it_begins() {
    let boards = [board("fast", 400.0), board("too-fast", 400.0)];
    let (at, _line) = line(&[(0, boards[0].address()), (1, boards[1].address())]);
    let mut links = [0, 1].map(|address| link::open(&port(at, address)).unwrap());
    let wanted = Selection { contacts: 1, health: 1, ..Selection::default() };
    let error = links.iter_mut().map(|link| link.subscribe(wanted).map(drop)).find_map(Result::err).unwrap();
    assert!(matches!(error.kind, LinkErrorKind::Overload(_)), "{error}");
    assert!(error.to_string().contains("rs485:tcp:") && !error.may_pass(), "{error}");
}

#[test]
fn devices_lists_who_is_on_a_line() {
    let desk = Desk::with_patch();
    let boards = [worn(&desk), empty_board()];
    let (at, _line) = line(&[(2, boards[0].address()), (11, boards[1].address())]);
    let bus = format!("rs485:tcp:{at}");
    let done = desk.run(&["devices", "--bus", &bus, "--json", "found.json"]).success();
    let wanted = [format!("{bus}#2  simulated, firmware"), format!("{bus}#11  simulated, firmware")];
    let lines: Vec<_> = done.out.lines().collect();
    assert!(
        lines.len() == 2 && lines.iter().zip(&wanted).all(|(line, start)| line.starts_with(start)),
        "{}",
        done.out
    );
    assert!(lines[0].contains("patch `tiny`") && lines[1].contains("no patch"), "{}", done.out);
    assert_eq!(desk.report("found.json")["boards"][1]["port"], format!("{bus}#11"));
    let (nobody, _line) = line(&[]);
    let done = desk.run(&["devices", "--bus", &format!("rs485:tcp:{nobody}")]).success();
    assert!(done.out.contains("no board answers on `rs485:tcp:"), "{}", done.out);
    let missing = desk.run(&["devices", "--bus", "rs485:/dev/ttyNOTTHERE7"]).refused();
    assert!(missing.contains("/dev/ttyNOTTHERE7#") && missing.contains("does not exist"), "{missing}");
}

#[test]
fn serve_runs_the_boards_of_a_line_and_says_which_do_not_answer() {
    let desk = Desk::with_patch();
    let boards = [worn(&desk), worn(&desk)];
    let (at, _line) = line(&[(0, boards[0].address()), (1, boards[1].address())]);
    let patch = |address: u8| {
        format!(
            "[[patches]]\nname = \"p{address}\"\nskin = \"skin.toml\"\nport = \"rs485:tcp:{at}#{address}\"\nlink = \"palm\"\n\
             position = [0, 0, 0]\norientation = [0, 0, 0, 1]\n"
        )
    };
    desk.write("robot.toml", format!("name = \"arm\"\n{}{}{}", patch(0), patch(1), patch(2)));
    let done = desk.run(&["serve", "robot.toml", "--duration", "8", "--json", "report.json"]).success();
    let lines: Vec<Value> = done.out.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let frames =
        |name: &str| lines.iter().filter(|line| line["patch"] == name && line["contacts"].is_array()).count();
    let report = desk.report("report.json");
    for number in [0, 1] {
        assert!(frames(&format!("p{number}")) > 50, "{}", done.out);
        assert_eq!(report["patches"][number]["frames_missing"], 0, "{report:#}");
    }
    let away =
        lines.iter().find(|line| line["patch"] == "p2" && line["state"]["phase"] == "no_board").unwrap();
    assert!(away["state"]["text"].as_str().unwrap().contains("no answer from `rs485:tcp:"), "{away}");
}

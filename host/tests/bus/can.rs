//! A CAN FD bus behind an adapter that speaks slcan: what goes over it, and what happens where something is missing.

use super::{
    WAIT, a_patch_goes_beside_a_stream, board, each_answers_for_itself, images_are_thinned_out,
    power_comes_late,
    program::Desk,
    testbench::{
        can::{bus, written},
        empty_board,
    },
    worn,
};
use dermatome::link::{self, Adapter, Bus, LinkErrorKind, Port, tare};
use dermatome::simulate::board::SimulatedBoard;
use dermatome_shared::protocol::{Request, Selection};
use std::{
    net::SocketAddr,
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

fn port(at: SocketAddr, address: u8) -> Port {
    Port::Bus(Bus::Slcan(Adapter::Tcp(at.to_string())), address)
}

#[test]
fn each_of_sixteen_boards_answers_for_itself_and_loses_nothing() {
    let name = |address: u8| format!("skin-{address}");
    let boards: Vec<_> = (0..16).map(|address| board(&name(address), 20.0)).collect();
    let places: Vec<_> = (0..).zip(boards.iter().map(SimulatedBoard::address)).collect();
    let (at, bus) = bus(&places);
    assert_eq!(port(at, 3).to_string(), format!("can:tcp:{at}#3"));
    each_answers_for_itself((0..16).map(|address| (port(at, address), name(address))).collect(), 100);
    // Set up once for all of them, and closed behind the last one.
    let deadline = Instant::now() + WAIT;
    while *bus.commands.lock().unwrap() != "C C S8 Y2 O C " {
        assert!(Instant::now() < deadline, "{:?}", bus.commands);
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_patch_goes_over_the_bus_while_others_stream() {
    let (empty, busy) = (empty_board(), board("busy", 100.0));
    let (at, _bus) = bus(&[(2, empty.address()), (3, busy.address())]);
    a_patch_goes_beside_a_stream(&port(at, 2), port(at, 3));
}

#[test]
fn a_board_without_power_holds_nobody_up_and_is_found_once_it_has_it() {
    let boards = [board("here", 100.0), board("away", 100.0)];
    let (at, bus) = bus(&[(4, boards[0].address()), (5, boards[1].address())]);
    bus.off.store(1 << 5, Ordering::Relaxed);
    power_comes_late(&port(at, 4), &port(at, 5), || bus.off.store(0, Ordering::Relaxed));
}

#[test]
fn who_reads_late_loses_what_there_was_no_room_for_which_is_counted_and_the_others_go_on() {
    let boards = [board("unread", 200.0), board("read", 50.0)];
    let (at, _bus) = bus(&[(1, boards[0].address()), (2, boards[1].address())]);
    let mut links = [1, 2].map(|address| link::open(&port(at, address)).unwrap());
    links.iter_mut().for_each(|link| tare(link, 3, WAIT).unwrap());
    let [unread, read] = &mut links;
    let wanted = Selection { contacts: 1, ..Selection::default() };
    let mut other = read.subscribe(wanted).unwrap();
    let mut stream = unread.subscribe(Selection { measurements: 1, ..wanted }).unwrap();
    for _ in 0..600 {
        other.next(WAIT).unwrap().expect("a frame");
    }
    assert_eq!((other.link().events_lost(), other.link().packets_damaged()), (0, 0));
    let is_lost = (0..4000).any(|_| {
        stream.next(WAIT).unwrap().expect("a frame");
        stream.link().events_lost() > 10
    });
    assert!(is_lost && stream.link().packets_damaged() <= 3, "{} damaged", stream.link().packets_damaged());
    stream.link().request(&Request::Info).unwrap();
    stream.stop().unwrap();
}

#[test]
fn what_strangers_say_on_the_bus_is_nobodys() {
    let board = board("known", 50.0);
    let (at, bus) = bus(&[(1, board.address())]);
    let mut link = link::open(&port(at, 1)).unwrap();
    tare(&mut link, 3, WAIT).unwrap();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() }).unwrap();
    // Another device, a request of another host, another board, a classic frame and a remote one, an answer, a refusal, and
    // half a frame.
    let strangers = [
        written(0x123, &[1, 2, 3]),
        written(0x101, &[5; 64]),
        written(0x202, &[5; 64]),
        "t20121122\r".to_owned(),
        "r2012\r".to_owned(),
        "z\r\r".to_owned(),
        "\x07".to_owned(),
        "b201F0011\r".to_owned(),
    ];
    for stranger in strangers {
        *bus.strangers.lock().unwrap() = stranger.into_bytes();
        for _ in 0..10 {
            stream.next(WAIT).unwrap().expect("a frame");
        }
    }
    assert_eq!((stream.link().packets_damaged(), stream.link().events_lost()), (0, 0));
    // What looks like its own is damage, which is counted.
    *bus.strangers.lock().unwrap() = written(0x201, &[5, 5, 5, 0]).into_bytes();
    for _ in 0..10 {
        stream.next(WAIT).unwrap().expect("a frame");
    }
    assert!((1..=2).contains(&stream.link().packets_damaged()));
}

#[test]
fn an_adapter_that_is_unplugged_cuts_all_its_boards_and_can_be_opened_again_at_once() {
    let boards = [board("one", 100.0), board("other", 100.0)];
    let (at, bus) = bus(&[(0, boards[0].address()), (1, boards[1].address())]);
    for _ in 0..5 {
        let mut links = [0, 1].map(|address| link::open(&port(at, address)).unwrap());
        bus.is_cut.store(true, Ordering::Relaxed);
        for link in &mut links {
            let error = (0..100).find_map(|_| link.info().err()).expect("the bus is cut");
            assert!(matches!(error.kind, LinkErrorKind::Cut), "{error}");
        }
        bus.is_cut.store(false, Ordering::Relaxed);
        let again = link::open(&port(at, 1)).unwrap();
        drop((links, again));
        assert!(link::open(&port(at, 0)).is_ok());
    }
}

#[test]
fn images_come_as_often_as_the_bus_carries_them_and_contacts_always() {
    let boards = [board("left", 100.0), board("right", 100.0)];
    let (at, _bus) = bus(&[(0, boards[0].address()), (1, boards[1].address())]);
    images_are_thinned_out([port(at, 0), port(at, 1)]);
}

#[test]
fn what_the_bus_cannot_carry_is_refused_before_it_begins() {
    let boards: Vec<_> = (0..3).map(|_| board("fast", 120.0)).collect();
    let places: Vec<_> = (0..).zip(boards.iter().map(SimulatedBoard::address)).collect();
    let (at, _bus) = bus(&places);
    let mut links = [0, 1, 2].map(|address| link::open(&port(at, address)).unwrap());
    let wanted = Selection { contacts: 1, health: 1, ..Selection::default() };
    let [one, other, last] = &mut links;
    let (_one, _other) = (one.subscribe(wanted).unwrap(), other.subscribe(wanted).unwrap());
    let error = last.subscribe(wanted).map(drop).unwrap_err();
    assert!(matches!(&error.kind, LinkErrorKind::Overload(load) if load.boards == 3), "{error}");
    assert!(error.to_string().contains("can:tcp:") && !error.may_pass(), "{error}");
}

#[test]
fn commands_take_boards_on_a_can_bus() {
    let desk = Desk::with_patch();
    let boards = [worn(&desk), empty_board()];
    let (at, adapter) = bus(&[(2, boards[0].address()), (11, boards[1].address())]);
    let bus = format!("can:tcp:{at}");
    // Whoever comes next finds it closed.
    let is_closed = || adapter.commands.lock().unwrap().ends_with("O C ");
    let done = desk.run(&["devices", "--bus", &bus]).success();
    let lines: Vec<_> = done.out.lines().collect();
    assert!(
        lines.len() == 2
            && lines[0].starts_with(&format!("{bus}#2  simulated, firmware"))
            && lines[1].starts_with(&format!("{bus}#11  simulated, firmware")),
        "{}",
        done.out
    );
    let empty = format!("{bus}#11");
    desk.run(&["flash", "skin.dermatome", "--port", &empty]).success();
    assert!(is_closed());
    desk.run(&["tare", "--port", &empty]).success();
    assert!(is_closed());
    let done = desk.run(&["stream", "--port", &empty, "--frames", "20", "--json", "stream.json"]).success();
    assert_eq!(desk.report("stream.json")["frames_received"], 20, "{}", done.out);
    let missing = desk.run(&["devices", "--bus", "can:/dev/ttyNOTTHERE7"]).refused();
    assert!(missing.contains("/dev/ttyNOTTHERE7#") && missing.contains("does not exist"), "{missing}");
    let missing = desk.run(&["stream", "--port", "can:nosuchcan#1"]).refused();
    assert!(missing.contains("`can:nosuchcan#1`"), "{missing}");
}

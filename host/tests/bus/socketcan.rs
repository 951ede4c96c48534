//! A CAN FD bus at a network interface: Linux' virtual one, which needs root and a kernel that has it. The script
//! `host/tests/bus/vcan` boots one and runs these tests there.

use super::{
    board, contacts,
    testbench::{empty_board, raw, square_patch},
};
use dermatome::link::{self, Bus, LinkErrorKind, Port, upload};
use dermatome::simulate::board::SimulatedBoard;
use dermatome_shared::protocol::can::{Carries, FRAME_BYTES, filled};
use socketcan::{
    CanAnyFrame, CanFdFrame, CanFdSocket, CanFilter, CanFrame, EmbeddedFrame, ExtendedId, Frame, Socket,
    SocketOptions, StandardId,
};
use std::{
    io::{Read, Write},
    net::SocketAddr,
    process::Command,
    thread,
    time::Duration,
};

const INTERFACE: &str = "dermatome0";

fn port(address: u8) -> Port {
    Port::Bus(Bus::SocketCan(INTERFACE.to_owned()), address)
}

/// The interface, anew; it takes frames of CAN FD if so wanted.
fn interface(mtu: &str) {
    let ip = |words: &[&str]| Command::new("ip").args(words).status().unwrap().success();
    ip(&["link", "delete", INTERFACE]);
    assert!(ip(&["link", "add", "dev", INTERFACE, "type", "vcan"]), "needs root and Linux' module vcan");
    assert!(ip(&["link", "set", INTERFACE, "mtu", mtu]) && ip(&["link", "set", INTERFACE, "up"]));
}

/// Joins a board to the bus, for as long as the interface is up.
fn join(address: u8, at: SocketAddr) {
    let heard = CanFdSocket::open(INTERFACE).unwrap();
    heard.set_filters(&[CanFilter::new(Carries::Request.identifier(address).into(), 0x7FF)]).unwrap();
    let said = CanFdSocket::open(INTERFACE).unwrap();
    said.set_filter_drop_all().unwrap();
    let mut stream = raw(at);
    let mut requests = stream.try_clone().unwrap();
    thread::spawn(move || {
        while let Ok(CanAnyFrame::Fd(frame)) = heard.read_frame() {
            assert!(frame.is_brs() && frame.raw_id() == u32::from(Carries::Request.identifier(address)));
            requests.write_all(frame.data()).unwrap();
        }
    });
    thread::spawn(move || {
        let identifier = StandardId::new(Carries::Said.identifier(address)).unwrap();
        let (mut buffer, mut room) = ([0; FRAME_BYTES], [0; FRAME_BYTES]);
        loop {
            let length = match stream.read(&mut buffer) {
                Ok(0) => return,
                Ok(length) => length,
                Err(_) => continue,
            };
            let frame = CanFdFrame::new(identifier, filled(&buffer[..length], &mut room)).unwrap();
            while said.write_frame(&frame).is_err() {
                thread::sleep(Duration::from_millis(1));
            }
        }
    });
}

#[test]
#[ignore = "needs Linux' virtual CAN interface: host/tests/bus/vcan runs it"]
fn boards_at_a_network_interface_are_boards_like_any_other() {
    interface("72");
    let boards: Vec<_> = (0..3).map(|number| board(&format!("skin-{number}"), 20.0)).collect();
    let empty = empty_board();
    let all = boards.iter().map(SimulatedBoard::address).chain([empty.address()]);
    (0..).zip(all).for_each(|(address, at)| join(address, at));
    // What strangers say, classic frames as well.
    let strangers = CanFdSocket::open(INTERFACE).unwrap();
    let stranger = StandardId::new(0x123).unwrap();
    strangers.write_frame(&CanFrame::new(stranger, &[1, 2, 3]).unwrap()).unwrap();
    strangers.write_frame(&CanFdFrame::new(stranger, &[7; 64]).unwrap()).unwrap();
    let extended = ExtendedId::new(0x1_0201).unwrap();
    strangers.write_frame(&CanFdFrame::new(extended, &[7; 64]).unwrap()).unwrap();
    thread::scope(|scope| {
        for address in 0..3 {
            scope.spawn(move || {
                let mut link = link::open(&port(address)).unwrap();
                assert_eq!(link.port(), format!("can:{INTERFACE}#{address}"));
                let skin = link.info().unwrap().patch.unwrap().skin;
                assert_eq!(skin.as_str(), format!("skin-{address}"));
                let frames = contacts(&mut link, 100);
                let first = frames[0].at.unwrap().sequence;
                assert_eq!(frames[99].at.unwrap().sequence, first + 99);
                assert_eq!((link.events_lost(), link.packets_damaged()), (0, 0));
            });
        }
        scope.spawn(|| {
            let mut link = link::open(&port(3)).unwrap();
            let patch = square_patch("sent", 16, 10, 50.0);
            upload(&mut link, &patch, |_| ()).unwrap();
            assert_eq!(link.patch().unwrap(), patch);
        });
    });
    let error = link::open(&port(9)).map(drop).unwrap_err();
    assert!(matches!(error.kind, LinkErrorKind::NoAnswer { .. }), "{error}");
    println!("boards at a network interface: each answers, nothing lost");
}

#[test]
#[ignore = "needs Linux' virtual CAN interface: host/tests/bus/vcan runs it"]
fn an_interface_that_goes_down_cuts_its_boards_and_is_open_again_once_it_is_up() {
    interface("72");
    let board = board("skin", 20.0);
    join(1, board.address());
    let mut link = link::open(&port(1)).unwrap();
    assert!(Command::new("ip").args(["link", "set", INTERFACE, "down"]).status().unwrap().success());
    let error = (0..100).find_map(|_| link.info().err()).expect("the interface is down");
    println!("an interface that goes down: {error}");
    assert!(matches!(error.kind, LinkErrorKind::Failed(_)), "{error:?}");
    interface("72");
    // The first one still has its host, as far as it knows.
    let other = self::board("other", 20.0);
    join(1, other.address());
    contacts(&mut link::open(&port(1)).unwrap(), 3);
}

#[test]
#[ignore = "needs Linux' virtual CAN interface: host/tests/bus/vcan runs it"]
fn an_interface_without_can_fd_says_what_to_do() {
    interface("16");
    let error = link::open(&port(1)).map(drop).unwrap_err();
    println!("an interface without CAN FD: {error}");
    assert!(error.to_string().contains("fd on"), "{error:?}");
    let error = link::open(&"can:nosuchcan#1".parse().unwrap()).map(drop).unwrap_err();
    println!("no interface: {error}");
    assert!(
        error.to_string().contains("`can:nosuchcan#1`")
            && error.to_string().contains("no such network interface for CAN"),
        "{error:?}"
    );
}

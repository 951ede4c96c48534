//! Several boards on one bus, a line of RS-485 or CAN FD.

mod can;
#[path = "../program/mod.rs"]
mod program;
mod rs485;
#[cfg(target_os = "linux")]
mod socketcan;
#[path = "../testbench/mod.rs"]
mod testbench;

use dermatome::{
    link::{self, Link, LinkErrorKind, Port, ScanFrame, tare, upload},
    simulate::board::{BoardOptions, SimulatedBoard},
};
use dermatome_shared::protocol::Selection;
use program::Desk;
use std::{thread, time::Duration};
use testbench::{Pressed, square_patch};

const WAIT: Duration = Duration::from_secs(30);

/// A board that measures at its skin's rate.
fn board(name: &str, frame_rate: f32) -> SimulatedBoard {
    let patch = Some(square_patch(name, 16, 10, frame_rate));
    SimulatedBoard::start(BoardOptions { patch, ..BoardOptions::default() }, Pressed::new(1)).unwrap()
}

/// A board with the skin of a desk.
fn worn(desk: &Desk) -> SimulatedBoard {
    let patch = Some(desk.read("skin.dermatome"));
    SimulatedBoard::start(BoardOptions { patch, ..BoardOptions::default() }, Pressed::new(1)).unwrap()
}

/// The frames' contacts, whatever else goes over the bus.
fn contacts(link: &mut Link, frames: usize) -> Vec<ScanFrame> {
    tare(link, 3, WAIT).unwrap();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() }).unwrap();
    (0..frames).map(|_| stream.next(WAIT).unwrap().expect("a frame")).collect()
}

/// Boards with skins of these names answer for themselves, all at once, and of each so many frames come, none missing.
fn each_answers_for_itself(boards: Vec<(Port, String)>, frames: u32) {
    thread::scope(|scope| {
        for (port, name) in boards {
            scope.spawn(move || {
                let mut link = link::open(&port).unwrap();
                assert_eq!(link.port(), port.to_string());
                for _ in 0..20 {
                    let patch = link.info().unwrap().patch.unwrap();
                    assert_eq!(patch.skin.as_str(), name);
                }
                let came = contacts(&mut link, frames as usize);
                let first = came[0].at.unwrap().sequence;
                let sequences: Vec<_> = came.iter().map(|frame| frame.at.unwrap().sequence).collect();
                assert_eq!(sequences, (first..first + frames).collect::<Vec<_>>());
                assert_eq!((link.events_lost(), link.packets_damaged()), (0, 0));
            });
        }
    });
}

/// One board takes a patch while another one streams.
fn a_patch_goes_beside_a_stream(empty: &Port, busy: Port) {
    let streaming = thread::spawn(move || {
        let mut link = link::open(&busy).unwrap();
        contacts(&mut link, 200);
        link.events_lost()
    });
    let mut link = link::open(empty).unwrap();
    let patch = square_patch("sent", 16, 10, 50.0);
    upload(&mut link, &patch, |_| ()).unwrap();
    assert_eq!(link.patch().unwrap(), patch);
    assert_eq!(streaming.join().unwrap(), 0);
}

/// A board without power holds another one up in nothing, and is found once it has it.
fn power_comes_late(here: &Port, away: &Port, switch_on: impl FnOnce()) {
    thread::scope(|scope| {
        scope.spawn(|| {
            let error = link::open(away).map(drop).unwrap_err();
            assert!(matches!(error.kind, LinkErrorKind::NoAnswer { .. }), "{error}");
        });
        let mut link = link::open(here).unwrap();
        contacts(&mut link, 200);
        assert_eq!(link.events_lost(), 0);
    });
    switch_on();
    contacts(&mut link::open(away).unwrap(), 10);
}

/// Two boards of three have contacts of each frame, and images as often as their bus carries them.
fn images_are_thinned_out(ports: [Port; 2]) {
    thread::scope(|scope| {
        for port in ports {
            scope.spawn(move || {
                let mut link = link::open(&port).unwrap();
                link.share_bus(3);
                tare(&mut link, 3, WAIT).unwrap();
                let wanted = Selection { images: 1, contacts: 1, ..Selection::default() };
                let mut stream = link.subscribe(wanted).unwrap();
                let every = stream.selection().images;
                assert!(every > 1 && stream.selection() == Selection { images: every, ..wanted }, "{every}");
                let frames: Vec<_> = (0..200).map(|_| stream.next(WAIT).unwrap().expect("a frame")).collect();
                assert!(frames.iter().all(|frame| frame.contacts.is_some()));
                let images = frames.iter().filter(|frame| frame.image.is_some()).count();
                assert!(images.abs_diff(200 / usize::from(every)) <= 1, "{images} of every {every}");
                assert_eq!(stream.link().events_lost(), 0);
            });
        }
    });
}

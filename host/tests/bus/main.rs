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
    link::{Link, ScanFrame, tare},
    simulate::board::{BoardOptions, SimulatedBoard},
};
use dermatome_shared::protocol::Selection;
use program::Desk;
use std::time::Duration;
use testbench::{Pressed, square_patch};

const WAIT: Duration = Duration::from_secs(3);

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

fn contacts(link: &mut Link, frames: usize) -> Vec<ScanFrame> {
    tare(link, 3, WAIT).unwrap();
    let mut stream = link.subscribe(Selection { contacts: 1, ..Selection::default() }).unwrap();
    (0..frames).map(|_| stream.next(WAIT).unwrap().expect("a frame")).collect()
}

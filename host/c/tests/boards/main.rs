//! The library's functions, called as C calls them, with simulated boards, with fakes, and with what is none.
#![cfg(unix)]
#![expect(unsafe_code, reason = "the functions are C's")]

mod allocations;
mod arguments;
mod faults;
mod handle;
mod programs;
mod serial;
#[path = "../../../tests/testbench/mod.rs"]
mod testbench;
mod use_of_a_skin;

use dermatome::simulate::board::{BoardOptions, SimulatedBoard};
use testbench::{Pressed, square_patch};

/// A board of 16 electrodes and 196 pixels that sends so many frames a second: who is slow finds no long backlog.
fn paced_board(frame_rate: f32) -> SimulatedBoard {
    let patch = Some(square_patch("sixteen", 16, 14, frame_rate));
    SimulatedBoard::start(BoardOptions { patch, ..BoardOptions::default() }, Pressed::new(1)).unwrap()
}

//! Firmware of Dermatome's sensor board: wiring, and nothing that `dermatome-shared` could hold.
//!
//! `board` names the hardware, `drivers` hold one device each, `tasks` join them to the shared
//! `Device`. So far there is one task: it answers the protocol on the serial link.
#![no_std]
#![no_main]

mod board;
mod drivers;
mod tasks;

use defmt::{info, unwrap};
use defmt_rtt as _;
use embassy_executor::Spawner;
use panic_probe as _;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = board::start();
    info!("{} firmware {}", board::NAME, env!("CARGO_PKG_VERSION"));
    spawner.spawn(unwrap!(tasks::link::run(board.link)));
}

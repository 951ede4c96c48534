//! Firmware of Dermatome's sensor board: wiring, and nothing that `dermatome-shared` could hold.
//!
//! The library of this package names the hardware and drives it; `tasks` join it to the shared
//! `Device`. Three tasks share one executor: the link answers requests and sends events, the frames
//! come from a task of their own, and the health task feeds the watchdog as long as all of them yield.
#![no_std]
#![no_main]

mod tasks;

use defmt::{Debug2Format, info};
use defmt_rtt as _;
use dermatome_firmware::{board, drivers};
use dermatome_shared::restart::Restart;
use embassy_executor::Spawner;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = board::start();
    let started_after = Restart::new(board.reset_causes, drivers::crash::take_message());
    info!("{} firmware {}", board::NAME, env!("CARGO_PKG_VERSION"));
    info!("started after {}", Debug2Format(&started_after));
    spawner.spawn(tasks::health::run(board.watchdog).expect("spawned once"));
    let state = tasks::State::take(board.flash, started_after);
    spawner.spawn(tasks::frames::run(state).expect("spawned once"));
    spawner.spawn(tasks::link::run(board.link, state).expect("spawned once"));
}

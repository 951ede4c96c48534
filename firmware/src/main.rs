//! Firmware of Dermatome's sensor board: wiring, and nothing that `dermatome-shared` could hold.
//!
//! The library of this package names the hardware and drives it; `tasks` join it to the shared
//! `Device`. Acquisition has an executor of its own, in an interrupt: it turns samples into frames
//! whatever else goes on. The other three share one: the frames task computes images and contacts, the
//! link answers requests and sends events, and the health task feeds the watchdog as long as both yield and
//! samples are looked at.
#![no_std]
#![no_main]

mod tasks;

use defmt::{Display2Format, info};
use defmt_rtt as _;
use dermatome_firmware::{
    board,
    drivers::{self, vitals::VitalSigns},
};
use dermatome_shared::restart::Restart;
use embassy_executor::Spawner;

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let board = board::start();
    let started_after = Restart::new(board.reset_causes, drivers::crash::take_message());
    info!("{} firmware {}", board::NAME, env!("CARGO_PKG_VERSION"));
    info!("started after {}", Display2Format(&started_after));
    let state = tasks::State::take(board.flash, started_after);
    let signs = VitalSigns::new(board.core.DCB, board.core.DWT);
    let (orders, frames) = tasks::acquire::start(board.sensing, board.thermometer, board.reflex_pins);
    spawner.spawn(tasks::health::run(board.watchdog, signs, state, orders).expect("spawned once"));
    spawner.spawn(tasks::frames::run(state, orders, frames).expect("spawned once"));
    spawner.spawn(tasks::link::run(board.link, state).expect("spawned once"));
}

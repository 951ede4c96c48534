//! Presses a simulated skin with two fingers and prints what its board says.
//!
//! `cargo run --release -p dermatome-simulate --example press`

use dermatome_model::skin::Skin;
use dermatome_simulate::{Noise, Press, Rig, rig::Observer};
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/disc-210mm/skin.toml");
    let skin = Skin::load(Path::new(path))?.made()?;
    let mut board = Observer::new(&skin)?;
    let mut rig = Rig::new(&skin, &board.patch(), Noise { snr_db: 60.0, seed: 1 })?;
    let untouched = rig.truth().conductivity(&[]);
    board.tare(&rig.tare(&untouched));
    let fingers = [[0.04, 0.03], [-0.05, -0.02]];
    let frame = rig.press(&fingers.map(|at| Press::finger(at, 0.0126, 1.0)));
    for contact in board.observe(&frame).contacts() {
        let [x, y] = contact.from_above().map(|metres| 1e3 * metres);
        println!("x {x:6.1} mm, y {y:6.1} mm, strength {:.3}", contact.strength);
    }
    Ok(())
}

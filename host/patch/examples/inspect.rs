//! What a patch file holds: `cargo run -p dermatome-patch --example inspect -- disc-210mm.dermatome`.

use dermatome_patch::write::{Contents, Stored};
use dermatome_shared::patch::PatchView;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a patch file, as `dermatome build` writes one")?;
    let bytes = std::fs::read(path)?;
    let patch = PatchView::validate(&bytes)?;
    let (contents, stored) = (Contents::read(&patch), Stored::of(&patch));
    println!(
        "skin {}: {} electrodes, {} steps",
        patch.header.skin,
        patch.header.electrodes,
        contents.steps.len()
    );
    println!("matrix: {} pixels, {} measurements", patch.header.pixels, patch.header.measurements);
    println!(
        "calibration: {} points, {} play operators",
        stored.curve.points.len(),
        stored.play_operators.len()
    );
    assert_eq!(contents.write(&stored)?, bytes, "what is read is written again, byte for byte");
    Ok(())
}

//! From a skin file to its reconstruction matrix, and to the patch of a board:
//! `cargo run --release -p dermatome-model --example matrix -- models/disc-210mm/skin.toml disc.dermatome`.

use dermatome_model::{model::Model, quantize, skin::Skin};
use dermatome_patch::output::write_whole;
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let skin_file = arguments.next().ok_or("name a skin file")?;
    let skin = Skin::load(Path::new(&skin_file))?.made()?;
    let model = Model::build(&skin, |stage| eprintln!("{stage}"))?;
    let matrix = &model.conductivity_from_difference;
    println!("{}: {} pixels from {} measurements", skin.name, matrix.nrows(), matrix.ncols());
    println!("noise figure {:.2}", model.noise_figure());
    if let Some(patch_file) = arguments.next() {
        write_whole(Path::new(&patch_file), &quantize::patch(&skin, &model)?)?;
    }
    Ok(())
}

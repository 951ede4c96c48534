//! Plays random contacts on the hemisphere and prints how well they are counted and placed.
//!
//! `cargo run --release -p dermatome-experiments --example scenes`

use dermatome_experiments::scenes::{Options, figures, play};
use dermatome_model::skin::Skin;
use std::{error::Error, path::Path};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/hemisphere-210mm"));
    let [skin, truth] =
        ["skin.toml", "formula.toml"].map(|file| Skin::load(&folder.join(file)).and_then(Skin::made));
    let options = Options { scenes: 9, ..Options::default() };
    let figures = figures(&play(&skin?, &truth?, &options)?, 0.105, |_| true);
    println!("scenes with the right number: {:.0} %", 100.0 * figures.board.right_of_all);
    println!("error of a single contact: {:.1} mm by the surface's model", figures.surface_error_mm);
    println!("                           {:.1} mm by the flattened one", figures.flattened_error_mm);
    Ok(())
}

//! Images of recorded frames: `cargo run -p dermatome-frames --example images [SKIN REFERENCE FRAMES]`.
//!
//! Without arguments it takes voltages that EIDORS computed for a disc with an object in it.

use dermatome_frames::recorded::{
    diagnose::diagnose,
    order::Arrangement,
    read::{Source, read},
    reconstruct::{Polarity, Reference, reconstruct},
    wording::Plain,
};
use dermatome_model::{model::Model, skin::Skin};
use std::{error::Error, ffi::OsString, path::Path};

const HOST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<OsString> = std::env::args_os().skip(1).collect();
    let [skin, reference, frames] = <[OsString; 3]>::try_from(given).unwrap_or_else(|_| {
        [
            "../models/saline-215mm/skin.toml",
            "tests/data/eidors/c2c_pem.npz:vh",
            "tests/data/eidors/c2c_pem.npz:vi",
        ]
        .map(|file| format!("{HOST}/{file}").into())
    });
    let skin = Skin::load(Path::new(&skin))?.made()?;
    let model = Model::build(&skin, |_| ())?;
    let (reference, frames) = (read(&Source::new(&reference))?, read(&Source::new(&frames))?);
    let order = Arrangement::default();
    let diagnosis = diagnose(&model.steps, skin.electrodes.count, &model.voltages, &reference.mean(), order)?;
    println!("{}: correlation of the reference with the model {:.3}", skin.name, diagnosis.correlation);
    diagnosis.warnings(&Plain).iter().for_each(|warning| println!("warning: {warning}"));
    for result in reconstruct(&model, Reference::Mean(&reference), &frames, &order, Polarity::Auto)? {
        println!("frame {}: {} pixels, peak {:+.3}", result.frame, result.image.len(), result.peak);
        for object in result.objects {
            println!("    object at {:+.1} mm, {:+.1} mm", object.x_mm, object.y_mm);
        }
    }
    Ok(())
}

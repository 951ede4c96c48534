//! Any text as a skin file. A small skin that passes the checks must also become a model or an
//! error, and its patch must be valid.
#![no_main]

use dermatome::{
    model::Model,
    quantize,
    skin::{ImageLayout, Skin},
};
use dermatome_shared::patch::PatchView;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Larger skins take too long to compute here.
const MOST_ELEMENTS: f64 = 400.0;

fuzz_target!(|text: &str| {
    let Ok(skin) = Skin::parse(Path::new("skin.toml"), text).and_then(Skin::made) else { return };
    assert!(skin.electrodes.count >= 4 && !skin.name.is_empty());
    assert!(skin.shape.electrode_centres().iter().all(|centre| centre.coords.iter().all(|x| x.is_finite())));
    let Ok(outline) = skin.shape.flat() else { return };
    let elements = outline.area() / (0.43 * skin.edges.electrodes.powi(2));
    if elements > MOST_ELEMENTS || matches!(skin.image, ImageLayout::Grid { columns } if columns > 16) {
        return;
    }
    let Ok(model) = Model::build(&skin, |_| ()) else { return };
    if let Ok(patch) = quantize::patch(&skin, &model) {
        PatchView::validate(&patch).expect("a patch that is built is valid");
    }
});

//! Any text as a skin file. A small skin that passes the checks must also become a model or an
//! error, and its patch must be valid.
#![no_main]

use dermatome::{model::Model, quantize, skin::Skin};
use dermatome_shared::patch::PatchView;
use libfuzzer_sys::fuzz_target;
use std::path::Path;

/// Larger skins take too long to compute here.
const MOST_ELEMENTS: f64 = 400.0;

fuzz_target!(|text: &str| {
    let Ok(skin) = Skin::parse(Path::new("skin.toml"), text) else { return };
    assert!((4..=16).contains(&skin.electrodes.count()) && !skin.name.is_empty());
    assert!(skin.rim().iter().flatten().all(|x| x.is_finite()));
    let elements = skin.outline.area() / (0.43 * skin.edge_length * skin.edge_length);
    if elements > MOST_ELEMENTS || skin.image_columns > 16 {
        return;
    }
    let Ok(model) = Model::build(&skin, |_| ()) else { return };
    if let Ok(patch) = quantize::patch(&skin, &model) {
        PatchView::validate(&patch).expect("a patch that is built is valid");
    }
});

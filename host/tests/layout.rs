//! Layouts: which pixel each cell of a picture shows.

use dermatome::{
    model::Model,
    patch::{layout::Layout, tables::SurfaceTables},
    skin::Skin,
};
use std::path::Path;

fn tables(model: &str) -> (Model, SurfaceTables) {
    let file = format!("{}/../models/{model}/skin.toml", env!("CARGO_MANIFEST_DIR"));
    let model = Model::build(&Skin::load(Path::new(&file)).unwrap().made().unwrap(), |_| ()).unwrap();
    let tables = model.pixels.surface_tables().unwrap();
    (model, tables)
}

#[test]
fn a_flat_skin_is_shown_cell_by_cell() {
    let (model, tables) = tables("disc-210mm");
    assert_eq!(Layout::from(&tables), Layout::from(model.pixels.grid.as_ref().unwrap()));
}

#[test]
fn a_hemisphere_is_shown_as_a_disc_of_its_nearest_pixels() {
    let (_, tables) = tables("hemisphere-120mm");
    let layout = Layout::from(&tables);
    let shown = (0..layout.grid.cells()).filter_map(|cell| layout.pixel(cell)).collect::<Vec<_>>();
    let disc = std::f64::consts::PI / 4.0 * layout.grid.cells() as f64;
    assert!((shown.len() as f64 / disc - 1.0).abs() < 0.08, "{} of {disc}", shown.len());
    let centres: Vec<_> = tables.centres().collect();
    for cell in 0..layout.grid.cells() {
        let at = layout.grid.position((cell % 36) as f32 + 0.5, (cell / 36) as f32 + 0.5);
        if let Some(pixel) = layout.pixel(cell) {
            let away = (centres[pixel][0] - f64::from(at[0])).hypot(centres[pixel][1] - f64::from(at[1]));
            assert!(away < 0.007, "{away}");
        }
    }
    let different: std::collections::HashSet<_> = shown.iter().collect();
    assert!(different.len() > 450, "{}", different.len());
}

//! Surface: where a skin file's pixels lie, to tell whether a board's patch is of that skin.

use dermatome_geometry::mesh::Lattice;
use dermatome_model::{
    model::{ModelError, mesh, pixels_on},
    skin::Skin,
};
use dermatome_patch::tables::SurfaceTables;

/// How far a pixel of the patch may lie from where the skin file has it, m.
const SAME_PLACE: f64 = 1e-4;

/// Where the pixels of a skin lie; nothing where they are more than a board takes.
pub fn of_skin(skin: &Skin) -> Result<Option<SurfaceTables>, ModelError> {
    let mesh = mesh(skin, 1.0, Lattice::default())?;
    Ok(pixels_on(skin, &mesh)?.surface_tables())
}

/// Whether both have the same pixels in the same places.
#[must_use]
pub fn is_same(a: &SurfaceTables, b: &SurfaceTables) -> bool {
    let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    a.pixels.len() == b.pixels.len()
        && a.centres().zip(b.centres()).all(|(a, b)| square(a, b) < SAME_PLACE * SAME_PLACE)
}

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

/// Why a patch is not of a skin.
#[derive(Debug, thiserror::Error)]
pub enum OtherSkin {
    /// It has another name.
    #[error("`name` is {name:?}; allowed: {of_patch:?}, the skin of the patch")]
    Name {
        /// The skin file's.
        name: String,
        /// The patch's.
        of_patch: String,
    },
    /// It has other pixels.
    #[error(
        "its pixels do not lie where those of the patch do, so neither would contacts: give the skin file that the patch was \
         built from, or build it anew"
    )]
    Pixels,
    /// It has no pixels.
    #[error(transparent)]
    Model(#[from] ModelError),
}

/// Whether a skin has the name that a patch has.
pub fn check_name(skin: &Skin, of_patch: &str) -> Result<(), OtherSkin> {
    if skin.name == of_patch {
        return Ok(());
    }
    Err(OtherSkin::Name { name: skin.name.clone(), of_patch: of_patch.to_owned() })
}

/// Whether a skin has the pixels that a patch has.
pub fn check_pixels(skin: &Skin, of_patch: &SurfaceTables) -> Result<(), OtherSkin> {
    if of_skin(skin)?.is_some_and(|of_skin| is_same(&of_skin, of_patch)) {
        return Ok(());
    }
    Err(OtherSkin::Pixels)
}

/// Whether both have the same pixels in the same places.
#[must_use]
pub fn is_same(a: &SurfaceTables, b: &SurfaceTables) -> bool {
    let square = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>();
    a.pixels.len() == b.pixels.len()
        && a.centres().zip(b.centres()).all(|(a, b)| square(a, b) < SAME_PLACE * SAME_PLACE)
}

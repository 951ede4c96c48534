//! Shape: where a skin lies in space, and where its electrodes lie on it.

use dermatome_geometry::{embedding::Embedding, mesh::Mesh, outline::Outline, sheet::Sheet};
use nalgebra::Point3;

/// Shape of a skin.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A sheet, to be meshed.
    Sheet(Sheet),
    /// A mesh that was made elsewhere.
    Mesh {
        /// Nodes, elements, and the electrodes on them.
        mesh: Box<Mesh>,
        /// Rim of the mesh if all of it lies in the plane z = 0.
        outline: Option<Outline>,
    },
}

/// A skin that is not flat where only a flat one will do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "`shape` is curved, or its rim as seen from above crosses itself: pixel grids (`image.columns`) need a flat \
     skin, simulated fingers and `--flatten` one that lies open from above"
)]
pub struct NotFlat;

impl Shape {
    /// Rim of a flat skin.
    pub fn flat(&self) -> Result<&Outline, NotFlat> {
        match self {
            Self::Sheet(Sheet { outline, embedding: Embedding::Flat, .. })
            | Self::Mesh { outline: Some(outline), .. } => Ok(outline),
            _ => Err(NotFlat),
        }
    }

    /// Centre of each electrode, m: `[electrode]`.
    #[must_use]
    pub fn electrode_centres(&self) -> Vec<Point3<f64>> {
        match self {
            Self::Sheet(sheet) => sheet.places.iter().map(|place| sheet.centre(place)).collect(),
            Self::Mesh { mesh, .. } => mesh.electrodes.iter().map(|contact| mesh.centre(contact)).collect(),
        }
    }
}

/// Centre of each electrode as seen from above, m: `[electrode]`.
#[must_use]
pub fn electrodes_in_plane(shape: &Shape) -> Vec<[f64; 2]> {
    shape.electrode_centres().iter().map(|centre| [centre.x, centre.y]).collect()
}

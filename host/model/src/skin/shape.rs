//! Shape: where a skin lies in space, and where its electrodes lie on it.

use super::{embedding::Embedding, outline::Outline};
use crate::mesh::Mesh;
use nalgebra::{Point2, Point3};

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

/// A sheet that is cut out flat and laid onto a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Rim of the flat sheet.
    pub outline: Outline,
    /// How the flat sheet lies in space.
    pub embedding: Embedding,
    /// Where each electrode lies: `[electrode]`.
    pub places: Vec<Place>,
}

/// Where an electrode lies on a sheet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Centred at an arc length of the outer rim, m: see [`Outline::rim_point`].
    Rim(f64),
    /// Centred at a point inside the flat sheet, m.
    Inside(Point2<f64>),
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

impl Sheet {
    fn centre(&self, place: &Place) -> Point3<f64> {
        match *place {
            Place::Rim(s) => self.embedding.lay(self.outline.rim_point(s)),
            Place::Inside(point) => self.embedding.lay(point),
        }
    }

    /// Arc lengths of the electrodes on the rim, with their numbers.
    pub fn on_rim(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.places.iter().enumerate().filter_map(|(electrode, place)| match place {
            Place::Rim(s) => Some((electrode, *s)),
            Place::Inside(_) => None,
        })
    }
}

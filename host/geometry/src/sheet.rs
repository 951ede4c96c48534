//! Sheet: what a mesh is generated of: an outline laid onto a surface, electrodes on it, and edge lengths.

use crate::{embedding::Embedding, outline::Outline};
use nalgebra::{Point2, Point3};

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

impl Sheet {
    /// Centre of an electrode in space, m.
    #[must_use]
    pub fn centre(&self, place: &Place) -> Point3<f64> {
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

/// Edge lengths of a generated mesh, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLengths {
    /// Away from electrodes.
    pub skin: f64,
    /// At the electrodes; triangles grow from there.
    pub electrodes: f64,
}

impl EdgeLengths {
    /// Both times `factor`.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self { skin: self.skin * factor, electrodes: self.electrodes * factor }
    }
}

/// How electrodes appear in the forward model.
#[derive(Clone, Debug, PartialEq)]
pub enum ElectrodeModel {
    /// Each is one node of the mesh, without contact impedance.
    Point,
    /// Each covers a piece of the rim, or inside the sheet a disc: the complete electrode model.
    Complete {
        /// Length of the piece, or diameter of the disc, m: `[electrode]`.
        width: Vec<f64>,
        /// Contact impedance of each electrode, ohm m: `[electrode]`. Divided by the width it gives ohms.
        contact_impedance: Vec<f64>,
    },
}

impl ElectrodeModel {
    /// Length of rim that an electrode covers, m; 0 for the point model.
    #[must_use]
    pub fn width(&self, electrode: usize) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Complete { width, .. } => width[electrode],
        }
    }
}

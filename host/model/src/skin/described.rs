//! Shape as a skin file describes it.

use dermatome_geometry::sheet::Sheet;
use nalgebra::Point3;
use std::path::PathBuf;

/// Units of a mesh file, with their length in metres.
pub const UNITS: [(&str, f64); 5] = [("m", 1.0), ("cm", 1e-2), ("mm", 1e-3), ("um", 1e-6), ("inch", 0.0254)];

/// Shape of a described skin.
#[derive(Clone, Debug, PartialEq)]
pub enum Described {
    /// A sheet, with its electrodes in place.
    Sheet(Sheet),
    /// A mesh that was made elsewhere, in a file that is yet to be read.
    Mesh(MeshFile),
}

/// Where a mesh comes from, and where electrodes go on it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// The skin file that names it: for messages.
    pub skin_file: PathBuf,
    /// The mesh file as the skin file writes it: for messages.
    pub written: PathBuf,
    /// The mesh file.
    pub path: PathBuf,
    /// Length of its unit, m.
    pub unit: f64,
    /// Vertices closer than this share of the bounding box's diagonal are one.
    pub weld: Option<f64>,
    /// Whether holes that look like cracks may stay.
    pub allow_cracks: bool,
    /// Where the electrodes lie.
    pub placement: Placement,
}

/// Where electrodes lie on a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum Placement {
    /// Where its groups `electrode_1`, ... are.
    Groups,
    /// Equally spaced along its longest boundary.
    Rim {
        /// Direction of electrode 1 from the middle, rad, from x towards y.
        first: f64,
        /// 1 if electrodes are numbered counter-clockwise, else -1.
        turn: f64,
    },
    /// At these points, m: `[electrode]`.
    Points(Vec<Point3<f64>>),
}

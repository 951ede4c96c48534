//! Placed skin: the pixels of a board's patch in the frame of the link that it lies on.

use dermatome_link::{pose::Pose, tables::SurfaceTables};

/// A skin's pixels on its link.
#[derive(Clone, Debug)]
pub struct PlacedSkin {
    /// Where it lies on its link.
    pub pose: Pose,
    /// m: `[pixel]`.
    pub centres: Vec<[f64; 3]>,
    /// Outward, unit length: `[pixel]`.
    pub(crate) normals: Vec<[f64; 3]>,
    /// m^2: `[pixel]`.
    pub(crate) areas: Vec<f64>,
    /// `[pixel][neighbour]`.
    neighbours: Vec<Vec<u16>>,
}

impl PlacedSkin {
    /// The pixels of a patch, where this pose puts them.
    #[must_use]
    pub fn new(tables: &SurfaceTables, pose: &Pose) -> Self {
        let surface = tables.view();
        let normal = |pixel| pose.direction(surface.normal(pixel).map(f64::from));
        let round = |pixel| surface.neighbours(pixel).map(|pixel| pixel as u16).collect();
        Self {
            pose: pose.clone(),
            centres: tables.centres().map(|centre| pose.point(centre)).collect(),
            normals: tables.pixels.iter().map(normal).collect(),
            areas: tables.pixels.iter().map(|pixel| f64::from(surface.area(pixel))).collect(),
            neighbours: (0..tables.pixels.len()).map(round).collect(),
        }
    }

    /// The pixel whose centre is nearest.
    pub(crate) fn nearest(&self, to: [f64; 3]) -> Option<usize> {
        let distances = self.centres.iter().map(|centre| square_distance(*centre, to)).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(pixel, _)| pixel)
    }

    pub(crate) fn neighbours(&self, pixel: usize) -> impl Iterator<Item = usize> + '_ {
        self.neighbours[pixel].iter().map(|&pixel| usize::from(pixel))
    }
}

pub(crate) fn square_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum()
}

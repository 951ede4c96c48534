//! Pixels: the coarse picture elements of an image, each a weighted set of mesh elements.

mod grid;
pub(crate) mod halving;
mod patches;
mod presses;
mod tables;

use dermatome_geometry::mesh::{Mesh, neighbours::neighbours_and_orientation, triangle};
use dermatome_shared::image::Geometry;
pub use grid::{grid, raster, samples};
use nalgebra::{Point3, Vector3};
pub use patches::element_patches;
pub use presses::Presses;

/// Which elements make up each pixel, where it lies, and which pixels are neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Elements of each pixel with the share of the element that lies in it: `[pixel]`.
    pub elements: Vec<Vec<(usize, f64)>>,
    /// Pairs of pixels that share an edge.
    pub neighbours: Vec<[usize; 2]>,
    /// Centre of gravity, m, or the middle of the grid's cell: `[pixel]`.
    pub centres: Vec<Point3<f64>>,
    /// Unit normal of the surface: `[pixel]`.
    pub normals: Vec<Vector3<f64>>,
    /// Area, m^2: `[pixel]`.
    pub areas: Vec<f64>,
    /// The grid, if the pixels are cells of one.
    pub grid: Option<Geometry>,
}

/// Two unit vectors at right angles to each other and to a normal.
pub(crate) fn tangents(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let aside = if normal.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let u = (aside - normal * normal.dot(&aside)).normalize();
    [u, normal.cross(&u)]
}

impl Pixels {
    /// Number of pixels.
    #[must_use]
    pub fn count(&self) -> usize {
        self.elements.len()
    }

    /// The skin file's field that says how many there are.
    #[must_use]
    pub fn field(&self) -> &'static str {
        if self.grid.is_some() { "image.columns" } else { "image.pixels" }
    }

    /// Larger side of the box round all pixels, m.
    #[must_use]
    pub fn larger_side(&self) -> f64 {
        let side = |axis: usize| {
            let places = || self.centres.iter().map(|centre| centre[axis]);
            places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
        };
        let pixel = (self.areas.iter().sum::<f64>() / self.count() as f64).sqrt();
        (0..3).map(side).fold(0.0, f64::max) + pixel
    }

    /// From the elements of each pixel; `signs` is [`orientation`] of the mesh.
    ///
    /// [`orientation`]: dermatome_geometry::mesh::neighbours::orientation
    fn new(
        mesh: &Mesh,
        elements: Vec<Vec<(usize, f64)>>,
        neighbours: Vec<[usize; 2]>,
        signs: &[f64],
    ) -> Self {
        let mut pixels = Self {
            centres: Vec::with_capacity(elements.len()),
            normals: Vec::with_capacity(elements.len()),
            areas: Vec::with_capacity(elements.len()),
            neighbours,
            grid: None,
            elements,
        };
        for parts in &pixels.elements {
            let (mut area, mut centre, mut normal) = (0.0, Vector3::zeros(), Vector3::zeros());
            for &(element, share) in parts {
                let corners = mesh.corners(element);
                let part = share * triangle::area(corners);
                area += part;
                centre += triangle::centroid(corners).coords * part;
                normal += triangle::normal(corners) * (part * signs[element]);
            }
            pixels.areas.push(area);
            pixels.centres.push(Point3::from(centre / area));
            pixels.normals.push(normal.try_normalize(0.0).unwrap_or(Vector3::z()));
        }
        pixels
    }
}

/// One pixel per element; neighbours share an edge of the mesh.
#[must_use]
pub fn per_element(mesh: &Mesh) -> Pixels {
    let elements = (0..mesh.elements.len()).map(|e| vec![(e, 1.0)]).collect();
    let (neighbours, signs) = neighbours_and_orientation(&mesh.elements);
    Pixels::new(mesh, elements, neighbours, &signs)
}

//! Sheet: a conductivity that is not the same in all directions, or not everywhere.
//!
//! Of each element the root of its conductivity tensor S is kept, relative to the sheet's conductivity along the
//! grain. The local admittance is G' S G with G the gradients of the shape functions, so that gradients times the root
//! take the place of gradients wherever those are used; a press changes the whole of S by one factor.

use crate::skin::{ConductivityMap, Material};
use dermatome_geometry::mesh::{
    Mesh,
    triangle::{Gradients, centroid, normal},
};
use nalgebra::{Matrix3, Point3, Vector3};
use std::sync::Arc;

/// Part of the grain's direction that is left in a plane that it stands on.
const UPRIGHT: f64 = 1e-6;

/// The untouched sheet on a mesh.
#[derive(Clone, Debug, Default)]
pub struct SheetTensors {
    /// In space, symmetric: `[element]`; none where the sheet is alike everywhere and in all directions.
    roots: Option<Arc<[Matrix3<f64>]>>,
}

impl SheetTensors {
    /// Of a material on a mesh.
    #[must_use]
    pub fn new(material: &Material, mesh: &Mesh) -> Self {
        if material.across.is_none() && material.map.is_none() {
            return Self::default();
        }
        let level = material.map.as_ref().map(ConductivityMap::interpolation);
        let root = |element: usize| {
            let corners = mesh.corners(element);
            let scale = level.as_ref().map_or(1.0, |level| level.at(centroid(corners)).sqrt());
            tensor_root(material, normal(corners)) * scale
        };
        Self { roots: Some((0..mesh.elements.len()).map(root).collect()) }
    }

    /// Gradients of an element's shape functions times the root of its tensor, in the element's plane.
    pub(crate) fn gradients(&self, element: usize, corners: [Point3<f64>; 3]) -> Gradients {
        let gradients = Gradients::of(corners);
        let Some(roots) = &self.roots else { return gradients };
        let along = (corners[1] - corners[0]).normalize();
        let side = corners[2] - corners[0];
        let axes = [along, (side - along * side.dot(&along)).normalize()];
        let Gradients([x, y]) = gradients;
        let row = |axis: Vector3<f64>| {
            let [of_x, of_y] = axes.map(|other| axis.dot(&(roots[element] * other)));
            std::array::from_fn(|corner| of_x * x[corner] + of_y * y[corner])
        };
        Gradients(axes.map(row))
    }

    /// S of an element; none where it is 1 everywhere.
    #[must_use]
    pub fn tensor(&self, element: usize) -> Option<Matrix3<f64>> {
        self.roots.as_ref().map(|roots| roots[element] * roots[element])
    }
}

/// Root of the tensor of a uniform sheet in a plane with this normal.
fn tensor_root(material: &Material, normal: Vector3<f64>) -> Matrix3<f64> {
    let in_plane = |axis: Vector3<f64>| (axis - normal * normal.dot(&axis)).try_normalize(UPRIGHT);
    let (sine, cosine) = material.grain.sin_cos();
    // Where the surface turns its back on the grain, as at the rim of a hemisphere, upwards is where it came from.
    let along = in_plane(Vector3::new(cosine, sine, 0.0)).or_else(|| in_plane(Vector3::z()));
    let along = along.unwrap_or_default();
    let plane = Matrix3::identity() - normal * normal.transpose();
    let along = along * along.transpose();
    along + (plane - along) * material.across.unwrap_or(1.0).sqrt()
}

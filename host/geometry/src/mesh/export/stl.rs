//! Binary STL, in millimetres as CAD programs expect, or in metres as robots' descriptions do: each triangle with its normal and its three corners.

use crate::mesh::{Mesh, neighbours::orientation, triangle};

const HEADER_BYTES: usize = 80;

/// A mesh without its electrodes, as a binary STL file in mm. Coordinates keep single precision.
#[must_use]
pub fn stl(mesh: &Mesh) -> Vec<u8> {
    written(mesh, "Dermatome: a skin's mesh, millimetres", 1e3)
}

/// How a file of [`stl_in_metres`] begins.
pub const IN_METRES: &str = "Dermatome: a skin's mesh, metres";

/// The same in metres, for robots' descriptions.
#[must_use]
pub fn stl_in_metres(mesh: &Mesh) -> Vec<u8> {
    written(mesh, IN_METRES, 1.0)
}

fn written(mesh: &Mesh, header: &str, scale: f64) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(HEADER_BYTES, 0);
    bytes.extend((mesh.elements.len() as u32).to_le_bytes());
    for (element, sign) in orientation(&mesh.elements).into_iter().enumerate() {
        let [a, mut b, mut c] = mesh.corners(element);
        if sign < 0.0 {
            std::mem::swap(&mut b, &mut c);
        }
        let normal = triangle::normal([a, b, c]);
        let corners = [a, b, c].map(|corner| corner.coords * scale);
        for vector in [normal].into_iter().chain(corners) {
            vector.iter().for_each(|part| bytes.extend((*part as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

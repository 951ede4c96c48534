//! Place: where on a skin a press was, from the coordinates that say so.
//!
//! On a flat skin in the plane z = 0, x and y say it. On any other a press is laid on the nearest point of the mesh, so that
//! what presses it may have a thickness, and its frame an error, of up to the width of a pixel.

use super::{Positions, PressError};
use dermatome_geometry::mesh::Mesh;
use dermatome_model::{
    inverse::targets::half_side,
    model::{Model, TooManyPixels},
};
use dermatome_patch::layout::Layout;
use nalgebra::Point3;
use rayon::prelude::*;
use serde::Serialize;

/// Heights up to this share of half the larger side are none.
const FLAT: f64 = 1e-6;

/// Presses laid on a skin.
#[derive(Clone, Debug, PartialEq)]
pub struct Laid {
    /// Where, m: `[press]`.
    pub places: Vec<Point3<f64>>,
    /// How far they were off the skin; none on a flat skin in the plane z = 0.
    pub off: Option<Off>,
}

/// How far presses were off a curved skin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Off {
    /// Median, mm.
    pub median_mm: f64,
    /// Largest, mm.
    pub farthest_mm: f64,
    /// Farthest that is allowed, mm.
    pub allowed_mm: f64,
}

/// Whether x and y say where on a mesh a press is: all of it lies in the plane z = 0.
#[must_use]
pub fn is_flat(mesh: &Mesh) -> bool {
    let most = FLAT * half_side(mesh);
    mesh.nodes.iter().all(|node| node.z.abs() < most)
}

/// Lays presses on a skin; what lies off it is refused.
pub fn lay(model: &Model, positions: &Positions) -> Result<Laid, PressError> {
    match positions {
        _ if is_flat(&model.mesh) => {
            Ok(Laid { places: in_plane(model, &positions.from_above())?, off: None })
        }
        Positions::FromAbove(_) => Err(PressError::NoHeight),
        Positions::InSpace(positions) => on_surface(model, positions),
    }
}

/// Places as they are, once each is known to be no farther from a pixel than these are apart.
fn in_plane(model: &Model, positions: &[[f64; 2]]) -> Result<Vec<Point3<f64>>, PressError> {
    let pitch = pitch_from_above(model)?;
    let place = |(press, &[x, y]): (usize, &[f64; 2])| {
        let distance = |centre: &Point3<f64>| (centre.x - x).hypot(centre.y - y);
        let nearest = model.pixels.centres.iter().map(distance).fold(f64::INFINITY, f64::min);
        if nearest <= pitch {
            return Ok(Point3::new(x, y, 0.0));
        }
        let reach_mm = half_side(&model.mesh) * 1e3;
        Err(PressError::OffTheSkin { press, x, y, far_mm: nearest * 1e3, reach_mm })
    };
    positions.iter().enumerate().map(place).collect()
}

fn pitch_from_above(model: &Model) -> Result<f64, TooManyPixels> {
    Ok(f64::from(Layout::from(&model.surface()?).grid.pitch))
}

/// The nearest points of the mesh.
fn on_surface(model: &Model, positions: &[[f64; 3]]) -> Result<Laid, PressError> {
    let allowed = (model.pixels.areas.iter().sum::<f64>() / model.pixels.count() as f64).sqrt();
    let nearest = |&at: &[f64; 3]| model.mesh.nearest(Point3::from(at));
    let places: Vec<Point3<f64>> = positions.par_iter().map(nearest).collect();
    let off = |(place, &at): (&Point3<f64>, &[f64; 3])| (place - Point3::from(at)).norm();
    let mut far: Vec<f64> = places.iter().zip(positions).map(off).collect();
    if let Some(press) = far.iter().position(|&far| far > allowed) {
        return Err(PressError::OffTheSurface {
            press,
            at: positions[press],
            nearest: places[press].into(),
            off_mm: far[press] * 1e3,
            most_mm: allowed * 1e3,
            reach_mm: half_side(&model.mesh) * 1e3,
        });
    }
    far.sort_by(f64::total_cmp);
    let at = |index: usize| far.get(index).copied().unwrap_or(0.0) * 1e3;
    let (median_mm, farthest_mm) = (at(far.len() / 2), at(far.len().saturating_sub(1)));
    Ok(Laid { places, off: Some(Off { median_mm, farthest_mm, allowed_mm: allowed * 1e3 }) })
}

//! Images of recorded frames, and where in them something touches the skin.

use super::{
    diagnose::dead_below,
    difference::{difference, signed_reference},
    order::{Arrangement, OrderError},
    read::Frames,
};
use dermatome_model::model::{Model, TooManyPixels};
use dermatome_patch::{layout::Layout, tables::SurfaceTables};
use dermatome_shared::{
    contact::{self, Contact},
    units::RelativeConductivity,
};
use num_complex::Complex64;
use serde::Serialize;

/// Whether what is looked for raises or lowers the conductivity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Polarity {
    /// Whichever the strongest pixel of the frame does.
    #[default]
    Auto,
    /// Conductivity up, as a press on piezoresistive fabric.
    Up,
    /// Conductivity down, as a plastic rod in a tank.
    Down,
}

/// One place that differs from the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Object {
    /// Centre in the skin's frame, mm.
    pub x_mm: f64,
    /// Centre in the skin's frame, mm.
    pub y_mm: f64,
    /// Direction from the grid's centre: 0 along x, counter-clockwise, -180 to 180.
    pub angle_degrees: f64,
    /// Distance from the grid's centre, in percent of half the grid's larger side.
    pub radius_percent: f64,
    /// Area of the pixels above a quarter of the image's peak, mm^2.
    pub area_mm2: f64,
    /// Strongest relative conductivity change in it, with sign.
    pub peak: f64,
}

/// What one frame shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameResult {
    /// Frame in its file, from 0.
    pub frame: usize,
    /// Strongest relative conductivity change of the looked-for polarity, with sign; 0 for none.
    pub peak: f64,
    /// Polarity that was looked for: up or down.
    pub polarity: Polarity,
    /// Objects, strongest first; none where nothing changes.
    pub objects: Vec<Object>,
    /// Relative conductivity change: `[pixel]`.
    #[serde(skip)]
    pub image: Vec<f64>,
}

/// Why frames cannot be reconstructed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReconstructError {
    /// The frames do not fit the drive pattern.
    #[error(transparent)]
    Order(#[from] OrderError),
    /// Reference and frames come from different instruments.
    #[error("the frames hold {frames} measurements each, the reference {reference}; they must be equal")]
    Lengths {
        /// Measurements in a frame.
        frames: usize,
        /// Measurements in the reference.
        reference: usize,
    },
    /// Numbers too large to reckon with.
    #[error(
        "frame {frame} holds values so large that its image overflows; allowed are voltages, in any unit"
    )]
    Overflow {
        /// The frame, from 0.
        frame: usize,
    },
    /// An image in which nothing can be looked for.
    #[error(transparent)]
    Pixels(#[from] TooManyPixels),
    /// Nothing to scale by.
    #[error("every measurement of the reference is zero")]
    DeadReference,
}

/// Reconstructs every frame against the mean of the reference frames.
///
/// Difference data are ratios to the reference, as on a board, so that the instrument's gain and the
/// skin's absolute conductivity cancel.
pub fn reconstruct(
    model: &Model,
    reference: &Frames,
    frames: &Frames,
    arrangement: &Arrangement,
    polarity: Polarity,
) -> Result<Vec<FrameResult>, ReconstructError> {
    let lengths = (frames.measurements, reference.measurements);
    if lengths.0 != lengths.1 {
        return Err(ReconstructError::Lengths { frames: lengths.0, reference: lengths.1 });
    }
    let place = Place::of(model)?;
    let electrodes = model.mesh.electrodes.len() as u8;
    let map = arrangement.index_map(&model.steps, electrodes, reference.measurements)?;
    let mut reference = reference.mean();
    let floor = dead_below(&reference, &map);
    // A dead measurement is exactly zero, and so is left out of the image.
    reference.iter_mut().filter(|value| value.norm() <= floor).for_each(|value| *value = Complex64::ZERO);
    let signed = signed_reference(&reference, &map, &model.voltages);
    if signed.iter().all(|&value| value == 0.0) {
        return Err(ReconstructError::DeadReference);
    }
    let of_frame = |(frame, values): (usize, &[Complex64])| {
        let image = model.image(&difference(&reference, values, &map, &model.voltages), &signed);
        if image.iter().any(|value| !value.is_finite()) {
            return Err(ReconstructError::Overflow { frame });
        }
        Ok(describe(&place, frame, image, polarity))
    };
    frames.iter().enumerate().map(of_frame).collect()
}

fn describe(place: &Place, frame: usize, image: Vec<f64>, polarity: Polarity) -> FrameResult {
    let strongest = image.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let sign = match polarity {
        Polarity::Auto => 1_f64.copysign(strongest),
        Polarity::Up => 1.0,
        Polarity::Down => -1.0,
    };
    let peak = image.iter().map(|value| value * sign).fold(0.0, f64::max);
    let contacts = contacts(&place.surface, &image, sign, peak);
    FrameResult {
        frame,
        peak: peak * sign,
        polarity: if sign > 0.0 { Polarity::Up } else { Polarity::Down },
        objects: contacts.iter().map(|contact| Object::new(place, contact, peak * sign)).collect(),
        image,
    }
}

/// Where the skin lies.
struct Place {
    surface: SurfaceTables,
    /// Middle of its picture, m.
    centre: [f64; 2],
    /// Half the larger side of its picture, m.
    half_width: f64,
}

impl Place {
    fn of(model: &Model) -> Result<Self, TooManyPixels> {
        let surface = model.surface()?;
        let grid = Layout::from(&surface).grid;
        let centre = grid.position(f32::from(grid.columns) / 2.0, f32::from(grid.rows) / 2.0).map(f64::from);
        let half_width = f64::from(grid.columns.max(grid.rows)) * f64::from(grid.pitch) / 2.0;
        Ok(Self { surface, centre, half_width })
    }
}

/// Contacts in the image over its peak, which has this sign: however weak the image is, the codes use their full
/// range.
pub(crate) fn contacts(surface: &SurfaceTables, image: &[f64], sign: f64, peak: f64) -> contact::Contacts {
    if peak <= 0.0 {
        return contact::Contacts::new();
    }
    let codes: Vec<_> =
        image.iter().map(|value| RelativeConductivity::from_f64(value * sign / peak)).collect();
    contact::find(&surface.view(), &codes, RelativeConductivity(1))
}

impl Object {
    /// `peak` is the image's, to which the contact was scaled.
    fn new(place: &Place, contact: &Contact, peak: f64) -> Self {
        let [x, y, _] = contact.position.map(f64::from);
        let (right, up) = (x - place.centre[0], y - place.centre[1]);
        Self {
            x_mm: x * 1e3,
            y_mm: y * 1e3,
            angle_degrees: up.atan2(right).to_degrees(),
            radius_percent: right.hypot(up) / place.half_width * 100.0,
            area_mm2: f64::from(contact.area) * 1e6,
            peak: f64::from(contact.peak) * peak,
        }
    }
}

/// Indices of at most `rows` of `count` frames, evenly spaced, the first and the last among them.
#[must_use]
pub fn evenly_spaced(count: usize, rows: usize) -> Vec<usize> {
    if count <= rows {
        return (0..count).collect();
    }
    let last = rows.saturating_sub(1).max(1);
    (0..rows).map(|row| (row * (count - 1) + last / 2) / last).collect()
}

#[cfg(test)]
mod tests;

//! Images of recorded frames, and where in them something touches the skin.

use super::{
    diagnose::dead_below,
    difference::{difference, signed_reference},
    order::{Arrangement, FileIndex, OrderError},
    read::Frames,
};
use dermatome_model::{model::Model, pixels::Pixels};
use dermatome_patch::{layout::Layout, tables::SurfaceTables};
use dermatome_shared::{
    contact::{self, Contact},
    limits::MAX_CONTACTS,
    patch::Difference,
    units::RelativeConductivity,
};
use nalgebra::Vector3;
use num_complex::Complex64;
use serde::Serialize;
use std::collections::BTreeMap;

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
    /// Not a reference for each frame.
    #[error("{frames} frames and {reference} references; with one for each allowed are as many")]
    Count {
        /// Frames.
        frames: usize,
        /// References.
        reference: usize,
    },
    /// Ratios without what they are ratios to.
    #[error(
        "the frames are differences, which have no reference to normalise by; allowed: `inverse.normalised` = false"
    )]
    NormalisedDifferences,
    /// Nothing to scale by.
    #[error("every measurement of the reference is zero")]
    DeadReference,
}

/// What frames are compared with.
#[derive(Clone, Copy, Debug)]
pub enum Reference<'a> {
    /// The mean of these frames.
    Mean(&'a Frames),
    /// For each frame the one of its number.
    Each(&'a Frames),
    /// The frames are differences already; only plain ones make an image, in a scale of their own.
    Subtracted,
}

/// Reconstructs every frame.
///
/// Difference data are ratios to the reference, as on a board, so that the instrument's gain and the
/// skin's absolute conductivity cancel.
pub fn reconstruct(
    model: &Model,
    reference: Reference<'_>,
    frames: &Frames,
    arrangement: &Arrangement,
    polarity: Polarity,
) -> Result<Vec<FrameResult>, ReconstructError> {
    let place = Place::of(model);
    let of_frame = |(frame, (change, signed)): (usize, (Vec<f64>, &Vec<f64>))| {
        let image = model.image(&change, signed);
        if image.iter().any(|value| !value.is_finite()) {
            return Err(ReconstructError::Overflow { frame });
        }
        Ok(describe(&place, frame, image, polarity))
    };
    let changes = Changes::of(model, reference, frames, arrangement)?;
    changes.iter().enumerate().map(of_frame).collect()
}

/// Changes of frames against their references.
#[derive(Clone, Debug)]
pub struct Changes {
    /// `[frame][step]`, in the file's unit with the model's sign.
    changes: Vec<Vec<f64>>,
    /// `[reference][step]`: one for all frames, or one for each.
    references: Vec<Vec<f64>>,
}

impl Changes {
    /// Of every frame.
    pub fn of(
        model: &Model,
        reference: Reference<'_>,
        frames: &Frames,
        arrangement: &Arrangement,
    ) -> Result<Self, ReconstructError> {
        let electrodes = model.mesh.electrodes.len() as u8;
        if let Reference::Mean(it) | Reference::Each(it) = reference
            && it.measurements != frames.measurements
        {
            let (frames, reference) = (frames.measurements, it.measurements);
            return Err(ReconstructError::Lengths { frames, reference });
        }
        let map = arrangement.index_map(&model.steps, electrodes, frames.measurements)?;
        let references: Vec<Vec<Complex64>> = match reference {
            Reference::Subtracted if model.difference == Difference::Normalised => {
                return Err(ReconstructError::NormalisedDifferences);
            }
            Reference::Subtracted => {
                let sign = |place: &FileIndex| if place.flipped { -1.0 } else { 1.0 };
                let change =
                    |frame: &[Complex64]| map.iter().map(|it| frame[it.index].re * sign(it)).collect();
                return Ok(Self {
                    changes: frames.iter().map(change).collect(),
                    references: vec![model.voltages.clone()],
                });
            }
            Reference::Mean(reference) => vec![reference.mean()],
            Reference::Each(reference) if reference.frames != frames.frames => {
                return Err(ReconstructError::Count { frames: frames.frames, reference: reference.frames });
            }
            Reference::Each(reference) => reference.iter().map(<[Complex64]>::to_vec).collect(),
        };
        let alive = |mut reference: Vec<Complex64>| {
            let floor = dead_below(&reference, &map);
            // A dead measurement is exactly zero, and so is left out of the image.
            reference.iter_mut().filter(|it| it.norm() <= floor).for_each(|it| *it = Complex64::ZERO);
            reference
        };
        let references: Vec<_> = references.into_iter().map(alive).collect();
        let signed: Vec<_> =
            references.iter().map(|reference| signed_reference(reference, &map, &model.voltages)).collect();
        if signed.iter().any(|signed| signed.iter().all(|&value| value == 0.0)) {
            return Err(ReconstructError::DeadReference);
        }
        let change = |(index, frame): (usize, &[Complex64])| {
            difference(&references[index.min(references.len() - 1)], frame, &map, &model.voltages)
        };
        Ok(Self { changes: frames.iter().enumerate().map(change).collect(), references: signed })
    }

    /// Changes with their references: `[step]`.
    fn iter(&self) -> impl Iterator<Item = (Vec<f64>, &Vec<f64>)> {
        let last = self.references.len() - 1;
        self.changes
            .iter()
            .enumerate()
            .map(move |(frame, change)| (change.clone(), &self.references[frame.min(last)]))
    }

    /// Difference data as a model takes them: `[frame][measurement]`.
    pub fn difference_data(&self, model: &Model) -> impl Iterator<Item = Vec<f64>> {
        self.iter().map(|(change, reference)| model.difference_data(&change, reference))
    }
}

fn describe(place: &Place<'_>, frame: usize, image: Vec<f64>, polarity: Polarity) -> FrameResult {
    let strongest = image.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    let sign = match polarity {
        Polarity::Auto => 1_f64.copysign(strongest),
        Polarity::Up => 1.0,
        Polarity::Down => -1.0,
    };
    let peak = image.iter().map(|value| value * sign).fold(0.0, f64::max);
    let objects = match &place.surface {
        Some(surface) => {
            let contacts = contacts(surface, &image, sign, peak);
            let object = |contact: &Contact| {
                let position = contact.position.map(f64::from);
                Object::new(place, position, contact.area.into(), f64::from(contact.peak) * peak * sign)
            };
            contacts.iter().map(object).collect()
        }
        None => blobs(place, &image, sign, peak),
    };
    let polarity = if sign > 0.0 { Polarity::Up } else { Polarity::Down };
    FrameResult { frame, peak: peak * sign, polarity, objects, image }
}

/// Objects of an image of more pixels than a board takes: neighbours above a quarter of the peak, each weighed by its area
/// times its value.
fn blobs(place: &Place<'_>, image: &[f64], sign: f64, peak: f64) -> Vec<Object> {
    let pixels = &place.pixels;
    let is_part = |pixel: usize| peak > 0.0 && image[pixel] * sign > peak / 4.0;
    let mut blob_of: Vec<usize> = (0..image.len()).collect();
    fn root(blob_of: &mut [usize], mut pixel: usize) -> usize {
        while blob_of[pixel] != pixel {
            blob_of[pixel] = blob_of[blob_of[pixel]];
            pixel = blob_of[pixel];
        }
        pixel
    }
    for &[a, b] in pixels.neighbours.iter().filter(|[a, b]| is_part(*a) && is_part(*b)) {
        let [a, b] = [root(&mut blob_of, a), root(&mut blob_of, b)];
        blob_of[a] = b;
    }
    let mut blobs: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for pixel in (0..image.len()).filter(|&pixel| is_part(pixel)) {
        blobs.entry(root(&mut blob_of, pixel)).or_default().push(pixel);
    }
    let object = |members: Vec<usize>| {
        let weight = |pixel: usize| image[pixel].abs() * pixels.areas[pixel];
        let all: f64 = members.iter().map(|&pixel| weight(pixel)).sum();
        let sum =
            members.iter().map(|&pixel| pixels.centres[pixel].coords * weight(pixel)).sum::<Vector3<f64>>();
        let area = members.iter().map(|&pixel| pixels.areas[pixel]).sum();
        let highest = members.iter().map(|&pixel| image[pixel].abs()).fold(0.0, f64::max);
        Object::new(place, (sum / all).into(), area, highest * sign)
    };
    let mut objects: Vec<Object> = blobs.into_values().map(object).collect();
    objects.sort_by(|a, b| b.peak.abs().total_cmp(&a.peak.abs()));
    objects.truncate(MAX_CONTACTS);
    objects
}

/// Where the skin lies.
struct Place<'a> {
    /// `None` where there are more pixels than a board takes.
    surface: Option<SurfaceTables>,
    pixels: &'a Pixels,
    /// Middle of its picture, m.
    centre: [f64; 2],
    /// Half the larger side of its picture, m.
    half_width: f64,
}

impl<'a> Place<'a> {
    fn of(model: &'a Model) -> Self {
        let (surface, pixels) = (model.surface().ok(), &model.pixels);
        let layout = surface.as_ref().map(Layout::from).or_else(|| pixels.grid.as_ref().map(Layout::from));
        if let Some(Layout { grid, .. }) = layout {
            let middle = grid.position(f32::from(grid.columns) / 2.0, f32::from(grid.rows) / 2.0);
            let half_width = f64::from(grid.columns.max(grid.rows)) * f64::from(grid.pitch) / 2.0;
            return Self { surface, pixels, centre: middle.map(f64::from), half_width };
        }
        let ends = |axis: usize| {
            let along = pixels.centres.iter().map(|centre| centre[axis]);
            along.fold([f64::MAX, f64::MIN], |[low, high], at| [low.min(at), high.max(at)])
        };
        let [x, y] = [ends(0), ends(1)];
        let half_width = (x[1] - x[0]).max(y[1] - y[0]) / 2.0;
        Self { surface, pixels, centre: [(x[0] + x[1]) / 2.0, (y[0] + y[1]) / 2.0], half_width }
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
    /// At a position, m, of an area, m^2.
    fn new(place: &Place<'_>, [x, y, _]: [f64; 3], area: f64, peak: f64) -> Self {
        let (right, up) = (x - place.centre[0], y - place.centre[1]);
        Self {
            x_mm: x * 1e3,
            y_mm: y * 1e3,
            angle_degrees: up.atan2(right).to_degrees(),
            radius_percent: right.hypot(up) / place.half_width * 100.0,
            area_mm2: area * 1e6,
            peak,
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

//! Reflexes: the rows by which a board reads the load on a region, one sum for each of its cells.
//!
//! A row shall read 1 for the standard press wherever in its cell it lies, nothing for one outside the region, no more than 1 for
//! one in the region's other cells, little noise, and nothing of changes that are no press: what all voltages have in common,
//! smooth changes of the sheet, electrodes that slip. Its weights w minimise
//!
//! ```text
//! sum over places p of share_p (a_p' w - wanted_p)^2 + w' N w + sum over known changes k of (size_k k' w)^2
//! ```
//!
//! with a_p the response to the press at p and N the covariance of noise: GREIT's idea (Adler et al. 2009), for a cell instead
//! of each pixel. Shares begin alike and grow where the error is large (Lawson's algorithm), so that the worst place counts.
//! Places just outside the region are left free. One row for all of a large region would be blind: a load that may lie
//! anywhere in it looks like a sheet that has become warm, which is why a region has cells.

use super::{
    PatchBuildError,
    responses::{deviation_at_60_db, even_response, radius, responses, slip_responses, smooth_responses},
};
use crate::{
    model::Model,
    skin::{FoundIn, Reflex, Skin},
};
use dermatome_patch::{places::FixedPlaces, reflexes::Reflexes, write::Stored};
use dermatome_shared::patch::{
    PatchView,
    places::MAX_PLACES,
    reflexes::{Limit, ReflexRow, ReflexRule, most_reflex_rows, reflex_bytes, strength_of},
};
use faer::{Col, Mat, Side, linalg::solvers::Solve};
use nalgebra::Point3;
use serde::Serialize;

/// What rows are made for: the share by which drift and warmth change the sheet, and by how much electrodes slip, in units of
/// half the skin's larger side.
const DRIFT: f64 = 0.1;
const SLIP: f64 = 0.005;
/// Places so far outside, in radii of the standard press, shall read nothing: about as far as such skins tell apart.
const MARGIN: f64 = 4.0;
/// Fewest cells that an area is counted in.
const FEWEST_CELLS: usize = 2;
/// Rounds in which places that are read worst come to count more.
const ROUNDS_OF_SHARES: usize = 40;
/// Rounds in which cells settle.
const ROUNDS_OF_CELLS: usize = 20;

/// Why a skin's reflexes make no patch.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReflexError {
    /// Loads are in strengths of presses found in the voltages.
    #[error("`reflexes` need contacts that are found in the voltages: `contact.found_in` is \"image\"")]
    FoundInImage,
    /// There is no pixel in a region.
    #[error(
        "`reflexes`: nothing of the skin lies in the region of {name:?}; allowed: a `centre` and `radius` that reach it"
    )]
    Empty {
        /// Name of the rule.
        name: String,
    },
    /// There is no force without a calibration.
    #[error(
        "`reflexes`: {name:?} has a limit in newtons, and the skin is not calibrated; allowed: `strength`, or a calibration \
         with `load_share`, of the skin file or kept by --preserve-calibration"
    )]
    NotCalibrated {
        /// Name of the rule.
        name: String,
    },
    /// Rules take more rows than there are.
    #[error(
        "`reflexes` need {needed} rows; allowed: {most}, of which a load takes one at least and an area {FEWEST_CELLS}"
    )]
    TooManyRows {
        /// Rows that they need.
        needed: usize,
        /// Rows of a board.
        most: usize,
    },
    /// The rows have no solution.
    #[error(
        "`reflexes`: the weights of {name:?} have no solution: the model has changes that are not finite"
    )]
    Singular {
        /// Name of the rule.
        name: String,
    },
}

/// How well a rule reads what it shall.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ReflexReport {
    /// Name of the rule.
    pub name: String,
    /// Its pin.
    pub pin: u8,
    /// Limit, in strengths of the standard press, or m^2.
    pub limit: f64,
    /// Whether that is an area.
    pub is_area: bool,
    /// Cells that its region is read in, and the area of the largest, m^2.
    pub cells: usize,
    /// Likewise.
    pub largest_cell: f64,
    /// Least and most that a standard press of strength 1 reads in the region.
    pub inside: [f64; 2],
    /// Most that one reads that lies four of its radii outside, or farther; 0 where there is no outside.
    pub outside: f64,
    /// Standard deviation of what one frame reads at 60 dB, of the worst cell.
    pub noise: f64,
}

/// The reflexes of a skin, in the form of a patch.
pub(super) fn reflexes(
    skin: &Skin,
    model: &Model,
    places: &FixedPlaces,
) -> Result<Reflexes, PatchBuildError> {
    if skin.reflexes.is_empty() {
        return Ok(Reflexes::default());
    }
    if skin.contacts_found_in == FoundIn::Image || places.layout().places == 0 {
        return Err(ReflexError::FoundInImage.into());
    }
    let training = Training::new(skin, model)?;
    let regions: Vec<Vec<usize>> =
        skin.reflexes.iter().map(|reflex| training.region(reflex)).collect::<Result<_, _>>()?;
    let mut made = Reflexes::default();
    for ((reflex, region), cells) in
        skin.reflexes.iter().zip(&regions).zip(training.counts(&skin.reflexes, &regions)?)
    {
        let cells = divided(region, &model.pixels.centres, cells);
        made.rules.push(rule(reflex, cells.len()));
        for cell in cells {
            let wanted = training.wanted(reflex, region, &cell);
            let weights = training
                .weights(&wanted)
                .ok_or_else(|| ReflexError::Singular { name: reflex.name.clone() })?;
            made.rows.push(ReflexRow {
                area: cell.iter().map(|&pixel| model.pixels.areas[pixel]).sum::<f64>() as f32,
                places: places_in(&cell, places),
                weights: weights.iter().map(|weight| *weight as f32).collect(),
            });
        }
    }
    Ok(made)
}

/// Bytes that the reflexes of a skin take in a patch at most.
pub(super) fn bytes(skin: &Skin, model: &Model) -> usize {
    let measurements = model.jacobian.nrows();
    let rows = if skin.reflexes.is_empty() { 0 } else { most_reflex_rows(measurements) };
    reflex_bytes(skin.reflexes.len(), rows, measurements)
}

/// Whether limits in newtons have a calibration that they need.
pub(super) fn check_forces(skin: &Skin, stored: &Stored) -> Result<(), ReflexError> {
    let is_calibrated = !stored.curve.points.is_empty() && stored.curve.load_share.is_some();
    let needs_one = |reflex: &&Reflex| matches!(reflex.limit, Limit::Force(_));
    match skin.reflexes.iter().find(needs_one).filter(|_| !is_calibrated) {
        Some(reflex) => Err(ReflexError::NotCalibrated { name: reflex.name.clone() }),
        None => Ok(()),
    }
}

fn rule(reflex: &Reflex, rows: usize) -> ReflexRule {
    ReflexRule {
        name: reflex.name.as_str().try_into().expect("a checked rule's name fits"),
        pin: reflex.pin,
        limit: reflex.limit,
        release: reflex.release as f32,
        frames: reflex.frames,
        hold: reflex.hold as f32,
        trips_blind: reflex.trips_blind,
        rows: rows as u8,
    }
}

/// The places among these pixels, one bit each.
fn places_in(region: &[usize], places: &FixedPlaces) -> [u8; MAX_PLACES / 8] {
    let mut bits = [0; MAX_PLACES / 8];
    for (number, place) in places.tables().places.iter().enumerate() {
        if region.contains(&usize::from(place.pixel)) {
            bits[number / 8] |= 1 << (number % 8);
        }
    }
    bits
}

/// What weights are chosen by.
struct Training<'a> {
    model: &'a Model,
    /// Responses to the standard press: `[measurement][pixel]`.
    responses: Mat<f64>,
    /// Noise and known changes: `[measurement][measurement]`.
    unwanted: Mat<f64>,
    margin: f64,
}

impl<'a> Training<'a> {
    fn new(skin: &Skin, model: &'a Model) -> Result<Self, PatchBuildError> {
        let noise = deviations(model);
        let (voltages, divisors) = (model.measurements(), model.divisors());
        let common = Mat::from_fn(noise.len(), 1, |m, _| voltages[m] / divisors[m]);
        let even = even_response(model, &model.relative_noise());
        let even = Mat::from_fn(noise.len(), usize::from(even.is_some()), |m, _| {
            even.as_ref().map_or(0.0, |e| e[m])
        });
        let mut unwanted =
            Mat::from_fn(noise.len(), noise.len(), |i, j| if i == j { noise[i] * noise[i] } else { 0.0 });
        let known = [
            (DRIFT, common),
            (DRIFT, smooth_responses(model)),
            (DRIFT, even),
            (SLIP, slip_responses(skin, model)?),
        ];
        for (size, changes) in known {
            unwanted += faer::Scale(size * size) * (&changes * changes.transpose());
        }
        Ok(Self { model, responses: responses(model), unwanted, margin: MARGIN * radius(model) })
    }

    /// Pixels of a rule's region.
    fn region(&self, reflex: &Reflex) -> Result<Vec<usize>, ReflexError> {
        let centres = &self.model.pixels.centres;
        let inside: Vec<usize> =
            (0..centres.len()).filter(|&p| reflex.region.beyond(&centres[p]) <= 0.0).collect();
        if inside.is_empty() { Err(ReflexError::Empty { name: reflex.name.clone() }) } else { Ok(inside) }
    }

    /// How many cells each region has: alike, but cells are no smaller than the standard press.
    fn counts(&self, reflexes: &[Reflex], regions: &[Vec<usize>]) -> Result<Vec<usize>, ReflexError> {
        let least =
            |reflex: &Reflex| if matches!(reflex.limit, Limit::Area { .. }) { FEWEST_CELLS } else { 1 };
        let mut counts: Vec<usize> = reflexes.iter().map(least).collect();
        let needed = counts.iter().sum::<usize>();
        let most = most_reflex_rows(self.responses.nrows());
        if needed > most {
            return Err(ReflexError::TooManyRows { needed, most });
        }
        let areas = &self.model.pixels.areas;
        let whole: Vec<f64> =
            regions.iter().map(|region| region.iter().map(|&pixel| areas[pixel]).sum()).collect();
        let press = std::f64::consts::PI * radius(self.model).powi(2);
        for _ in needed..most {
            let cell = |rule: usize| whole[rule] / counts[rule] as f64;
            let fewest =
                (0..counts.len()).filter(|&rule| cell(rule) > press).min_by_key(|&rule| counts[rule]);
            match fewest {
                Some(rule) => counts[rule] += 1,
                None => break,
            }
        }
        Ok(counts)
    }

    /// What the row of a cell shall read of presses on pixels.
    fn wanted(&self, reflex: &Reflex, region: &[usize], cell: &[usize]) -> Vec<(usize, Wanted)> {
        // What counts towards an area shall not count twice.
        let (seen, others) = match reflex.limit {
            Limit::Area { .. } => (cell, &[][..]),
            Limit::Strength(_) | Limit::Force(_) => (region, region),
        };
        let others =
            others.iter().filter(|pixel| !cell.contains(pixel)).map(|&pixel| (pixel, Wanted::AtMostOne));
        let outside = self.outside(seen).into_iter().map(|pixel| (pixel, Wanted::Nothing));
        cell.iter().map(|&pixel| (pixel, Wanted::One)).chain(others).chain(outside).collect()
    }

    /// Weights that read what is wanted of presses on pixels: `[measurement]`; none if the model is not finite.
    fn weights(&self, wanted: &[(usize, Wanted)]) -> Option<Col<f64>> {
        let of = Mat::from_fn(self.responses.nrows(), wanted.len(), |m, p| self.responses[(m, wanted[p].0)]);
        let count = |kind: Wanted| wanted.iter().filter(|(_, other)| *other == kind).count().max(1) as f64;
        let mut shares: Vec<f64> = wanted.iter().map(|&(_, kind)| 1.0 / count(kind)).collect();
        let mut aims: Vec<f64> = wanted.iter().map(|(_, kind)| kind.nearest(0.0)).collect();
        let mut weights = self.solved(&of, &aims, &shares)?;
        for _ in 0..ROUNDS_OF_SHARES {
            let reads: Vec<f64> = of.col_iter().map(|response| response.transpose() * &weights).collect();
            aims = wanted.iter().zip(&reads).map(|((_, kind), read)| kind.nearest(*read)).collect();
            // What may read anything up to 1 keeps its share: it is aimed at what it reads.
            let is_exact = |pixel: &usize| wanted[*pixel].1 != Wanted::AtMostOne;
            let exact = || (0..wanted.len()).filter(is_exact);
            let before: f64 = exact().map(|pixel| shares[pixel]).sum();
            exact().for_each(|pixel| shares[pixel] *= (reads[pixel] - aims[pixel]).abs());
            let now: f64 = exact().map(|pixel| shares[pixel]).sum();
            exact().for_each(|pixel| shares[pixel] *= before / now);
            weights = self.solved(&of, &aims, &shares)?;
        }
        let is_finite = weights.iter().all(|weight| weight.is_finite());
        is_finite.then_some(weights)
    }

    /// Weights by which responses `[measurement][pixel]` read what is aimed at, each with its share of the error.
    fn solved(&self, of: &Mat<f64>, aims: &[f64], shares: &[f64]) -> Option<Col<f64>> {
        let shared = Mat::from_fn(of.nrows(), of.ncols(), |m, p| of[(m, p)] * shares[p]);
        let system = &self.unwanted + &shared * of.transpose();
        Some(system.llt(Side::Lower).ok()?.solve(&shared * Col::from_fn(aims.len(), |p| aims[p])))
    }

    /// Pixels that a region shall not read.
    fn outside(&self, region: &[usize]) -> Vec<usize> {
        let centres = &self.model.pixels.centres;
        let is_far = |&pixel: &usize| {
            region.iter().all(|&inside| (centres[pixel] - centres[inside]).norm() > self.margin)
        };
        (0..centres.len()).filter(is_far).collect()
    }
}

/// What a row shall read of a press.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wanted {
    One,
    AtMostOne,
    Nothing,
}

impl Wanted {
    /// The nearest to what it reads.
    fn nearest(self, read: f64) -> f64 {
        match self {
            Self::One => 1.0,
            Self::AtMostOne => read.min(1.0),
            Self::Nothing => 0.0,
        }
    }
}

/// Standard deviations of difference data of one frame at 60 dB: `[measurement]`.
fn deviations(model: &Model) -> Vec<f64> {
    let deviation = deviation_at_60_db(model);
    model.relative_noise().iter().map(|noise| (deviation * noise).abs()).collect()
}

/// Pixels in so many cells about alike in size, as Lloyd's algorithm settles them; each begins where the others are far.
fn divided(pixels: &[usize], centres: &[Point3<f64>], cells: usize) -> Vec<Vec<usize>> {
    let nearest = |middles: &[Point3<f64>], pixel: usize| {
        let away = |middle: &Point3<f64>| (centres[pixel] - middle).norm();
        let distances = middles.iter().map(away).enumerate();
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).expect("there is a middle")
    };
    let mut middles = vec![centres[pixels[0]]];
    while middles.len() < cells.min(pixels.len()) {
        let away = |pixel: &&usize| nearest(&middles, **pixel).1;
        let farthest = pixels.iter().max_by(|a, b| away(a).total_cmp(&away(b))).expect("there is a pixel");
        middles.push(centres[*farthest]);
    }
    let assign = |middles: &[Point3<f64>]| {
        let mut cells = vec![Vec::new(); middles.len()];
        pixels.iter().for_each(|&pixel| cells[nearest(middles, pixel).0].push(pixel));
        cells
    };
    for _ in 0..ROUNDS_OF_CELLS {
        let mean = |(cell, middle): (&Vec<usize>, &Point3<f64>)| {
            let sum = cell.iter().fold(nalgebra::Vector3::zeros(), |sum, &pixel| sum + centres[pixel].coords);
            if cell.is_empty() { *middle } else { (sum / cell.len() as f64).into() }
        };
        middles = assign(&middles).iter().zip(&middles).map(mean).collect();
    }
    assign(&middles).into_iter().filter(|cell| !cell.is_empty()).collect()
}

/// How well the rules of a patch read loads on the skin of this model, whose rules they are: `[rule]`.
#[must_use]
pub fn reflex_reports(skin: &Skin, model: &Model, patch: &PatchView<'_>) -> Vec<ReflexReport> {
    let (responses, deviations, margin) = (responses(model), deviations(model), MARGIN * radius(model));
    let mut rows = patch.reflex_rows();
    let report = |(rule, reflex): (ReflexRule, &Reflex)| {
        let cells: Vec<_> = rows.by_ref().take(rule.rows.into()).collect();
        let weights: Vec<Col<f64>> =
            cells.iter().map(|row| Col::from_fn(deviations.len(), |m| row.weights.get(m).into())).collect();
        let read = |pixel: usize| {
            weights.iter().map(|row| row.transpose() * responses.col(pixel)).fold(f64::NEG_INFINITY, f64::max)
        };
        let beyond = |pixel: usize| reflex.region.beyond(&model.pixels.centres[pixel]);
        let pixels = 0..responses.ncols();
        let inside = pixels.clone().filter(|&pixel| beyond(pixel) <= 0.0).map(read);
        let outside = pixels.filter(|&pixel| beyond(pixel) > margin).map(read);
        let noise = |row: &Col<f64>| {
            let each =
                deviations.iter().zip(row.iter()).map(|(deviation, weight)| (deviation * weight).powi(2));
            each.sum::<f64>().sqrt()
        };
        let (limit, is_area) = match rule.limit {
            Limit::Strength(strength) => (strength, false),
            Limit::Force(newtons) => (strength_of(&patch.header, newtons), false),
            Limit::Area { area, .. } => (area, true),
        };
        ReflexReport {
            name: rule.name.to_string(),
            pin: rule.pin,
            limit: limit.into(),
            is_area,
            cells: cells.len(),
            largest_cell: cells.iter().map(|row| f64::from(row.area)).fold(0.0, f64::max),
            inside: [inside.clone().fold(f64::INFINITY, f64::min), inside.fold(f64::NEG_INFINITY, f64::max)],
            outside: outside.fold(0.0, f64::max),
            noise: weights.iter().map(noise).fold(0.0, f64::max),
        }
    };
    patch.reflex_rules().zip(&skin.reflexes).map(report).collect()
}

#[cfg(test)]
mod tests;

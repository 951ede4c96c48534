//! Responses: places where a board looks for a press, and what the measurements make of one there.
//!
//! The response to a press is linear: the Jacobian's columns, summed over the pixels under it. Places are chosen among the
//! pixels ([`super::choice`]).

use super::{PatchBuildError, choice::Candidates, exponents_of, rounded_rows};
use crate::{
    inverse::movement::Movement,
    jacobian::combine_voltages,
    metrics::detectability::passing,
    model::{Model, ModelError, forward_model},
    skin::Skin,
};
use dermatome_patch::places::FixedPlaces;
use dermatome_shared::patch::places::{DetectionLayout, MAX_PLACES};
use faer::{Col, Mat, Scale};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// Radius of the standard press, a share of the skin's size.
const RADIUS: f64 = 0.045;

pub(super) fn radius(model: &Model) -> f64 {
    RADIUS * model.pixels.larger_side()
}

/// An even change of the sheet of 10 % that makes more standard deviations of a frame at 60 dB is told from presses: after a
/// minute of that a skin with 14 had contacts that stayed, those with up to 5 none.
const LEAST_EVEN: f64 = 8.0;
/// Strain by which the response to a stretch is taken.
const STRAIN: f64 = 1e-3;
/// All ways to strain space: row and column of a symmetric tensor.
const STRAINS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
/// A way of stretching that changes voltages by less than this share of another's says nothing, as across a flat skin.
const LEAST_STRETCH: f64 = 1e-3;
/// Noise whose size is measured has longer tails than noise of known size: in 32 hours of frames at 40 dB 2.5 times as many
/// were false contacts as normal noise makes.
const TAILS: f64 = 4.0;
/// Fewest places that presses are found at.
pub(super) const FEWEST_PLACES: usize = 64;

/// Places and responses in fixed point, no more than there is room for, bytes; none where a skin has too few pixels.
pub(super) fn places(skin: &Skin, model: &Model, room: usize) -> Result<FixedPlaces, PatchBuildError> {
    let responses = responses(model);
    let noise = model.relative_noise();
    let smooth = smooth_responses(model);
    let even = even_response(model, &noise);
    let slips = slip_responses(skin, model)?;
    let layout = |places: usize| DetectionLayout {
        places: places as u16,
        smooth: (smooth.ncols() + usize::from(even.is_some())) as u8,
        slips: slips.ncols() as u8,
        radius: radius(model) as f32,
        averaging: skin.averaging() as f32,
        level: level(skin.false_alarms / (TAILS * 3600.0 * skin.drive.frame_rate * places as f64)) as f32,
    };
    let measurements = noise.len() as u16;
    let most = (0..=MAX_PLACES).rfind(|&places| layout(places).bytes(measurements) <= room).unwrap_or(0);
    if most < FEWEST_PLACES.min(model.pixels.count()) {
        return Err(PatchBuildError::FewPlaces { places: most });
    }
    let places = Candidates::new(&model.pixels, &responses, &noise).choose(most);
    if places.is_empty() {
        return Ok(FixedPlaces::default());
    }
    // So that the responses in units of the noise are alike in size, and so are the data that they meet.
    let column_exponents = exponents_of(noise.iter().map(|noise| -noise.abs().log2()));
    let rows = places.iter().map(|place| responses.col(place.pixel.into()));
    let known = smooth.col_iter().chain(even.iter().map(Col::as_ref)).chain(slips.col_iter());
    let (row_exponents, mantissas) = rounded_rows(rows.chain(known), &column_exponents)?;
    Ok(FixedPlaces::new(layout(places.len()), places, column_exponents, row_exponents, &mantissas))
}

/// Standard deviations that normal noise passes with this probability.
fn level(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 30.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if passing(middle) > probability { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// What the standard press on each pixel changes difference data by: `[measurement][pixel]`.
pub(super) fn responses(model: &Model) -> Mat<f64> {
    divided(model, model.pixels.presses(radius(model)).responses(&model.jacobian))
}

/// Changes of voltages become difference data: `[measurement][change]`.
fn divided(model: &Model, mut changes: Mat<f64>) -> Mat<f64> {
    for (m, divisor) in model.divisors().iter().enumerate() {
        changes.row_mut(m).iter_mut().for_each(|change| *change /= divisor);
    }
    changes
}

/// What smooth changes of the sheet change difference data by, `[measurement][change]`: those that grow along the skin's
/// longest axes, and with the squares and products of the two longest.
pub(super) fn smooth_responses(model: &Model) -> Mat<f64> {
    let centres = &model.pixels.centres;
    let middle =
        centres.iter().fold(Vector3::zeros(), |sum, centre| sum + centre.coords) / centres.len() as f64;
    let ways: Vec<Vector3<f64>> = centres.iter().map(|centre| centre.coords - middle).collect();
    let spread = ways.iter().fold(Matrix3::zeros(), |sum: Matrix3<f64>, way| sum + way * way.transpose());
    let eigen = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let longest = eigen.eigenvalues[order[0]];
    let deviations = (longest / centres.len() as f64).sqrt();
    let axes = order.map(|axis| eigen.eigenvectors.column(axis) / deviations);
    // A flat skin has no third one.
    let is_flat = eigen.eigenvalues[order[2]] < 1e-6 * longest;
    let changes = Mat::from_fn(centres.len(), if is_flat { 5 } else { 6 }, |pixel, change| {
        let [u, v, w] = [0, 1, 2].map(|axis| axes[axis].dot(&ways[pixel]));
        [u, v, u * u, u * v, v * v, w][change]
    });
    divided(model, &model.jacobian * &changes)
}

/// What an even change of the sheet changes difference data by beside what is common to all voltages, `[measurement]`, as
/// contacts keep their impedances; none where that is little.
pub(super) fn even_response(model: &Model, noise: &[f64]) -> Option<Col<f64>> {
    let voltages = model.measurements();
    let ones = Mat::full(model.pixels.count(), 1, 1.0);
    let even = divided(model, &model.jacobian * ones);
    // In units of the noise, as whatever both have in common is by that.
    let mut even = Col::from_fn(noise.len(), |m| even[(m, 0)] / noise[m]);
    let common = Col::from_fn(noise.len(), |m| voltages[m] / model.divisors()[m] / noise[m]);
    even -= Scale(common.transpose() * &even / common.squared_norm_l2()) * &common;
    let deviation = deviation_at_60_db(model);
    (0.1 * even.norm_l2() > LEAST_EVEN * deviation).then(|| Col::from_fn(noise.len(), |m| even[m] * noise[m]))
}

/// Standard deviation of noise on a voltage at 60 dB of their root mean square.
pub(super) fn deviation_at_60_db(model: &Model) -> f64 {
    let voltages = model.measurements();
    1e-3 * (voltages.iter().map(|v| v * v).sum::<f64>() / voltages.len() as f64).sqrt()
}

/// What the slip of each electrode changes difference data by, `[measurement][electrode]`, where all are on the rim. Those
/// inside move two ways, which are more than there is room for: there it is what a stretch of the whole skin does, which
/// moves them all, `[measurement][way]`.
pub(super) fn slip_responses(skin: &Skin, model: &Model) -> Result<Mat<f64>, ModelError> {
    let changes = match &model.movement {
        Some(Movement { responses, is_on_rim: true }) => responses.clone(),
        _ => stretch_responses(skin, model)?,
    };
    Ok(divided(model, changes))
}

/// What a stretch of the whole skin changes voltages by, for each strain of space that changes them: `[measurement][way]`.
fn stretch_responses(skin: &Skin, model: &Model) -> Result<Mat<f64>, ModelError> {
    let of_strain = |(i, j): (usize, usize)| -> Result<Col<f64>, ModelError> {
        let mut strain = Matrix3::zeros();
        (strain[(i, j)], strain[(j, i)]) = (STRAIN, STRAIN);
        let [longer, shorter] = [strained(skin, model, &strain)?, strained(skin, model, &-strain)?];
        Ok((longer - shorter) * Scale(0.5 / STRAIN))
    };
    let responses: Vec<Col<f64>> = STRAINS.into_par_iter().map(of_strain).collect::<Result<_, _>>()?;
    let most = responses.iter().map(Col::norm_l2).fold(0.0, f64::max);
    let known: Vec<&Col<f64>> = responses.iter().filter(|one| one.norm_l2() > LEAST_STRETCH * most).collect();
    Ok(Mat::from_fn(model.jacobian.nrows(), known.len(), |m, way| known[way][m]))
}

/// Voltages of the skin under this strain, as conductivity per square stays: `[measurement]`.
fn strained(skin: &Skin, model: &Model, strain: &Matrix3<f64>) -> Result<Col<f64>, ModelError> {
    let mut mesh = model.mesh.clone();
    mesh.nodes.iter_mut().for_each(|node| *node += strain * node.coords);
    let conductivity = vec![skin.admittivity().re; mesh.elements.len()];
    let fields = forward_model::<f64>(skin, &mesh)?.solve(&conductivity)?;
    Ok(combine_voltages(&fields.voltages(&model.steps), &model.combination).into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantize;
    use dermatome_shared::patch::PatchView;
    use std::path::Path;

    #[test]
    fn places_are_as_many_as_there_is_room_for_and_too_few_are_refused() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/square-50mm/skin.toml");
        let skin = Skin::load(&file).unwrap().made().unwrap();
        let model = Model::build(&skin, |_| ()).unwrap();
        let in_room = |room| places(&skin, &model, room).map(|places| places.layout());
        let measurements = model.jacobian.nrows() as u16;
        for count in [64, 100, 256] {
            let layout = in_room(usize::MAX).unwrap();
            let room = DetectionLayout { places: count, ..layout }.bytes(measurements);
            assert_eq!(in_room(room).unwrap().places, count);
        }
        let Err(PatchBuildError::FewPlaces { places: 0 }) = in_room(1000) else { panic!("there is no room") };
    }

    #[test]
    fn a_stretch_of_a_skin_with_electrodes_inside_is_a_sum_of_known_ones_and_a_flat_skin_has_three() {
        let text = include_str!("../../../../models/hemisphere-210mm-designed/skin.toml");
        let skin = Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap();
        let model = Model::build(&skin, |_| ()).unwrap();
        let known = stretch_responses(&skin, &model).unwrap();
        assert_eq!((known.nrows(), known.ncols()), (model.jacobian.nrows(), 6));
        let along = Vector3::new(0.6, -0.7, 0.4).normalize();
        let strain = 0.01 * along * along.transpose();
        let none = strained(&skin, &model, &Matrix3::zeros()).unwrap();
        let mut left = strained(&skin, &model, &strain).unwrap() - none;
        let all = left.norm_l2();
        for (way, at) in STRAINS.into_iter().enumerate() {
            left -= Scale(strain[at]) * known.col(way);
        }
        // What is left is of second order.
        assert!(left.norm_l2() < 0.05 * all, "{} of {all}", left.norm_l2());

        let disc = include_str!("../../../../models/disc-210mm/skin.toml");
        let disc = Skin::parse(Path::new("skin.toml"), disc).unwrap().made().unwrap();
        let flat = Model::build(&disc, |_| ()).unwrap();
        assert_eq!(stretch_responses(&disc, &flat).unwrap().ncols(), 3);
    }

    #[test]
    fn where_the_image_takes_the_room_of_places_it_is_known_how_many_pixels_leave_it() {
        let skin = include_str!("../../../../models/hemisphere-210mm-designed/skin.toml");
        let patch_of = |pixels: usize| {
            let text = skin.replace("\npixels = 700 ", &format!("\npixels = {pixels} "));
            let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
            quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap()
        };
        let judge = |patch: &[u8]| {
            let view = PatchView::validate(patch).unwrap();
            (view.header.detection.places, quantize::pixels_for_all_places(&view))
        };
        let (places, pixels) = judge(&patch_of(800));
        let pixels = pixels.unwrap();
        assert!(places < 200 && (650..750).contains(&pixels), "{places} {pixels}");
        let (places, _) = judge(&patch_of(pixels));
        assert!(places >= 230, "{places}");
    }

    #[test]
    fn levels_are_those_of_the_tables_of_the_normal_distribution() {
        for (probability, expected) in [(0.5, 0.0), (0.0227501, 2.0), (2.866516e-7, 5.0), (9.8659e-10, 6.0)] {
            assert!((level(probability) - expected).abs() < 1e-4, "{probability}: {}", level(probability));
        }
    }
}

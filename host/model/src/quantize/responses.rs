//! Responses: places where a board looks for a press, and what the measurements make of one there.
//!
//! The response to a press is linear: the Jacobian's columns, summed over the pixels under it. Places are chosen among the
//! pixels, each where the places before explain a press least, so that they lie closest where presses are easiest told
//! apart, near the electrodes.

use super::{PatchBuildError, exponents_of, rounded_rows};
use crate::{metrics::detectability::LEVEL, model::Model};
use dermatome_patch::places::FixedPlaces;
use dermatome_shared::patch::places::{DetectionLayout, MAX_PLACES, PLACE_NEIGHBOURS, Place};
use faer::Mat;
use nalgebra::{Point3, Vector3};

/// Radius of the standard press, a share of the skin's size.
const RADIUS: f64 = 0.045;

fn radius(model: &Model) -> f64 {
    RADIUS * model.pixels.larger_side()
}

/// Places and responses in fixed point; none where a skin has too few pixels.
pub(super) fn places(model: &Model) -> Result<FixedPlaces, PatchBuildError> {
    let responses = responses(model);
    let noise = model.relative_noise();
    let chosen = choose(&responses, &noise);
    if chosen.len() <= PLACE_NEIGHBOURS {
        return Ok(FixedPlaces::default());
    }
    let centres: Vec<_> = chosen.iter().map(|&pixel| model.pixels.centres[pixel]).collect();
    let place = |place: usize| Place {
        pixel: chosen[place] as u16,
        neighbours: round(&centres, &model.pixels.normals[chosen[place]], place),
    };
    // So that the responses in units of the noise are alike in size, and so are the data that they meet.
    let column_exponents = exponents_of(noise.iter().map(|noise| -noise.abs().log2()));
    let rows = chosen.iter().map(|&pixel| responses.col(pixel));
    let (row_exponents, mantissas) = rounded_rows(rows, &column_exponents)?;
    let layout = DetectionLayout { places: 0, level: LEVEL, radius: radius(model) as f32 };
    let places = (0..chosen.len()).map(place).collect();
    Ok(FixedPlaces::new(layout, places, column_exponents, row_exponents, &mantissas))
}

/// What the standard press on each pixel changes difference data by: `[measurement][pixel]`.
fn responses(model: &Model) -> Mat<f64> {
    let mut responses = model.pixels.presses(radius(model)).responses(&model.jacobian);
    for (m, divisor) in model.divisors().iter().enumerate() {
        responses.row_mut(m).iter_mut().for_each(|response| *response /= divisor);
    }
    responses
}

/// Pixels whose responses are told apart best against this noise, `[measurement]`.
fn choose(responses: &Mat<f64>, noise: &[f64]) -> Vec<usize> {
    let whitened =
        Mat::from_fn(responses.nrows(), responses.ncols(), |m, press| responses[(m, press)] / noise[m].abs());
    let sizes: Vec<f64> = whitened.col_iter().map(|column| column.norm_l2()).collect();
    let count = sizes.len();
    let Some(mut next) = (0..count).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b])) else { return Vec::new() };
    // How much of each press the places explain.
    let mut explained = vec![0.0_f64; count];
    let mut chosen = Vec::new();
    while chosen.len() < MAX_PLACES.min(count) && sizes[next] > 0.0 {
        chosen.push(next);
        explained[next] = f64::INFINITY;
        let alike = whitened.transpose() * whitened.col(next);
        for (press, explained) in explained.iter_mut().enumerate() {
            *explained = explained.max(alike[press] / (sizes[press] * sizes[next]));
        }
        next = (0..count).min_by(|&a, &b| explained[a].total_cmp(&explained[b])).expect("there are presses");
        if explained[next].is_infinite() {
            break;
        }
    }
    chosen
}

/// The places round one: the closest in each sixth of a turn, then the closest of all the others.
fn round(centres: &[Point3<f64>], normal: &Vector3<f64>, place: usize) -> [u8; PLACE_NEIGHBOURS] {
    let aside = if normal.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let axis = (aside - normal * normal.dot(&aside)).normalize();
    let other_axis = normal.cross(&axis);
    let mut others: Vec<usize> = (0..centres.len()).filter(|&other| other != place).collect();
    let away = |other: &usize| (centres[*other] - centres[place]).norm_squared();
    others.sort_by(|a, b| away(a).total_cmp(&away(b)));
    let sector = |other: usize| {
        let way = centres[other] - centres[place];
        let turn = way.dot(&other_axis).atan2(way.dot(&axis)) / std::f64::consts::TAU + 0.5;
        (turn * PLACE_NEIGHBOURS as f64) as usize % PLACE_NEIGHBOURS
    };
    let mut round: Vec<usize> = (0..PLACE_NEIGHBOURS)
        .filter_map(|wanted| others.iter().copied().find(|&other| sector(other) == wanted))
        .filter(|other| away(other) <= 9.0 * away(&others[0]).max(away(&others[PLACE_NEIGHBOURS - 1])))
        .collect();
    let more: Vec<usize> = others.into_iter().filter(|other| !round.contains(other)).collect();
    round.extend(more.into_iter().take(PLACE_NEIGHBOURS - round.len()));
    std::array::from_fn(|n| round[n] as u8)
}

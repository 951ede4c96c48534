//! Shares: how the response to a press round a place is made of those at the place and at its neighbours.
//!
//! A board knows responses at places only. Between them it takes the response to a press at an offset (x, y) from a place as
//! a sum of the place's own row and its neighbours', in which each row's share is a polynomial of second order. The
//! polynomials are those that explain the responses on the pixels round the place best, by least squares in units of the
//! noise.

use crate::pixels::{Pixels, tangents};
use dermatome_shared::patch::places::{PLACE_NEIGHBOURS, PLACE_ROWS, Place, SHARE_TERMS, SHARE_UNIT};
use faer::{Mat, Side, linalg::solvers::Solve};
use nalgebra::{Matrix3, Point3, Vector2, Vector3};
use rayon::prelude::*;

/// Shares of a place's own row and of its neighbours', [`SHARE_UNIT`]s: `[row][term]`.
type Shares = [[i8; SHARE_TERMS]; PLACE_ROWS];

/// Pixels count for `exp(-(d² - n²) / NEAR²)`, d being how far they are from the place and n from the nearest one, in mean
/// distances of its neighbours: those that are nearest to another place are fitted there.
const NEAR: f64 = 0.5;
/// Those farther than this do not count.
const FARTHEST: f64 = 1.6;
/// Price of squares of shares, so that rows that are nearly dependent have no large ones: of the place's squares.
const PRICE: f64 = 1e-4;

/// Places chosen among the pixels, and what they are made of.
pub(super) struct Rounds<'a> {
    pixels: &'a Pixels,
    /// `a' S^-1 b` of the responses to presses on each two pixels.
    products: &'a Mat<f64>,
    /// Pixels.
    places: &'a [usize],
    /// The places round each.
    neighbours: Vec<[usize; PLACE_NEIGHBOURS]>,
    /// Square of the distance from each pixel to the place nearest to it.
    nearest: Vec<f64>,
}

impl<'a> Rounds<'a> {
    /// Of more places than [`PLACE_NEIGHBOURS`].
    pub(super) fn new(pixels: &'a Pixels, products: &'a Mat<f64>, places: &'a [usize]) -> Self {
        let centres: Vec<Point3<f64>> = places.iter().map(|&place| pixels.centres[place]).collect();
        let round = |place: usize| round(&centres, &pixels.normals[places[place]], place);
        let neighbours = (0..places.len()).into_par_iter().map(round).collect();
        let to_nearest = |at: &Point3<f64>| {
            centres.iter().map(|centre| (centre - at).norm_squared()).fold(f64::INFINITY, f64::min)
        };
        let nearest = pixels.centres.par_iter().map(to_nearest).collect();
        Self { pixels, products, places, neighbours, nearest }
    }

    /// The places with shares, in order.
    pub(super) fn places(&self) -> Vec<Place> {
        let place = |place: usize| Place {
            pixel: self.places[place] as u16,
            neighbours: self.neighbours[place].map(|neighbour| neighbour as u8),
            shares: self.shares(place),
        };
        (0..self.places.len()).into_par_iter().map(place).collect()
    }

    /// The pixels whose rows the response round a place is made of.
    fn rows(&self, place: usize) -> [usize; PLACE_ROWS] {
        let round = &self.neighbours[place];
        std::array::from_fn(|row| self.places[row.checked_sub(1).map_or(place, |neighbour| round[neighbour])])
    }

    fn shares(&self, place: usize) -> Shares {
        let rows = self.rows(place);
        let [centre, first, ..] = rows.map(|row| self.pixels.centres[row]);
        let axes = axes(&self.pixels.normals[rows[0]], &(first - centre));
        let along = |pixel: usize| axes.map(|axis| axis.dot(&(self.pixels.centres[pixel] - centre)));
        let lengths = rows[1..].iter().map(|&row| Vector2::from(along(row)).norm());
        let spacing = lengths.sum::<f64>() / PLACE_NEIGHBOURS as f64;
        let square = self.products[(rows[0], rows[0])];
        // Normal equations of the shares, `[row and term]`.
        let count = PLACE_ROWS * SHARE_TERMS;
        let (mut matrix, mut right) = (Mat::<f64>::zeros(count, count), Mat::<f64>::zeros(count, 1));
        for (pixel, at) in self.pixels.centres.iter().enumerate() {
            let away = (at - centre).norm_squared() / spacing.powi(2);
            if pixel == rows[0] || away > FARTHEST.powi(2) {
                continue;
            }
            let weight = ((self.nearest[pixel] / spacing.powi(2) - away) / NEAR.powi(2)).exp() / square;
            let terms = terms(along(pixel).map(|part| part / spacing));
            for one in 0..count {
                let (row, term) = (rows[one / SHARE_TERMS], terms[one % SHARE_TERMS]);
                let more = self.products[(row, pixel)] - self.products[(row, rows[0])];
                right[(one, 0)] += weight * term * more;
                for other in 0..=one {
                    let (of_other, other_term) = (rows[other / SHARE_TERMS], terms[other % SHARE_TERMS]);
                    matrix[(one, other)] += weight * term * other_term * self.products[(row, of_other)];
                }
            }
        }
        for one in 0..count {
            matrix[(one, one)] += PRICE;
        }
        // With the price it is positive definite.
        let Ok(factor) = matrix.llt(Side::Lower) else { return Shares::default() };
        let found = factor.solve(&right);
        let share = |one: usize| (found[(one, 0)] / f64::from(SHARE_UNIT)).round().clamp(-127.0, 127.0) as i8;
        std::array::from_fn(|row| std::array::from_fn(|term| share(SHARE_TERMS * row + term)))
    }

    /// By how much more the variance of a press' strength at a place is as its place is not known.
    pub(super) fn inflation(&self, place: &Place, at: usize) -> f64 {
        let rows = self.rows(at);
        let of_slope = |row: usize, term: usize| f64::from(place.shares[row][term]) * f64::from(SHARE_UNIT);
        let columns: [_; PLACE_ROWS] = std::array::from_fn(|row| {
            Vector3::new(if row == 0 { 1.0 } else { 0.0 }, of_slope(row, 0), of_slope(row, 1))
        });
        let mut matrix = Matrix3::zeros();
        for (one, of_one) in rows.iter().zip(&columns) {
            for (other, of_other) in rows.iter().zip(&columns) {
                matrix += self.products[(*one, *other)] * of_one * of_other.transpose();
            }
        }
        matrix.try_inverse().map_or(f64::INFINITY, |inverse| inverse.m11 * matrix.m11)
    }
}

/// What a share's terms are at an offset, as `Spot` in `shared` has them.
fn terms([x, y]: [f64; 2]) -> [f64; SHARE_TERMS] {
    [x, y, x * x / 2.0, x * y, y * y / 2.0]
}

/// Two unit vectors at right angles to each other and to a normal, the first of them as a way goes, as `Spot` in `shared` has
/// them.
fn axes(normal: &Vector3<f64>, way: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let along = (way - normal * normal.dot(way)).normalize();
    [along, normal.cross(&along)]
}

/// The places round one: the closest in each sixth of a turn, then the closest of all the others.
fn round(centres: &[Point3<f64>], normal: &Vector3<f64>, place: usize) -> [usize; PLACE_NEIGHBOURS] {
    let [axis, other_axis] = tangents(normal);
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
    std::array::from_fn(|n| round[n])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{model::Model, quantize::responses::responses, skin::Skin};
    use std::path::Path;

    fn square() -> Model {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models/square-50mm/skin.toml");
        Model::build(&Skin::load(&file).unwrap().made().unwrap(), |_| ()).unwrap()
    }

    /// A share of the squares of each response that is left of it, by how it is made of the rows of the place nearest to it,
    /// with shares or with the place's own row only: `[pixel]`.
    fn left(model: &Model, responses: &Mat<f64>, has_shares: bool) -> Vec<f64> {
        let products = responses.transpose() * responses;
        let places: Vec<usize> = (0..model.pixels.count()).step_by(3).collect();
        let rounds = Rounds::new(&model.pixels, &products, &places);
        let made = rounds.places();
        let centres = &model.pixels.centres;
        let of_pixel = |pixel: usize| {
            let away = |place: &usize| (centres[places[*place]] - centres[pixel]).norm_squared();
            let nearest = (0..places.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap();
            let rows = rounds.rows(nearest);
            let way = |to: usize| centres[to] - centres[rows[0]];
            let axes = axes(&model.pixels.normals[rows[0]], &way(rows[1]));
            let spacing = rows[1..].iter().map(|&row| way(row).norm()).sum::<f64>() / PLACE_NEIGHBOURS as f64;
            let terms = terms(axes.map(|axis| axis.dot(&way(pixel)) / spacing));
            let mut rest = responses.col(pixel) - responses.col(rows[0]);
            for (row, shares) in rows.iter().zip(made[nearest].shares).filter(|_| has_shares) {
                let share: f64 = terms.iter().zip(shares).map(|(term, share)| term * f64::from(share)).sum();
                rest -= faer::Scale(share * f64::from(SHARE_UNIT)) * responses.col(*row);
            }
            rest.squared_norm_l2() / responses.col(pixel).squared_norm_l2()
        };
        (0..model.pixels.count()).map(of_pixel).collect()
    }

    #[test]
    fn responses_that_bend_as_shares_do_are_made_of_the_rows_round_a_place() {
        let model = square();
        let responses = Mat::from_fn(6, model.pixels.count(), |m, press| {
            let [x, y] =
                [model.pixels.centres[press].x, model.pixels.centres[press].y].map(|part| part / 0.01);
            [1.0, x, y, x * x, x * y, y * y][m]
        });
        let most = |has_shares| left(&model, &responses, has_shares).into_iter().fold(0.0, f64::max);
        let [with, without] = [true, false].map(most);
        // Shares are rounded.
        assert!(with < 2e-3 && with < 0.05 * without, "{with} {without}");
    }

    #[test]
    fn shares_leave_hardly_anything_of_a_press_between_places() {
        let model = square();
        let noise = model.relative_noise();
        let mut responses = responses(&model);
        for (m, noise) in noise.iter().enumerate() {
            responses.row_mut(m).iter_mut().for_each(|response| *response /= noise);
        }
        let mean = |has_shares| {
            let left = left(&model, &responses, has_shares);
            left.iter().sum::<f64>() / left.len() as f64
        };
        let [with, without] = [true, false].map(mean);
        assert!(with < 0.02, "{with}");
        assert!(with < 0.1 * without, "{with} {without}");
    }
}

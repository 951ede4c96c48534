//! Choice: the pixels that are the places where a board looks for a press.
//!
//! Between places a board takes the response to a press to change linearly, as the places round the nearest one have it
//! (`spot` in `shared`), so that it is wrong there about where a press is, how strong it is and what it leaves of the data.
//! The first places lie each where those before are least like a press, so that they are closest where presses are easiest
//! told apart, near the electrodes; the others each where the board would be most wrong. On skins that are deaf somewhere all
//! are chosen as the first ones.

use crate::pixels::{Pixels, tangents};
use dermatome_shared::patch::places::PLACE_NEIGHBOURS;
use faer::Mat;
use nalgebra::{Matrix2, Matrix3, Point3, Vector2, Vector3};
use rayon::prelude::*;
use std::iter;

/// So many places are chosen by likeness. With 208 or fewer a finger held through a drift left a contact on a hemisphere with
/// electrodes inside, and a moving one lost its number; with all of them fingers at the rim of a disc were 1.7 to 2.3 % of the
/// size off, not 1.2 to 1.6.
const BY_LIKENESS: usize = 240;
/// A skin is deaf where a press changes the voltages by less than this share of what the loudest does, by squares: those with
/// electrodes all over or round a flat sheet have 0.001 and more, hemispheres with electrodes on the rim 0.0002. There it
/// would be most wrong where little is told from noise: a finger that slides was one contact in 69 to 98 % of frames with 128
/// places by that, in 74 to 99 without.
const DEAF: f64 = 0.0005;
/// Errors that count alike: of the place, share of the skin's size, of the strength, and of the squares of the response that
/// are not explained.
const OFF: f64 = 0.01;
const STRONGER: f64 = 0.05;
const LEFT: f64 = 0.01;

/// Presses on all pixels of a skin.
pub(super) struct Candidates<'a> {
    pixels: &'a Pixels,
    /// `a' S^-1 b` of each two responses: `[pixel][pixel]`.
    products: Mat<f64>,
}

impl<'a> Candidates<'a> {
    /// Of responses `[measurement][pixel]` and noise `[measurement]`.
    pub(super) fn new(pixels: &'a Pixels, responses: &Mat<f64>, noise: &[f64]) -> Self {
        let whitened = Mat::from_fn(responses.nrows(), responses.ncols(), |m, press| {
            responses[(m, press)] / noise[m].abs()
        });
        Self { pixels, products: whitened.transpose() * &whitened }
    }

    /// At most so many pixels.
    pub(super) fn choose(&self, most: usize) -> Vec<usize> {
        let answering: Vec<usize> =
            (0..self.products.ncols()).filter(|&press| self.square(press) > 0.0).collect();
        let most = most.min(answering.len());
        let squares = answering.iter().map(|&press| self.square(press));
        let loudest = squares.clone().fold(0.0, f64::max);
        let is_deaf = squares.fold(f64::INFINITY, f64::min) < DEAF * loudest;
        let mut chosen = self.least_alike(&answering, if is_deaf { most } else { BY_LIKENESS.min(most) });
        while chosen.len() < most {
            let wrong = self.wrong(&answering, &chosen);
            let others = answering.iter().zip(wrong).filter(|(press, _)| !chosen.contains(press));
            chosen.extend(others.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(press, _)| *press));
        }
        chosen
    }

    fn square(&self, press: usize) -> f64 {
        self.products[(press, press)]
    }

    /// So many presses, each that which those before resemble least, from the loudest on.
    fn least_alike(&self, presses: &[usize], count: usize) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        // How much the most alike of the chosen ones explain of each.
        let mut explained: Vec<f64> = presses.iter().map(|&press| -self.square(press)).collect();
        while chosen.len() < count {
            let least = (0..presses.len()).min_by(|&a, &b| explained[a].total_cmp(&explained[b]));
            let Some(next) = least else { break };
            if chosen.is_empty() {
                explained.fill(0.0);
            }
            chosen.push(presses[next]);
            for (&press, explained) in presses.iter().zip(&mut explained) {
                let squares = self.square(press) * self.square(presses[next]);
                *explained = explained.max(self.products[(press, presses[next])] / squares.sqrt());
            }
            explained[next] = f64::INFINITY;
        }
        chosen
    }

    /// How wrong the board would be about each press with these places, in squares of the errors that count alike.
    fn wrong(&self, presses: &[usize], places: &[usize]) -> Vec<f64> {
        let centres: Vec<Point3<f64>> = places.iter().map(|&place| self.pixels.centres[place]).collect();
        let spots: Vec<Spot> = (0..places.len())
            .into_par_iter()
            .map(|place| Spot::new(&centres, &self.pixels.normals[places[place]], place))
            .collect();
        let fits: Vec<Fit> = spots.par_iter().map(|spot| self.fit_at(spot, places)).collect();
        let wrong = |&press: &usize| {
            let at = self.pixels.centres[press];
            let away = |place: &usize| (centres[*place] - at).norm_squared();
            let nearest = (0..centres.len()).min_by(|a, b| away(a).total_cmp(&away(b)));
            let nearest = nearest.expect("there are places");
            self.wrong_from(&spots[nearest], &fits[nearest], press, &(at - centres[nearest]))
        };
        presses.par_iter().map(wrong).collect()
    }

    /// The normal equations of a press at a spot of these places.
    fn fit_at(&self, spot: &Spot, places: &[usize]) -> Fit {
        let columns: Vec<_> =
            spot.columns().into_iter().map(|(place, shares)| (places[place], shares)).collect();
        let mut matrix = Matrix3::zeros();
        for (one, of_one) in &columns {
            for (other, of_other) in &columns {
                matrix += self.products[(*one, *other)] * of_one * of_other.transpose();
            }
        }
        Fit { columns, inverse: matrix.try_inverse() }
    }

    /// How wrong the board would be, at this spot, about a press that is so far from it.
    fn wrong_from(&self, spot: &Spot, fit: &Fit, press: usize, way: &Vector3<f64>) -> f64 {
        // Where slopes cannot be told apart the board has no fit, and another place near does not give it one.
        let Some(inverse) = fit.inverse else { return 0.0 };
        let right: Vector3<f64> =
            fit.columns.iter().map(|(place, shares)| self.products[(*place, press)] * shares).sum();
        let found = inverse * right;
        let left = 1.0 - found.dot(&right) / self.square(press);
        let off = (spot.within_reach(found.yz() / found.x) - along(&spot.axes, way)).norm();
        (off / (OFF * self.pixels.larger_side())).powi(2)
            + ((found.x - 1.0) / STRONGER).powi(2)
            + left.max(0.0) / LEFT
    }
}

/// What a press at a spot is fitted by.
struct Fit {
    /// Places with what their responses have of response and slopes.
    columns: Vec<(usize, Vector3<f64>)>,
    /// Inverse of the normal matrix, if there is one.
    inverse: Option<Matrix3<f64>>,
}

/// How the response changes round a place, by those at the places round it.
struct Spot {
    place: usize,
    axes: [Vector3<f64>; 2],
    /// Mean distance of the places round it, m: presses go no farther from it.
    spacing: f64,
    /// What the response at each place round it adds to the slopes, 1/m. The place's own takes as much off.
    round: [(usize, Vector2<f64>); PLACE_NEIGHBOURS],
}

impl Spot {
    /// Least squares, near places counting for more, as `Spot::new` in `shared` has it.
    fn new(centres: &[Point3<f64>], normal: &Vector3<f64>, place: usize) -> Self {
        let axes = tangents(normal);
        let neighbours = round(centres, normal, place);
        let ways = neighbours.map(|other| along(&axes, &(centres[other] - centres[place])));
        let spacing = ways.iter().map(Vector2::norm).sum::<f64>() / ways.len() as f64;
        let weighted = ways.map(|way| way / (way.norm_squared() + 0.1 * spacing * spacing));
        let matrix: Matrix2<f64> =
            ways.iter().zip(&weighted).map(|(way, weighted)| weighted * way.transpose()).sum();
        let is_wide = matrix.determinant() > 1e-3 * matrix.m11 * matrix.m22;
        let inverse = matrix.try_inverse().filter(|_| is_wide).unwrap_or_default();
        Self { place, axes, spacing, round: std::array::from_fn(|n| (neighbours[n], inverse * weighted[n])) }
    }

    /// An offset, no longer than slopes hold for, m.
    fn within_reach(&self, offset: Vector2<f64>) -> Vector2<f64> {
        offset * (self.spacing / offset.norm()).min(1.0)
    }

    /// Places with what their responses have of the response here and of its slopes.
    fn columns(&self) -> Vec<(usize, Vector3<f64>)> {
        let slopes: Vector2<f64> = self.round.iter().map(|(_, shares)| shares).sum();
        let own = (self.place, Vector3::new(1.0, -slopes.x, -slopes.y));
        let others = self.round.iter().map(|(other, shares)| (*other, Vector3::new(0.0, shares.x, shares.y)));
        iter::once(own).chain(others).collect()
    }
}

/// A way along axes, m.
fn along(axes: &[Vector3<f64>; 2], way: &Vector3<f64>) -> Vector2<f64> {
    Vector2::from(axes.map(|axis| axis.dot(way)))
}

/// The places round one: the closest in each sixth of a turn, then the closest of all the others.
pub(super) fn round(
    centres: &[Point3<f64>],
    normal: &Vector3<f64>,
    place: usize,
) -> [usize; PLACE_NEIGHBOURS] {
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

    #[test]
    fn nothing_is_wrong_where_responses_are_linear_in_the_place_and_much_where_they_bend() {
        let Model { pixels, .. } = square();
        let all: Vec<usize> = (0..pixels.count()).collect();
        let places: Vec<usize> = all.iter().copied().step_by(3).collect();
        let most_wrong = |bend: f64| {
            let responses = Mat::from_fn(4, pixels.count(), |m, press| {
                let [x, y] = [pixels.centres[press].x, pixels.centres[press].y].map(|part| part / 0.05);
                [1.0, x, y, bend * x * x][m]
            });
            let candidates = Candidates::new(&pixels, &responses, &[1.0; 4]);
            candidates.wrong(&all, &places).into_iter().fold(0.0, f64::max)
        };
        assert!(most_wrong(0.0) < 1e-9, "{}", most_wrong(0.0));
        assert!(most_wrong(3.0) > 0.01, "{}", most_wrong(3.0));
    }

    #[test]
    fn places_differ_and_the_board_is_less_wrong_than_with_those_that_are_least_alike() {
        let model = square();
        let candidates = Candidates::new(&model.pixels, &responses(&model), &model.relative_noise());
        let all: Vec<usize> = (0..model.pixels.count()).collect();
        let chosen = candidates.choose(256);
        let mut places = chosen.clone();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 256);
        let mean = |places: &[usize]| candidates.wrong(&all, places).iter().sum::<f64>() / all.len() as f64;
        let [least_alike, chosen] = [candidates.least_alike(&all, 256), chosen].map(|places| mean(&places));
        assert!(chosen < least_alike / 4.0, "{chosen}, {least_alike}");
        assert_eq!(candidates.choose(usize::MAX).len(), model.pixels.count());
    }

    #[test]
    fn on_a_skin_that_is_deaf_somewhere_places_are_chosen_by_likeness() {
        let Model { pixels, .. } = square();
        let all: Vec<usize> = (0..pixels.count()).collect();
        let chosen_by_likeness = |quietest: f64| {
            let responses = Mat::from_fn(4, pixels.count(), |m, press| {
                let [x, y] = [pixels.centres[press].x, pixels.centres[press].y].map(|part| part / 0.05);
                [1.0, x, y, 3.0 * x * x][m] * if press == 0 { quietest } else { 1.0 }
            });
            let candidates = Candidates::new(&pixels, &responses, &[1.0; 4]);
            candidates.choose(256) == candidates.least_alike(&all, 256)
        };
        assert!(chosen_by_likeness(0.01));
        assert!(!chosen_by_likeness(0.5));
    }
}

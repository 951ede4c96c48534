//! Choice: the pixels that are the places where a board looks for a press.
//!
//! Between places a board takes the response to a press to change linearly, as the places round the nearest one have it
//! (`spot` in `shared`). The first places lie each where those before are least like a press, so that they are closest where
//! presses are easiest told apart, near the electrodes; the others each where the board would miss most. On skins that are
//! deaf somewhere all are chosen as the first ones.

use crate::pixels::{Pixels, tangents};
use dermatome_shared::patch::places::PLACE_NEIGHBOURS;
use faer::Mat;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// So many places are chosen by likeness. With 128 a finger was 5 % of the size off at some places, and loads by 1 % more;
/// with all of them fingers at the rim of flat skins were twice as far off.
const BY_LIKENESS: usize = 200;
/// A skin is deaf where a press changes the voltages by less than this share of what the loudest does, by squares: those with
/// electrodes all over or round a flat sheet have 0.001 and more, hemispheres with electrodes on the rim 0.0002. There a
/// finger that slides was one contact in 75 to 81 % of frames if places were chosen by what is missed, in 86 to 99 if not.
const DEAF: f64 = 0.0005;
/// What is missed counts by its square over this power of the square of the response: neither for its size alone, which is
/// largest at the electrodes, nor for its share alone.
const SHARE: f64 = 0.75;

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
            let missed = self.missed(&answering, &chosen);
            let others = answering.iter().zip(missed).filter(|(press, _)| !chosen.contains(press));
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

    /// How much the board would miss of each press with these places.
    fn missed(&self, presses: &[usize], places: &[usize]) -> Vec<f64> {
        let Pixels { centres, normals, .. } = self.pixels;
        let at: Vec<Point3<f64>> = places.iter().map(|&place| centres[place]).collect();
        let slopes: Vec<Slopes> = (0..places.len())
            .into_par_iter()
            .map(|place| Slopes::new(&at, &normals[places[place]], place))
            .collect();
        let missed = |&press: &usize| {
            let away = |place: &usize| (at[*place] - centres[press]).norm_squared();
            let nearest = (0..at.len()).min_by(|a, b| away(a).total_cmp(&away(b))).expect("there are places");
            let shares = slopes[nearest].shares(nearest, &(centres[press] - at[nearest]));
            let with = |a: usize, b: usize| self.products[(a, b)];
            let of_both: f64 = shares.iter().map(|&(place, share)| share * with(places[place], press)).sum();
            let of_board: f64 = shares
                .iter()
                .flat_map(|a| shares.iter().map(move |b| (a, b)))
                .map(|((a, of_a), (b, of_b))| of_a * of_b * with(places[*a], places[*b]))
                .sum();
            (self.square(press) - 2.0 * of_both + of_board) / self.square(press).powf(SHARE)
        };
        presses.par_iter().map(missed).collect()
    }
}

/// How the response changes round a place, by those at the places round it.
struct Slopes {
    axes: [Vector3<f64>; 2],
    /// Mean distance of the places round it, m: presses go no farther from it.
    spacing: f64,
    /// What the response at each place round it adds to the slopes, 1/m. The place's own takes as much off.
    round: [(usize, [f64; 2]); PLACE_NEIGHBOURS],
}

impl Slopes {
    /// Least squares, near places counting for more, as `Spot::new` in `shared` has it.
    fn new(centres: &[Point3<f64>], normal: &Vector3<f64>, place: usize) -> Self {
        let axes = tangents(normal);
        let neighbours = round(centres, normal, place);
        let ways = neighbours.map(|other| axes.map(|axis| axis.dot(&(centres[other] - centres[place]))));
        let spacing = ways.iter().map(|[x, y]| x.hypot(*y)).sum::<f64>() / ways.len() as f64;
        let weights = ways.map(|[x, y]| 1.0 / (x * x + y * y + 0.1 * spacing * spacing));
        let sum = |of: fn([f64; 2]) -> f64| {
            ways.iter().zip(weights).map(|(way, weight)| weight * of(*way)).sum::<f64>()
        };
        let (xx, xy, yy) = (sum(|[x, _]| x * x), sum(|[x, y]| x * y), sum(|[_, y]| y * y));
        let determinant = xx * yy - xy * xy;
        let inverse = if determinant > 1e-3 * xx * yy { 1.0 / determinant } else { 0.0 };
        let round = std::array::from_fn(|n| {
            let ([x, y], weight) = (ways[n], weights[n] * inverse);
            (neighbours[n], [weight * (yy * x - xy * y), weight * (xx * y - xy * x)])
        });
        Self { axes, spacing, round }
    }

    /// The places whose responses make that of a press so far from this place, with their shares.
    fn shares(&self, place: usize, way: &Vector3<f64>) -> Vec<(usize, f64)> {
        let [x, y] = self.axes.map(|axis| axis.dot(way));
        let reach = (self.spacing / x.hypot(y)).min(1.0);
        let [x, y] = [reach * x, reach * y];
        let of_others =
            self.round.iter().map(|&(other, [along_x, along_y])| (other, x * along_x + y * along_y));
        let own = 1.0 - of_others.clone().map(|(_, share)| share).sum::<f64>();
        of_others.chain([(place, own)]).collect()
    }
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
    fn what_is_linear_in_where_it_lies_is_not_missed_and_what_bends_is() {
        let Model { pixels, .. } = square();
        let all: Vec<usize> = (0..pixels.count()).collect();
        let places: Vec<usize> = all.iter().copied().step_by(3).collect();
        let most_missed = |bend: f64| {
            let responses = Mat::from_fn(3, pixels.count(), |m, press| {
                let [x, y] = [pixels.centres[press].x, pixels.centres[press].y].map(|part| part / 0.05);
                [1.0, x, y + bend * x * x][m]
            });
            let missed = Candidates::new(&pixels, &responses, &[1.0; 3]).missed(&all, &places);
            missed.into_iter().fold(0.0, f64::max)
        };
        assert!(most_missed(0.0) < 1e-12, "{}", most_missed(0.0));
        assert!(most_missed(3.0) > 1e-6, "{}", most_missed(3.0));
    }

    #[test]
    fn places_differ_and_less_is_missed_with_them_than_with_those_that_are_least_alike() {
        let model = square();
        let candidates = Candidates::new(&model.pixels, &responses(&model), &model.relative_noise());
        let all: Vec<usize> = (0..model.pixels.count()).collect();
        let chosen = candidates.choose(256);
        let mut places = chosen.clone();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 256);
        let most_missed = |places: &[usize]| candidates.missed(&all, places).into_iter().fold(0.0, f64::max);
        let [least_alike, chosen] =
            [candidates.least_alike(&all, 256), chosen].map(|places| most_missed(&places));
        assert!(chosen < least_alike / 4.0, "{chosen}, {least_alike}");
        assert_eq!(candidates.choose(usize::MAX).len(), model.pixels.count());
    }
}

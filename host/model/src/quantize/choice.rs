//! Choice: the pixels that are the places where a board looks for a press.
//!
//! Each lies where those before are least like a press, so that they are closest where presses are easiest told apart, near
//! the electrodes.

use super::shares::Rounds;
use crate::pixels::Pixels;
use dermatome_shared::patch::places::{PLACE_NEIGHBOURS, Place};
use faer::Mat;

/// Where not knowing the place of a press makes the variance of its strength so many times as large, presses of all
/// strengths look alike: in a corner the response grows many times within the way to the next place. There is no place
/// there. Disc and rim hemispheres have up to 14 of it, corners of the small square 140 to 200.
const MOST_INFLATED: f64 = 40.0;
/// Times that others are chosen for such places.
const TIMES: usize = 4;

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

    /// At most so many places; none if there are too few for each to have neighbours.
    pub(super) fn choose(&self, most: usize) -> Vec<Place> {
        let mut presses: Vec<usize> =
            (0..self.products.ncols()).filter(|&press| self.square(press) > 0.0).collect();
        for time in 0.. {
            let chosen = self.least_alike(&presses, most.min(presses.len()));
            if chosen.len() <= PLACE_NEIGHBOURS {
                break;
            }
            let rounds = Rounds::new(self.pixels, &self.products, &chosen);
            let places = rounds.places();
            let inflated =
                places.iter().enumerate().filter(|(at, place)| rounds.inflation(place, *at) > MOST_INFLATED);
            let inflated: Vec<usize> = inflated.map(|(at, _)| chosen[at]).collect();
            let is_enough = inflated.is_empty() || presses.len() - inflated.len() <= PLACE_NEIGHBOURS;
            if is_enough || time == TIMES {
                return places;
            }
            presses.retain(|press| !inflated.contains(press));
        }
        Vec::new()
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

    fn chosen(model: &Model, most: usize) -> Vec<usize> {
        let candidates = Candidates::new(&model.pixels, &responses(model), &model.relative_noise());
        candidates.choose(most).into_iter().map(|place| place.pixel.into()).collect()
    }

    #[test]
    fn places_differ_and_none_is_in_a_corner_where_all_strengths_look_alike() {
        let model = square();
        let mut places = chosen(&model, 256);
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 256);
        let in_corner = |pixel: usize| {
            let centre = model.pixels.centres[pixel];
            centre.x.abs().min(centre.y.abs()) > 0.0235
        };
        assert_eq!((0..model.pixels.count()).filter(|&pixel| in_corner(pixel)).count(), 4);
        assert!(!places.into_iter().any(in_corner));
    }

    #[test]
    fn there_are_no_more_places_than_pixels_that_answer_and_none_without_neighbours() {
        let model = square();
        let candidates = |pixels: usize| {
            let responses = Mat::from_fn(4, model.pixels.count(), |m, press| {
                let [x, y] =
                    [model.pixels.centres[press].x, model.pixels.centres[press].y].map(|part| part / 0.05);
                if press < pixels { [1.0, x, y, x * x][m] } else { 0.0 }
            });
            Candidates::new(&model.pixels, &responses, &[1.0; 4])
        };
        assert_eq!(candidates(50).choose(usize::MAX).len(), 50);
        assert_eq!(candidates(PLACE_NEIGHBOURS).choose(usize::MAX), []);
    }
}

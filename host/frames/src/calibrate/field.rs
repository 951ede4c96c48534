//! Field of gain: by how much a skin reads more or less from place to place, smooth over it, from presses of known
//! pressure at several places.
//!
//! Of a reading, ln strength = curve(ln pressure) + ln gain(place) + noise. The curve is a polynomial of low degree; the
//! field is a Gaussian process of squared exponential covariance; the noise is partly that of a place, which all its
//! readings share, as the board's own places lie some distance apart (Rasmussen and Williams, Gaussian Processes for
//! Machine Learning, sections 2.7 and 5.4.2). How smooth and how large the field is, nobody knows: several of each are
//! averaged, no field among them, each by how well it foretells places that are left out. So few presses, or presses that
//! contradict each other, leave the gain near 1.

use super::{Reading, trials};
use dermatome_patch::write::{gain_centres, takes_gains};
use dermatome_shared::patch::PatchView;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Point3};

/// Fewest places of a field.
const FEWEST: usize = 4;
/// Loads below this share of the largest one say nothing of gain.
const LEAST_LOAD: f64 = 0.1;
/// Loads that differ by less than this share of the largest one are the same.
const SAME_LOAD: f64 = 0.01;
/// Distances over which a field changes, as shares of the skin's size.
const LENGTHS: [f64; 3] = [0.35, 0.7, 1.4];
/// Variances of a field, those of the noise of a place.
const VARIANCES: [f64; 5] = [0.25, 1.0, 4.0, 16.0, 64.0];
/// Variance of the noise of one reading, that of the noise of a place.
const OF_READING: f64 = 0.25;
/// Weight of no field before anything was measured.
const EVEN: f64 = 0.5;
/// A place is odd that is this many usual deviations off, and at least so much, relative; fewest places among which one can
/// be odd, and at most one in so many.
const ODD: f64 = 4.0;
const LEAST_ODD: f64 = 0.2;
const FEWEST_OF_ODD: usize = 8;
const MOST_ODD: usize = 5;
/// Most that a gain differs from 1: a factor.
const MOST: f64 = 4.0;

/// A field of gain.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Places that were pressed.
    places: Vec<Point3<f64>>,
    /// A length, m, and the weight of each place at it.
    parts: Vec<(f64, Vec<f64>)>,
    /// Mean over the skin of the logarithm that they make.
    mean: f64,
    /// Places whose strengths are so far from what the others foretell that the field was fitted without them.
    pub odd: usize,
    /// How far strengths at a place are off when the others foretell it: root mean square, relative; without the field,
    /// and with it.
    pub left_out: [f64; 2],
}

/// Why there is no field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoField {
    /// No reading has a place.
    #[error(
        "it is not known where the skin was pressed; allowed: readings with the columns `x_mm` and `y_mm`"
    )]
    NoPlaces,
    /// Too few places.
    #[error(
        "the skin was pressed at {found} {}; allowed: {FEWEST} or more, all over the skin, each pressed by a tenth of the \
         largest load or more",
        if *found == 1 { "place" } else { "places" }
    )]
    FewPlaces {
        /// How many.
        found: usize,
    },
    /// The patch cannot have one.
    #[error(
        "contacts of this patch are found in an image whose pixels are interpolated from each other; allowed: a patch built with \
         `contact.found_in` = \"voltages\", or a learnt one"
    )]
    Interpolated,
    /// Places that are left out are not foretold any better.
    #[error(
        "with one, strengths at a place that was left out would be {with:.1} % off, without {without:.1} %: the presses show \
         none"
    )]
    NoBetter {
        /// Per cent.
        without: f64,
        /// Per cent.
        with: f64,
    },
}

/// A reading on a place.
struct Observation {
    place: usize,
    pressure: f64,
    strength: f64,
}

impl Field {
    /// Of readings at places, as [`super::at_places`] gives them, for a patch.
    pub fn fit(readings: &[Reading], patch: &PatchView<'_>) -> Result<Self, NoField> {
        if readings.iter().all(|reading| reading.place.is_none()) {
            return Err(NoField::NoPlaces);
        }
        let (mut places, mut observations) = observations(readings);
        if places.len() < FEWEST {
            return Err(NoField::FewPlaces { found: places.len() });
        }
        if !takes_gains(patch) {
            return Err(NoField::Interpolated);
        }
        let skin = super::centres(patch);
        let size = super::size(&skin);
        let lengths = LENGTHS.map(|share| share * size);
        let all = Smooth::new(&places, &observations, &lengths);
        let odd = odd(&all.errors);
        let smooth = if odd.is_empty() {
            all
        } else {
            (places, observations) = without(&places, observations, &odd);
            Smooth::new(&places, &observations, &lengths)
        };
        let Smooth { parts, left_out, .. } = smooth;
        let [without, with] = left_out.map(|deviation| 100.0 * deviation);
        if with >= without {
            return Err(NoField::NoBetter { without, with });
        }
        let mut field = Self { parts, places, mean: 0.0, odd: odd.len(), left_out };
        field.mean = skin.iter().map(|at| field.logarithm(at)).sum::<f64>() / skin.len() as f64;
        Ok(field)
    }

    /// How many places were pressed.
    #[must_use]
    pub fn places(&self) -> usize {
        self.places.len()
    }

    /// Gain at a place, m: strength over that of the same press on a skin that reads alike everywhere.
    #[must_use]
    pub fn gain(&self, place: [f64; 3]) -> f64 {
        (self.logarithm(&place.into()) - self.mean).exp().clamp(1.0 / MOST, MOST)
    }

    /// Gains as a patch takes them ([`dermatome_patch::write::with_gains`]).
    #[must_use]
    pub fn gains(&self, patch: &PatchView<'_>) -> Vec<f64> {
        gain_centres(patch).into_iter().map(|centre| self.gain(centre)).collect()
    }

    /// The readings as a skin that reads alike everywhere would have given them.
    #[must_use]
    pub fn corrected(&self, readings: &[Reading]) -> Vec<Reading> {
        let correct = |reading: &Reading| {
            let gain = reading.place.map_or(1.0, |place| self.gain(place));
            Reading { strength: reading.strength / gain, deviation: reading.deviation / gain, ..*reading }
        };
        readings.iter().map(correct).collect()
    }

    fn logarithm(&self, at: &Point3<f64>) -> f64 {
        let of_part = |(length, weights): &(f64, Vec<f64>)| {
            let near = self.places.iter().zip(weights);
            near.map(|(place, weight)| weight * covariance(place, at, *length)).sum::<f64>()
        };
        self.parts.iter().map(of_part).sum()
    }
}

/// Places, and the readings on them as the skin was loaded, one for each place and load.
fn observations(readings: &[Reading]) -> (Vec<Point3<f64>>, Vec<Observation>) {
    let largest = readings.iter().fold(0.0, |most: f64, reading| most.max(reading.pressure_kpa));
    let loading = trials(readings).into_iter().flat_map(|trial| trial.loading());
    let counts = |reading: &Reading| reading.pressure_kpa >= LEAST_LOAD * largest && reading.strength > 0.0;
    let (mut places, mut sums): (Vec<[f64; 3]>, Vec<(Observation, f64)>) = (Vec::new(), Vec::new());
    for reading in loading.filter(counts) {
        let Some(at) = reading.place else { continue };
        let place = places.iter().position(|other| *other == at).unwrap_or_else(|| {
            places.push(at);
            places.len() - 1
        });
        let is_same = |other: &Observation, count: f64| {
            let apart = (other.pressure / count - reading.pressure_kpa).abs();
            other.place == place && apart <= SAME_LOAD * largest
        };
        match sums.iter_mut().find(|(other, count)| is_same(other, *count)) {
            Some((sum, count)) => {
                sum.pressure += reading.pressure_kpa;
                sum.strength += reading.strength;
                *count += 1.0;
            }
            None => {
                let Reading { pressure_kpa: pressure, strength, .. } = reading;
                sums.push((Observation { place, pressure, strength }, 1.0));
            }
        }
    }
    let mean = |(Observation { place, pressure, strength }, count): (Observation, f64)| Observation {
        place,
        pressure: pressure / count,
        strength: strength / count,
    };
    (places.into_iter().map(Point3::from).collect(), sums.into_iter().map(mean).collect())
}

/// Places that the others foretell so badly that something else happened there: none of few, nor of many.
fn odd(errors: &[Option<f64>]) -> Vec<usize> {
    let mut sizes: Vec<f64> = errors.iter().flatten().map(|error| error.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let usual = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    // 1.4826 times the median is the standard deviation of normal errors.
    let most = (ODD * 1.4826 * usual).max(LEAST_ODD);
    let is_odd = |place: &usize| errors[*place].is_some_and(|error| error.abs() > most);
    let odd: Vec<usize> = (0..errors.len()).filter(is_odd).collect();
    if errors.len() < FEWEST_OF_ODD || MOST_ODD * odd.len() > errors.len() { Vec::new() } else { odd }
}

/// Places and observations without some places.
fn without(
    places: &[Point3<f64>],
    observations: Vec<Observation>,
    odd: &[usize],
) -> (Vec<Point3<f64>>, Vec<Observation>) {
    let kept: Vec<usize> = (0..places.len()).filter(|place| !odd.contains(place)).collect();
    let renumbered = |one: Observation| {
        let place = kept.iter().position(|&place| place == one.place)?;
        Some(Observation { place, ..one })
    };
    let observations = observations.into_iter().filter_map(renumbered).collect();
    (kept.iter().map(|&place| places[place]).collect(), observations)
}

/// A field before its mean is known.
struct Smooth {
    /// As [`Field`] has them.
    parts: Vec<(f64, Vec<f64>)>,
    /// How far the field of the other places is off: `[place]`.
    errors: Vec<Option<f64>>,
    /// As [`Field`] has it.
    left_out: [f64; 2],
}

impl Smooth {
    fn new(places: &[Point3<f64>], observations: &[Observation], lengths: &[f64]) -> Self {
        let (tried, weights) = Data::new(places, observations).try_all(lengths);
        let mixed = |place: usize| -> Option<f64> {
            tried.iter().zip(&weights).map(|(one, weight)| Some(weight * one.errors[place]?)).sum()
        };
        let errors: Vec<Option<f64>> = (0..places.len()).map(mixed).collect();
        let even = tried.first().map_or(0.0, |none| mean_square(&none.errors));
        let part = |&length: &f64| {
            let of_length = || tried.iter().zip(&weights).filter(|(one, _)| one.length == Some(length));
            let of_place =
                |place: usize| of_length().map(|(one, weight)| weight * one.of_places[place]).sum();
            (length, (0..places.len()).map(of_place).collect())
        };
        let left_out = [even, mean_square(&errors)].map(f64::sqrt);
        Self { parts: lengths.iter().map(part).collect(), errors, left_out }
    }
}

/// How alike a field is at two places.
fn covariance(a: &Point3<f64>, b: &Point3<f64>, length: f64) -> f64 {
    (-(a - b).norm_squared() / (2.0 * length * length)).exp()
}

/// Logarithms of the strengths, and what explains them.
struct Data<'a> {
    places: &'a [Point3<f64>],
    observations: &'a [Observation],
    /// Logarithms of the strengths: `[observation]`.
    strengths: DVector<f64>,
    /// Powers of the logarithms of the loads: `[observation][power]`.
    curve: DMatrix<f64>,
}

/// One kind of field.
struct Tried {
    /// The distance over which it changes, m; none of no field.
    length: Option<f64>,
    /// How far the other places' field is off: `[place]`; none where the curve is not known without it.
    errors: Vec<Option<f64>>,
    /// What each place adds to the field near it: `[place]`.
    of_places: Vec<f64>,
}

impl<'a> Data<'a> {
    fn new(places: &'a [Point3<f64>], observations: &'a [Observation]) -> Self {
        let count = observations.len();
        let loads: Vec<f64> = observations.iter().map(|one| one.pressure.ln()).collect();
        let mean = loads.iter().sum::<f64>() / count as f64;
        let mut sorted = loads.clone();
        sorted.sort_by(f64::total_cmp);
        let different = sorted.chunk_by(|a, b| b - a <= SAME_LOAD).count();
        let powers = different.min(3).min(1 + count / 5);
        let strengths = DVector::from_iterator(count, observations.iter().map(|one| one.strength.ln()));
        let curve = DMatrix::from_fn(count, powers, |one, power| (loads[one] - mean).powi(power as i32));
        Self { places, observations, strengths, curve }
    }

    /// All kinds of fields, the first of them none, and their weights.
    fn try_all(&self, lengths: &[f64]) -> (Vec<Tried>, Vec<f64>) {
        let smooth = lengths.iter().flat_map(|&length| VARIANCES.map(|variance| Some((length, variance))));
        let tried: Vec<Tried> =
            [None].into_iter().chain(smooth).filter_map(|kind| self.try_one(kind)).collect();
        let weights = weights(&tried, self.curve.ncols());
        (tried, weights)
    }

    /// Tries a length and a variance.
    fn try_one(&self, kind: Option<(f64, f64)>) -> Option<Tried> {
        let (length, variance) = kind.unwrap_or((1.0, 0.0));
        let place = |one: usize| self.observations[one].place;
        let noise = |i: usize, j: usize| {
            f64::from(u8::from(place(i) == place(j))) + if i == j { OF_READING } else { 0.0 }
        };
        let of_field = |i: usize, j: usize| {
            variance * covariance(&self.places[place(i)], &self.places[place(j)], length)
        };
        let count = self.observations.len();
        let inverse =
            DMatrix::from_fn(count, count, |i, j| of_field(i, j) + noise(i, j)).cholesky()?.inverse();
        // What is left of the inverse covariance once the curve is fitted.
        let of_curve = &inverse * &self.curve;
        let fitted = (self.curve.transpose() * &of_curve).cholesky()?.solve(&of_curve.transpose());
        let inverse = &inverse - of_curve * fitted;
        let weighted = &inverse * &self.strengths;
        let members: Vec<Vec<usize>> =
            (0..self.places.len()).map(|at| (0..count).filter(|&one| place(one) == at).collect()).collect();
        let error = |members: &Vec<usize>| {
            let block =
                DMatrix::from_fn(members.len(), members.len(), |i, j| inverse[(members[i], members[j])]);
            let known: Cholesky<f64, Dyn> =
                block.cholesky().filter(|known| known.determinant() > f64::MIN_POSITIVE)?;
            let errors = known.solve(&DVector::from_fn(members.len(), |i, _| weighted[members[i]]));
            Some(errors.mean())
        };
        Some(Tried {
            length: kind.map(|(length, _)| length),
            errors: members.iter().map(error).collect(),
            of_places: members
                .iter()
                .map(|m| variance * m.iter().map(|&one| weighted[one]).sum::<f64>())
                .collect(),
        })
    }
}

/// Weights of the fields, by how well they foretell places that are left out, of which so many powers of the curve take
/// some; the first is no field. Few places say little of which is best.
fn weights(tried: &[Tried], powers: usize) -> Vec<f64> {
    let score = |(number, one): (usize, &Tried)| {
        let count = one.errors.iter().flatten().count() as f64 - powers as f64 - 1.0;
        let others = (tried.len() - 1).max(1) as f64;
        let before = if number == 0 { EVEN } else { (1.0 - EVEN) / others };
        -0.5 * count.max(1.0) * mean_square(&one.errors).max(f64::MIN_POSITIVE).ln() + before.ln()
    };
    let scores: Vec<f64> = tried.iter().enumerate().map(score).collect();
    let most = scores.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sum: f64 = scores.iter().map(|score| (score - most).exp()).sum();
    scores.iter().map(|score| (score - most).exp() / sum).collect()
}

/// Of the errors that are known.
fn mean_square(errors: &[Option<f64>]) -> f64 {
    let known = || errors.iter().flatten();
    known().map(|error| error * error).sum::<f64>() / known().count().max(1) as f64
}

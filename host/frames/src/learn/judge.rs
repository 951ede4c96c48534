//! Judge: how far from the presses a matrix's strongest contacts lie, and whether two at once are told apart.

use super::{LearnError, presses::Presses};
use crate::recorded::reconstruct::{contacts, evenly_spaced};
use dermatome_model::model::Model;
use dermatome_patch::{layout::Layout, tables::SurfaceTables};
use dermatome_shared::{
    contact::{self, Contact},
    image::Image,
    patch::PatchView,
    reconstruct::reconstruct,
    reference::DifferenceData,
};
use faer::{Col, Mat};
use nalgebra::{Point3, Vector3};
use serde::Serialize;
use std::ops::RangeInclusive;

/// Mean normals shorter than this say nothing: a skin that faces all ways alike.
const LEAST_MEAN_NORMAL: f64 = 0.1;

/// Position errors of some presses, mm in space. A press without a contact counts as the skin's larger side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Presses judged.
    pub presses: usize,
    /// Presses that showed no contact.
    pub missed: usize,
    /// Presses that showed more than one.
    pub seconds: usize,
    /// Median.
    pub median_mm: f64,
    /// Mean.
    pub mean_mm: f64,
    /// Standard error of the mean.
    pub standard_error_mm: f64,
    /// Nine in ten are smaller.
    pub ninth_decile_mm: f64,
    /// Largest.
    pub worst_mm: f64,
}

/// How places have to be turned about the image's centre, round the skin's mean normal, to fit the presses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Turn {
    /// Counter-clockwise as the normal looks back, degrees; of the better of both ways round.
    pub degrees: f64,
    /// Whether places mirrored (x to -x on a flat skin) and then turned fit better.
    pub mirrored: bool,
}

/// The strongest contact of a press.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Centre, on the skin as a board lays it there, m.
    pub place: Point3<f64>,
    /// Mean relative conductivity change.
    pub strength: f64,
    /// Largest relative conductivity change.
    pub peak: f64,
}

/// One press and what was seen of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Judgement {
    /// Index of the press.
    pub press: usize,
    /// Where it was, m.
    pub place: Point3<f64>,
    /// Its strongest contact.
    pub found: Option<Found>,
    /// Whether there are others beside it.
    pub has_others: bool,
}

/// All presses judged.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Each press.
    pub presses: Vec<Judgement>,
    /// Where the image lies.
    frame: ImageFrame,
}

/// Where an image lies, as far as judging needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct ImageFrame {
    /// Middle of its grid and of its heights, m.
    centre: Point3<f64>,
    /// Larger side of the grid, or the height if that is more, m.
    side: f64,
    /// Two directions along the skin at right angles to its mean normal; none where it faces all ways alike.
    across: Option<[Vector3<f64>; 2]>,
}

/// A matrix to be judged in f64: `[pixel][measurement]`.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'a> {
    /// Relative conductivity, up where pressed.
    pub matrix: &'a Mat<f64>,
    /// Its pixels.
    pub surface: &'a SurfaceTables,
}

/// Two presses at once, taken as the sum of what each of them changes.
pub type Pair = [usize; 2];

/// Pairs of some presses that are so far apart, m, evenly spaced among all such pairs, and no more than `most`.
#[must_use]
pub fn pairs(presses: &Presses, which: &[usize], apart: RangeInclusive<f64>, most: usize) -> Vec<Pair> {
    let all = which.iter().enumerate().flat_map(|(n, &a)| which[..n].iter().map(move |&b| [a, b]));
    let away = |[a, b]: &Pair| (presses.places[*a] - presses.places[*b]).norm();
    let all: Vec<Pair> = all.filter(|pair| apart.contains(&away(pair))).collect();
    evenly_spaced(all.len(), most).into_iter().map(|pair| all[pair]).collect()
}

/// How many pairs are told apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ToldApart {
    /// Pairs judged.
    pub pairs: usize,
    /// Those that showed two contacts, each nearer to a press of its own than half of what both are apart.
    pub told_apart: usize,
}

impl ToldApart {
    /// Both together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self { pairs: self.pairs + other.pairs, told_apart: self.told_apart + other.told_apart }
    }

    /// Share of pairs that were not told apart; none of none.
    #[must_use]
    pub fn missed(self) -> f64 {
        (self.pairs - self.told_apart) as f64 / self.pairs.max(1) as f64
    }
}

/// Judges pairs by what `find` finds in difference data, `[measurement]`.
#[must_use]
pub fn told_apart(
    presses: &Presses,
    pairs: &[Pair],
    find: impl Fn(&[f64]) -> contact::Contacts,
) -> ToldApart {
    let is_told = |&&[a, b]: &&Pair| {
        let sum = presses.data[a].iter().zip(&presses.data[b]).map(|(a, b)| a + b);
        let contacts = find(&sum.collect::<Vec<_>>());
        let [one, other] = contacts.as_slice() else { return false };
        let places = [a, b].map(|press| presses.places[press]);
        let half = 0.5 * (places[0] - places[1]).norm();
        let fits =
            |[x, y]: [Point3<f64>; 2]| (centre(one) - x).norm() < half && (centre(other) - y).norm() < half;
        fits(places) || fits([places[1], places[0]])
    };
    ToldApart { pairs: pairs.len(), told_apart: pairs.iter().filter(is_told).count() }
}

impl Judged<'_> {
    /// Finds the strongest contact of each press, however weak.
    #[must_use]
    pub fn judge(&self, presses: &Presses, which: &[usize]) -> Outcome {
        outcome(self.surface, presses, which, |data| self.contacts(data))
    }

    /// Looks for two contacts in each pair.
    #[must_use]
    pub fn told_apart(&self, presses: &Presses, pairs: &[Pair]) -> ToldApart {
        told_apart(presses, pairs, |data| self.contacts(data).0)
    }

    /// Contacts, strongest first, and what their image was divided by.
    fn contacts(&self, data: &[f64]) -> (contact::Contacts, f64) {
        let image = self.matrix * Col::from_fn(data.len(), |m| data[m]);
        let image: Vec<f64> = image.iter().copied().collect();
        let peak = image.iter().copied().fold(0.0, f64::max);
        (contacts(self.surface, &image, 1.0, peak), peak)
    }
}

/// Judges a model's matrix in f64.
pub fn judge_matrix(model: &Model, presses: &Presses, which: &[usize]) -> Result<Outcome, LearnError> {
    let judged = Judged { matrix: &model.conductivity_from_difference, surface: &model.surface()? };
    Ok(judged.judge(presses, which))
}

/// Judges a model's patch with a board's arithmetic and contact threshold.
pub fn judge_board(
    model: &Model,
    patch: &PatchView<'_>,
    presses: &Presses,
    which: &[usize],
) -> Result<Outcome, LearnError> {
    Ok(outcome(&model.surface()?, presses, which, |data| (board_contacts(patch, data), 1.0)))
}

/// Contacts as a board finds them, from difference data `[measurement]`.
#[must_use]
pub fn board_contacts(patch: &PatchView<'_>, data: &[f64]) -> contact::Contacts {
    contact::find(&patch.surface(), &board_image(patch, data), patch.header.contact_threshold)
}

/// Image as a board computes it, from difference data `[measurement]`.
#[must_use]
pub fn board_image(patch: &PatchView<'_>, data: &[f64]) -> Image {
    let relative: Vec<f32> = data.iter().map(|&value| value as f32).collect();
    let mut difference = DifferenceData::default();
    difference.quantise(&relative, patch.matrix().column_exponents());
    let mut image = Image::new();
    reconstruct(patch, &difference, &mut image);
    image
}

/// `find` gives contacts, strongest first, and what their image was divided by.
fn outcome(
    surface: &SurfaceTables,
    presses: &Presses,
    which: &[usize],
    find: impl Fn(&[f64]) -> (contact::Contacts, f64),
) -> Outcome {
    let judge = |&press: &usize| {
        let (contacts, scale) = find(&presses.data[press]);
        Judgement {
            press,
            place: presses.places[press],
            found: contacts.first().map(|contact| Found::new(contact, scale)),
            has_others: contacts.len() > 1,
        }
    };
    Outcome { presses: which.iter().map(judge).collect(), frame: ImageFrame::of(surface) }
}

/// Centre of a contact, m.
fn centre(contact: &Contact) -> Point3<f64> {
    Point3::from(contact.position.map(f64::from))
}

impl ImageFrame {
    fn of(tables: &SurfaceTables) -> Self {
        let grid = Layout::from(tables).grid;
        let [x, y] = grid.position(f32::from(grid.columns) / 2.0, f32::from(grid.rows) / 2.0).map(f64::from);
        let heights = || tables.centres().map(|[_, _, z]| z);
        let (low, high) =
            (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let side = f64::from(grid.columns.max(grid.rows)) * f64::from(grid.pitch);
        Self {
            centre: Point3::new(x, y, (low + high) / 2.0),
            side: side.max(high - low),
            across: across(&mean_normal(tables)),
        }
    }

    /// Of a place as seen along the mean normal.
    fn seen(&self, place: Point3<f64>) -> Option<[f64; 2]> {
        self.across.map(|across| across.map(|direction| direction.dot(&(place - self.centre))))
    }
}

/// Mean of the unit normals, weighted by area.
fn mean_normal(tables: &SurfaceTables) -> Vector3<f64> {
    let surface = tables.view();
    let of = |pixel| (f64::from(surface.area(&pixel)), Vector3::from(surface.normal(&pixel).map(f64::from)));
    let add = |(area, sum): (f64, Vector3<f64>), (part, normal): (f64, Vector3<f64>)| {
        (area + part, sum + normal * part)
    };
    let (area, sum) = surface.pixels().map(of).fold((0.0, Vector3::zeros()), add);
    sum / area
}

/// Two unit vectors at right angles to a mean normal, x and y for one along z; none for one that is hardly any.
fn across(normal: &Vector3<f64>) -> Option<[Vector3<f64>; 2]> {
    let up = normal.try_normalize(LEAST_MEAN_NORMAL)?;
    let aside = if up.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
    let right = (aside - up * up.dot(&aside)).normalize();
    Some([right, up.cross(&right)])
}

impl Found {
    /// `scale` is what the contact's image was divided by.
    fn new(contact: &Contact, scale: f64) -> Self {
        Self {
            place: centre(contact),
            strength: f64::from(contact.strength) * scale,
            peak: f64::from(contact.peak) * scale,
        }
    }
}

impl Outcome {
    /// The presses of several outcomes of one image.
    pub(super) fn together<'a>(mut parts: impl Iterator<Item = &'a Self>) -> Self {
        let mut all = parts.next().cloned().unwrap_or_default();
        parts.for_each(|part| all.presses.extend(&part.presses));
        all
    }

    /// Position errors.
    #[must_use]
    pub fn errors(&self) -> Errors {
        let error = |press: &Judgement| {
            press.found.map_or(self.frame.side, |found| (found.place - press.place).norm()) * 1e3
        };
        let mut errors: Vec<f64> = self.presses.iter().map(error).collect();
        errors.sort_by(f64::total_cmp);
        let Some(last) = errors.len().checked_sub(1) else { return Errors::default() };
        let at = |share: f64| errors[(share * last as f64).round() as usize];
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        let squares: f64 = errors.iter().map(|error| (error - mean).powi(2)).sum();
        Errors {
            presses: errors.len(),
            missed: self.presses.iter().filter(|press| press.found.is_none()).count(),
            seconds: self.presses.iter().filter(|press| press.has_others).count(),
            median_mm: at(0.5),
            mean_mm: mean,
            standard_error_mm: (squares / last.max(1) as f64 / errors.len() as f64).sqrt(),
            ninth_decile_mm: at(0.9),
            worst_mm: errors[last],
        }
    }

    /// The turn that brings what was found closest to the presses, in the least-squares sense; none of a skin that faces all
    /// ways alike, as a whole tube does.
    #[must_use]
    pub fn turn(&self) -> Option<Turn> {
        self.frame.across?;
        let seen =
            |press: &Judgement| Some((self.frame.seen(press.found?.place)?, self.frame.seen(press.place)?));
        let (mut plain, mut mirrored) = ([0.0; 2], [0.0; 2]);
        for ([x, y], [tx, ty]) in self.presses.iter().filter_map(seen) {
            plain = [plain[0] + x * tx + y * ty, plain[1] + x * ty - y * tx];
            mirrored = [mirrored[0] - x * tx + y * ty, mirrored[1] - x * ty - y * tx];
        }
        let size = |[along, across]: [f64; 2]| along.hypot(across);
        let is_mirrored = size(mirrored) > size(plain);
        let [along, across] = if is_mirrored { mirrored } else { plain };
        Some(Turn { degrees: across.atan2(along).to_degrees(), mirrored: is_mirrored })
    }

    /// Farthest that a contact lies from the same one of another outcome, mm; the larger side where one of them
    /// has none.
    #[must_use]
    pub fn farthest_from(&self, other: &Self) -> f64 {
        let apart = |(a, b): (&Judgement, &Judgement)| match (a.found, b.found) {
            (Some(a), Some(b)) => (a.place - b.place).norm(),
            (None, None) => 0.0,
            _ => self.frame.side,
        };
        self.presses.iter().zip(&other.presses).map(apart).fold(0.0, f64::max) * 1e3
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn seen(pairs: &[([f64; 2], Option<[f64; 2]>)]) -> Outcome {
        let flat = |[x, y]: [f64; 2]| Point3::new(x, y, 0.0);
        let judgement = |(press, &(place, found)): (usize, &([f64; 2], Option<[f64; 2]>))| Judgement {
            press,
            place: flat(place),
            found: found.map(|place| Found { place: flat(place), strength: 1.0, peak: 1.0 }),
            has_others: false,
        };
        let frame = ImageFrame { centre: Point3::origin(), side: 0.2, across: across(&Vector3::z()) };
        Outcome { presses: pairs.iter().enumerate().map(judgement).collect(), frame }
    }

    #[test]
    fn a_missed_press_counts_as_the_whole_skin() {
        let errors = seen(&[([0.0, 0.0], Some([0.003, 0.004])), ([0.0, 0.0], None)]).errors();
        assert_eq!((errors.presses, errors.missed), (2, 1));
        assert!((errors.mean_mm - 102.5).abs() < 1e-9 && (errors.worst_mm - 200.0).abs() < 1e-9);
        assert!((errors.standard_error_mm - 97.5).abs() < 1e-9, "{errors:?}");
    }

    #[test]
    fn nothing_judged_has_no_error() {
        assert_eq!(seen(&[]).errors(), Errors::default());
    }

    #[test]
    fn a_contact_that_fixed_point_loses_is_the_whole_skin_away() {
        let (a, b) = ([0.01, 0.0], [0.01, 0.002]);
        let (exact, near) = (seen(&[(a, Some(a)), (a, Some(a))]), seen(&[(a, Some(b)), (a, Some(a))]));
        assert!((exact.farthest_from(&near) - 2.0).abs() < 1e-9);
        assert!((exact.farthest_from(&seen(&[(a, None), (a, Some(a))])) - 200.0).abs() < 1e-9);
    }

    /// Presses at these places, of which each changes a measurement of its own.
    fn pressed(places: &[[f64; 2]]) -> Presses {
        let one = |press: usize| (0..places.len()).map(|m| f64::from(u8::from(m == press))).collect();
        Presses {
            data: (0..places.len()).map(one).collect(),
            places: places.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect(),
            off: None,
            forces: None,
            mean_divisors: vec![1.0; places.len()],
            mean_reference: Vec::new(),
        }
    }

    #[test]
    fn pairs_are_as_far_apart_as_asked_for_and_told_apart_by_two_contacts_near_them() {
        let presses = pressed(&[[0.0, 0.0], [0.04, 0.0], [0.0, 0.03], [0.2, 0.2]]);
        let all = pairs(&presses, &[0, 1, 2, 3], 0.03..=0.05, 10);
        assert_eq!(all, [[1, 0], [2, 0], [2, 1]]);
        assert_eq!(pairs(&presses, &[0, 1, 2, 3], 0.03..=0.05, 1).len(), 1);
        let seen = |off: f32, extra: bool| {
            told_apart(&presses, &all, |data| {
                let contact = |press: usize| Contact {
                    position: [presses.places[press].x as f32 + off, presses.places[press].y as f32, 0.0],
                    normal: [0.0, 0.0, 1.0],
                    area: 1e-4,
                    strength: 1.0,
                    peak: 1.0,
                    pressure: None,
                    load_area: None,
                    evidence: None,
                    identity: None,
                };
                let pressed = (0..4).filter(|&press| data[press] > 0.0);
                pressed.chain(extra.then_some(3)).map(contact).collect()
            })
        };
        assert_eq!(seen(0.01, false), ToldApart { pairs: 3, told_apart: 3 });
        // 17 mm are more than half of the 30 mm of one pair.
        assert_eq!(seen(0.017, false), ToldApart { pairs: 3, told_apart: 2 });
        assert_eq!(seen(0.0, true).told_apart, 0);
        assert!((seen(0.017, false).and(seen(0.0, true)).missed() - 4.0 / 6.0).abs() < 1e-12);
    }

    proptest! {
        #[test]
        fn the_turn_of_turned_places_is_found(degrees in -179.0..179.0_f64, mirrored: bool) {
            let (sin, cos) = (-degrees).to_radians().sin_cos();
            let turned_back = |[x, y]: [f64; 2]| {
                let (x, y) = (x * cos - y * sin, x * sin + y * cos);
                if mirrored { [-x, y] } else { [x, y] }
            };
            let places = [[0.03, 0.01], [-0.02, 0.05], [0.01, -0.04], [0.06, 0.02]];
            let turn = seen(&places.map(|place| (place, Some(turned_back(place))))).turn().unwrap();
            prop_assert_eq!(turn.mirrored, mirrored);
            prop_assert!((turn.degrees - degrees).abs() < 1e-6, "{:?}", turn);
        }
    }
}

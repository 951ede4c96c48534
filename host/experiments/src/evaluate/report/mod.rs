//! Report: figures of all targets, by rings of the skin. Keys are documented in docs/cli.md.

mod rows;

use super::{
    Evaluation, FoundBy,
    pairs::{Direction, Pair},
    single::Single,
};
pub use rows::{GreitRow, PairRow, TargetRow, ThesisRow};
use serde::Serialize;

/// Ways to the rim, per cent, at which one ring ends and the next begins.
const RINGS: [f64; 7] = [0.0, 20.0, 40.0, 60.0, 80.0, 90.0, 100.0];
/// EIDORS scales AR by the targets within this share of the skin's radius.
const CENTRAL: f64 = 0.05;

/// What an evaluation tells.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Largest extent of the skin.
    pub skin_diameter_mm: f64,
    /// Diameter of a target.
    pub target_diameter_mm: f64,
    /// Distance of neighbouring places.
    pub spacing_mm: f64,
    /// Standard deviation of the electrodes' places.
    pub electrode_error_mm: f64,
    /// Triangles of the true skin.
    pub true_elements: usize,
    /// Smallest relative conductivity change that counted as a contact; none in the voltages.
    pub contact_threshold: Option<f64>,
    /// What contacts were found in: `voltages` or `image`.
    pub contacts_found_in: &'static str,
    /// How: `board`, or `image` for the f64 image.
    pub contacts_found_by: &'static str,
    /// Why no board finds them in the voltages although the skin says so.
    pub no_board: Option<String>,
    /// Whether all targets were tried.
    pub complete: bool,
    /// All single targets.
    pub total: Ring,
    /// Single targets by ring; rings without any are left out.
    pub rings: Vec<Ring>,
    /// All pairs.
    pub pairs_total: PairRing,
    /// Pairs by ring; rings without any are left out.
    pub pair_rings: Vec<PairRing>,
    /// Step between distances of pairs.
    pub pair_step_mm: f64,
    /// Every single target.
    pub targets: Vec<TargetRow>,
    /// Every place and direction of pairs.
    pub pairs: Vec<PairRow>,
}

/// Mean, and the value of the largest magnitude.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Farthest from zero, with its sign.
    pub max: f64,
}

/// Single targets in a ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ring {
    /// Where the ring begins, per cent of the way to the rim.
    pub from_percent: f64,
    /// Where it ends.
    pub to_percent: f64,
    /// Targets in it.
    pub targets: usize,
    /// Those without a contact; position errors leave them out.
    pub missed: usize,
    /// Contacts beyond one for each target.
    pub false_contacts: usize,
    /// Those with exactly one contact.
    pub exactly_one: usize,
    /// Strongest contact to target.
    pub position_error_mm: Option<Spread>,
    /// The same, per cent of the skin's diameter.
    pub position_error_percent: Option<Spread>,
    /// Area of the strongest contact, per cent of the target's; none in the voltages.
    pub contact_area_percent: Option<Spread>,
    /// Strength of the strongest contact.
    pub contact_strength: Option<Spread>,
    /// Its standard deviation from target to target, per cent of the mean.
    pub contact_strength_variation_percent: Option<f64>,
    /// Standard deviation that the board states of the strongest contact's place; none in the image.
    pub stated_deviation_mm: Option<Spread>,
    /// Strongest contacts that are off by no more than twice of that, per cent.
    pub within_two_stated_percent: Option<f64>,
    /// dV/V.
    pub relative_voltage_change_percent: Option<Spread>,
    /// What one frame tells at most; none without noise.
    pub detectability: Option<DetectabilityRing>,
    /// Figures of [`dermatome_model::metrics::thesis`].
    pub thesis: ThesisRing,
    /// Figures of [`dermatome_model::metrics::greit`].
    pub greit: GreitRing,
}

/// What one frame tells at most of the targets in a ring: see [`dermatome_model::metrics::detectability`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectabilityRing {
    /// d', mean.
    pub significance_mean: f64,
    /// d', least.
    pub significance_least: f64,
    /// Targets that are not detected.
    pub deaf: usize,
    /// Smallest change of conductivity that is detected, as a linear model sees it.
    pub smallest_change: Spread,
    /// Standard deviation of a target's place along an axis.
    pub position_deviation_mm: Spread,
}

/// The thesis' figures in a ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ThesisRing {
    /// PE along the radius.
    pub position_error_mm: Option<Spread>,
    /// The same, per cent of the skin's diameter.
    pub position_error_percent: Option<Spread>,
    /// RES.
    pub resolution: Option<Spread>,
    /// RNG.
    pub ringing: Option<Spread>,
    /// Mean of the region of interest.
    pub strength: Option<Spread>,
}

/// GREIT's figures in a ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GreitRing {
    /// PE along the radius.
    pub position_error_mm: Option<Spread>,
    /// The same, per cent of the skin's diameter.
    pub position_error_percent: Option<Spread>,
    /// RES.
    pub resolution: Option<Spread>,
    /// SD.
    pub shape_deformation: Option<Spread>,
    /// RNG outside the circle, as in the paper.
    pub ringing: Option<Spread>,
    /// RNG outside the set, as in EIDORS' code.
    pub ringing_of_set: Option<Spread>,
    /// AR over the target's amplitude.
    pub amplitude_response: Option<Spread>,
    /// AR over that of targets at the skin's centre, as in EIDORS' code.
    pub amplitude_over_centre: Option<Spread>,
}

/// Pairs in a ring.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairRing {
    /// Where the ring begins, per cent of the way to the rim.
    pub from_percent: f64,
    /// Where it ends.
    pub to_percent: f64,
    /// Pairs of which one lies farther out.
    pub radial: PairFigures,
    /// Pairs side by side.
    pub across: PairFigures,
}

/// Two-point discrimination of some places.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairFigures {
    /// Places tried.
    pub places: usize,
    /// Those at which no pair was told apart, however far apart there was room for; distances leave
    /// them out.
    pub never: usize,
    /// Smallest distance told apart.
    pub distance_mm: Option<Spread>,
    /// The same, per cent of the skin's diameter.
    pub distance_percent: Option<Spread>,
}

impl Report {
    /// Sums an evaluation up.
    #[must_use]
    pub fn new(evaluation: &Evaluation) -> Self {
        let diameter = evaluation.skin_diameter;
        let rings = || RINGS.windows(2).map(|ends| [ends[0], ends[1]]);
        let amplitude = central_amplitude(evaluation);
        let of_ring = |ends| Ring::new(ends, &evaluation.singles, diameter, amplitude);
        let pairs_of_ring = |ends| PairRing::new(ends, &evaluation.pairs, diameter);
        Self {
            skin_diameter_mm: diameter * 1e3,
            target_diameter_mm: evaluation.target_diameter * 1e3,
            spacing_mm: evaluation.spacing * 1e3,
            electrode_error_mm: evaluation.electrode_error * 1e3,
            true_elements: evaluation.mesh.elements.len(),
            contact_threshold: evaluation.threshold,
            contacts_found_in: match evaluation.found_by {
                FoundBy::Voltages => "voltages",
                FoundBy::Image | FoundBy::F64Image => "image",
            },
            contacts_found_by: match evaluation.found_by {
                FoundBy::Voltages | FoundBy::Image => "board",
                FoundBy::F64Image => "image",
            },
            no_board: evaluation.no_board.as_ref().map(ToString::to_string),
            complete: evaluation.complete,
            total: of_ring([0.0, 100.0]),
            rings: rings().map(of_ring).filter(|ring| ring.targets > 0).collect(),
            pairs_total: pairs_of_ring([0.0, 100.0]),
            pair_rings: rings().map(pairs_of_ring).filter(|ring| ring.places() > 0).collect(),
            pair_step_mm: evaluation.pair_step * 1e3,
            targets: evaluation.singles.iter().map(TargetRow::new).collect(),
            pairs: evaluation.pairs.iter().map(PairRow::new).collect(),
        }
    }
}

/// Mean amplitude of the targets at the skin's centre, if there are any.
fn central_amplitude(evaluation: &Evaluation) -> Option<f64> {
    let reach = CENTRAL * evaluation.skin_diameter / 2.0;
    let central =
        evaluation.singles.iter().filter(|single| (single.position - evaluation.centre).norm() < reach);
    spread(central.filter_map(|single| Some(single.greit?.amplitude))).map(|amplitude| amplitude.mean)
}

/// Whether a way to the rim falls into a ring; the last one includes the rim.
fn is_in([from, to]: [f64; 2], way: f64) -> bool {
    let per_cent = 100.0 * way;
    (from..to).contains(&per_cent) || (to >= 100.0 && per_cent >= from)
}

fn spread(values: impl Iterator<Item = f64>) -> Option<Spread> {
    let (mut sum, mut count, mut max) = (0.0, 0.0, 0.0_f64);
    for value in values {
        sum += value;
        count += 1.0;
        max = if value.abs() > max.abs() { value } else { max };
    }
    (count > 0.0).then(|| Spread { mean: sum / count, max })
}

/// Standard deviation, per cent of the mean.
fn variation_percent(values: impl Iterator<Item = f64> + Clone) -> Option<f64> {
    let mean = spread(values.clone())?.mean;
    let variance = spread(values.map(|value| (value - mean).powi(2)))?.mean;
    Some(100.0 * variance.sqrt() / mean)
}

/// How many are true, per cent.
fn share_percent(values: impl Iterator<Item = bool>) -> Option<f64> {
    Some(spread(values.map(|is_true| if is_true { 100.0 } else { 0.0 }))?.mean)
}

impl Ring {
    fn new(ends: [f64; 2], singles: &[Single], diameter: f64, central_amplitude: Option<f64>) -> Self {
        let inside: Vec<_> = singles.iter().filter(|single| is_in(ends, single.normalised_radius)).collect();
        let errors = || inside.iter().filter_map(|single| single.position_error());
        let strengths = || inside.iter().filter_map(|single| Some(single.contacts.first()?.strength));
        let stated = || inside.iter().filter_map(|single| single.is_as_stated());
        let areas = inside.iter().filter_map(|single| Some(100.0 * single.contact_area?));
        let changes = inside.iter().map(|single| 100.0 * single.relative_voltage_change);
        Self {
            from_percent: ends[0],
            to_percent: ends[1],
            targets: inside.len(),
            missed: inside.iter().filter(|single| single.contacts.is_empty()).count(),
            false_contacts: inside.iter().map(|single| single.contacts.len().saturating_sub(1)).sum(),
            exactly_one: inside.iter().filter(|single| single.contacts.len() == 1).count(),
            position_error_mm: spread(errors().map(|error| error * 1e3)),
            position_error_percent: spread(errors().map(|error| 100.0 * error / diameter)),
            contact_area_percent: spread(areas),
            contact_strength: spread(strengths()),
            contact_strength_variation_percent: variation_percent(strengths()),
            stated_deviation_mm: spread(
                inside.iter().filter_map(|single| Some(1e3 * single.stated_deviation()?)),
            ),
            within_two_stated_percent: share_percent(stated()),
            relative_voltage_change_percent: spread(changes),
            detectability: DetectabilityRing::new(&inside),
            thesis: ThesisRing::new(&inside, diameter),
            greit: GreitRing::new(&inside, diameter, central_amplitude),
        }
    }
}

impl DetectabilityRing {
    fn new(singles: &[&Single]) -> Option<Self> {
        let places = || singles.iter().filter_map(|single| single.detectability);
        Some(Self {
            significance_mean: spread(places().map(|place| place.significance))?.mean,
            significance_least: places().map(|place| place.significance).fold(f64::INFINITY, f64::min),
            deaf: places().filter(|place| !place.is_detected()).count(),
            smallest_change: spread(places().map(|place| place.smallest))?,
            position_deviation_mm: spread(places().map(|place| place.position_deviation * 1e3))?,
        })
    }
}

impl ThesisRing {
    fn new(singles: &[&Single], diameter: f64) -> Self {
        let figures = || singles.iter().filter_map(|single| single.thesis);
        Self {
            position_error_mm: spread(figures().map(|f| f.position_error * 1e3)),
            position_error_percent: spread(figures().map(|f| 100.0 * f.position_error / diameter)),
            resolution: spread(figures().map(|f| f.resolution)),
            ringing: spread(figures().map(|f| f.ringing)),
            strength: spread(figures().map(|f| f.strength)),
        }
    }
}

impl GreitRing {
    fn new(singles: &[&Single], diameter: f64, central_amplitude: Option<f64>) -> Self {
        let figures = || singles.iter().filter_map(|single| single.greit);
        let over_centre = |amplitude: f64| Some(amplitude / central_amplitude?);
        Self {
            position_error_mm: spread(figures().map(|f| f.position_error * 1e3)),
            position_error_percent: spread(figures().map(|f| 100.0 * f.position_error / diameter)),
            resolution: spread(figures().map(|f| f.resolution)),
            shape_deformation: spread(figures().map(|f| f.shape_deformation)),
            ringing: spread(figures().filter_map(|f| f.ringing)),
            ringing_of_set: spread(figures().map(|f| f.ringing_of_set)),
            amplitude_response: spread(figures().map(|f| f.amplitude_response)),
            amplitude_over_centre: spread(figures().filter_map(|f| over_centre(f.amplitude))),
        }
    }
}

impl PairRing {
    fn new(ends: [f64; 2], pairs: &[Pair], diameter: f64) -> Self {
        let figures = |direction| {
            let is_meant = |pair: &&Pair| pair.direction == direction && is_in(ends, pair.normalised_radius);
            PairFigures::new(&pairs.iter().filter(is_meant).collect::<Vec<_>>(), diameter)
        };
        let (radial, across) = (figures(Direction::Radial), figures(Direction::Across));
        Self { from_percent: ends[0], to_percent: ends[1], radial, across }
    }

    fn places(&self) -> usize {
        self.radial.places.max(self.across.places)
    }
}

impl PairFigures {
    fn new(pairs: &[&Pair], diameter: f64) -> Self {
        let distances = || pairs.iter().filter_map(|pair| pair.told_apart);
        Self {
            places: pairs.len(),
            never: pairs.len() - distances().count(),
            distance_mm: spread(distances().map(|distance| distance * 1e3)),
            distance_percent: spread(distances().map(|distance| 100.0 * distance / diameter)),
        }
    }
}

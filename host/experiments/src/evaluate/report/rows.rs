//! Rows: every target and pair of a report.

use crate::evaluate::{
    pairs::{Direction, Pair},
    single::Single,
};
use nalgebra::Point3;
use serde::Serialize;

/// One single target.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TargetRow {
    /// Centre of the target, x, y, z.
    pub position_mm: [f64; 3],
    /// Way to the rim.
    pub way_to_rim_percent: f64,
    /// Contacts found.
    pub contacts: usize,
    /// Strongest contact to target.
    pub position_error_mm: Option<f64>,
    /// Area of the strongest contact, per cent of the target's; none in the voltages.
    pub contact_area_percent: Option<f64>,
    /// Strength of the strongest contact.
    pub contact_strength: Option<f64>,
    /// By how many standard deviations the board says that it stands out; none in the image.
    pub contact_significance: Option<f64>,
    /// Standard deviation that the board states of its place; none in the image.
    pub stated_deviation_mm: Option<f64>,
    /// dV/V.
    pub relative_voltage_change_percent: f64,
    /// d' of what one frame tells.
    pub significance: Option<f64>,
    /// Smallest change of conductivity that is detected here, as a linear model sees it.
    pub smallest_change: Option<f64>,
    /// Least standard deviation of its place along an axis.
    pub position_deviation_mm: Option<f64>,
    /// The thesis' figures.
    pub thesis: Option<ThesisRow>,
    /// GREIT's figures.
    pub greit: Option<GreitRow>,
}

/// The thesis' figures of one target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ThesisRow {
    /// PE along the radius.
    pub position_error_mm: f64,
    /// RES.
    pub resolution: f64,
    /// RNG.
    pub ringing: f64,
    /// Mean of the region of interest.
    pub strength: f64,
}

/// GREIT's figures of one target.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GreitRow {
    /// PE along the radius.
    pub position_error_mm: f64,
    /// RES.
    pub resolution: f64,
    /// SD.
    pub shape_deformation: f64,
    /// RNG outside the circle.
    pub ringing: Option<f64>,
    /// RNG outside the set.
    pub ringing_of_set: f64,
    /// Sum of the image.
    pub amplitude_mm2: f64,
    /// AR over the target's amplitude.
    pub amplitude_response: f64,
}

/// Pairs about one place in one direction.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairRow {
    /// Half way between the two, x, y, z.
    pub middle_mm: [f64; 3],
    /// Way to the rim.
    pub way_to_rim_percent: f64,
    /// `radial` or `across`.
    pub direction: &'static str,
    /// Smallest distance told apart.
    pub distance_mm: Option<f64>,
    /// Largest distance tried.
    pub largest_mm: f64,
}

impl TargetRow {
    pub(super) fn new(single: &Single) -> Self {
        let strongest = single.contacts.first();
        Self {
            position_mm: millimetres(single.position),
            way_to_rim_percent: 100.0 * single.normalised_radius,
            contacts: single.contacts.len(),
            position_error_mm: single.position_error().map(|error| error * 1e3),
            contact_area_percent: single.contact_area.map(|area| area * 100.0),
            contact_strength: strongest.map(|contact| contact.strength),
            contact_significance: strongest.and_then(|contact| Some(contact.evidence?.significance)),
            stated_deviation_mm: single.stated_deviation().map(|deviation| deviation * 1e3),
            relative_voltage_change_percent: 100.0 * single.relative_voltage_change,
            significance: single.detectability.map(|place| place.significance),
            smallest_change: single.detectability.map(|place| place.smallest),
            position_deviation_mm: single.detectability.map(|place| place.position_deviation * 1e3),
            thesis: single.thesis.map(|figures| ThesisRow {
                position_error_mm: figures.position_error * 1e3,
                resolution: figures.resolution,
                ringing: figures.ringing,
                strength: figures.strength,
            }),
            greit: single.greit.map(|figures| GreitRow {
                position_error_mm: figures.position_error * 1e3,
                resolution: figures.resolution,
                shape_deformation: figures.shape_deformation,
                ringing: figures.ringing,
                ringing_of_set: figures.ringing_of_set,
                amplitude_mm2: figures.amplitude * 1e6,
                amplitude_response: figures.amplitude_response,
            }),
        }
    }
}

impl PairRow {
    pub(super) fn new(pair: &Pair) -> Self {
        Self {
            middle_mm: millimetres(pair.middle),
            way_to_rim_percent: 100.0 * pair.normalised_radius,
            direction: match pair.direction {
                Direction::Radial => "radial",
                Direction::Across => "across",
            },
            distance_mm: pair.told_apart.map(|distance| distance * 1e3),
            largest_mm: pair.largest * 1e3,
        }
    }
}

fn millimetres(point: Point3<f64>) -> [f64; 3] {
    (point * 1e3).coords.into()
}

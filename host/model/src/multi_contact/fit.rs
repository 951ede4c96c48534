//! Fit: places and strengths of some fingers by damped least squares.

use super::atlas::{Atlas, Place, Response};
use crate::inverse::least_squares::{Problem, Schedule, minimise};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::convert::Infallible;

/// A step that lowers the sum of squares by less than a share of the noise is the last.
const SCHEDULE: Schedule = Schedule {
    first: 1e-3,
    rise: 6.0,
    fall: 10.0,
    least: 1e-6,
    most: f64::INFINITY,
    ridge: 0.0,
    steps: 12,
    attempts: 6,
    attempts_in_all: usize::MAX,
    enough: 0.05,
    enough_share: 0.0,
};
/// Strength of a finger that is added, and the least it may fall to.
const FIRST_STRENGTH: f64 = 0.3;
const LEAST_STRENGTH: f64 = 0.02;
/// A site whose response is explained but for this share of its square tells nothing new.
const NEW: f64 = 1e-3;

/// One finger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Finger {
    pub(super) at: Place,
    pub(super) strength: f64,
}

/// Some fingers, and what they leave unexplained of data with noise of size 1.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) fingers: Vec<Finger>,
    left: DVector<f64>,
    /// Sum of squares of what is left.
    pub(super) square: f64,
}

impl Fit {
    /// No finger.
    pub(super) fn of_nothing(data: DVector<f64>) -> Self {
        Self { fingers: Vec::new(), square: data.norm_squared(), left: data }
    }

    /// Where another finger may begin: where what is left asks for one most, once anywhere and once at least so
    /// far from the others. Only what the others' own strengths and movements do not explain counts.
    pub(super) fn starts(&self, atlas: &Atlas, apart: f64) -> Vec<Place> {
        let own = self.fingers.iter().flat_map(|finger| {
            let Response { value, slopes: [x, y] } = atlas.response(finger.at);
            [value, x, y]
        });
        let own: Vec<_> = own.collect();
        let own = (!own.is_empty()).then(|| DMatrix::from_columns(&own).qr().q());
        let asks: Vec<f64> =
            atlas.sites.par_iter().map(|site| self.asks(&site.response, own.as_ref())).collect();
        let points: Vec<_> = self.fingers.iter().map(|finger| atlas.point(finger.at)).collect();
        let is_far =
            |site: usize| points.iter().all(|point| (atlas.sites[site].place - point).norm() >= apart);
        let most = |sites: &mut dyn Iterator<Item = usize>| {
            sites.filter(|&site| asks[site] > 0.0).max_by(|&a, &b| asks[a].total_cmp(&asks[b]))
        };
        let count = atlas.sites.len();
        let mut sites: Vec<_> = [most(&mut (0..count)), most(&mut (0..count).filter(|&site| is_far(site)))]
            .into_iter()
            .flatten()
            .collect();
        sites.dedup();
        sites.into_iter().map(Atlas::at_node).collect()
    }

    /// By how much a finger with this response would lower the sum of squares.
    fn asks(&self, response: &DVector<f64>, own: Option<&DMatrix<f64>>) -> f64 {
        let along = self.left.dot(response);
        let whole = response.norm_squared();
        let known = own.map_or(0.0, |own| own.tr_mul(response).norm_squared());
        if along > 0.0 { along * along / (whole - known).max(NEW * whole) } else { 0.0 }
    }

    /// The same with another finger, not fitted yet.
    pub(super) fn with(&self, at: Place) -> Vec<Finger> {
        let mut fingers = self.fingers.clone();
        fingers.push(Finger { at, strength: FIRST_STRENGTH });
        fingers
    }
}

/// Fits fingers to data. None moves farther than `stride`, m, in one step.
pub(super) fn refined(fingers: Vec<Finger>, atlas: &Atlas, data: &DVector<f64>, stride: f64) -> Fit {
    let start = explained(fingers, atlas, data);
    let Ok(fitted) = minimise(&Refinement { atlas, data, stride }, start, &SCHEDULE);
    fitted.state
}

/// Places and strengths of fingers that are to explain `data`.
struct Refinement<'a> {
    atlas: &'a Atlas,
    data: &'a DVector<f64>,
    stride: f64,
}

impl Problem for Refinement<'_> {
    type State = Fit;
    type Error = Infallible;

    fn left(&self, fit: &Fit) -> DVector<f64> {
        fit.left.clone()
    }

    fn square(&self, fit: &Fit) -> f64 {
        fit.square
    }

    fn slopes(&self, fit: &Fit) -> Result<DMatrix<f64>, Infallible> {
        Ok(columns(&fit.fingers, self.atlas))
    }

    fn moved(&self, fit: &Fit, change: &DVector<f64>) -> Result<Fit, Infallible> {
        let pairs = fit.fingers.iter().zip(change.as_slice().chunks_exact(3));
        let moved = pairs.map(|(finger, by)| finger.moved(self.atlas, [by[0], by[1], by[2]], self.stride));
        Ok(explained(moved.collect(), self.atlas, self.data))
    }
}

fn explained(fingers: Vec<Finger>, atlas: &Atlas, data: &DVector<f64>) -> Fit {
    let mut left = data.clone();
    for finger in &fingers {
        left -= atlas.response(finger.at).value * finger.strength;
    }
    Fit { square: left.norm_squared(), left, fingers }
}

/// What the responses of all fingers change by for each unit of strength, x and y.
fn columns(fingers: &[Finger], atlas: &Atlas) -> DMatrix<f64> {
    let of_finger = |finger: &Finger| {
        let Response { value, slopes: [x, y] } = atlas.response(finger.at);
        [value, x * finger.strength, y * finger.strength]
    };
    DMatrix::from_columns(&fingers.iter().flat_map(of_finger).collect::<Vec<_>>())
}

impl Finger {
    fn moved(&self, atlas: &Atlas, [stronger, x, y]: [f64; 3], stride: f64) -> Self {
        let shrink = (stride / x.hypot(y)).min(1.0);
        Self {
            at: atlas.moved(self.at, [x * shrink, y * shrink]),
            strength: (self.strength + stronger).max(LEAST_STRENGTH),
        }
    }
}

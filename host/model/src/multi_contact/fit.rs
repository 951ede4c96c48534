//! Fit: places and strengths of some fingers by least squares (Levenberg 1944, Marquardt 1963).

use super::atlas::{Atlas, Place, Response};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Steps of a fit, and attempts at each.
const STEPS: usize = 12;
const ATTEMPTS: usize = 6;
/// A step that lowers the sum of squares by less is the last.
const ENOUGH: f64 = 0.05;
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
    let mut fit = explained(fingers, atlas, data);
    let mut damping = 1e-3;
    for _ in 0..STEPS {
        let columns = columns(&fit.fingers, atlas);
        let (normal, slope) = (columns.tr_mul(&columns), columns.tr_mul(&fit.left));
        let mut attempts = (0..ATTEMPTS).filter_map(|_| {
            let step = damped(&normal, damping).cholesky()?.solve(&slope);
            let moved = fit.fingers.iter().zip(step.as_slice().chunks_exact(3));
            let moved = moved.map(|(finger, step)| finger.moved(atlas, [step[0], step[1], step[2]], stride));
            let next = explained(moved.collect(), atlas, data);
            if next.square >= fit.square {
                damping *= 6.0;
                return None;
            }
            Some(next)
        });
        let Some(next) = attempts.next() else { break };
        let gain = fit.square - next.square;
        damping = (damping / 10.0).max(1e-6);
        fit = next;
        if gain < ENOUGH {
            break;
        }
    }
    fit
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

fn damped(normal: &DMatrix<f64>, damping: f64) -> DMatrix<f64> {
    let mut damped = normal.clone();
    (0..normal.nrows()).for_each(|i| damped[(i, i)] *= 1.0 + damping);
    damped
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

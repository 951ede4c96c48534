//! The curve of a skin: strength by pressure on first loading, monotone, with its uncertainty.

use super::{Reading, Trial};
use dermatome_shared::calibration::{Calibration, CalibrationPoint, MAX_POINTS};
use serde::Serialize;

/// Loads that differ by less than this share of the largest one are the same.
pub(super) const SAME_LOAD: f64 = 0.01;
/// A point must lie this share of the span above the one before it.
const LEAST_RISE: f64 = 1e-4;

/// Strength at one load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CurvePoint {
    /// Pressure, kPa.
    pub pressure_kpa: f64,
    /// Strength, made monotone.
    pub strength: f64,
    /// Standard deviation of a press's strength at this load.
    pub deviation: f64,
}

/// A monotone curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// By pressure, which rises; strengths never fall.
    pub points: Vec<CurvePoint>,
}

impl Curve {
    /// Of the loading branches of these trials.
    #[must_use]
    pub fn of_loading(trials: &[Trial]) -> Self {
        let mut readings: Vec<Reading> = trials.iter().flat_map(Trial::loading).collect();
        readings.sort_by(|a, b| a.pressure_kpa.total_cmp(&b.pressure_kpa));
        let largest = readings.last().map_or(0.0, |reading| reading.pressure_kpa);
        let same = |a: &Reading, b: &Reading| b.pressure_kpa - a.pressure_kpa <= SAME_LOAD * largest;
        let mut points: Vec<CurvePoint> = readings.chunk_by(same).map(point).collect();
        let weights: Vec<f64> = readings.chunk_by(same).map(|group| group.len() as f64).collect();
        let strengths: Vec<f64> = points.iter().map(|point| point.strength).collect();
        for (point, strength) in points.iter_mut().zip(isotonic(&strengths, &weights)) {
            point.strength = strength;
        }
        Self { points }
    }

    /// Share of the variance of the loading readings that the curve explains, at most 1; 0 where all are equal.
    #[must_use]
    pub fn explained(&self, trials: &[Trial]) -> f64 {
        let readings: Vec<Reading> = trials.iter().flat_map(Trial::loading).collect();
        let mean = readings.iter().map(|reading| reading.strength).sum::<f64>() / readings.len() as f64;
        let square = |value: f64| value * value;
        let all: f64 = readings.iter().map(|reading| square(reading.strength - mean)).sum();
        let left =
            readings.iter().map(|reading| square(reading.strength - self.nearest(reading))).sum::<f64>();
        if all > 0.0 { 1.0 - left / all } else { 0.0 }
    }

    /// Strength of the curve at the load nearest to a reading's.
    fn nearest(&self, reading: &Reading) -> f64 {
        let far = |point: &&CurvePoint| (point.pressure_kpa - reading.pressure_kpa).abs();
        let nearest = self.points.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
        nearest.map_or(0.0, |point| point.strength)
    }

    /// As the patch holds it, or `None` if the strength does not rise with the load.
    ///
    /// Where it has more points than a patch holds, those go that change it least.
    #[must_use]
    pub fn calibration(&self) -> Option<Calibration> {
        let span = self.points.last()?.strength;
        let mut points: Vec<[f64; 2]> = vec![[0.0, 0.0]];
        for point in self.points.iter().filter(|point| point.pressure_kpa > 0.0) {
            let last = points.last_mut().expect("the list starts with the origin");
            if point.strength > last[0] + LEAST_RISE * span {
                points.push([point.strength, point.pressure_kpa * 1e3]);
            }
        }
        while points.len() > MAX_POINTS + 1 {
            points.remove(least_needed(&points));
        }
        let to_point = |p: &[f64; 2]| CalibrationPoint { strength: p[0] as f32, pressure: p[1] as f32 };
        let points = points[1..].iter().map(to_point).collect();
        let calibration = Calibration { points, load_share: None };
        (!calibration.points.is_empty() && calibration.is_valid()).then_some(calibration)
    }
}

/// Mean of the readings at one load. Where several trials disagree more than their readings scatter, their
/// disagreement is the deviation.
fn point(group: &[Reading]) -> CurvePoint {
    let count = group.len() as f64;
    let mean = |value: fn(&Reading) -> f64| group.iter().map(value).sum::<f64>() / count;
    let strength = mean(|reading| reading.strength);
    let between = group.iter().map(|reading| (reading.strength - strength).powi(2)).sum::<f64>();
    let between = if group.len() > 1 { between / (count - 1.0) } else { 0.0 };
    let within = mean(|reading| reading.deviation.powi(2));
    CurvePoint {
        pressure_kpa: mean(|reading| reading.pressure_kpa),
        strength,
        deviation: between.max(within).sqrt(),
    }
}

/// The point whose neighbours' line misses it least.
fn least_needed(points: &[[f64; 2]]) -> usize {
    let miss = |i: usize| {
        let [[x0, y0], [x, y], [x1, y1]] = [points[i - 1], points[i], points[i + 1]];
        (y0 + (y1 - y0) * (x - x0) / (x1 - x0) - y).abs()
    };
    let inner = 1..points.len() - 1;
    inner.min_by(|&a, &b| miss(a).total_cmp(&miss(b))).expect("more points than a patch holds")
}

/// The rising sequence nearest to `values` in least squares (pool adjacent violators).
#[must_use]
pub fn isotonic(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for (&value, &weight) in values.iter().zip(weights) {
        let mut pool = (value, weight, 1);
        while let Some(&(before, heavy, count)) = pools.last()
            && before >= pool.0
        {
            pools.pop();
            let weight = heavy + pool.1;
            pool = ((before * heavy + pool.0 * pool.1) / weight, weight, count + pool.2);
        }
        pools.push(pool);
    }
    pools.into_iter().flat_map(|(value, _, count)| std::iter::repeat_n(value, count)).collect()
}

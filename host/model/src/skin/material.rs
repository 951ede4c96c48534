//! Material: electrical properties of the untouched sheet.

use nalgebra::{DMatrix, DVector, Point3};

/// Electrical properties of the untouched sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Conductivity along the grain, S per square.
    pub sheet_conductivity: f64,
    /// Conductivity across the grain over that along it, if the sheet has a grain.
    pub across: Option<f64>,
    /// Direction of the grain: angle from x towards y, rad; on a curved skin projected onto its tangent plane.
    pub grain: f64,
    /// How the conductivity varies over the sheet, if it does.
    pub map: Option<ConductivityMap>,
    /// Capacitance, F per square: the sheet's admittivity is conductivity + j omega capacitance.
    pub sheet_capacitance: f64,
}

/// Conductivity over the sheet, relative to the material's, by what it is at some points.
#[derive(Clone, Debug, PartialEq)]
pub struct ConductivityMap {
    points: Vec<(Point3<f64>, f64)>,
}

impl ConductivityMap {
    /// From points, m, and the conductivity there; none if a point comes twice or there is none.
    #[must_use]
    pub fn new(points: Vec<(Point3<f64>, f64)>) -> Option<Self> {
        let twice = points.iter().enumerate().any(|(i, (a, _))| points[..i].iter().any(|(b, _)| a == b));
        (!points.is_empty() && !twice).then_some(Self { points })
    }

    /// Places that the file tells the conductivity of, m.
    pub(super) fn places(&self) -> impl Iterator<Item = &Point3<f64>> {
        self.points.iter().map(|(place, _)| place)
    }

    /// The same seen from above: z is dropped.
    #[must_use]
    pub fn flattened(&self) -> Self {
        let flat = |&(point, value): &(Point3<f64>, f64)| (Point3::new(point.x, point.y, 0.0), value);
        Self { points: self.points.iter().map(flat).collect() }
    }

    /// Radial basis functions |r| and a constant, through the logarithms at all points: between two points
    /// the logarithm goes straight, nothing overshoots by much, and far away it stays as it is.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation<'_> {
        let count = self.points.len();
        let matrix = DMatrix::from_fn(count + 1, count + 1, |i, j| match (i < count, j < count) {
            (true, true) => (self.points[i].0 - self.points[j].0).norm(),
            (false, false) => 0.0,
            _ => 1.0,
        });
        let values = DVector::from_fn(count + 1, |i, _| self.points.get(i).map_or(0.0, |point| point.1.ln()));
        // |r| is conditionally negative definite (Micchelli 1986), so that points apart leave it regular.
        let weights = matrix.lu().solve(&values).unwrap_or_else(|| DVector::zeros(count + 1));
        Interpolation { points: &self.points, weights }
    }
}

/// A map that can be asked anywhere.
#[derive(Clone, Debug)]
pub struct Interpolation<'a> {
    points: &'a [(Point3<f64>, f64)],
    /// Of each point, then the constant.
    weights: DVector<f64>,
}

impl Interpolation<'_> {
    /// Relative conductivity at a place, m.
    #[must_use]
    pub fn at(&self, place: Point3<f64>) -> f64 {
        let terms = self.points.iter().zip(&self.weights).map(|((point, _), w)| w * (place - point).norm());
        (terms.sum::<f64>() + self.weights[self.points.len()]).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(points: &[([f64; 2], f64)]) -> ConductivityMap {
        let point = |&([x, y], value): &([f64; 2], f64)| (Point3::new(x, y, 0.0), value);
        ConductivityMap::new(points.iter().map(point).collect()).unwrap()
    }

    #[test]
    fn a_map_goes_through_its_points_and_straight_between_two() {
        let points = [([0.0, 0.0], 1.0), ([0.1, 0.0], 4.0), ([0.05, 0.08], 0.5)];
        let map_of_three = map(&points);
        let level = map_of_three.interpolation();
        for ([x, y], value) in points {
            assert!((level.at(Point3::new(x, y, 0.0)) - value).abs() < 1e-12);
        }
        let map_of_two = map(&points[..2]);
        let level = map_of_two.interpolation();
        assert!((level.at(Point3::new(0.05, 0.0, 0.0)) - 2.0).abs() < 1e-12);
        assert!((level.at(Point3::new(0.4, 0.0, 0.0)) - 4.0).abs() < 1e-12);
        assert!((map(&points[1..2]).interpolation().at(Point3::origin()) - 4.0).abs() < 1e-12);
    }

    #[test]
    fn points_that_come_twice_make_no_map() {
        assert_eq!(ConductivityMap::new(vec![(Point3::origin(), 1.0); 2]), None);
        assert_eq!(ConductivityMap::new(Vec::new()), None);
    }
}

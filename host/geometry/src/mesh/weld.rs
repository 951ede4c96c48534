//! Joins points that lie at the same place but for rounding.

use nalgebra::{Point3, Vector3};
use std::{collections::HashMap, ops::RangeInclusive};

/// Tolerances that are allowed, relative to the bounding box's diagonal.
pub const TOLERANCES: RangeInclusive<f64> = 1e-12..=1e-2;

/// Cells of the grid are this many tolerances long: a ball of the tolerance touches mostly one cell.
const CELL_TOLERANCES: f64 = 4.0;
/// No point: the end of a cell's chain.
const NONE: usize = usize::MAX;

/// Points that are left after welding.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// Those left, in their old order. Any two are further apart than the tolerance.
    pub points: Vec<Point3<f64>>,
    /// Which of them each old point became: `[old point]`. None has moved further than the tolerance.
    pub numbers: Vec<usize>,
}

/// Joins each point to the nearest one left so far, if that is within `tolerance` times the bounding
/// box's diagonal; else it stays.
///
/// Points in a chain of small steps are so not all joined, but no point moves far, and time and
/// memory stay proportional to the number of points, whatever a file holds.
#[must_use]
pub fn weld(points: &[Point3<f64>], tolerance: f64) -> Welded {
    let mut grid = Grid::around(points, tolerance);
    let numbers = points.iter().map(|&point| grid.number(point)).collect();
    Welded { points: grid.points, numbers }
}

/// Points left so far, by the cell they lie in.
struct Grid {
    corner: Point3<f64>,
    tolerance: f64,
    cell: f64,
    points: Vec<Point3<f64>>,
    /// The newest point in each cell.
    newest: HashMap<[i64; 3], usize>,
    /// The next older point in the same cell: `[point]`.
    older: Vec<usize>,
}

impl Grid {
    fn around(points: &[Point3<f64>], tolerance: f64) -> Self {
        let start = points.first().copied().unwrap_or_else(Point3::origin);
        let corner = points.iter().fold(start, |corner, point| corner.inf(point));
        let opposite = points.iter().fold(start, |corner, point| corner.sup(point));
        let tolerance = tolerance * (opposite - corner).norm();
        let cell = CELL_TOLERANCES * tolerance;
        Self { corner, tolerance, cell, points: Vec::new(), newest: HashMap::new(), older: Vec::new() }
    }

    /// Number of the point left that this one becomes.
    fn number(&mut self, point: Point3<f64>) -> usize {
        self.nearest(point).unwrap_or_else(|| self.insert(point))
    }

    fn insert(&mut self, point: Point3<f64>) -> usize {
        let number = self.points.len();
        self.points.push(point);
        self.older.push(self.newest.insert(self.cell(point), number).unwrap_or(NONE));
        number
    }

    /// The nearest point within the tolerance, the oldest of equally near ones.
    fn nearest(&self, point: Point3<f64>) -> Option<usize> {
        // Mostly the same place exactly, which spares the other cells.
        let own = self.nearest_in(self.cell(point), point);
        if own.0 == 0.0 {
            return Some(own.1);
        }
        let reach = Vector3::repeat(self.tolerance);
        let (low, high) = (self.cell(point - reach), self.cell(point + reach));
        let mut nearest = own;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let there = self.nearest_in([x, y, z], point);
                    nearest = if there < nearest { there } else { nearest };
                }
            }
        }
        (nearest.0 <= self.tolerance).then_some(nearest.1)
    }

    /// Distance and number of the nearest point in a cell.
    fn nearest_in(&self, cell: [i64; 3], point: Point3<f64>) -> (f64, usize) {
        let mut nearest = (f64::INFINITY, NONE);
        let mut other = self.newest.get(&cell).copied().unwrap_or(NONE);
        while other != NONE {
            let there = ((self.points[other] - point).norm(), other);
            nearest = if there < nearest { there } else { nearest };
            other = self.older[other];
        }
        nearest
    }

    fn cell(&self, point: Point3<f64>) -> [i64; 3] {
        // Where all points are one, 0 / 0 becomes cell 0.
        std::array::from_fn(|axis| ((point[axis] - self.corner[axis]) / self.cell).floor() as i64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn far_corners() -> [Point3<f64>; 2] {
        [Point3::new(-1.0, -1.0, -1.0), Point3::new(1.0, 1.0, 1.0)]
    }

    #[test]
    fn points_on_both_sides_of_a_cell_border_weld() {
        let tolerance = 1e-3 * 12_f64.sqrt();
        let cell = CELL_TOLERANCES * tolerance;
        for axes in 1..8 {
            let step = |sign: f64| {
                let along = |axis: i32| if axes >> axis & 1 == 1 { sign * 0.2 * tolerance } else { 0.0 };
                Point3::new(along(0), along(1), along(2))
            };
            // The corner where eight cells meet, 100 cells from the box's own corner.
            let border = Vector3::repeat(100.0 * cell - 1.0);
            let [low, high] = far_corners();
            let welded = weld(&[low, high, step(-1.0) + border, step(1.0) + border], 1e-3);
            assert_eq!(welded.numbers, [0, 1, 2, 2], "axes {axes:03b}");
        }
    }

    #[test]
    fn a_point_joins_the_nearest_of_several() {
        let [low, high] = far_corners();
        let tolerance = 1e-3 * 12_f64.sqrt();
        let along = |x: f64| Point3::new(x * tolerance, 0.0, 0.0);
        let welded = weld(&[low, high, along(0.0), along(1.1), along(0.7), along(0.4)], 1e-3);
        assert_eq!(welded.numbers, [0, 1, 2, 3, 3, 2]);
        assert_eq!(welded.points, [low, high, along(0.0), along(1.1)]);
    }

    #[test]
    fn no_points_or_all_at_one_place_are_no_trouble() {
        assert!(weld(&[], 1e-6).points.is_empty());
        assert_eq!(weld(&[Point3::new(3.0, -0.0, 1.0), Point3::new(3.0, 0.0, 1.0)], 1e-6).numbers, [0, 0]);
    }

    proptest! {
        #[test]
        fn what_stays_is_apart_and_nothing_moves_far(
            // Few places, so that many points lie close together.
            points in prop::collection::vec(prop::array::uniform3(0..12_u8), 1..60),
            tolerance in 0.01..0.2_f64,
        ) {
            let points: Vec<_> = points.iter().map(|p| Point3::from(p.map(|x| f64::from(x) * 0.05))).collect();
            let diagonal = {
                let low = points.iter().fold(points[0], |low, p| low.inf(p));
                let high = points.iter().fold(points[0], |high, p| high.sup(p));
                (high - low).norm()
            };
            let welded = weld(&points, tolerance);
            for (point, &number) in points.iter().zip(&welded.numbers) {
                prop_assert!((welded.points[number] - point).norm() <= tolerance * diagonal);
            }
            for (place, one) in welded.points.iter().enumerate() {
                for other in &welded.points[..place] {
                    prop_assert!((one - other).norm() > tolerance * diagonal);
                }
            }
        }
    }
}

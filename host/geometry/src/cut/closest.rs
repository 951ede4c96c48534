//! The point of a surface that is closest to another point: triangles in the cells of a grid.

use crate::mesh::triangle;
use nalgebra::{Point3, Vector3};

/// Most cells along an axis.
const MOST_CELLS: f64 = 160.0;

/// Longest edge of the pieces that are sorted into cells, in cells.
const LONGEST_PIECE: f64 = 2.0;

/// Looked through first, in cells: most points lie so close to the surface that one cell is enough, and cells of a link
/// with slivers are full.
const FIRST_REACH: f64 = 1.0 / 32.0;

/// Triangles by the cells that they touch.
#[derive(Clone, Debug)]
pub(super) struct Closest {
    corner: Point3<f64>,
    cell: f64,
    counts: [usize; 3],
    /// Where each cell's triangles begin in `entries`, and the end: `[cell]`, one more.
    starts: Vec<u32>,
    entries: Vec<u32>,
    triangles: Vec<[Point3<f64>; 3]>,
}

impl Closest {
    /// Cells are about `cell` long, which should be the length of an edge.
    pub(super) fn new(triangles: impl Iterator<Item = [Point3<f64>; 3]>, cell: f64) -> Self {
        let has_area = |[a, b, c]: &[Point3<f64>; 3]| (b - a).cross(&(c - a)).norm() > 0.0;
        let triangles: Vec<_> = triangles.filter(has_area).collect();
        let start = triangles.first().map_or(Point3::origin(), |corners| corners[0]);
        let corner = triangles.iter().flatten().fold(start, |low, point| low.inf(point));
        let size = triangles.iter().flatten().fold(start, |high, point| high.sup(point)) - corner;
        let cell = cell.max(size.max() / MOST_CELLS).max(f64::MIN_POSITIVE);
        let counts = std::array::from_fn(|axis| (size[axis] / cell) as usize + 1);
        let cells = counts.iter().product::<usize>();
        let mut closest =
            Self { corner, cell, counts, starts: vec![0; cells + 1], entries: Vec::new(), triangles };
        closest.sort_in();
        closest
    }

    fn sort_in(&mut self) {
        let mut pairs = Vec::new();
        for (triangle, &[a, b, c]) in self.triangles.iter().enumerate() {
            let mut cells = Vec::new();
            self.enter([a, b, c], &mut cells);
            cells.sort_unstable();
            cells.dedup();
            pairs.extend(cells.into_iter().map(|cell| (cell, triangle as u32)));
        }
        pairs.iter().for_each(|&(cell, _)| self.starts[cell as usize + 1] += 1);
        (1..self.starts.len()).for_each(|cell| self.starts[cell] += self.starts[cell - 1]);
        let mut free = self.starts.clone();
        self.entries = vec![0; pairs.len()];
        for (cell, triangle) in pairs {
            self.entries[free[cell as usize] as usize] = triangle;
            free[cell as usize] += 1;
        }
    }

    /// Cells near a triangle: those of the boxes round its pieces, which are a few cells long, for the box round a long
    /// sliver that lies askew is nearly all of the grid.
    fn enter(&self, [a, b, c]: [Point3<f64>; 3], cells: &mut Vec<u32>) {
        let [ab, bc, ca] = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
        if ab.max(bc).max(ca) <= LONGEST_PIECE * self.cell {
            cells.extend(self.cells(a.inf(&b).inf(&c), a.sup(&b).sup(&c)).map(|cell| cell as u32));
            return;
        }
        // The longest edge is halved.
        let [a, b, c] = if ab >= bc && ab >= ca {
            [a, b, c]
        } else if bc >= ca {
            [b, c, a]
        } else {
            [c, a, b]
        };
        let middle = nalgebra::center(&a, &b);
        self.enter([a, middle, c], cells);
        self.enter([middle, b, c], cells);
    }

    /// Numbers of the cells that a box touches.
    fn cells(&self, low: Point3<f64>, high: Point3<f64>) -> impl Iterator<Item = usize> + use<> {
        let index = |point: Point3<f64>, axis: usize| {
            (((point[axis] - self.corner[axis]) / self.cell).max(0.0) as usize).min(self.counts[axis] - 1)
        };
        let [from, to] = [low, high].map(|point| [0, 1, 2].map(|axis| index(point, axis)));
        let counts = self.counts;
        let rows = (from[2]..=to[2]).flat_map(move |z| (from[1]..=to[1]).map(move |y| (y, z)));
        rows.flat_map(move |(y, z)| (from[0]..=to[0]).map(move |x| x + counts[0] * (y + counts[1] * z)))
    }

    /// The closest point of triangles with area; the same point if there are none.
    pub(super) fn point(&self, to: Point3<f64>) -> Point3<f64> {
        let far = 4.0 * MOST_CELLS * self.cell + (to - self.corner).norm();
        let mut reach = self.cell * FIRST_REACH;
        loop {
            let best = self.within(to, reach);
            if best.is_some() || reach > far {
                return best.unwrap_or(to);
            }
            reach *= 4.0;
        }
    }

    fn within(&self, to: Point3<f64>, reach: f64) -> Option<Point3<f64>> {
        let around = Vector3::repeat(reach);
        let mut best = (reach * reach, None);
        for cell in self.cells(to - around, to + around) {
            let entries = &self.entries[self.starts[cell] as usize..self.starts[cell + 1] as usize];
            for &triangle in entries {
                let point = triangle::nearest(self.triangles[triangle as usize], to);
                let distance = (point - to).norm_squared();
                if distance <= best.0 {
                    best = (distance, Some(point));
                }
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(size: f64) -> impl Strategy<Value = Point3<f64>> {
        prop::array::uniform3(-size..size).prop_map(Point3::from)
    }

    proptest! {
        #[test]
        fn the_grid_finds_what_looking_at_every_triangle_finds(
            corners in prop::collection::vec(prop::array::uniform3(point(1.0)), 1..40),
            to in point(3.0),
            cell in 0.01..2.0_f64,
        ) {
            let closest = Closest::new(corners.iter().copied(), cell);
            let found = (closest.point(to) - to).norm();
            let distance = |&corners: &[Point3<f64>; 3]| (triangle::nearest(corners, to) - to).norm();
            let least = corners.iter().map(distance).fold(f64::INFINITY, f64::min);
            prop_assert!((found - least).abs() < 1e-9, "{found} {least}");
        }

        #[test]
        fn no_point_of_a_triangle_is_closer(
            corners in prop::array::uniform3(point(1.0)), to in point(2.0), u in 0.0..1.0_f64, v in 0.0..1.0_f64,
        ) {
            let [a, b, c] = corners;
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let other = a + (b - a) * u + (c - a) * v;
            prop_assert!((triangle::nearest(corners, to) - to).norm() <= (other - to).norm() + 1e-9);
        }
    }
}

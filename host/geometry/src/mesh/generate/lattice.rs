//! Inner points: a triangular lattice, finer where edges are to be shorter.
//!
//! Lattices of edge length e, e / sqrt(3), e / 3, ... contain each other: with Eisenstein integers
//! a + b w, w = exp(2 pi j / 3), lattice k is all (a + b w) / t^k with t = j sqrt(3), and 1 / t turns
//! by a quarter and shrinks by sqrt(3). A point belongs to a mesh if the wanted edge length there is
//! shorter than the lattice below its own could give. So points never come too close to each other,
//! whatever the lengths wanted, and where those are about equal the triangles are equilateral.
//!
//! Squares are halved until one look decides for all points within, or few are left to look at.

use super::{
    Lattice, MOST_NODES, MeshError,
    size_field::{SizeField, Source},
    skeleton::Skeleton,
};
use nalgebra::{Point2, Rotation2, Vector2};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Inner points keep this distance from the skeleton, in wanted edge lengths.
const CLEARANCE: f64 = 0.6;
/// Squares of at most so many lattice edges are not halved further.
const FEW: f64 = 4.0;
/// Squares halved fewer times than this are looked at side by side.
const PARALLEL_HALVINGS: usize = 5;

/// Points that fill the sheet within its skeleton.
pub(super) fn inner_points(
    skeleton: &Skeleton<'_>,
    size_field: &SizeField,
    lattice: Lattice,
) -> Result<Vec<Point2<f64>>, MeshError> {
    let [low, high] = skeleton.outline.bounds();
    let middle = nalgebra::center(&low, &high);
    let filler = Filler {
        skeleton,
        size_field,
        turn: Rotation2::new(lattice.angle),
        origin: middle,
        shift: Vector2::new(1.0, 3_f64.sqrt() / 2.0) * (lattice.shift * size_field.longest),
        placed: AtomicUsize::new(skeleton.points.len()),
    };
    let half = (high - middle).norm() + size_field.longest;
    // A power of two: borders of squares are exact however often these are halved, so that a point on
    // one is in one square and not in both or neither.
    let all = Square { middle: Point2::origin(), half: 2_f64.powi(half.log2().ceil() as i32) };
    let points = filler.fill(all, &size_field.sources, 0);
    if filler.full() { Err(MeshError::TooManyNodes) } else { Ok(points) }
}

struct Filler<'a> {
    skeleton: &'a Skeleton<'a>,
    size_field: &'a SizeField,
    turn: Rotation2<f64>,
    origin: Point2<f64>,
    shift: Vector2<f64>,
    /// Nodes so far.
    placed: AtomicUsize,
}

/// A square in the frame of the lattice.
#[derive(Clone, Copy)]
struct Square {
    middle: Point2<f64>,
    half: f64,
}

impl Filler<'_> {
    fn fill(&self, square: Square, sources: &[Source], halvings: usize) -> Vec<Point2<f64>> {
        let middle = self.on_sheet(square.middle);
        let radius = square.half * 2_f64.sqrt();
        let clearance = self.skeleton.clearance(middle);
        if clearance < -radius || self.full() {
            return Vec::new();
        }
        let around = self.size_field.around(sources, middle, radius);
        let [fine, coarse] = [around.shortest, around.longest].map(|wanted| self.level(wanted));
        let points: Vec<_> = if fine == coarse && clearance - radius > CLEARANCE * around.longest {
            self.points(square, fine).map(|(_, point)| point).collect()
        } else if 2.0 * square.half <= FEW * self.edge(fine) {
            let belongs = |&(level, point): &(i32, Point2<f64>)| {
                let wanted = self.size_field.with(&around.sources, point);
                level <= self.level(wanted) && self.skeleton.clearance(point) > CLEARANCE * wanted
            };
            self.points(square, fine).filter(belongs).map(|(_, point)| point).collect()
        } else {
            return self.fill_quarters(square, &around.sources, halvings);
        };
        self.placed.fetch_add(points.len(), Ordering::Relaxed);
        points
    }

    fn fill_quarters(&self, square: Square, sources: &[Source], halvings: usize) -> Vec<Point2<f64>> {
        let fill = |quarter| self.fill(quarter, sources, halvings + 1);
        let [a, b, c, d] = square.quarters();
        if halvings < PARALLEL_HALVINGS {
            let ((a, b), (c, d)) =
                rayon::join(|| rayon::join(|| fill(a), || fill(b)), || rayon::join(|| fill(c), || fill(d)));
            [a, b, c, d].concat()
        } else {
            [a, b, c, d].into_iter().flat_map(fill).collect()
        }
    }

    fn full(&self) -> bool {
        self.placed.load(Ordering::Relaxed) > MOST_NODES
    }

    fn on_sheet(&self, point: Point2<f64>) -> Point2<f64> {
        self.origin + self.turn * (point.coords + self.shift)
    }

    /// The lattice whose edges are closest to a wanted length, in ratio.
    fn level(&self, wanted: f64) -> i32 {
        let finer = (self.size_field.longest / wanted).ln() / 3_f64.sqrt().ln();
        finer.round().max(0.0) as i32
    }

    fn edge(&self, level: i32) -> f64 {
        self.size_field.longest * 3_f64.sqrt().powi(-level)
    }

    /// Points of a lattice within a square, each with the coarsest lattice that it belongs to.
    fn points(&self, square: Square, level: i32) -> impl Iterator<Item = (i32, Point2<f64>)> + '_ {
        let edge = self.edge(level);
        let Square { middle, half } = square.turned_back(level);
        let reach = move |x: f64, unit: f64| {
            ((x - half) / unit - 0.5).floor() as i64..=((x + half) / unit + 0.5).ceil() as i64
        };
        let rows = reach(middle.y, edge * 3_f64.sqrt() / 2.0);
        rows.flat_map(move |b| reach(middle.x + b as f64 / 2.0 * edge, edge).map(move |a| [a, b]))
            .map(move |integer| coarsest(integer, level))
            .map(move |(integer, level)| (level, self.place(integer, level)))
            .filter(move |(_, point)| square.holds(*point))
            .map(|(level, point)| (level, self.on_sheet(point)))
    }

    /// (a + b w) / t^level in edges of the coarsest lattice, in the frame of the lattice.
    fn place(&self, [a, b]: [i64; 2], level: i32) -> Point2<f64> {
        let edge = self.edge(level);
        let (a, b) = (a as f64, b as f64);
        quarter_turns(Point2::new((a - b / 2.0) * edge, b * 3_f64.sqrt() / 2.0 * edge), -level)
    }
}

impl Square {
    fn quarters(self) -> [Self; 4] {
        let half = self.half / 2.0;
        [[-half, -half], [half, -half], [-half, half], [half, half]]
            .map(|step| Self { middle: self.middle + Vector2::from(step), half })
    }

    /// Without its right and upper side, so that squares share no point.
    fn holds(self, point: Point2<f64>) -> bool {
        let [low, high] = [-self.half, self.half].map(|half| self.middle + Vector2::repeat(half));
        (low.x..high.x).contains(&point.x) && (low.y..high.y).contains(&point.y)
    }

    fn turned_back(self, level: i32) -> Self {
        Self { middle: quarter_turns(self.middle, level), half: self.half }
    }
}

fn quarter_turns(point: Point2<f64>, turns: i32) -> Point2<f64> {
    match turns.rem_euclid(4) {
        0 => point,
        1 => Point2::new(-point.y, point.x),
        2 => Point2::new(-point.x, -point.y),
        _ => Point2::new(point.y, -point.x),
    }
}

/// Divides by t = 1 + 2 w as often as that leaves integers.
fn coarsest([mut a, mut b]: [i64; 2], mut level: i32) -> ([i64; 2], i32) {
    while level > 0 && (a + b).rem_euclid(3) == 0 {
        (a, b) = ((2 * b - a) / 3, (b - 2 * a) / 3);
        level -= 1;
    }
    ([a, b], level)
}

//! Closed curves, walked by arc length.

use super::piece::{Ellipse, Piece};
use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// A closed curve that does not meet itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    pieces: Vec<Piece>,
    /// How far along the pieces each one starts, m.
    starts: Vec<f64>,
    length: f64,
    /// How far along the pieces arc length 0 lies, m.
    zero: f64,
}

/// The point of one piece that is nearest to another point.
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// Its arc length, m.
    pub arc_length: f64,
    /// Where it lies.
    pub point: Point2<f64>,
    /// How far away it is, m.
    pub distance: f64,
}

impl Curve {
    /// A circle; arc length 0 lies to the right of its centre.
    #[must_use]
    pub fn circle(centre: Point2<f64>, radius: f64) -> Self {
        Self::new(vec![Piece::Arc { centre, radius, start: 0.0, sweep: TAU }])
    }

    /// Straight sides between `corners`, counter-clockwise; arc length 0 lies at one of them.
    #[must_use]
    pub fn polygon(corners: &[Point2<f64>]) -> Self {
        let side = |i: usize| Piece::Line { from: corners[i], to: corners[(i + 1) % corners.len()] };
        let curve = Self::new((0..corners.len()).map(side).collect());
        if curve.signed_area() >= 0.0 {
            return curve;
        }
        Self::polygon(&corners.iter().rev().copied().collect::<Vec<_>>())
    }

    pub(super) fn ellipse(half: [f64; 2]) -> Self {
        Self::new(vec![Piece::Ellipse(Ellipse::new(half))])
    }

    pub(super) fn new(pieces: Vec<Piece>) -> Self {
        let mut length = 0.0;
        let start_of = |piece: &Piece| {
            length += piece.length();
            length - piece.length()
        };
        let starts = pieces.iter().map(start_of).collect();
        Self { pieces, starts, length, zero: 0.0 }
    }

    /// The same curve with arc length 0 where it was `s`.
    pub(super) fn starting_at(mut self, s: f64) -> Self {
        self.zero += s;
        self
    }

    /// Length all round, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Point at an arc length, m.
    #[must_use]
    pub fn point(&self, s: f64) -> Point2<f64> {
        let (piece, s) = self.locate(s);
        self.pieces[piece].point(s)
    }

    /// How far apart two arc lengths lie along the curve, the shorter way round, m.
    #[must_use]
    pub fn along(&self, a: f64, b: f64) -> f64 {
        let ahead = (a - b).rem_euclid(self.length);
        ahead.min(self.length - ahead)
    }

    /// Radius of curvature at an arc length, m; infinite on a straight side.
    #[must_use]
    pub fn curvature_radius(&self, s: f64) -> f64 {
        let (piece, s) = self.locate(s);
        self.pieces[piece].curvature_radius(s)
    }

    fn locate(&self, s: f64) -> (usize, f64) {
        let s = (s + self.zero).rem_euclid(self.length);
        let piece = self.starts.partition_point(|&start| start <= s).max(1) - 1;
        (piece, s - self.starts[piece])
    }

    /// Arc lengths where two pieces meet, ascending; none on a circle or an ellipse.
    #[must_use]
    pub fn corners(&self) -> Vec<f64> {
        if self.pieces.len() == 1 {
            return Vec::new();
        }
        let mut corners: Vec<_> = self.starts.iter().map(|&start| self.piece_arc_length(start)).collect();
        corners.sort_by(f64::total_cmp);
        corners
    }

    fn piece_arc_length(&self, along: f64) -> f64 {
        (along - self.zero).rem_euclid(self.length)
    }

    /// The nearest point of each piece.
    pub fn feet(&self, point: Point2<f64>) -> impl Iterator<Item = Foot> + '_ {
        self.pieces.iter().zip(&self.starts).map(move |(piece, start)| {
            let s = piece.nearest(point);
            let foot = piece.point(s);
            let arc_length = self.piece_arc_length(start + s);
            Foot { arc_length, point: foot, distance: (point - foot).norm() }
        })
    }

    /// The nearest point of the curve.
    #[must_use]
    pub fn nearest(&self, point: Point2<f64>) -> Foot {
        let nearest = self.feet(point).min_by(|a, b| a.distance.total_cmp(&b.distance));
        nearest.expect("a curve has a piece")
    }

    /// Whether a point lies within the curve: a ray to the right crosses the polygon of chords an
    /// odd number of times, but for the bulges between pieces and chords.
    #[must_use]
    pub fn encloses(&self, point: Point2<f64>) -> bool {
        // Each chord ends where the next begins, to the last bit: the end of a whole circle is its start.
        let next = self.pieces.iter().cycle().skip(1);
        self.pieces.iter().zip(next).fold(false, |inside, (piece, next)| {
            let [from, to] = [piece, next].map(|piece| piece.ends()[0]);
            let straddles = (from.y <= point.y) != (to.y <= point.y);
            let left = (to - from).perp(&(point - from)) > 0.0;
            inside ^ (straddles && left == (to.y > from.y)) ^ piece.bulge_holds(point)
        })
    }

    /// Area within, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.signed_area().abs()
    }

    fn signed_area(&self) -> f64 {
        let of_piece = |piece: &Piece| {
            let [from, to] = piece.ends();
            from.coords.perp(&to.coords) / 2.0 + piece.bulge_area()
        };
        self.pieces.iter().map(of_piece).sum()
    }

    /// Lower left and upper right corner of the box round the curve.
    #[must_use]
    pub fn bounds(&self) -> [Point2<f64>; 2] {
        let extremes = self.pieces.iter().flat_map(Piece::extremes);
        let nothing = [Point2::from([f64::INFINITY; 2]), Point2::from([f64::NEG_INFINITY; 2])];
        extremes.fold(nothing, |[low, high], point| [low.inf(&point), high.sup(&point)])
    }

    /// Arc length at which the ray from `eye` in direction `angle` (rad) meets the curve last.
    #[must_use]
    pub fn last_crossing(&self, eye: Point2<f64>, angle: f64) -> Option<f64> {
        let direction = Vector2::new(angle.cos(), angle.sin());
        let crossings = self.pieces.iter().zip(&self.starts).flat_map(|(piece, start)| {
            piece.crossings(eye, direction).into_iter().map(move |(t, s)| (t, start + s))
        });
        let last = crossings.max_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(self.piece_arc_length(last.1))
    }
}

//! Outline: the rim of a flat sheet, and of the holes in it.
//!
//! x points to the right, y upwards, lengths are in metres. The rim is walked counter-clockwise by arc
//! length, from where the positive x axis leaves the sheet. Angles are seen from the origin; if that
//! lies outside the rim, from the middle of the box round it.

mod curve;
mod piece;
mod polygon;

pub use curve::{Curve, Foot};
use nalgebra::Point2;
use piece::Piece;
pub use polygon::{Loop, PolygonError};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Shape of a flat sheet: a rim with holes.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    rim: Curve,
    holes: Vec<Curve>,
    /// Where angles are seen from.
    eye: Point2<f64>,
}

impl Outline {
    /// A disc round the origin.
    #[must_use]
    pub fn disc(radius: f64) -> Self {
        Self::new(Curve::circle(Point2::origin(), radius), Vec::new())
    }

    /// A rectangle round the origin.
    #[must_use]
    pub fn rectangle(width: f64, height: f64) -> Self {
        let (x, y) = (width / 2.0, height / 2.0);
        let corners = [[x, -y], [x, y], [-x, y], [-x, -y]].map(Point2::from);
        Self::new(Curve::polygon(&corners), Vec::new())
    }

    /// An ellipse round the origin with its axes along x and y.
    #[must_use]
    pub fn ellipse(width: f64, height: f64) -> Self {
        Self::new(Curve::ellipse([width / 2.0, height / 2.0]), Vec::new())
    }

    /// Straight sides between corners, and holes of the same kind; either way round.
    pub fn polygon(rim: &[Point2<f64>], holes: &[Vec<Point2<f64>>]) -> Result<Self, PolygonError> {
        polygon::check(rim, holes)?;
        Ok(Self::new(Curve::polygon(rim), holes.iter().map(|hole| Curve::polygon(hole)).collect()))
    }

    /// A sector of a ring, downwards from its centre. The origin lies half way between its arcs, on
    /// its axis of symmetry; `angle` is in rad, less than a full turn. `inner` may be 0.
    #[must_use]
    pub fn sector(inner: f64, outer: f64, angle: f64) -> Self {
        let centre = Point2::new(0.0, (inner + outer) / 2.0);
        let start = -FRAC_PI_2 - angle / 2.0;
        let rim = Piece::Arc { centre, radius: outer, start, sweep: angle };
        let back = Piece::Arc { centre, radius: inner, start: start + angle, sweep: -angle };
        let ([first, last], [top_last, top_first]) = (rim.ends(), back.ends());
        let mut pieces = vec![rim, Piece::Line { from: last, to: top_last }];
        if inner > 0.0 {
            pieces.push(back);
        }
        pieces.push(Piece::Line { from: top_first, to: first });
        Self::new(Curve::new(pieces), Vec::new())
    }

    fn new(rim: Curve, holes: Vec<Curve>) -> Self {
        let [low, high] = rim.bounds();
        let origin = Point2::origin();
        let eye = if rim.encloses(origin) { origin } else { nalgebra::center(&low, &high) };
        let start = position_at(&rim, eye, 0.0);
        Self { rim: rim.starting_at(start), holes, eye }
    }

    /// The outer rim.
    #[must_use]
    pub fn rim(&self) -> &Curve {
        &self.rim
    }

    /// Rims of the holes.
    #[must_use]
    pub fn holes(&self) -> &[Curve] {
        &self.holes
    }

    /// The outer rim, then those of the holes.
    pub fn curves(&self) -> impl Iterator<Item = &Curve> + Clone {
        std::iter::once(&self.rim).chain(&self.holes)
    }

    /// Length of the outer rim, m.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        self.rim.length()
    }

    /// Area of the sheet without its holes, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.rim.area() - self.holes.iter().map(Curve::area).sum::<f64>()
    }

    /// Lower left and upper right corner of the box round the sheet.
    #[must_use]
    pub fn bounds(&self) -> [Point2<f64>; 2] {
        self.rim.bounds()
    }

    /// Middle of the box round the sheet.
    #[must_use]
    pub fn middle(&self) -> Point2<f64> {
        let [low, high] = self.bounds();
        nalgebra::center(&low, &high)
    }

    /// Half the size of the box round the sheet along x and y, m.
    #[must_use]
    pub fn half_size(&self) -> [f64; 2] {
        let [low, high] = self.bounds();
        ((high - low) / 2.0).into()
    }

    /// The larger of width and height, m: what errors in per cent refer to.
    #[must_use]
    pub fn diameter(&self) -> f64 {
        let [x, y] = self.half_size();
        2.0 * x.max(y)
    }

    /// Point of the outer rim at arc length `s` from where the positive x axis leaves the sheet.
    #[must_use]
    pub fn rim_point(&self, s: f64) -> Point2<f64> {
        self.rim.point(s)
    }

    /// Arc length at which the ray in direction `angle` (rad) leaves the sheet: of several crossings
    /// the last. Where it misses a sheet that is not round its middle, the corner closest to that
    /// direction.
    #[must_use]
    pub fn rim_position(&self, angle: f64) -> f64 {
        position_at(&self.rim, self.eye, angle)
    }

    /// Arc lengths of the rim's corners, ascending; none on a disc or an ellipse.
    #[must_use]
    pub fn corners(&self) -> Vec<f64> {
        self.rim.corners()
    }

    /// Distance from `point` to the nearest rim, m: positive on the sheet, negative off it and in its
    /// holes.
    #[must_use]
    pub fn depth(&self, point: Point2<f64>) -> f64 {
        let distance = self.curves().map(|curve| curve.nearest(point).distance).fold(f64::INFINITY, f64::min);
        let on_sheet = self.rim.encloses(point) && !self.holes.iter().any(|hole| hole.encloses(point));
        if on_sheet { distance } else { -distance }
    }
}

fn position_at(rim: &Curve, eye: Point2<f64>, angle: f64) -> f64 {
    let off = |s: &f64| {
        let seen = rim.point(*s) - eye;
        let turn = (seen.y.atan2(seen.x) - angle).rem_euclid(TAU);
        turn.min(TAU - turn)
    };
    let closest = || rim.corners().into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    rim.last_crossing(eye, angle).or_else(closest).unwrap_or(0.0)
}

#[cfg(test)]
mod tests;

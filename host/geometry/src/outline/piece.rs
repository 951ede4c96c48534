//! Pieces of a closed curve: straight lines, circular arcs, whole ellipses.

use nalgebra::{Point2, Vector2};
use std::f64::consts::{FRAC_PI_2, TAU};

/// One piece; arc lengths count from its start.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Piece {
    /// Straight from one point to another.
    Line { from: Point2<f64>, to: Point2<f64> },
    /// From the angle `start` on, counter-clockwise if `sweep` is positive.
    Arc { centre: Point2<f64>, radius: f64, start: f64, sweep: f64 },
    /// A whole ellipse round the origin.
    Ellipse(Ellipse),
}

impl Piece {
    pub(super) fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
            Self::Ellipse(ellipse) => ellipse.length(),
        }
    }

    pub(super) fn point(&self, s: f64) -> Point2<f64> {
        match self {
            Self::Line { from, to } => from + (to - from) * (s / self.length()),
            Self::Arc { centre, radius, start, sweep } => {
                centre + polar(*radius, start + s / radius * sweep.signum())
            }
            Self::Ellipse(ellipse) => ellipse.point(ellipse.anomaly(s)),
        }
    }

    /// Arc length of its point nearest to `point`.
    pub(super) fn nearest(&self, point: Point2<f64>) -> f64 {
        match self {
            Self::Line { from, to } => {
                let along = (to - from) / self.length();
                (point - from).dot(&along).clamp(0.0, self.length())
            }
            Self::Arc { centre, radius, start, sweep } => {
                let turn = turn_to(point - centre, *start, *sweep);
                // Beyond its end, the end or the start is nearest, whichever is reached first.
                let end = sweep.abs();
                let turn = if turn <= end {
                    turn
                } else if turn - end < TAU - turn {
                    end
                } else {
                    0.0
                };
                radius * turn
            }
            Self::Ellipse(ellipse) => ellipse.arc_length(ellipse.nearest(point)),
        }
    }

    /// Where the ray from `eye` in the unit `direction` meets it: distance and arc length.
    pub(super) fn crossings(&self, eye: Point2<f64>, direction: Vector2<f64>) -> Vec<(f64, f64)> {
        let met = match self {
            Self::Line { from, to } => line_crossing(*from, *to, eye, direction),
            Self::Arc { centre, radius, start, sweep } => {
                let on_arc =
                    |&(_, offset): &(f64, Vector2<f64>)| turn_to(offset, *start, *sweep) <= sweep.abs();
                let arc_length = |offset| radius * turn_to(offset, *start, *sweep);
                let met = circle_crossings((eye - centre) / *radius, direction / *radius);
                met.into_iter().filter(on_arc).map(|(t, offset)| (t, arc_length(offset))).collect()
            }
            Self::Ellipse(ellipse) => {
                let [a, b] = ellipse.half;
                let squeeze = |v: Vector2<f64>| Vector2::new(v.x / a, v.y / b);
                let met = circle_crossings(squeeze(eye.coords), squeeze(direction));
                met.into_iter().map(|(t, v)| (t, ellipse.arc_length(v.y.atan2(v.x)))).collect()
            }
        };
        met.into_iter().filter(|&(t, _)| t > 0.0).collect()
    }

    /// Radius of curvature at an arc length; infinite on a line.
    pub(super) fn curvature_radius(&self, s: f64) -> f64 {
        match self {
            Self::Line { .. } => f64::INFINITY,
            Self::Arc { radius, .. } => *radius,
            Self::Ellipse(ellipse) => {
                let [a, b] = ellipse.half;
                ellipse.speed(ellipse.anomaly(s)).powi(3) / (a * b)
            }
        }
    }

    /// Whether `point` lies between the piece and its chord.
    pub(super) fn bulge_holds(&self, point: Point2<f64>) -> bool {
        match self {
            Self::Line { .. } => false,
            Self::Arc { centre, radius, sweep, .. } => {
                let [from, to] = self.ends();
                let left_of_chord = (to - from).perp(&(point - from)) > 0.0;
                let whole = sweep.abs() >= TAU;
                (point - centre).norm() < *radius && (whole || left_of_chord == (*sweep < 0.0))
            }
            Self::Ellipse(ellipse) => ellipse.holds(point),
        }
    }

    /// Area between the piece and its chord; positive if the piece turns counter-clockwise.
    pub(super) fn bulge_area(&self) -> f64 {
        match self {
            Self::Line { .. } => 0.0,
            Self::Arc { radius, sweep, .. } if sweep.abs() >= TAU => sweep / 2.0 * radius * radius,
            Self::Arc { radius, sweep, .. } => (sweep - sweep.sin()) / 2.0 * radius * radius,
            Self::Ellipse(Ellipse { half: [a, b], .. }) => TAU / 2.0 * a * b,
        }
    }

    pub(super) fn ends(&self) -> [Point2<f64>; 2] {
        match self {
            Self::Line { from, to } => [*from, *to],
            Self::Arc { centre, radius, start, sweep } => {
                [*start, start + sweep].map(|angle| centre + polar(*radius, angle))
            }
            Self::Ellipse(ellipse) => [ellipse.point(0.0); 2],
        }
    }

    /// Points that reach as far as the piece does along x and y, both ways.
    pub(super) fn extremes(&self) -> Vec<Point2<f64>> {
        let quarters = (0..4).map(|quarter| f64::from(quarter) * FRAC_PI_2);
        match self {
            Self::Line { from, to } => vec![*from, *to],
            Self::Arc { centre, radius, start, sweep } => {
                let on_arc = |angle: &f64| turn_to(polar(1.0, *angle), *start, *sweep) <= sweep.abs();
                let sides = quarters.filter(on_arc).map(|angle| centre + polar(*radius, angle));
                sides.chain(self.ends()).collect()
            }
            Self::Ellipse(ellipse) => quarters.map(|angle| ellipse.point(angle)).collect(),
        }
    }
}

fn polar(radius: f64, angle: f64) -> Vector2<f64> {
    Vector2::new(radius * angle.cos(), radius * angle.sin())
}

/// Angle from `start` on to a direction, the way that `sweep` turns: 0 to a full turn.
fn turn_to(direction: Vector2<f64>, start: f64, sweep: f64) -> f64 {
    ((direction.y.atan2(direction.x) - start) * sweep.signum()).rem_euclid(TAU)
}

fn line_crossing(
    from: Point2<f64>,
    to: Point2<f64>,
    eye: Point2<f64>,
    direction: Vector2<f64>,
) -> Vec<(f64, f64)> {
    let side = to - from;
    let across = direction.perp(&side);
    let share = (from - eye).perp(&direction) / across;
    let t = (from - eye).perp(&side) / across;
    // A share just outside 0 to 1 is rounding at a corner.
    let met = (-1e-12..=1.0 + 1e-12).contains(&share);
    if met { vec![(t, share.clamp(0.0, 1.0) * side.norm())] } else { Vec::new() }
}

/// Where the line `eye + t * step` meets the unit circle: t and point.
fn circle_crossings(eye: Vector2<f64>, step: Vector2<f64>) -> Vec<(f64, Vector2<f64>)> {
    let (a, b, c) = (step.norm_squared(), eye.dot(&step), eye.norm_squared() - 1.0);
    let discriminant = b * b - a * c;
    if discriminant < 0.0 {
        return Vec::new();
    }
    let root = discriminant.sqrt();
    [(-b - root) / a, (-b + root) / a].map(|t| (t, eye + step * t)).to_vec()
}

/// An ellipse round the origin, walked from (a, 0) on by the eccentric anomaly: (a cos E, b sin E).
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ellipse {
    half: [f64; 2],
    /// Arc length at equally spaced anomalies, both ends included.
    arc_lengths: Vec<f64>,
}

/// Steps of the table of arc lengths; fine enough for ten-point accuracy on flat ellipses.
const STEPS: usize = 720;
const STEP: f64 = TAU / STEPS as f64;
/// Nodes and weights of Gauss' quadrature with five points on -1 to 1.
const GAUSS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

impl Ellipse {
    pub(super) fn new(half: [f64; 2]) -> Self {
        let mut ellipse = Self { half, arc_lengths: vec![0.0] };
        for step in 0..STEPS {
            let so_far = ellipse.arc_lengths[step];
            let from = step as f64 * STEP;
            ellipse.arc_lengths.push(so_far + ellipse.between(from, from + STEP));
        }
        ellipse
    }

    fn length(&self) -> f64 {
        self.arc_lengths[STEPS]
    }

    fn point(&self, anomaly: f64) -> Point2<f64> {
        let [a, b] = self.half;
        Point2::new(a * anomaly.cos(), b * anomaly.sin())
    }

    /// Arc length per anomaly.
    fn speed(&self, anomaly: f64) -> f64 {
        let [a, b] = self.half;
        (a * anomaly.sin()).hypot(b * anomaly.cos())
    }

    /// Arc length between two anomalies no further apart than a step.
    fn between(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
        half * GAUSS.iter().map(|(x, weight)| weight * self.speed(middle + half * x)).sum::<f64>()
    }

    fn arc_length(&self, anomaly: f64) -> f64 {
        let anomaly = anomaly.rem_euclid(TAU);
        let step = ((anomaly / STEP) as usize).min(STEPS - 1);
        self.arc_lengths[step] + self.between(step as f64 * STEP, anomaly)
    }

    /// The anomaly at an arc length, by Newton's method within one step.
    fn anomaly(&self, s: f64) -> f64 {
        let step = self.arc_lengths.partition_point(|&length| length <= s).clamp(1, STEPS) - 1;
        let from = step as f64 * STEP;
        let rest = s - self.arc_lengths[step];
        let start = from + rest / self.speed(from + STEP / 2.0);
        (0..4).fold(start, |anomaly, _| anomaly - (self.between(from, anomaly) - rest) / self.speed(anomaly))
    }

    fn holds(&self, point: Point2<f64>) -> bool {
        let [a, b] = self.half;
        (point.x / a).hypot(point.y / b) < 1.0
    }

    /// Anomaly of the nearest point of the ellipse (Eberly, "Distance from a point to an ellipse").
    ///
    /// In the first quadrant with a >= b, the foot is (a^2 x / (t + a^2), b^2 y / (t + b^2)), where t
    /// is the largest root of F(t) = (a x / (t + a^2))^2 + (b y / (t + b^2))^2 - 1. F falls and is
    /// convex, so Newton's method from its left runs straight to the root.
    fn nearest(&self, point: Point2<f64>) -> f64 {
        let [a, b] = self.half;
        let long = a.max(b);
        // A point on an axis is taken for one a hair beside it.
        let (x, y) = (point.x.abs().max(1e-13 * long), point.y.abs().max(1e-13 * long));
        let (ax, by) = (a * x, b * y);
        let mut t = (ax - a * a).max(by - b * b);
        for _ in 0..100 {
            let (u, v) = (ax / (t + a * a), by / (t + b * b));
            let excess = u * u + v * v - 1.0;
            let slope = -2.0 * (u * u / (t + a * a) + v * v / (t + b * b));
            let next = t - excess / slope;
            if (next - t).abs() <= 1e-15 * long * long {
                break;
            }
            t = next;
        }
        let (u, v) = (ax / (t + a * a), by / (t + b * b));
        (v * point.y.signum()).atan2(u * point.x.signum())
    }
}

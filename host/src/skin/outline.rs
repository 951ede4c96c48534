//! Outline: the rim of a flat skin as a closed curve, walked counter-clockwise by arc length.
//!
//! The origin is the skin's centre, x points to the right, y upwards, lengths are in metres.

use nalgebra::{Point2, Vector2};
use std::f64::consts::TAU;

/// Shape of a flat skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Outline {
    /// A disc.
    Disc {
        /// Radius, m.
        radius: f64,
    },
    /// A rectangle.
    Rectangle {
        /// Length along x, m.
        width: f64,
        /// Length along y, m.
        height: f64,
    },
}

impl Outline {
    /// Length of the rim, m.
    #[must_use]
    pub fn perimeter(&self) -> f64 {
        match *self {
            Self::Disc { radius } => TAU * radius,
            Self::Rectangle { width, height } => 2.0 * (width + height),
        }
    }

    /// Area of the skin, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        match *self {
            Self::Disc { radius } => TAU / 2.0 * radius * radius,
            Self::Rectangle { width, height } => width * height,
        }
    }

    /// Half the size along x and y, m.
    #[must_use]
    pub fn half_size(&self) -> [f64; 2] {
        match *self {
            Self::Disc { radius } => [radius; 2],
            Self::Rectangle { width, height } => [width / 2.0, height / 2.0],
        }
    }

    /// The larger of width and height, m: what errors in per cent refer to.
    #[must_use]
    pub fn diameter(&self) -> f64 {
        let [x, y] = self.half_size();
        2.0 * x.max(y)
    }

    /// Point of the rim at arc length `s` from where the positive x axis leaves the skin.
    #[must_use]
    pub fn rim_point(&self, s: f64) -> Point2<f64> {
        let s = s.rem_euclid(self.perimeter());
        match *self {
            Self::Disc { radius } => Point2::new(radius * (s / radius).cos(), radius * (s / radius).sin()),
            Self::Rectangle { .. } => self.rectangle_point(s),
        }
    }

    fn rectangle_point(&self, s: f64) -> Point2<f64> {
        let [x, y] = self.half_size();
        let corners = self.corners();
        if s <= corners[0] {
            Point2::new(x, s)
        } else if s <= corners[1] {
            Point2::new(x - (s - corners[0]), y)
        } else if s <= corners[2] {
            Point2::new(-x, y - (s - corners[1]))
        } else if s <= corners[3] {
            Point2::new(-x + (s - corners[2]), -y)
        } else {
            Point2::new(x, -y + (s - corners[3]))
        }
    }

    /// Arc length at which the ray from the centre in direction `angle` (rad) crosses the rim.
    #[must_use]
    pub fn rim_position(&self, angle: f64) -> f64 {
        let direction = Vector2::new(angle.cos(), angle.sin());
        match *self {
            Self::Disc { radius } => radius * angle.rem_euclid(TAU),
            Self::Rectangle { .. } => self.rectangle_position(direction),
        }
    }

    fn rectangle_position(&self, direction: Vector2<f64>) -> f64 {
        let [x, y] = self.half_size();
        let corners = self.corners();
        let hit = direction * (x / direction.x.abs()).min(y / direction.y.abs());
        let on_side = (hit.x.abs() - x).abs() <= (hit.y.abs() - y).abs();
        let s = match (on_side, hit.x > 0.0, hit.y > 0.0) {
            (true, true, _) => hit.y,
            (true, false, _) => corners[1] + (y - hit.y),
            (false, _, true) => corners[0] + (x - hit.x),
            (false, _, false) => corners[2] + (hit.x + x),
        };
        s.rem_euclid(self.perimeter())
    }

    /// Arc lengths of the corners, ascending; none on a disc.
    #[must_use]
    pub fn corners(&self) -> Vec<f64> {
        match *self {
            Self::Disc { .. } => Vec::new(),
            Self::Rectangle { width, height } => {
                let first = height / 2.0;
                vec![first, first + width, first + width + height, first + 2.0 * width + height]
            }
        }
    }

    /// Distance from `point` to the rim, m: positive inside, negative outside.
    #[must_use]
    pub fn depth(&self, point: Point2<f64>) -> f64 {
        match *self {
            Self::Disc { radius } => radius - point.coords.norm(),
            Self::Rectangle { .. } => {
                let [x, y] = self.half_size();
                (x - point.x.abs()).min(y - point.y.abs())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn outlines() -> impl Strategy<Value = Outline> {
        prop_oneof![
            (0.01..1.0).prop_map(|radius| Outline::Disc { radius }),
            (0.01..1.0, 0.01..1.0).prop_map(|(width, height)| Outline::Rectangle { width, height }),
        ]
    }

    proptest! {
        #[test]
        fn a_ray_meets_the_rim_where_its_arc_length_says(outline in outlines(), angle in 0.0..TAU) {
            let point = outline.rim_point(outline.rim_position(angle));
            prop_assert!(outline.depth(point).abs() < 1e-12);
            let turn = (point.y.atan2(point.x) - angle).rem_euclid(TAU);
            prop_assert!(turn.min(TAU - turn) < 1e-9);
        }

        #[test]
        fn walking_the_rim_covers_its_length(outline in outlines(), start in 0.0..3.0) {
            let step = outline.perimeter() / 4000.0;
            let length: f64 = (0..4000)
                .map(|i| start + f64::from(i) * step)
                .map(|s| (outline.rim_point(s + step) - outline.rim_point(s)).norm())
                .sum();
            prop_assert!((length / outline.perimeter() - 1.0).abs() < 2e-3);
        }
    }
}

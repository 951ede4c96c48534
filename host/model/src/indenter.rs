//! Indenter: what touches a skin, where, and how hard.

use dermatome_geometry::outline::Outline;
use nalgebra::Point2;
use std::{f64::consts::PI, str::FromStr};

/// Shape of what touches the skin. Sizes are in m, corners in the indenter's own frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Footprint {
    /// A round tip, whose pressure falls to zero at the radius as under a ball on a plane (Hertz).
    Finger {
        /// Radius of the touched disc.
        radius: f64,
    },
    /// The flat end of a rod.
    Disc {
        /// Radius.
        radius: f64,
    },
    /// The flat end of a tube: an 'O'.
    Ring {
        /// Outer radius.
        outer: f64,
        /// Radius of the hole.
        inner: f64,
    },
    /// A flat square.
    Square {
        /// Side.
        side: f64,
    },
    /// An 'L' of two equal arms; the middle of the box round it is the origin, its corner at the lower
    /// left.
    Corner {
        /// Length of an arm, measured outside.
        length: f64,
        /// Width of an arm.
        width: f64,
    },
    /// Any flat polygon, its corners either way round; sides must not meet.
    Polygon(Vec<[f64; 2]>),
}

/// How hard an indenter presses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// Relative conductivity change in its middle, whatever the skin is made of.
    Change(f64),
    /// Mean pressure, Pa; what it changes is up to the skin's material.
    Pressure(f64),
    /// Force, N; likewise.
    Force(f64),
}

/// One indenter on the skin.
#[derive(Clone, Debug, PartialEq)]
pub struct Press {
    /// Origin of the indenter, m, in the skin's frame.
    pub position: [f64; 2],
    /// Counter-clockwise turn of the indenter, rad.
    pub angle: f64,
    /// Its shape.
    pub footprint: Footprint,
    /// How hard it presses.
    pub load: Load,
}

/// A press makes no sense.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("press field `{field}` is {value}; allowed: {allowed}")]
pub struct PressError {
    /// Which number.
    pub field: &'static str,
    /// Its value.
    pub value: String,
    /// What it may be.
    pub allowed: String,
}

impl Footprint {
    /// Pressure at a point of the indenter's frame over that in its middle, 0 to 1.
    fn profile(&self, [x, y]: [f64; 2]) -> f64 {
        let flat = |inside: bool| f64::from(u8::from(inside));
        match self {
            Self::Finger { radius } => (1.0 - (x.hypot(y) / radius).powi(2)).max(0.0).sqrt(),
            Self::Disc { radius } => flat(x.hypot(y) < *radius),
            Self::Ring { outer, inner } => flat((*inner..*outer).contains(&x.hypot(y))),
            Self::Square { .. } | Self::Corner { .. } | Self::Polygon(_) => {
                flat(is_inside(&self.corners(), [x, y]))
            }
        }
    }

    /// Mean of the profile over the area.
    fn mean_profile(&self) -> f64 {
        if matches!(self, Self::Finger { .. }) { 2.0 / 3.0 } else { 1.0 }
    }

    /// Touched area, m^2.
    #[must_use]
    pub fn area(&self) -> f64 {
        match self {
            Self::Finger { radius } | Self::Disc { radius } => PI * radius * radius,
            Self::Ring { outer, inner } => PI * (outer * outer - inner * inner),
            _ => signed_area(&self.corners()).abs(),
        }
    }

    /// Centre of pressure in the indenter's frame, m.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        match self {
            Self::Corner { .. } | Self::Polygon(_) => centroid(&self.corners()),
            _ => [0.0; 2],
        }
    }

    /// Distance of its farthest point from its origin, m.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Finger { radius } | Self::Disc { radius } | Self::Ring { outer: radius, .. } => *radius,
            _ => self.corners().iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
        }
    }

    /// Corners of one that has some.
    fn corners(&self) -> Vec<[f64; 2]> {
        match self {
            Self::Square { side } => {
                let half = side / 2.0;
                vec![[-half, -half], [half, -half], [half, half], [-half, half]]
            }
            Self::Corner { length, width } => {
                let half = length / 2.0;
                let inner = width - half;
                vec![
                    [-half, -half],
                    [half, -half],
                    [half, inner],
                    [inner, inner],
                    [inner, half],
                    [-half, half],
                ]
            }
            Self::Polygon(corners) => corners.clone(),
            Self::Finger { .. } | Self::Disc { .. } | Self::Ring { .. } => Vec::new(),
        }
    }

    /// What lies `share` of the way to another of the same kind; `None` if it is of another kind.
    #[must_use]
    pub fn towards(&self, to: &Self, share: f64) -> Option<Self> {
        let mix = |a: &f64, b: &f64| a + (b - a) * share;
        Some(match (self, to) {
            (Self::Finger { radius: a }, Self::Finger { radius: b }) => Self::Finger { radius: mix(a, b) },
            (Self::Disc { radius: a }, Self::Disc { radius: b }) => Self::Disc { radius: mix(a, b) },
            (Self::Square { side: a }, Self::Square { side: b }) => Self::Square { side: mix(a, b) },
            (Self::Ring { outer, inner }, Self::Ring { outer: o, inner: i }) => {
                Self::Ring { outer: mix(outer, o), inner: mix(inner, i) }
            }
            (Self::Corner { length, width }, Self::Corner { length: l, width: w }) => {
                Self::Corner { length: mix(length, l), width: mix(width, w) }
            }
            (Self::Polygon(a), Self::Polygon(b)) if a == b => self.clone(),
            _ => return None,
        })
    }

    /// The number that makes no sense, with its value and what is allowed.
    fn fault(&self) -> Option<(&'static str, String, &'static str)> {
        let length = |field, value: f64| {
            let is_wrong = !(value > 0.0 && value.is_finite());
            is_wrong.then(|| (field, format!("{value} m"), "a length above zero, in m"))
        };
        let below = |field, value: f64, limit: f64, allowed| {
            (value >= limit).then(|| (field, format!("{value} m"), allowed))
        };
        match self {
            Self::Finger { radius } | Self::Disc { radius } => length("radius", *radius),
            Self::Square { side } => length("radius", side / 2.0),
            Self::Ring { outer, inner } => length("radius", *outer)
                .or_else(|| length("inner", *inner))
                .or_else(|| below("inner", *inner, *outer, "less than the radius")),
            Self::Corner { length: arm, width } => length("radius", arm / 2.0)
                .or_else(|| length("inner", *width))
                .or_else(|| below("inner", *width, *arm, "less than twice the radius")),
            Self::Polygon(corners) => {
                let is_wrong = !(signed_area(corners).abs() > 0.0 && self.reach().is_finite());
                let allowed = "three or more corners x:y round an area, in m, as in 0:0 0.01:0 0:0.01";
                let points: Vec<Point2<f64>> = corners.iter().copied().map(Point2::from).collect();
                let meets = || Outline::polygon(&points, &[]).err();
                let empty = is_wrong.then(|| ("corners", format!("{corners:?}"), allowed));
                empty.or_else(|| {
                    let fault = meets()?;
                    Some(("corners", format!("{corners:?} ({fault})"), "sides that do not meet or cross"))
                })
            }
        }
    }
}

impl Load {
    /// Its number, in its own unit.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Change(value) | Self::Pressure(value) | Self::Force(value) => value,
        }
    }

    /// The same kind of load with another number.
    #[must_use]
    pub fn with(self, value: f64) -> Self {
        match self {
            Self::Change(_) => Self::Change(value),
            Self::Pressure(_) => Self::Pressure(value),
            Self::Force(_) => Self::Force(value),
        }
    }

    /// What lies `share` of the way to another of the same kind.
    #[must_use]
    pub fn towards(self, to: Self, share: f64) -> Option<Self> {
        let is_alike = std::mem::discriminant(&self) == std::mem::discriminant(&to);
        is_alike.then(|| self.with(self.value() + (to.value() - self.value()) * share))
    }

    fn fault(self) -> Option<(&'static str, String, &'static str)> {
        let (range, field, allowed) = match self {
            Self::Change(_) => (-0.99..=1000.0, "depth", "-0.99 to 1000 (1 doubles the conductivity)"),
            Self::Pressure(_) => (0.0..=1e9, "pressure", "0 to 1e9 Pa"),
            Self::Force(_) => (0.0..=1e6, "force", "0 to 1e6 N"),
        };
        (!range.contains(&self.value())).then(|| (field, self.value().to_string(), allowed))
    }
}

impl Press {
    /// A finger that changes the conductivity under its middle by `depth`, relative.
    #[must_use]
    pub const fn finger(position: [f64; 2], radius: f64, depth: f64) -> Self {
        let footprint = Footprint::Finger { radius };
        Self { position, angle: 0.0, footprint, load: Load::Change(depth) }
    }

    /// A shape in its usual attitude.
    #[must_use]
    pub const fn new(footprint: Footprint, position: [f64; 2], load: Load) -> Self {
        Self { position, angle: 0.0, footprint, load }
    }

    /// Relative conductivity change at a point that this press makes by itself; none where it is
    /// pressure that matters.
    #[must_use]
    pub fn change_at(&self, point: [f64; 2]) -> f64 {
        match self.load {
            Load::Change(depth) => depth * self.footprint.profile(self.local(point)),
            Load::Pressure(_) | Load::Force(_) => 0.0,
        }
    }

    /// Pressure at a point, Pa; none where only the change is given.
    #[must_use]
    pub fn pressure_at(&self, point: [f64; 2]) -> f64 {
        let profile = || self.footprint.profile(self.local(point)) / self.footprint.mean_profile();
        self.mean_pressure().map_or(0.0, |mean| mean * profile())
    }

    /// Mean pressure, Pa, unless only the change is given.
    #[must_use]
    pub fn mean_pressure(&self) -> Option<f64> {
        match self.load {
            Load::Change(_) => None,
            Load::Pressure(pressure) => Some(pressure),
            Load::Force(force) => Some(force / self.footprint.area()),
        }
    }

    /// Centre of pressure, m, in the skin's frame.
    #[must_use]
    pub fn centre(&self) -> [f64; 2] {
        let ([x, y], (sin, cos)) = (self.footprint.centre(), self.angle.sin_cos());
        [self.position[0] + x * cos - y * sin, self.position[1] + x * sin + y * cos]
    }

    /// Whether the numbers make sense on a skin.
    pub fn check(&self, outline: &Outline) -> Result<(), PressError> {
        let refuse = |(field, value, allowed): (&'static str, String, &str)| {
            Err(PressError { field, value, allowed: allowed.into() })
        };
        let [x, y] = self.position;
        let on_skin = outline.depth(Point2::new(x, y)) >= 0.0;
        if !on_skin {
            let [low, high] = outline.bounds();
            let allowed = format!(
                "a point on the skin, which lies between {} and {} m in x, {} and {} m in y",
                low.x, high.x, low.y, high.y
            );
            return refuse(("x,y", format!("{x},{y} m"), &allowed));
        }
        if !self.angle.is_finite() {
            return refuse(("angle", self.angle.to_string(), "an angle"));
        }
        self.footprint.fault().or_else(|| self.load.fault()).map_or(Ok(()), refuse)
    }

    /// A point in the indenter's own frame.
    fn local(&self, point: [f64; 2]) -> [f64; 2] {
        let [x, y] = [point[0] - self.position[0], point[1] - self.position[1]];
        let (sin, cos) = self.angle.sin_cos();
        [x * cos + y * sin, y * cos - x * sin]
    }
}

impl FromStr for Press {
    type Err = PressError;

    /// A finger: `x,y,radius,depth`, lengths in m.
    fn from_str(text: &str) -> Result<Self, PressError> {
        let parse = |part: &str| part.trim().parse::<f64>().ok();
        let numbers: Option<Vec<f64>> = text.split(',').map(parse).collect();
        match numbers.as_deref() {
            Some(&[x, y, radius, depth]) => Ok(Self::finger([x, y], radius, depth)),
            _ => Err(PressError {
                field: "press",
                value: format!("{text:?}"),
                allowed: "four numbers x,y,radius,depth (m, m, m, relative), as in 0.03,-0.02,0.01,1".into(),
            }),
        }
    }
}

/// Sides of a polygon.
fn sides(corners: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn signed_area(corners: &[[f64; 2]]) -> f64 {
    sides(corners).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum::<f64>() / 2.0
}

fn centroid(corners: &[[f64; 2]]) -> [f64; 2] {
    let moment = |axis: usize| -> f64 {
        sides(corners).map(|(a, b)| (a[axis] + b[axis]) * (a[0] * b[1] - b[0] * a[1])).sum()
    };
    [0, 1].map(|axis| moment(axis) / (6.0 * signed_area(corners)))
}

/// Whether an odd number of sides lies to the right of a point.
fn is_inside(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let crosses = |(a, b): &([f64; 2], [f64; 2])| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1])
    };
    sides(corners).filter(crosses).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SIZE: f64 = 0.04;

    fn shapes() -> [Footprint; 6] {
        [
            Footprint::Finger { radius: SIZE / 2.0 },
            Footprint::Disc { radius: SIZE / 2.0 },
            Footprint::Ring { outer: SIZE / 2.0, inner: SIZE / 4.0 },
            Footprint::Square { side: SIZE },
            Footprint::Corner { length: SIZE, width: SIZE / 4.0 },
            Footprint::Polygon(vec![[0.0, 0.0], [SIZE, 0.0], [0.0, SIZE]]),
        ]
    }

    /// Force and centre of pressure, summed over a fine grid.
    fn summed(press: &Press) -> (f64, [f64; 2]) {
        const STEPS: i32 = 400;
        let pitch = 4.0 * SIZE / f64::from(STEPS);
        let at = |i: i32| (f64::from(i) + 0.5) * pitch - 2.0 * SIZE;
        let (mut force, mut moment) = (0.0, [0.0; 2]);
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            let point = [press.position[0] + at(i), press.position[1] + at(j)];
            let here = press.pressure_at(point) * pitch * pitch;
            force += here;
            moment[0] += here * point[0];
            moment[1] += here * point[1];
        }
        (force, moment.map(|moment| moment / force))
    }

    #[test]
    fn every_shape_carries_its_force_and_has_its_centre() {
        for footprint in shapes() {
            let press = Press { position: [0.01, -0.02], angle: 0.5, footprint, load: Load::Force(3.0) };
            let (force, centre) = summed(&press);
            assert!((force / 3.0 - 1.0).abs() < 0.02, "{press:?}: {force}");
            let expected = press.centre();
            for axis in 0..2 {
                assert!((centre[axis] - expected[axis]).abs() < 2e-4, "{press:?}: {centre:?}");
            }
        }
    }

    #[test]
    fn a_pressure_is_the_mean_over_the_shape() {
        for footprint in shapes() {
            let area = footprint.area();
            let press = Press::new(footprint, [0.0; 2], Load::Pressure(2e3));
            let (force, _) = summed(&press);
            assert!((force / (2e3 * area) - 1.0).abs() < 0.02, "{press:?}");
        }
    }

    #[test]
    fn an_o_has_a_hole_and_an_l_has_a_corner() {
        let press = |footprint| Press::new(footprint, [0.0; 2], Load::Change(1.0));
        let [_, _, ring, _, corner, _] = shapes().map(press);
        assert_eq!((ring.change_at([0.005, 0.0]), ring.change_at([0.015, 0.0])), (0.0, 1.0));
        assert_eq!((corner.change_at([0.015, 0.015]), corner.change_at([-0.015, 0.015])), (0.0, 1.0));
        assert_eq!((corner.change_at([0.015, -0.015]), corner.change_at([0.0, 0.0])), (1.0, 0.0));
        let turned = Press { angle: PI / 2.0, ..corner };
        assert_eq!((turned.change_at([0.015, 0.015]), turned.change_at([-0.015, 0.015])), (1.0, 0.0));
    }

    #[test]
    fn numbers_that_make_no_sense_are_named() {
        let outline = Outline::disc(0.1);
        let refused =
            |footprint, load| Press::new(footprint, [0.0; 2], load).check(&outline).unwrap_err().to_string();
        let change = Load::Change(1.0);
        for (footprint, expected) in [
            (Footprint::Square { side: -0.1 }, "`radius` is -0.05 m"),
            (Footprint::Ring { outer: 0.01, inner: 0.02 }, "`inner` is 0.02 m"),
            (Footprint::Corner { length: 0.01, width: 0.01 }, "`inner` is 0.01 m"),
            (Footprint::Polygon(vec![[0.0; 2], [0.01, 0.0]]), "`corners`"),
            (
                Footprint::Polygon(vec![[0.0, 0.0], [0.02, 0.01], [0.02, 0.0], [0.0, 0.015]]),
                "sides that do not meet or cross",
            ),
            (Footprint::Polygon(vec![[0.0; 2], [0.01, f64::NAN], [1.0, 0.0]]), "`corners`"),
            (Footprint::Disc { radius: f64::NAN }, "`radius`"),
        ] {
            assert!(refused(footprint.clone(), change).contains(expected), "{footprint:?}");
        }
        let disc = Footprint::Disc { radius: 0.01 };
        assert!(refused(disc.clone(), Load::Force(-1.0)).contains("`force` is -1"));
        assert!(refused(disc, Load::Pressure(f64::INFINITY)).contains("`pressure` is inf"));
    }

    proptest! {
        #[test]
        fn a_square_is_the_same_however_it_is_given(x in -0.03..0.03_f64, y in -0.03..0.03_f64, angle in -7.0..7.0_f64) {
            let square = Footprint::Square { side: SIZE };
            let polygon = Footprint::Polygon(square.corners());
            let [a, b] = [square, polygon]
                .map(|footprint| Press { position: [0.001, 0.002], angle, footprint, load: Load::Change(1.0) });
            prop_assert_eq!(a.change_at([x, y]), b.change_at([x, y]));
        }
    }
}

//! Whether points are the corners of a polygon with holes.

use super::Curve;
use nalgebra::Point2;

/// Why points are no sheet. Rows count from 0.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Too few corners, or too many.
    #[error("{which} has {corners} corners; 3 to {MOST_CORNERS} make a polygon")]
    Corners {
        /// The rim, or a hole.
        which: Loop,
        /// How many it has.
        corners: usize,
    },
    /// A coordinate is not finite.
    #[error("row {} of {which} is not a number", row + 1)]
    NotFinite {
        /// The rim, or a hole.
        which: Loop,
        /// The corner.
        row: usize,
    },
    /// A corner lies on another corner or on a side.
    #[error("row {} of {which} touches the side of {other} that starts at row {}", row + 1, side + 1)]
    Touches {
        /// The rim, or a hole.
        which: Loop,
        /// The corner.
        row: usize,
        /// Where the side is.
        other: Loop,
        /// First corner of the side.
        side: usize,
    },
    /// Two sides cross.
    #[error("the sides of {which} and of {other} that start at rows {} and {} cross", row + 1, side + 1)]
    Crosses {
        /// The rim, or a hole.
        which: Loop,
        /// First corner of its side.
        row: usize,
        /// Where the other side is.
        other: Loop,
        /// First corner of the other side.
        side: usize,
    },
    /// A hole lies outside the rim, or in another hole.
    #[error("{which} does not lie on the sheet")]
    Outside {
        /// The hole.
        which: Loop,
    },
}

/// The rim, or a hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Loop {
    /// The outer rim.
    Rim,
    /// A hole, from 0.
    Hole(usize),
}

impl std::fmt::Display for Loop {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Rim => write!(formatter, "the rim"),
            Self::Hole(hole) => write!(formatter, "hole {}", hole + 1),
        }
    }
}

impl PolygonError {
    /// The rim or hole that is wrong.
    #[must_use]
    pub fn which(&self) -> Loop {
        match self {
            Self::Corners { which, .. }
            | Self::NotFinite { which, .. }
            | Self::Touches { which, .. }
            | Self::Crosses { which, .. }
            | Self::Outside { which } => *which,
        }
    }
}

/// Corners of a rim or a hole.
const MOST_CORNERS: usize = 5000;
/// Parts of the rims keep this distance, as a share of the size.
const CLEARANCE: f64 = 1e-6;

pub(super) fn check(rim: &[Point2<f64>], holes: &[Vec<Point2<f64>>]) -> Result<(), PolygonError> {
    let loops: Vec<(Loop, &[Point2<f64>])> = std::iter::once((Loop::Rim, rim))
        .chain(holes.iter().enumerate().map(|(i, hole)| (Loop::Hole(i), hole.as_slice())))
        .collect();
    for &(which, corners) in &loops {
        corners_are_sound(which, corners)?;
    }
    let extent = |axis: usize| {
        let values = rim.iter().map(|corner| corner[axis]);
        values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
    };
    let clearance = CLEARANCE * extent(0).max(extent(1));
    // A corner on a side would also count as a crossing: that is looked for last.
    for &here in &loops {
        loops.iter().try_for_each(|&there| keep_clear(here, there, clearance))?;
    }
    for (i, &here) in loops.iter().enumerate() {
        loops[..=i].iter().try_for_each(|&there| do_not_cross(here, there))?;
    }
    holes_lie_on_sheet(&loops)
}

fn corners_are_sound(which: Loop, corners: &[Point2<f64>]) -> Result<(), PolygonError> {
    if !(3..=MOST_CORNERS).contains(&corners.len()) {
        return Err(PolygonError::Corners { which, corners: corners.len() });
    }
    match corners.iter().position(|corner| !corner.iter().all(|value| value.is_finite())) {
        Some(row) => Err(PolygonError::NotFinite { which, row }),
        None => Ok(()),
    }
}

/// No corner of one loop touches a side of the other.
fn keep_clear(
    (which, corners): (Loop, &[Point2<f64>]),
    (other, sides): (Loop, &[Point2<f64>]),
    clearance: f64,
) -> Result<(), PolygonError> {
    for (row, &corner) in corners.iter().enumerate() {
        for side in 0..sides.len() {
            let end = (side + 1) % sides.len();
            let own = which == other && (row == side || row == end);
            if !own && distance(corner, sides[side], sides[end]) <= clearance {
                return Err(PolygonError::Touches { which, row, other, side });
            }
        }
    }
    Ok(())
}

fn do_not_cross(
    (which, corners): (Loop, &[Point2<f64>]),
    (other, sides): (Loop, &[Point2<f64>]),
) -> Result<(), PolygonError> {
    for row in 0..corners.len() {
        let next = (row + 1) % corners.len();
        for side in 0..sides.len() {
            let end = (side + 1) % sides.len();
            let meet = which == other && (side == row || side == next || end == row);
            if !meet && cross(corners[row], corners[next], sides[side], sides[end]) {
                return Err(PolygonError::Crosses { which, row, other, side });
            }
        }
    }
    Ok(())
}

fn distance(point: Point2<f64>, from: Point2<f64>, to: Point2<f64>) -> f64 {
    let side = to - from;
    let share = (point - from).dot(&side) / side.norm_squared();
    let share = if share.is_finite() { share.clamp(0.0, 1.0) } else { 0.0 };
    (point - (from + side * share)).norm()
}

fn cross(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>, d: Point2<f64>) -> bool {
    let left = |p: Point2<f64>, q: Point2<f64>, r: Point2<f64>| (q - p).perp(&(r - p)) > 0.0;
    left(a, b, c) != left(a, b, d) && left(c, d, a) != left(c, d, b)
}

fn holes_lie_on_sheet(loops: &[(Loop, &[Point2<f64>])]) -> Result<(), PolygonError> {
    let curves: Vec<Curve> = loops.iter().map(|(_, corners)| Curve::polygon(corners)).collect();
    for (i, &(which, corners)) in loops.iter().enumerate().skip(1) {
        let within = |j: usize| curves[j].encloses(corners[0]);
        if !within(0) || (1..curves.len()).any(|j| j != i && within(j)) {
            return Err(PolygonError::Outside { which });
        }
    }
    Ok(())
}

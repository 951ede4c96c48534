//! Shapes of elements, and which of Gmsh's are read.

use super::super::{
    Problem,
    cursor::{Cursor, Scalar},
};

/// Shape of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    Point,
    Line,
    Triangle,
}

impl Shape {
    pub(super) fn read(cursor: &mut Cursor) -> Result<Self, Problem> {
        let number = cursor.integer(Scalar::I32, "the type of an element")?;
        match number {
            15 => Ok(Self::Point),
            1 => Ok(Self::Line),
            2 => Ok(Self::Triangle),
            _ => {
                let found = format!("{number}, {}", foreign_shape(number));
                let allowed = "15, point; 1, line of 2 nodes; 2, triangle of 3 nodes";
                Err(cursor.wrong("the type of an element", &found, allowed))
            }
        }
    }

    pub(super) fn corners(self) -> usize {
        self.dimension() + 1
    }

    pub(super) fn dimension(self) -> usize {
        match self {
            Self::Point => 0,
            Self::Line => 1,
            Self::Triangle => 2,
        }
    }
}

/// Gmsh's name of an element that is not read.
fn foreign_shape(number: i64) -> &'static str {
    match number {
        3 => "quadrangle",
        4 => "tetrahedron",
        5 => "hexahedron",
        6 => "prism",
        7 => "pyramid",
        8 => "line of second order",
        9 => "triangle of second order",
        10 | 16 => "quadrangle of second order",
        11 => "tetrahedron of second order",
        12 | 17 => "hexahedron of second order",
        13 | 18 => "prism of second order",
        14 | 19 => "pyramid of second order",
        20..=25 => "triangle of higher order",
        26..=28 => "line of higher order",
        29..=31 => "tetrahedron of higher order",
        92 | 93 => "hexahedron of higher order",
        _ => "unknown",
    }
}

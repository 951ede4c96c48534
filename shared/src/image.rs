//! Image: relative conductivity per pixel of a square grid, and the grid itself.

use crate::{MAX_GRID_SIDE, MAX_PIXELS, units::RelativeConductivity};
use heapless::Vec;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// Relative conductivity: `[pixel]`, pixels in the order of the mask's set cells.
pub type Image = Vec<RelativeConductivity, MAX_PIXELS>;

/// Bytes of a full mask.
pub const MAX_MASK_BYTES: usize = MAX_GRID_SIDE * MAX_GRID_SIDE / 8;

/// Square pixels in the skin's frame: x to the right, y upwards, metres.
///
/// Cells run row by row from the top left; row 0 is the row of largest y, so that a picture
/// printed row by row stands upright.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct PixelGrid {
    /// Cells in a row.
    pub columns: u8,
    /// Cells in a column.
    pub rows: u8,
    /// Edge length of a pixel, m.
    pub pitch: f32,
    /// x of the left edge of column 0, m.
    pub left: f32,
    /// y of the top edge of row 0, m.
    pub top: f32,
}

impl PixelGrid {
    /// Cells of the whole grid, masked or not.
    #[must_use]
    pub fn cells(&self) -> usize {
        usize::from(self.columns) * usize::from(self.rows)
    }

    /// Bytes of this grid's mask.
    #[must_use]
    pub fn mask_bytes(&self) -> usize {
        self.cells().div_ceil(8)
    }

    /// Position of a point given in columns and rows from the top left corner, m.
    #[must_use]
    pub fn position(&self, column: f32, row: f32) -> [f32; 2] {
        [self.left + column * self.pitch, self.top - row * self.pitch]
    }
}

/// A grid with the cells that are pixels: everything a viewer needs to draw an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Schema)]
pub struct Geometry {
    /// The grid.
    pub grid: PixelGrid,
    /// One bit per cell, lowest bit first; a set bit is a pixel.
    pub mask: Vec<u8, MAX_MASK_BYTES>,
}

/// Whether `cell` is a pixel.
#[must_use]
pub fn is_pixel(mask: &[u8], cell: usize) -> bool {
    mask.get(cell / 8).is_some_and(|byte| byte >> (cell % 8) & 1 == 1)
}

/// Cells that are pixels, ascending; the n-th is pixel n.
pub fn pixel_cells(mask: &[u8]) -> impl Iterator<Item = usize> {
    (0..mask.len() * 8).filter(move |&cell| is_pixel(mask, cell))
}

/// Finds the cells of pixels that are asked for in ascending order, without a look at all of them.
#[derive(Clone, Debug)]
pub struct PixelCells<'a> {
    mask: &'a [u8],
    byte: usize,
    /// Pixels before that byte.
    before: usize,
}

impl<'a> PixelCells<'a> {
    /// The pixels of a mask.
    #[must_use]
    pub fn new(mask: &'a [u8]) -> Self {
        Self { mask, byte: 0, before: 0 }
    }

    /// Cell of a pixel, no earlier one than the last that was asked for; none if there is none.
    pub fn cell(&mut self, pixel: usize) -> Option<usize> {
        let mut bits = *self.mask.get(self.byte)?;
        while self.before + bits.count_ones() as usize <= pixel {
            self.before += bits.count_ones() as usize;
            self.byte += 1;
            bits = *self.mask.get(self.byte)?;
        }
        for _ in self.before..pixel {
            // Clears the lowest bit that is set.
            bits &= bits - 1;
        }
        Some(8 * self.byte + bits.trailing_zeros() as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::vec::Vec;

    proptest! {
        #[test]
        fn cells_of_some_pixels_are_those_of_all(mask in prop::collection::vec(any::<u8>(), 0..40), every in 1_usize..9) {
            let all: Vec<_> = pixel_cells(&mask).collect();
            let mut cells = PixelCells::new(&mask);
            for (pixel, &cell) in all.iter().enumerate().step_by(every) {
                prop_assert_eq!(cells.cell(pixel), Some(cell));
            }
            prop_assert_eq!(cells.cell(all.len()), None);
        }
    }
}

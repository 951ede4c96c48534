//! Image: relative conductivity per pixel of a square grid, and the grid itself.

pub mod surface;

use crate::{
    image::surface::{Pixel, SurfaceScale},
    limits::{MAX_GRID_SIDE, MAX_PIXELS},
    units::RelativeConductivity,
};
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

/// A grid with the cells that are pixels, which every cell may be but need not.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// The grid.
    pub grid: PixelGrid,
    /// One bit per cell, lowest bit first; a set bit is a pixel.
    pub mask: Vec<u8, MAX_MASK_BYTES>,
}

/// A grid's pixels and the lists of their neighbours, as a patch holds them.
pub type GridTables = (Vec<Pixel, MAX_PIXELS>, Vec<u16, { 4 * MAX_PIXELS }>);

impl Geometry {
    /// The grid with all its cells as pixels, row by row, up to `pixels`.
    #[must_use]
    pub fn first_cells(grid: PixelGrid, pixels: usize) -> Self {
        let byte = |byte: usize| (0xFF_u16 >> (8 - pixels.saturating_sub(8 * byte).min(8))) as u8;
        Self { grid, mask: (0..grid.mask_bytes()).map(byte).collect() }
    }

    /// What the numbers of [`Self::tables`] stand for: a step is half the pitch, a unit of area a cell.
    #[must_use]
    pub fn scale(&self) -> SurfaceScale {
        let PixelGrid { pitch, left, top, .. } = self.grid;
        SurfaceScale { origin: [left, top, 0.0], step: pitch / 2.0, area: pitch * pitch }
    }

    /// The pixels, as many as a patch may have; neighbours share an edge.
    #[must_use]
    pub fn tables(&self) -> GridTables {
        let columns = usize::from(self.grid.columns);
        let pixel_of = |cell: usize| pixel_cells(&self.mask).take_while(|&before| before < cell).count();
        let (mut pixels, mut neighbours) = (Vec::new(), Vec::new());
        for cell in pixel_cells(&self.mask).take(MAX_PIXELS) {
            let (column, row) = (cell % columns, cell / columns);
            let round = [
                cell.checked_sub(columns),
                cell.checked_sub(1).filter(|_| column > 0),
                Some(cell + 1).filter(|_| column + 1 < columns),
                Some(cell + columns),
            ];
            let pixel_at = |&other: &usize| is_pixel(&self.mask, other) && pixel_of(other) < MAX_PIXELS;
            neighbours
                .extend(round.into_iter().flatten().filter(pixel_at).map(|other| pixel_of(other) as u16));
            let centre = [2 * column as i16 + 1, -2 * row as i16 - 1, 0];
            let neighbours_end = neighbours.len() as u16;
            // Not full: there are at most so many.
            let _ = pixels.push(Pixel { centre, neighbours_end, normal: [0, 0, 127], area: 1 });
        }
        (pixels, neighbours)
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_go_row_by_row_from_the_top_left_corner() {
        let grid = PixelGrid { columns: 5, rows: 2, pitch: 0.01, left: -0.025, top: 0.01 };
        assert_eq!((grid.cells(), grid.mask_bytes()), (10, 2));
        for (column, row, x, y) in
            [(0.0, 0.0, -0.025, 0.01), (2.5, 1.5, 0.0, -0.005), (5.0, 2.0, 0.025, -0.01)]
        {
            let [found_x, found_y] = grid.position(column, row);
            assert!((found_x - x).abs() < 1e-8 && (found_y - y).abs() < 1e-8, "{column} {row}");
        }
        for (pixels, mask) in [(0, [0, 0]), (3, [0b111, 0]), (8, [0xFF, 0]), (10, [0xFF, 0b11])] {
            assert_eq!(Geometry::first_cells(grid, pixels).mask[..], mask, "{pixels}");
        }
    }

    #[test]
    fn neighbours_on_a_grid_share_an_edge_and_a_masked_cell_is_none() {
        // Two rows of three cells, without the middle one of the upper row.
        let grid = PixelGrid { columns: 3, rows: 2, pitch: 0.01, left: -0.015, top: 0.01 };
        let geometry = Geometry { grid, mask: [0b11_1101].into_iter().collect() };
        let (pixels, neighbours) = geometry.tables();
        let mut start = 0;
        let lists: std::vec::Vec<&[u16]> = pixels
            .iter()
            .map(|pixel| {
                let end = usize::from(pixel.neighbours_end);
                &neighbours[core::mem::replace(&mut start, end)..end]
            })
            .collect();
        assert_eq!(lists, [&[2][..], &[4], &[0, 3], &[2, 4], &[1, 3]]);
        assert_eq!(pixels[1].centre, [5, -1, 0]);
        assert_eq!(pixels[3].centre, [3, -3, 0]);
    }
}

//! Layout: which pixel each cell of a picture shows.
//!
//! A flat skin's picture is its grid. All else is seen from above, along z: each cell shows the nearest
//! pixel that faces upwards, so what faces down is not seen.

use crate::tables::SurfaceTables;
use dermatome_shared::{
    image::{Geometry, PixelGrid, pixel_cells},
    surface::{Pixel, Surface},
};

/// Cells across the larger side of a skin that has no grid.
const CELLS: f32 = 36.0;
/// A cell shows a pixel whose centre is no farther than this many pixel widths.
const REACH: f32 = 0.8;

/// Which pixel each cell shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Where the cells lie, seen from above.
    pub grid: PixelGrid,
    /// `[cell]`.
    pixels: Vec<Option<usize>>,
}

impl From<&Geometry> for Layout {
    fn from(geometry: &Geometry) -> Self {
        let mut pixels = vec![None; geometry.grid.cells()];
        pixel_cells(&geometry.mask).enumerate().for_each(|(pixel, cell)| pixels[cell] = Some(pixel));
        Self { grid: geometry.grid, pixels }
    }
}

impl From<&SurfaceTables> for Layout {
    fn from(tables: &SurfaceTables) -> Self {
        match tables.grid {
            Some(grid) => Self::on_grid(grid, &tables.pixels),
            None => Self::from_above(&tables.view()),
        }
    }
}

impl Layout {
    /// The pixel that a cell shows.
    #[must_use]
    pub fn pixel(&self, cell: usize) -> Option<usize> {
        self.pixels.get(cell).copied().flatten()
    }

    /// Pixels whose centres lie at whole cells of the grid: two steps a cell.
    fn on_grid(grid: PixelGrid, places: &[Pixel]) -> Self {
        let mut pixels = vec![None; grid.cells()];
        for (pixel, place) in places.iter().enumerate() {
            let [column, row] = [place.centre[0], -place.centre[1]].map(|steps| i32::from(steps - 1) / 2);
            let cell = row * i32::from(grid.columns) + column;
            if let Some(shown) = usize::try_from(cell).ok().and_then(|cell| pixels.get_mut(cell)) {
                *shown = Some(pixel);
            }
        }
        Self { grid, pixels }
    }

    fn from_above(surface: &Surface<'_>) -> Self {
        let places: Vec<[f32; 4]> = surface.pixels().map(|pixel| seen(surface, &pixel)).collect();
        let grid = grid_over(&places);
        let nearest = |cell: usize| {
            let [x, y] = grid.position(
                (cell % usize::from(grid.columns)) as f32 + 0.5,
                (cell / usize::from(grid.columns)) as f32 + 0.5,
            );
            let distances = places.iter().map(|place| (place[0] - x).hypot(place[1] - y));
            let facing = distances.zip(&places).enumerate().filter(|(_, (_, place))| place[3] >= 0.0);
            let within = facing.filter(|(_, (distance, place))| *distance < REACH * place[2]);
            within.min_by(|a, b| a.1.0.total_cmp(&b.1.0)).map(|(pixel, _)| pixel)
        };
        Self { grid, pixels: (0..grid.cells()).map(nearest).collect() }
    }
}

/// x, y, width, and how far upwards the normal points.
fn seen(surface: &Surface<'_>, pixel: &Pixel) -> [f32; 4] {
    let [x, y, _] = surface.centre(pixel);
    [x, y, surface.area(pixel).sqrt(), surface.normal(pixel)[2]]
}

fn grid_over(places: &[[f32; 4]]) -> PixelGrid {
    let width = places.iter().map(|place| place[2]).sum::<f32>() / places.len().max(1) as f32;
    let range = |axis: usize| {
        let along = places.iter().map(|place| place[axis]);
        let (low, high) =
            along.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        (low - width / 2.0, high + width / 2.0)
    };
    let ((left, right), (bottom, top)) = (range(0), range(1));
    let pitch = (right - left).max(top - bottom) / CELLS;
    let cells = |length: f32| (length / pitch).ceil().clamp(1.0, CELLS) as u8;
    PixelGrid { columns: cells(right - left), rows: cells(top - bottom), pitch, left, top }
}

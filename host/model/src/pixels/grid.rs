//! A grid of square pixels over a flat skin.

use super::Pixels;
use dermatome_geometry::{
    mesh::{Mesh, neighbours::orientation},
    outline::Outline,
};
use dermatome_shared::image::{Geometry, PixelGrid, is_pixel, pixel_cells};
use nalgebra::Point3;
use std::collections::HashMap;

/// Square pixels over the skin: `columns` across its larger side, a pixel wherever the centre of
/// a cell lies on the sheet.
#[must_use]
pub fn grid(outline: &Outline, columns: u8) -> Geometry {
    let ([x, y], middle) = (outline.half_size(), outline.middle());
    let pitch = outline.diameter() / f64::from(columns);
    let cells = |half: f64| ((2.0 * half / pitch - 1e-6).ceil() as u8).max(1);
    let (columns, rows) = (cells(x), cells(y));
    let left = middle.x - f64::from(columns) * pitch / 2.0;
    let top = middle.y + f64::from(rows) * pitch / 2.0;
    let grid = PixelGrid { columns, rows, pitch: pitch as f32, left: left as f32, top: top as f32 };
    let mut mask = vec![0_u8; grid.mask_bytes()];
    for cell in 0..grid.cells() {
        let (column, row) = (cell % usize::from(columns), cell / usize::from(columns));
        let centre = [left + (column as f64 + 0.5) * pitch, top - (row as f64 + 0.5) * pitch];
        if outline.depth(centre.into()) > 0.0 {
            mask[cell / 8] |= 1 << (cell % 8);
        }
    }
    Geometry { grid, mask: heapless_mask(&mask) }
}

fn heapless_mask(mask: &[u8]) -> heapless::Vec<u8, { dermatome_shared::image::MAX_MASK_BYTES }> {
    mask.iter().copied().collect()
}

/// Centre of each pixel, m: `[pixel]`.
fn centres(geometry: &Geometry) -> Vec<[f64; 2]> {
    let grid = &geometry.grid;
    let columns = usize::from(grid.columns);
    pixel_cells(&geometry.mask)
        .map(|cell| {
            grid.position((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5).map(f64::from)
        })
        .collect()
}

/// Each triangle is sampled at the centres of this many squared equal parts.
const SAMPLES_PER_EDGE: usize = 8;

/// Maps a flat mesh onto a grid: every part of an element goes to the pixel it lies in, or, in
/// the slivers that no pixel covers along the rim, to the nearest one, so that nothing is lost.
#[must_use]
pub fn raster(mesh: &Mesh, geometry: &Geometry) -> Pixels {
    let lookup = Lookup::new(geometry);
    let share = 1.0 / (SAMPLES_PER_EDGE * SAMPLES_PER_EDGE) as f64;
    let mut elements = vec![Vec::new(); lookup.centres.len()];
    for element in 0..mesh.elements.len() {
        let corners = mesh.corners(element);
        if let Some(pixel) = lookup.pixel_of_all(corners) {
            elements[pixel].push((element, 1.0));
            continue;
        }
        for point in samples(corners) {
            let parts: &mut Vec<(usize, f64)> = &mut elements[lookup.pixel_at(point)];
            match parts.last_mut() {
                Some((last, weight)) if *last == element => *weight += share,
                _ => parts.push((element, share)),
            }
        }
    }
    let centres = lookup.centres.iter().map(|&[x, y]| Point3::new(x, y, 0.0)).collect();
    let pixels = Pixels::new(mesh, elements, grid_neighbours(geometry), &orientation(&mesh.elements));
    Pixels { grid: Some(geometry.clone()), centres, ..pixels }
}

/// Centres of the equal parts of a triangle.
pub fn samples(corners: [Point3<f64>; 3]) -> impl Iterator<Item = Point3<f64>> {
    let step = 1.0 / SAMPLES_PER_EDGE as f64;
    let at = move |u: f64, v: f64| corners[0] + (corners[1] - corners[0]) * u + (corners[2] - corners[0]) * v;
    (0..SAMPLES_PER_EDGE).flat_map(move |i| {
        (0..SAMPLES_PER_EDGE - i).flat_map(move |j| {
            let (u, v) = (i as f64 * step, j as f64 * step);
            let upright = at(u + step / 3.0, v + step / 3.0);
            let inverted =
                (i + j + 1 < SAMPLES_PER_EDGE).then(|| at(u + 2.0 * step / 3.0, v + 2.0 * step / 3.0));
            std::iter::once(upright).chain(inverted)
        })
    })
}

/// Finds the pixel of a point.
struct Lookup {
    grid: PixelGrid,
    pixel_of_cell: Vec<Option<usize>>,
    centres: Vec<[f64; 2]>,
}

impl Lookup {
    fn new(geometry: &Geometry) -> Self {
        let mut pixel_of_cell = vec![None; geometry.grid.cells()];
        for (pixel, cell) in pixel_cells(&geometry.mask).enumerate() {
            pixel_of_cell[cell] = Some(pixel);
        }
        Self { grid: geometry.grid, pixel_of_cell, centres: centres(geometry) }
    }

    /// The pixel in which a whole triangle lies, if one does.
    fn pixel_of_all(&self, corners: [Point3<f64>; 3]) -> Option<usize> {
        let [a, b, c] = corners.map(|corner| self.cell_at(corner));
        if a == b && b == c { self.pixel_of_cell[a] } else { None }
    }

    fn pixel_at(&self, point: Point3<f64>) -> usize {
        self.pixel_of_cell[self.cell_at(point)].unwrap_or_else(|| self.nearest(point))
    }

    fn cell_at(&self, point: Point3<f64>) -> usize {
        let (pitch, left, top) =
            (f64::from(self.grid.pitch), f64::from(self.grid.left), f64::from(self.grid.top));
        let column = ((point.x - left) / pitch).floor().clamp(0.0, f64::from(self.grid.columns - 1)) as usize;
        let row = ((top - point.y) / pitch).floor().clamp(0.0, f64::from(self.grid.rows - 1)) as usize;
        row * usize::from(self.grid.columns) + column
    }

    fn nearest(&self, point: Point3<f64>) -> usize {
        let distance = |c: &[f64; 2]| (c[0] - point.x).powi(2) + (c[1] - point.y).powi(2);
        let closest = self.centres.iter().enumerate().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
        closest.map_or(0, |(pixel, _)| pixel)
    }
}

fn grid_neighbours(geometry: &Geometry) -> Vec<[usize; 2]> {
    let columns = usize::from(geometry.grid.columns);
    let mut number = HashMap::new();
    let mut neighbours = Vec::new();
    for (pixel, cell) in pixel_cells(&geometry.mask).enumerate() {
        number.insert(cell, pixel);
        if cell % columns > 0 && is_pixel(&geometry.mask, cell - 1) {
            neighbours.push([pixel - 1, pixel]);
        }
        if let Some(&above) = cell.checked_sub(columns).and_then(|above| number.get(&above)) {
            neighbours.push([above, pixel]);
        }
    }
    neighbours
}

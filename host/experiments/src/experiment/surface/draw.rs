//! Pictures of elements seen from above, as in Figs 5.3 and 5.4: a row for what is stimulated and for each way to image it.

use crate::experiment::{ExperimentError, report::number};
use dermatome_geometry::mesh::{Mesh, triangle};
use dermatome_view::{
    colour::diverging,
    picture::{Picture, SMALL, Tile},
};
use embedded_graphics::{
    geometry::Point,
    text::{Alignment, Baseline},
};
use nalgebra::Point3;

/// Side of a tile, and what surrounds it.
const TILE: u32 = 190;
const MARGIN: u32 = 8;
const COLUMN: u32 = TILE + 2 * MARGIN;
const LINE: u32 = 22;
const BAR: u32 = 54;
const RIM: [u8; 3] = [150; 3];

/// Images of one mesh, side by side.
pub(super) struct Row<'a> {
    pub(super) name: String,
    pub(super) mesh: &'a Mesh,
    /// Relative conductivity change: `[image][element]`.
    pub(super) images: Vec<Vec<f64>>,
}

/// Draws rows of images of a skin of this side, m; each row has a colour scale of its own. `centres` are marked:
/// `[image]`.
pub(super) fn draw(
    rows: &[Row<'_>],
    centres: &[Vec<Point3<f64>>],
    side: f64,
) -> Result<Vec<u8>, ExperimentError> {
    let width = COLUMN * centres.len() as u32;
    let mut picture = Picture::new(width, rows.len() as u32 * (LINE + COLUMN) + BAR);
    for (index, row) in (0..).zip(rows) {
        let top = index * (LINE + COLUMN);
        let full = row.images.iter().flatten().fold(0.0, |full: f64, value| full.max(value.abs()));
        let words = format!("{}; full colour: {}", row.name, number(full));
        let at = Point::new(MARGIN as i32, top as i32 + 6);
        picture.text(at, &words, SMALL, Alignment::Left, Baseline::Top);
        let seen = seen_from_above(row.mesh, side);
        for (column, (image, centres)) in (0..).zip(row.images.iter().zip(centres)) {
            let corner = ((column * COLUMN + MARGIN) as i32, (top + LINE + MARGIN) as i32);
            let colour = |dot: usize| {
                let colour =
                    |element: usize| if is_rim(&seen, dot) { RIM } else { diverging(image[element], full) };
                seen[dot].map(colour)
            };
            let colours: Vec<_> = (0..seen.len()).map(colour).collect();
            picture.dots(corner, TILE, &colours);
            let tile = Tile::square(corner, TILE, [-side / 2.0, side / 2.0], side);
            centres.iter().for_each(|centre| picture.truth(&tile, [centre.x, centre.y]));
        }
    }
    let labels = ["-full", "0", "full"].map(str::to_owned);
    let at = (width as i32 / 2 - 120, (rows.len() as u32 * (LINE + COLUMN)) as i32 + 2);
    picture.bar(at, 240, "relative conductivity change", &labels, |share| diverging(2.0 * share - 1.0, 1.0));
    picture.encode().map_err(|error| ExperimentError::Draw(error.to_string()))
}

/// Whether one of the four dots round a dot, or the edge of the tile, is outside the mesh.
fn is_rim(seen: &[Option<usize>], dot: usize) -> bool {
    let size = TILE as usize;
    let (column, row) = (dot % size, dot / size);
    let is_at_edge = [column, row].into_iter().any(|at| at == 0 || at + 1 == size);
    is_at_edge || [dot - 1, dot + 1, dot - size, dot + size].iter().any(|&dot| seen[dot].is_none())
}

/// The element that each dot of a tile shows, the highest one: `[row][column]`.
fn seen_from_above(mesh: &Mesh, side: f64) -> Vec<Option<usize>> {
    let scale = f64::from(TILE) / side;
    let size = TILE as usize;
    let mut seen: Vec<Option<(usize, f64)>> = vec![None; size * size];
    for element in 0..mesh.elements.len() {
        let corners = mesh.corners(element);
        let columns = corners.map(|corner| (corner.x + side / 2.0) * scale);
        let rows = corners.map(|corner| (side / 2.0 - corner.y) * scale);
        for row in dots(rows) {
            for column in dots(columns) {
                let at =
                    [(column as f64 + 0.5) / scale - side / 2.0, side / 2.0 - (row as f64 + 0.5) / scale];
                let Some(point) = triangle::point_above(corners, at) else { continue };
                let dot = &mut seen[row * size + column];
                if dot.is_none_or(|(_, height)| point.z > height) {
                    *dot = Some((element, point.z));
                }
            }
        }
    }
    seen.into_iter().map(|dot| dot.map(|(element, _)| element)).collect()
}

/// Dots that three places span along one axis.
fn dots(places: [f64; 3]) -> std::ops::Range<usize> {
    let low = places.into_iter().fold(f64::INFINITY, f64::min).max(0.0);
    let high = places.into_iter().fold(0.0, f64::max).min(f64::from(TILE));
    low.floor() as usize..high.ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::surface::mesh;

    #[test]
    fn each_dot_of_a_disc_shows_the_element_that_lies_there() {
        let mesh = mesh::disc(0.1);
        let seen = seen_from_above(&mesh, 0.2);
        let size = TILE as usize;
        let inside = seen.iter().flatten().count() as f64 / (size * size) as f64;
        assert!((inside - std::f64::consts::FRAC_PI_4).abs() < 0.01, "{inside}");
        assert_eq!(seen[0], None);
        let rim = (0..seen.len()).filter(|&dot| seen[dot].is_some() && is_rim(&seen, dot)).count();
        // Between the sides of a square round the disc, less its corners, and those of the disc.
        assert!((500..760).contains(&rim), "{rim}");
        // Right of the middle and above it.
        let (column, row) = (140, 60);
        let middle = triangle::centroid(mesh.corners(seen[row * size + column].unwrap()));
        let at = [(column as f64 + 0.5) / 950.0 - 0.1, 0.1 - (row as f64 + 0.5) / 950.0];
        assert!((middle.x - at[0]).hypot(middle.y - at[1]) < 0.005, "{middle} {at:?}");
    }
}

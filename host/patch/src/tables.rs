//! Tables: pixels as a board knows them, in whole numbers; see [`dermatome_shared::surface`].

use super::Pixels;
use crate::mesh::neighbours::Adjacency;
use dermatome_shared::{
    MAX_PIXELS,
    image::PixelGrid,
    patch::PatchView,
    surface::{MAX_NEIGHBOURS, NEIGHBOUR_BYTES, NORMAL_UNIT, PIXEL_BYTES, Pixel, Surface, SurfaceScale},
};
use nalgebra::{Point3, Vector3};

/// The pixels of a patch.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceTables {
    /// What the whole numbers stand for.
    pub scale: SurfaceScale,
    /// The grid whose cells the pixels are, if they are.
    pub grid: Option<PixelGrid>,
    /// `[pixel]`.
    pub pixels: Vec<Pixel>,
    /// Neighbours of all pixels, list after list.
    pub neighbours: Vec<u16>,
    /// The same as bytes of a patch.
    bytes: (Vec<[u8; PIXEL_BYTES]>, Vec<[u8; NEIGHBOUR_BYTES]>),
}

impl SurfaceTables {
    /// Tables of these pixels; `None` if they, or their neighbours, are more than a board takes.
    #[must_use]
    pub fn new(pixels: &Pixels) -> Option<Self> {
        if let Some(geometry) = pixels.grid.as_ref().filter(|_| pixels.count() <= MAX_PIXELS) {
            let (places, neighbours) = geometry.tables();
            return Some(Self::of(
                geometry.scale(),
                Some(geometry.grid),
                places.to_vec(),
                neighbours.to_vec(),
            ));
        }
        let fits = pixels.count() <= MAX_PIXELS && 2 * pixels.neighbours.len() <= MAX_NEIGHBOURS;
        fits.then(|| Self::curved(pixels))
    }

    /// Tables of a board's patch.
    #[must_use]
    pub fn read(patch: &PatchView<'_>) -> Self {
        let surface = patch.surface();
        let neighbours = (0..surface.count()).flat_map(|pixel| surface.neighbours(pixel));
        let neighbours = neighbours.map(|pixel| pixel as u16).collect();
        Self::of(surface.scale, patch.header.grid, surface.pixels().collect(), neighbours)
    }

    fn of(scale: SurfaceScale, grid: Option<PixelGrid>, pixels: Vec<Pixel>, neighbours: Vec<u16>) -> Self {
        let bytes = (
            pixels.iter().map(|pixel| pixel.to_bytes()).collect(),
            neighbours.iter().map(|pixel| pixel.to_le_bytes()).collect(),
        );
        Self { scale, grid, pixels, neighbours, bytes }
    }

    fn curved(pixels: &Pixels) -> Self {
        let origin = middle(&pixels.centres);
        let farthest = pixels.centres.iter().map(|centre| (centre - origin).amax()).fold(1e-9, f64::max);
        let largest = pixels.areas.iter().copied().fold(0.0, f64::max);
        let (step, unit) = (farthest / f64::from(i16::MAX), largest / f64::from(u8::MAX));
        let pairs = pixels.neighbours.iter().map(|&pair| (pair, ()));
        let adjacent = Adjacency::new(pixels.count(), pairs, ());
        let mut neighbours = Vec::new();
        let mut place = |pixel: usize| {
            let mut list: Vec<u16> = adjacent.of(pixel).iter().map(|&(other, ())| other as u16).collect();
            list.sort_unstable();
            neighbours.extend(list);
            Pixel {
                centre: ((pixels.centres[pixel] - origin) / step).map(|part| part.round() as i16).into(),
                neighbours_end: neighbours.len() as u16,
                normal: pixels.normals[pixel]
                    .map(|part| (part * f64::from(NORMAL_UNIT)).round() as i8)
                    .into(),
                area: (pixels.areas[pixel] / unit).round().max(1.0) as u8,
            }
        };
        let places = (0..pixels.count()).map(&mut place).collect();
        let origin = origin.coords.map(|part| part as f32).into();
        let scale = SurfaceScale { origin, step: step as f32, area: unit as f32 };
        Self::of(scale, None, places, neighbours)
    }

    /// As the board reads them.
    #[must_use]
    pub fn view(&self) -> Surface<'_> {
        Surface::new(self.scale, self.bytes.0.as_flattened(), self.bytes.1.as_flattened())
    }

    /// Centre of each pixel, m: `[pixel]`.
    pub fn centres(&self) -> impl Iterator<Item = Point3<f64>> + '_ {
        let surface = self.view();
        self.pixels.iter().map(move |pixel| Point3::from(surface.centre(pixel).map(f64::from)))
    }
}

/// Middle of the box round some points.
fn middle(points: &[Point3<f64>]) -> Point3<f64> {
    let infinity = Vector3::repeat(f64::INFINITY);
    let (low, high) = points
        .iter()
        .fold((infinity, -infinity), |(low, high), point| (low.inf(&point.coords), high.sup(&point.coords)));
    Point3::from((low + high) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{model::Model, skin::Skin};
    use std::path::Path;

    #[test]
    fn tables_of_a_hemisphere_keep_places_normals_areas_and_neighbours() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/hemisphere-120mm/skin.toml");
        let pixels = Model::build(&Skin::load(Path::new(file)).unwrap(), |_| ()).unwrap().pixels;
        let tables = SurfaceTables::new(&pixels).unwrap();
        let surface = tables.view();
        assert_eq!(surface.count(), pixels.count());
        for (number, pixel) in surface.pixels().enumerate() {
            let centre = Point3::from(surface.centre(&pixel).map(f64::from));
            assert!((centre - pixels.centres[number]).norm() < 4e-6, "{centre}");
            let normal = Vector3::from(surface.normal(&pixel).map(f64::from));
            assert!(normal.angle(&pixels.normals[number]).to_degrees() < 0.45);
            let area = f64::from(surface.area(&pixel));
            assert!((area - pixels.areas[number]).abs() < 0.6 * f64::from(tables.scale.area));
            for other in surface.neighbours(number) {
                assert!(surface.neighbours(other).any(|back| back == number), "{number} {other}");
            }
        }
        assert_eq!(tables.neighbours.len(), 2 * pixels.neighbours.len());
    }
}

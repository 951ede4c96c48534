//! Tables: pixels in whole numbers, as a board knows them; see [`dermatome_shared::surface`].

use super::Pixels;
use dermatome_geometry::mesh::neighbours::Adjacency;
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{
    MAX_PIXELS,
    surface::{MAX_NEIGHBOURS, NORMAL_UNIT, Pixel, SurfaceScale},
};
use nalgebra::{Point3, Vector3};

impl Pixels {
    /// Tables of these pixels; `None` if they, or their neighbours, are more than a board takes.
    #[must_use]
    pub fn surface_tables(&self) -> Option<SurfaceTables> {
        if let Some(geometry) = self.grid.as_ref().filter(|_| self.count() <= MAX_PIXELS) {
            let (places, neighbours) = geometry.tables();
            return Some(SurfaceTables::of(
                geometry.scale(),
                Some(geometry.grid),
                places.to_vec(),
                neighbours.to_vec(),
            ));
        }
        let fits = self.count() <= MAX_PIXELS && 2 * self.neighbours.len() <= MAX_NEIGHBOURS;
        fits.then(|| curved(self))
    }
}

fn curved(pixels: &Pixels) -> SurfaceTables {
    let origin = middle(&pixels.centres);
    let farthest = pixels.centres.iter().map(|centre| (centre - origin).amax()).fold(1e-9, f64::max);
    let largest = pixels.areas.iter().copied().fold(0.0, f64::max);
    let (step, unit) = (farthest / f64::from(i16::MAX), largest / f64::from(u8::MAX));
    let pairs = pixels.neighbours.iter().map(|&pair| (pair, ()));
    let adjacent = Adjacency::new(pixels.count(), pairs, ());
    let mut neighbours = Vec::new();
    let mut place = |pixel: usize| {
        let mut list: Vec<u16> = adjacent.of(pixel).map(|(other, ())| other as u16).collect();
        list.sort_unstable();
        neighbours.extend(list);
        Pixel {
            centre: ((pixels.centres[pixel] - origin) / step).map(|part| part.round() as i16).into(),
            neighbours_end: neighbours.len() as u16,
            normal: pixels.normals[pixel].map(|part| (part * f64::from(NORMAL_UNIT)).round() as i8).into(),
            area: (pixels.areas[pixel] / unit).round().max(1.0) as u8,
        }
    };
    let places = (0..pixels.count()).map(&mut place).collect();
    let origin = origin.coords.map(|part| part as f32).into();
    let scale = SurfaceScale { origin, step: step as f32, area: unit as f32 };
    SurfaceTables::of(scale, None, places, neighbours)
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
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/hemisphere-120mm/skin.toml");
        let pixels =
            Model::build(&Skin::load(Path::new(file)).unwrap().made().unwrap(), |_| ()).unwrap().pixels;
        let tables = pixels.surface_tables().unwrap();
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

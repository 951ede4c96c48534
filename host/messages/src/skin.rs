//! Skin: what a skin looks like, by its patch alone or by its model.

use crate::{dermatome::Skin, frame::Place};
use dermatome_patch::tables::SurfaceTables;
use dermatome_shared::{patch::PatchView, stimulation::Step, surface::Surface};
use std::collections::HashMap;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// m: `[vertex]`.
    pub vertices: Vec<[f64; 3]>,
    /// `[triangle]`.
    pub triangles: Vec<[u32; 3]>,
}

/// What a patch does not hold of its skin, in the skin's frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Look {
    /// The model's surface; without it the pixels' centres are the surface.
    pub surface: Option<Triangles>,
    /// m: `[electrode]`; may be empty.
    pub electrodes: Vec<[f64; 3]>,
    /// The robot link, in the link's frame.
    pub link: Option<Triangles>,
}

/// The message that tells what a skin looks like.
#[must_use]
pub fn skin(patch: &PatchView<'_>, look: &Look, place: &Place, time_ns: u64) -> Skin {
    let tables = SurfaceTables::read(patch);
    let surface = tables.view();
    let centres: Vec<[f64; 3]> = tables.centres().collect();
    let (shape, vertex_pixels) = match &look.surface {
        Some(shape) => (shape.clone(), nearest_pixels(&shape.vertices, &centres)),
        None => between_centres(&surface, &centres),
    };
    let on_link = |points: &[[f64; 3]]| {
        points.iter().flat_map(|point| place.point(*point)).map(|value| value as f32).collect()
    };
    let link = look.link.clone().unwrap_or_default();
    let header = &patch.header;
    Skin {
        header: place.header(time_ns),
        name: header.skin.as_str().to_owned(),
        patch_crc: patch.crc(),
        vertices: on_link(&shape.vertices),
        triangles: shape.triangles.concat(),
        vertex_pixels,
        pixel_centres: on_link(&centres),
        pixel_areas: surface.pixels().map(|pixel| surface.area(&pixel)).collect(),
        electrodes: on_link(&look.electrodes),
        steps: patch.steps().flat_map(Step::to_bytes).collect(),
        link_vertices: link.vertices.iter().flatten().map(|value| *value as f32).collect(),
        link_triangles: link.triangles.concat(),
        contact_threshold: header.contact_threshold.to_f64() as f32,
        is_calibrated: !header.calibration.points.is_empty() || header.play_operators > 0,
    }
}

/// The pixel whose centre is nearest: `[vertex]`.
fn nearest_pixels(vertices: &[[f64; 3]], centres: &[[f64; 3]]) -> Vec<u16> {
    let nearest = |vertex: &[f64; 3]| {
        let distance =
            |centre: &[f64; 3]| (0..3).map(|axis| (centre[axis] - vertex[axis]).powi(2)).sum::<f64>();
        let by_distance = centres.iter().map(distance).enumerate();
        by_distance.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(u16::MAX, |(pixel, _)| pixel as u16)
    };
    vertices.iter().map(nearest).collect()
}

/// Triangles between the centres of pixels that touch: three that touch each other, or two of four round a corner.
fn between_centres(surface: &Surface<'_>, centres: &[[f64; 3]]) -> (Triangles, Vec<u16>) {
    let neighbours: Vec<Vec<usize>> =
        (0..centres.len()).map(|pixel| surface.neighbours(pixel).collect()).collect();
    let touch = |a: usize, b: usize| neighbours[a].contains(&b);
    let mut triangles = Vec::new();
    for (a, round) in neighbours.iter().enumerate() {
        let later = || round.iter().copied().filter(move |&b| b > a);
        // The fourth pixel round a corner, by the two that touch both.
        let mut opposite: HashMap<usize, usize> = HashMap::new();
        for b in later() {
            for c in round.iter().copied().filter(|&c| c > b && touch(b, c)) {
                triangles.push([a, b, c].map(|pixel| pixel as u32));
            }
            for d in neighbours[b].iter().copied().filter(|&d| d > a && !touch(a, d)) {
                if let Some(c) = opposite.insert(d, b).filter(|&c| !touch(b, c)) {
                    triangles.push([a, b, d].map(|pixel| pixel as u32));
                    triangles.push([a, d, c].map(|pixel| pixel as u32));
                }
            }
        }
    }
    let vertex_pixels = (0..centres.len()).map(|pixel| pixel as u16).collect();
    (Triangles { vertices: centres.to_vec(), triangles }, vertex_pixels)
}

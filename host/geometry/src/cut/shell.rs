//! The part of a link's mesh that a cutout can come from: one shell of it, cleaned and oriented.

use super::{
    error::CutError,
    surface::{Surface, vector_area},
};
use crate::mesh::{boundary::DisjointSets, import::Imported, neighbours, triangle};
use nalgebra::Point3;
use std::collections::{HashMap, HashSet};

/// A seed may be this far from the mesh, as a share of the bounding box's diagonal.
const FARTHEST: f64 = 0.05;

/// The crop of a link in which a cutout lies.
pub(super) struct Crop {
    /// Triangles of the seed's shell that the cut may touch, those that hang together with the seed.
    pub(super) surface: Surface,
    /// The point of the link that is closest to the seed.
    pub(super) seed: Point3<f64>,
    /// Shells of the whole link.
    pub(super) shells: usize,
}

/// Lowest and highest corner of the box round some points.
#[must_use]
pub fn bounds(nodes: &[Point3<f64>]) -> [Point3<f64>; 2] {
    let start = nodes.first().copied().unwrap_or_else(Point3::origin);
    nodes.iter().fold([start, start], |[low, high], node| [low.inf(node), high.sup(node)])
}

/// The triangles round the one closest to `seed` that hang together and of which `touches` holds.
pub(super) fn crop(
    link: &Imported,
    seed: Point3<f64>,
    touches: impl Fn(Point3<f64>, &[Point3<f64>; 3]) -> bool,
) -> Result<Crop, CutError> {
    if let Some(node) = link.nodes.iter().position(|node| !node.coords.norm_squared().is_finite()) {
        return Err(CutError::NotFinite { node });
    }
    let triangles = clean(&link.triangles);
    let corners = |&triangle: &[usize; 3]| triangle.map(|node| link.nodes[node]);
    let (nearest, at) = nearest(&link.nodes, &triangles, seed)?;
    let edges = neighbours::edges(&triangles);
    let pairs: Vec<[usize; 2]> = edges
        .chunk_by(|a, b| a.nodes() == b.nodes())
        .filter_map(|on_edge| <&[_; 2]>::try_from(on_edge).ok())
        .map(|[a, b]| [a.element(), b.element()])
        .collect();
    let shells = count_parts(triangles.len(), &pairs);
    let touched: Vec<bool> = triangles.iter().map(|triangle| touches(at, &corners(triangle))).collect();
    let part = part(nearest, &touched, &pairs);
    let surface = manifold(&link.nodes, &triangles, &part, &pairs)?;
    Ok(Crop { surface, seed: at, shells })
}

/// Triangles with three different corners, each once whichever way round.
fn clean(triangles: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let mut known = HashSet::with_capacity(triangles.len());
    let mut sorted = |mut corners: [usize; 3]| {
        corners.sort_unstable();
        corners[0] != corners[1] && corners[1] != corners[2] && known.insert(corners)
    };
    triangles.iter().copied().filter(|&corners| sorted(corners)).collect()
}

fn nearest(
    nodes: &[Point3<f64>],
    triangles: &[[usize; 3]],
    seed: Point3<f64>,
) -> Result<(usize, Point3<f64>), CutError> {
    let mut best = (f64::INFINITY, None);
    for (number, triangle) in triangles.iter().enumerate() {
        let corners = triangle.map(|node| nodes[node]);
        if vector_area(corners).norm() > 0.0 {
            let point = triangle::nearest(corners, seed);
            let distance = (point - seed).norm();
            if distance < best.0 {
                best = (distance, Some((number, point)));
            }
        }
    }
    let [low, high] = bounds(nodes);
    let allowed = FARTHEST * (high - low).norm();
    match best {
        (_, None) => Err(CutError::Empty),
        (distance, Some(found)) if distance <= allowed => Ok(found),
        (distance, _) => Err(CutError::Far { point: seed, distance, allowed, low, high }),
    }
}

fn count_parts(count: usize, pairs: &[[usize; 2]]) -> usize {
    let mut sets = DisjointSets::new(count);
    pairs.iter().for_each(|&[a, b]| sets.join(a, b));
    (0..count).filter(|&member| sets.find(member) == member).count()
}

/// Triangles that hang together with `start` over those that are wanted, ascending.
fn part(start: usize, wanted: &[bool], pairs: &[[usize; 2]]) -> Vec<usize> {
    let mut sets = DisjointSets::new(wanted.len());
    for &[a, b] in pairs.iter().filter(|pair| pair.iter().all(|&it| wanted[it] || it == start)) {
        sets.join(a, b);
    }
    let own = sets.find(start);
    (0..wanted.len()).filter(|&member| sets.find(member) == own).collect()
}

/// Some of the triangles as a surface: nodes that hold several fans together become several nodes, and so
/// do edges with more than two triangles; all are oriented like most.
fn manifold(
    nodes: &[Point3<f64>],
    triangles: &[[usize; 3]],
    part: &[usize],
    pairs: &[[usize; 2]],
) -> Result<Surface, CutError> {
    let places: HashMap<usize, usize> = part.iter().enumerate().map(|(place, &it)| (it, place)).collect();
    let corner = |triangle: usize, node: usize| {
        let at = triangles[triangle].iter().position(|&other| other == node);
        places.get(&triangle).zip(at).map(|(place, at)| 3 * place + at)
    };
    let mut fans = DisjointSets::new(3 * part.len());
    for &[one, other] in pairs {
        for &node in triangles[one].iter().filter(|node| triangles[other].contains(node)) {
            if let (Some(a), Some(b)) = (corner(one, node), corner(other, node)) {
                fans.join(a, b);
            }
        }
    }
    let mut numbers = HashMap::new();
    let mut points = Vec::new();
    let mut faces: Vec<[usize; 3]> = Vec::with_capacity(part.len());
    for (place, &triangle) in part.iter().enumerate() {
        faces.push([0, 1, 2].map(|at| {
            *numbers.entry(fans.find(3 * place + at)).or_insert_with(|| {
                points.push(nodes[triangles[triangle][at]]);
                points.len() - 1
            })
        }));
    }
    orient(&mut faces)?;
    Ok(Surface::new(points, faces))
}

fn orient(faces: &mut [[usize; 3]]) -> Result<(), CutError> {
    let signs = neighbours::orientation(faces);
    for (face, sign) in faces.iter_mut().zip(signs) {
        if sign < 0.0 {
            face.swap(0, 1);
        }
    }
    let mut passed = HashSet::new();
    let passes = |&[a, b, c]: &[usize; 3]| [[a, b], [b, c], [c, a]];
    if faces.iter().flat_map(passes).all(|edge| passed.insert(edge)) {
        Ok(())
    } else {
        Err(CutError::OneSided)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(points: &[[f64; 3]], triangles: &[[usize; 3]]) -> Imported {
        Imported {
            nodes: points.iter().map(|&point| point.into()).collect(),
            triangles: triangles.to_vec(),
            ..Imported::default()
        }
    }

    const CORNERS: [[f64; 3]; 6] = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 1.0, 0.0],
        [0.0, 1.0, 0.0],
        [2.0, 0.0, 0.0],
        [1.0, 0.0, 1.0],
    ];

    #[test]
    fn repeated_triangles_count_once_and_turned_ones_are_turned_back() {
        let square = link(&CORNERS, &[[0, 1, 2], [0, 2, 3], [3, 2, 0], [1, 1, 2], [1, 2, 4]]);
        let crop = crop(&square, Point3::new(0.5, 0.4, 0.01), |_, _| true).unwrap();
        assert_eq!((crop.surface.faces().count(), crop.shells), (3, 1));
        let sides = crop.surface.faces().map(|face| vector_area(crop.surface.corners(face)).z);
        let sides: Vec<f64> = sides.collect();
        assert!(sides.iter().all(|side| side * sides[0] > 0.0), "{sides:?}");
    }

    #[test]
    fn a_fin_on_an_edge_is_another_shell() {
        let finned = link(&CORNERS, &[[0, 1, 2], [0, 2, 3], [1, 4, 2], [1, 2, 5]]);
        let crop = crop(&finned, Point3::new(0.2, 0.4, 0.0), |_, _| true).unwrap();
        assert_eq!((crop.surface.faces().count(), crop.shells), (2, 3));
    }

    #[test]
    fn points_far_away_and_meshes_without_area_are_refused() {
        let square = link(&CORNERS, &[[0, 1, 2]]);
        let error = crop(&square, Point3::new(0.0, 9.0, 0.0), |_, _| true).err().unwrap().to_string();
        assert!(error.contains("8062.258 mm from the link's mesh") && error.contains("`unit`"), "{error}");
        let thin = link(&CORNERS, &[[0, 1, 4]]);
        assert_eq!(crop(&thin, Point3::origin(), |_, _| true).err(), Some(CutError::Empty));
        let mut broken = square;
        broken.nodes[2].x = f64::NAN;
        assert_eq!(crop(&broken, Point3::origin(), |_, _| true).err(), Some(CutError::NotFinite { node: 2 }));
    }
}

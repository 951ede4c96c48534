//! Element patches: the pixels of any surface, connected sets of elements of about equal area.
//!
//! Elements are first halved, see [`super::halving`]. Then each
//! part becomes the region around its middle: every element goes to the middle that it is closest
//! to, along the surface (Lloyd's method on the graph of neighbouring elements).

use super::{Pixels, halving::Halves};
use dermatome_geometry::mesh::{
    Mesh,
    neighbours::{Adjacency, neighbours_and_orientation},
    triangle,
};
use nalgebra::Point3;

/// Rounds of Lloyd's method.
const ROUNDS: usize = 2;

/// Divides a mesh into `count` element patches, or as many as it has elements.
#[must_use]
pub fn element_patches(mesh: &Mesh, count: usize) -> Pixels {
    let surface = Surface::new(mesh);
    let mut patch_of = surface.bisect(count.min(mesh.elements.len()));
    for _ in 0..ROUNDS {
        let middles = surface.middles(&patch_of);
        patch_of = surface.grow(&middles);
    }
    let mut elements = vec![Vec::new(); patch_of.iter().max().map_or(0, |last| last + 1)];
    patch_of.iter().enumerate().for_each(|(element, &patch)| elements[patch].push((element, 1.0)));
    Pixels::new(mesh, elements, surface.neighbours_of(&patch_of), &surface.signs)
}

struct Surface {
    centres: Vec<Point3<f64>>,
    areas: Vec<f64>,
    pairs: Vec<[usize; 2]>,
    /// Which way round each element lies.
    signs: Vec<f64>,
    /// Neighbours of each element with the distance of their centres.
    adjacent: Adjacency<f64>,
}

impl Surface {
    fn new(mesh: &Mesh) -> Self {
        let corners = || (0..mesh.elements.len()).map(|element| mesh.corners(element));
        let centres: Vec<_> = corners().map(triangle::centroid).collect();
        let (pairs, signs) = neighbours_and_orientation(&mesh.elements);
        let distances = pairs.iter().map(|&[a, b]| ([a, b], (centres[a] - centres[b]).norm()));
        let adjacent = Adjacency::new(centres.len(), distances, 0.0);
        Self { areas: corners().map(triangle::area).collect(), centres, pairs, signs, adjacent }
    }

    /// Patch of each element, by halving.
    fn bisect(&self, count: usize) -> Vec<usize> {
        let mut patch_of = vec![0; self.centres.len()];
        for (patch, elements) in Halves::new(&self.centres, count).parts().enumerate() {
            elements.iter().for_each(|&element| patch_of[element] = patch);
        }
        patch_of
    }

    /// The element of each patch that is closest to its centre of gravity: `[patch]`.
    fn middles(&self, patch_of: &[usize]) -> Vec<usize> {
        let patches = patch_of.iter().max().map_or(0, |last| last + 1);
        let mut sums = vec![(nalgebra::Vector3::zeros(), 0.0); patches];
        for (element, &patch) in patch_of.iter().enumerate() {
            sums[patch].0 += self.centres[element].coords * self.areas[element];
            sums[patch].1 += self.areas[element];
        }
        let mut closest = vec![(f64::INFINITY, 0); patches];
        for (element, &patch) in patch_of.iter().enumerate() {
            let (sum, area) = sums[patch];
            let distance = (self.centres[element].coords - sum / area).norm_squared();
            if distance < closest[patch].0 {
                closest[patch] = (distance, element);
            }
        }
        closest.into_iter().map(|(_, element)| element).collect()
    }

    /// The patch of each element whose middle is the closest along the surface. Parts of the mesh
    /// without a middle join the first patch.
    ///
    /// Elements wait in buckets of about equal distance, not in exact order, and are looked at again
    /// where a shorter way turns up.
    fn grow(&self, middles: &[usize]) -> Vec<usize> {
        let width = self.mean_step();
        let mut best = vec![(f64::INFINITY, 0); self.centres.len()];
        let mut buckets = vec![middles.to_vec()];
        middles.iter().enumerate().for_each(|(patch, &element)| best[element] = (0.0, patch));
        let mut current = 0;
        while current < buckets.len() {
            while let Some(element) = buckets[current].pop() {
                let (distance, patch) = best[element];
                if (distance / width) as usize != current {
                    continue;
                }
                for (next, step) in self.adjacent.of(element) {
                    let distance = distance + step;
                    if distance < best[next].0 {
                        best[next] = (distance, patch);
                        let bucket = (distance / width) as usize;
                        if bucket >= buckets.len() {
                            buckets.resize_with(bucket + 1, Vec::new);
                        }
                        buckets[bucket].push(next);
                    }
                }
            }
            current += 1;
        }
        best.into_iter().map(|(_, patch)| patch).collect()
    }

    fn mean_step(&self) -> f64 {
        let sum: f64 = self.pairs.iter().map(|&[a, b]| (self.centres[a] - self.centres[b]).norm()).sum();
        (sum / self.pairs.len().max(1) as f64).max(f64::MIN_POSITIVE)
    }

    fn neighbours_of(&self, patch_of: &[usize]) -> Vec<[usize; 2]> {
        let mut pairs: Vec<[usize; 2]> = self
            .pairs
            .iter()
            .map(|pair| pair.map(|element| patch_of[element]))
            .filter(|[a, b]| a != b)
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{model, skin::Skin};
    use dermatome_geometry::mesh::{Lattice, neighbours::neighbours};
    use proptest::prelude::*;
    use std::path::Path;

    fn disc(fineness: f64) -> Mesh {
        let text = include_str!("../../../../models/disc-210mm/skin.toml");
        let skin = Skin::parse(Path::new("disc.toml"), text).unwrap().made().unwrap();
        model::mesh(&skin, fineness, Lattice::default()).unwrap()
    }

    /// The disc rolled up into three quarters of a tube, along which the way is long.
    fn rolled(mut mesh: Mesh) -> Mesh {
        for node in &mut mesh.nodes {
            let angle = node.x / 0.105 * 0.75 * std::f64::consts::PI;
            *node = Point3::new(0.045 * angle.sin(), node.y, 0.045 * angle.cos());
        }
        mesh
    }

    fn is_connected(mesh: &Mesh, parts: &[(usize, f64)]) -> bool {
        let elements: Vec<[usize; 3]> = parts.iter().map(|&(element, _)| mesh.elements[element]).collect();
        let mut reached = vec![false; elements.len()];
        let pairs = neighbours(&elements);
        let mut waiting = vec![0];
        while let Some(element) = waiting.pop() {
            if !std::mem::replace(&mut reached[element], true) {
                let next = pairs.iter().filter(|pair| pair.contains(&element));
                waiting.extend(next.map(|&[a, b]| if a == element { b } else { a }));
            }
        }
        reached.into_iter().all(|reached| reached)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]
        #[test]
        fn patches_are_connected_cover_everything_once_and_are_of_like_size(
            count in 4..200_usize,
            roll in any::<bool>(),
        ) {
            let mesh = if roll { rolled(disc(1.5)) } else { disc(1.5) };
            let pixels = element_patches(&mesh, count);
            prop_assert_eq!(pixels.count(), count);
            let mut elements: Vec<usize> =
                pixels.elements.iter().flatten().map(|&(element, _)| element).collect();
            elements.sort_unstable();
            prop_assert!(elements.into_iter().eq(0..mesh.elements.len()));
            prop_assert!(pixels.elements.iter().all(|parts| is_connected(&mesh, parts)));
            let mean = pixels.areas.iter().sum::<f64>() / count as f64;
            let largest = pixels.areas.iter().fold(0.0, |max: f64, &area| max.max(area));
            prop_assert!(largest < 2.5 * mean, "{} times the mean area", largest / mean);
        }
    }

    #[test]
    fn more_patches_than_elements_are_as_many_as_there_are_elements() {
        let mesh = disc(6.0);
        assert_eq!(element_patches(&mesh, 100_000).count(), mesh.elements.len());
    }

    #[test]
    fn normals_of_a_bent_sheet_point_away_from_its_axis_even_if_elements_are_turned() {
        let mut mesh = rolled(disc(2.0));
        mesh.elements.iter_mut().step_by(3).for_each(|element| element.swap(1, 2));
        let pixels = element_patches(&mesh, 40);
        for (centre, normal) in pixels.centres.iter().zip(&pixels.normals) {
            let outward = nalgebra::Vector3::new(centre.x, 0.0, centre.z).normalize();
            assert!(outward.dot(normal) > 0.9, "{centre} {normal}");
        }
    }
}

//! Cuts a skin out of the mesh of a robot's link.
//!
//! [`cut`] takes the shell that the seed lies on and the triangles that the region may reach
//! (`shell`), makes them even (`remesh`), measures how far each node lies from the cut (`region`,
//! `geodesic`), cuts triangles exactly on that line (`clip`), smooths the boundary along the surface and puts
//! nodes where electrodes begin and end (`boundary`), and remeshes once more to the wanted edge length. All nodes
//! lie on the link's own triangles (`closest`) but for those of the boundary's cut edges.

mod boundary;
mod clip;
mod closest;
mod error;
mod frame;
mod geodesic;
mod region;
mod remesh;
mod shell;
mod surface;

use crate::mesh::{ElectrodeContact, Mesh, import::Imported, triangle};
use boundary::{Curve, Layout, Target};
use clip::{clip, closest_face, no_disc};
use closest::Closest;
pub use error::{CutError, Wrapped};
use nalgebra::{Isometry3, Point3, Vector3};
pub use region::{Cutter, Region, Slab};
use remesh::Effort;
pub use shell::bounds;
use std::collections::HashMap;
use surface::Surface;

/// Triangles on which the cut may be made.
const MOST_TRIANGLES: f64 = 1e6;
/// A cutout whose nodes are closer to a plane than this share of its size is flat.
const FLAT: f64 = 1e-6;
/// Fewest and most electrodes.
const ELECTRODES: std::ops::RangeInclusive<usize> = 4..=250;

/// What to cut, and how to make a skin of it. Lengths are in metres, in the link's frame.
#[derive(Clone, Debug)]
pub struct Request {
    /// A point of the cutout, on the link or close to it: there is the cutout's origin.
    pub around: Point3<f64>,
    /// What is cut out.
    pub region: Region,
    /// Direction that is up as one looks onto the cutout; without it z, or on a horizontal cutout y.
    pub up: Option<Vector3<f64>>,
    /// Number of electrodes along the boundary.
    pub electrodes: usize,
    /// Boundary that an electrode covers; without it a quarter of the distance between centres.
    pub width: Option<f64>,
    /// Edge length of the mesh; without it a third of the electrodes' width.
    pub edge_length: Option<f64>,
}

/// A skin cut out of a link.
#[derive(Clone, Debug)]
pub struct Cutout {
    /// The mesh in the cutout's frame, with its electrodes, m.
    pub mesh: Mesh,
    /// The cutout's frame in the link's: takes points of the cutout to points of the link.
    pub link_from_skin: Isometry3<f64>,
    /// Length of the boundary, m.
    pub boundary: f64,
    /// Width of the electrodes, m.
    pub width: f64,
    /// Edge length wanted, m.
    pub edge_length: f64,
    /// Largest distance of a triangle's middle from the link's surface, m.
    pub deviation: f64,
    /// Whether all of it lies in one plane.
    pub flat: bool,
    /// Shells of the link.
    pub shells: usize,
}

/// Cuts a cutout out of a link, whose nodes are in metres.
pub fn cut(link: &Imported, request: &Request) -> Result<Cutout, CutError> {
    if !ELECTRODES.contains(&request.electrodes) {
        let allowed = format!("{} to {}", ELECTRODES.start(), ELECTRODES.end());
        let value = request.electrodes.to_string();
        return Err(CutError::Value { option: "electrodes", value, allowed });
    }
    request.region.check(&link.nodes)?;
    let touches = |seed, corners: &[Point3<f64>; 3]| request.region.touches(seed, corners);
    let crop = shell::crop(link, request.around, touches)?;
    let (even, onto) = even_triangles(crop.surface, &request.region, crop.seed);
    let piece = cut_out(&even, &request.region, crop.seed)?;
    let link_from_skin = frame::frame(&piece, crop.seed, request.up)?;
    finish(piece, &onto, request, link_from_skin, crop.shells)
}

/// The crop in even triangles fine enough to cut them, and the crop itself to project onto.
fn even_triangles(crop: Surface, region: &Region, seed: Point3<f64>) -> (Surface, Closest) {
    let edge = region.cut_edge(&crop).max((crop.area() / (0.433 * MOST_TRIANGLES)).sqrt());
    let onto = Closest::new(crop.faces().map(|face| crop.corners(face)), edge);
    let mut even = crop;
    let mut longest = even.longest_edge();
    while longest > edge {
        longest = (longest / 2.0).max(edge);
        remesh::shorten(&mut even, longest, edge, &onto);
        even = touched(&even, region, seed);
    }
    even.fixed.clone_from(&even.boundary);
    remesh::remesh(&mut even, edge, &onto, Effort::EVEN);
    (even, onto)
}

/// The faces that the region may reach.
fn touched(surface: &Surface, region: &Region, seed: Point3<f64>) -> Surface {
    let kept = surface.faces().filter(|&face| region.touches(seed, &surface.corners(face))).collect();
    let (points, faces, _) = Surface::new(surface.points.clone(), kept).compact();
    Surface::new(points, faces)
}

/// The cutout, a disc.
fn cut_out(even: &Surface, region: &Region, seed: Point3<f64>) -> Result<Surface, CutError> {
    let outside = || CutError::Outside { option: region.option(), at: seed };
    let face = closest_face(even, seed).ok_or_else(outside)?;
    let field = region.field(even, face, seed);
    if face.iter().all(|&node| field[node] >= 0.0) {
        return Err(outside());
    }
    refuse_openings(even, &field, region)?;
    let piece = clip(even, &field, seed);
    match no_disc(&piece) {
        None => Ok(piece),
        Some(found) => Err(CutError::NotADisc { found, largest: largest_radius(even, &field, region, seed) }),
    }
}

/// Refuses a cutout that the mesh's own edge runs through; of several openings the nearest is named, for a radius that
/// leaves it out leaves out all.
fn refuse_openings(even: &Surface, field: &[f64], region: &Region) -> Result<(), CutError> {
    let nearer = |a: &usize, b: &usize| field[*a].total_cmp(&field[*b]);
    let openings = even.loops().into_iter();
    let openings = openings.filter_map(|around| Some((around.iter().copied().min_by(nearer)?, around)));
    let Some((node, around)) = openings.min_by(|a, b| nearer(&a.0, &b.0)).filter(|it| field[it.0] < 0.0)
    else {
        return Ok(());
    };
    let allowed = match region {
        Region::Disc { radius } => {
            format!("a radius below {:.3} mm, or a point further away", (radius + field[node]) * 1e3)
        }
        Region::Slabs(_) | Region::Polygon(_) => "a patch beside it".to_owned(),
    };
    Err(CutError::Opening { at: even.points[node], around: clip::length(even, &around), allowed })
}

/// The largest radius that gives a disc, nearly.
fn largest_radius(even: &Surface, field: &[f64], region: &Region, seed: Point3<f64>) -> Option<f64> {
    let Region::Disc { radius } = region else { return None };
    let gives_disc = |share: f64| {
        let smaller: Vec<f64> = field.iter().map(|value| value + (1.0 - share) * radius).collect();
        no_disc(&clip(even, &smaller, seed)).is_none()
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..8 {
        let middle = (low + high) / 2.0;
        if gives_disc(middle) { low = middle } else { high = middle }
    }
    (low > 0.0).then_some(low * radius)
}

/// Smooths the boundary, places the electrodes, remeshes, and takes everything into the cutout's frame.
fn finish(
    mut piece: Surface,
    onto: &Closest,
    request: &Request,
    link_from_skin: Isometry3<f64>,
    shells: usize,
) -> Result<Cutout, CutError> {
    let around = piece.loops().swap_remove(0);
    let rough = clip::length(&piece, &around);
    let asked =
        |boundary: f64| request.width.unwrap_or_else(|| boundary::usual_width(boundary, request.electrodes));
    let edge = request.edge_length.unwrap_or_else(|| boundary::usual_edge(rough, asked(rough)));
    boundary::check(rough, request.electrodes, asked(rough), edge)?;
    let curve = Curve::smoothed(&piece, &around, edge, onto);
    let width = asked(curve.length());
    boundary::check(
        curve.length(),
        request.electrodes,
        width,
        edge.min(width / boundary::EDGES_OF_ELECTRODE),
    )?;
    let first = curve.towards_top(|point| link_from_skin.inverse_transform_point(&point));
    let targets = curve.targets(&Layout { electrodes: request.electrodes, width, edge, first });
    let nodes = boundary::insert(&mut piece, &around, &targets, edge);
    remesh::remesh(&mut piece, edge, onto, Effort::FINAL);
    for (&node, target) in nodes.iter().zip(&targets) {
        piece.points[node] = target.point;
    }
    remesh::polish(&mut piece, onto, Effort::FINAL);
    let contacts = contacts(&piece, &nodes, &targets, request.electrodes);
    let deviation = deviation(&piece, onto);
    let (mesh, flat) = in_frame(&piece, contacts, &link_from_skin);
    Ok(Cutout {
        mesh,
        link_from_skin,
        boundary: curve.length(),
        width,
        edge_length: edge,
        deviation,
        flat,
        shells,
    })
}

/// Edges of the boundary under each electrode.
fn contacts(piece: &Surface, nodes: &[usize], targets: &[Target], count: usize) -> Vec<Vec<[usize; 2]>> {
    let mut electrodes = vec![Vec::new(); count];
    let next: HashMap<usize, usize> = piece.boundary_edges().into_iter().map(|[a, b]| (a, b)).collect();
    let ends = targets.iter().zip(nodes).filter_map(|(target, &node)| Some((target.ends?, node)));
    let ends: HashMap<usize, usize> = ends.collect();
    for (target, &node) in targets.iter().zip(nodes) {
        let Some(electrode) = target.begins else { continue };
        let mut at = node;
        while at != ends[&electrode] && electrodes[electrode].len() < next.len() {
            electrodes[electrode].push([at, next[&at]]);
            at = next[&at];
        }
    }
    electrodes
}

fn deviation(piece: &Surface, onto: &Closest) -> f64 {
    let middles = piece.faces().map(|face| triangle::centroid(piece.corners(face)));
    middles.map(|middle| (onto.point(middle) - middle).norm()).fold(0.0, f64::max)
}

/// The mesh in the cutout's frame, and whether it is flat; then it lies in z = 0 exactly.
fn in_frame(
    piece: &Surface,
    contacts: Vec<Vec<[usize; 2]>>,
    link_from_skin: &Isometry3<f64>,
) -> (Mesh, bool) {
    let (points, elements, numbers) = piece.compact();
    let mut nodes: Vec<_> =
        points.iter().map(|point| link_from_skin.inverse_transform_point(point)).collect();
    let [low, high] = bounds(&nodes);
    let flat = nodes.iter().all(|node| node.z.abs() < FLAT * (high - low).norm());
    if flat {
        nodes.iter_mut().for_each(|node| node.z = 0.0);
    }
    let renumbered = |edges: Vec<[usize; 2]>| {
        ElectrodeContact::Edges(edges.into_iter().map(|edge| edge.map(|node| numbers[&node])).collect())
    };
    (Mesh { nodes, elements, electrodes: contacts.into_iter().map(renumbered).collect() }, flat)
}

#[cfg(test)]
mod tests;

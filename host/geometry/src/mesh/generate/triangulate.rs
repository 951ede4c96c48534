//! Triangles between the nodes, and nodes moved so that these become better.

use super::{MeshError, middle, polish, skeleton::Skeleton};
use nalgebra::{Point2, Vector2};
use spade::{
    ConstrainedDelaunayTriangulation, DelaunayTriangulation, Triangulation, handles::FixedVertexHandle,
};
use std::collections::HashMap;

/// Times that each inner node moves to the mean of its neighbours.
const SMOOTHINGS: usize = 2;

/// Triangulates the sheet between nodes, of which those behind the skeleton's may be moved.
pub(super) fn triangulate(
    skeleton: &Skeleton<'_>,
    points: &mut [Point2<f64>],
) -> Result<Vec<[usize; 3]>, MeshError> {
    let fixed = skeleton.points.len();
    let rough = delaunay(skeleton, points)?;
    (0..SMOOTHINGS).for_each(|_| smooth(points, &rough, fixed));
    let elements = delaunay(skeleton, points)?;
    polish::polish(points, &elements, fixed);
    check_edges(skeleton, &elements)?;
    check_coverage(skeleton, points, &elements)?;
    Ok(elements)
}

/// Delaunay triangles on the sheet that keep to the skeleton's edges.
fn delaunay(skeleton: &Skeleton<'_>, points: &[Point2<f64>]) -> Result<Vec<[usize; 3]>, MeshError> {
    let vertices = points.iter().map(|p| spade::Point2::new(p.x, p.y)).collect();
    let triangulation = DelaunayTriangulation::<spade::Point2<f64>>::bulk_load_stable(vertices)
        .map_err(|error| MeshError::Point(error.to_string()))?;
    if triangulation.num_vertices() != points.len() {
        return Err(MeshError::Point("two nodes lie at the same place".into()));
    }
    let mut triangulation = ConstrainedDelaunayTriangulation::<spade::Point2<f64>>::from(triangulation);
    for edge in skeleton.boundary_edges.iter().chain(&skeleton.inner_edges) {
        let [a, b] = edge.map(FixedVertexHandle::from_index);
        triangulation.try_add_constraint(a, b);
    }
    let corners = triangulation.inner_faces().map(|face| face.vertices().map(|vertex| vertex.index()));
    // Triangles off the sheet have all their corners on rims. Rounding can leave flat ones along a
    // straight side; they hold no skin.
    let on_sheet = |element: &[usize; 3]| {
        element.iter().any(|&node| node >= skeleton.points.len())
            || !is_flat(element.map(|node| points[node]))
                && skeleton.outline.depth(middle(points, element)) > 0.0
    };
    Ok(corners.filter(on_sheet).collect())
}

fn is_flat([p, q, r]: [Point2<f64>; 3]) -> bool {
    let doubled_area = (q - p).perp(&(r - p)).abs();
    let longest = (q - p).norm_squared().max((r - p).norm_squared()).max((r - q).norm_squared());
    doubled_area < 1e-6 * longest
}

/// Moves every node behind the `fixed` ones to the mean of its neighbours.
fn smooth(points: &mut [Point2<f64>], elements: &[[usize; 3]], fixed: usize) {
    let mut sums = vec![(Vector2::zeros(), 0.0); points.len()];
    for element in elements {
        for corner in 0..3 {
            let [node, next, last] = [element[corner], element[(corner + 1) % 3], element[(corner + 2) % 3]];
            sums[node].0 += points[next].coords + points[last].coords;
            sums[node].1 += 2.0;
        }
    }
    for (point, (sum, count)) in points.iter_mut().zip(sums).skip(fixed) {
        *point = Point2::from(sum / count);
    }
}

/// Every edge of a rim belongs to one element, every edge inside to two.
fn check_edges(skeleton: &Skeleton<'_>, elements: &[[usize; 3]]) -> Result<(), MeshError> {
    let fixed = skeleton.points.len();
    let mut uses = HashMap::<[usize; 2], usize>::new();
    for &[a, b, c] in elements {
        for [a, b] in [[a, b], [b, c], [c, a]] {
            if a < fixed && b < fixed {
                *uses.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
    }
    let wanted = skeleton.boundary_edges.iter().map(|edge| (edge, 1));
    for (&[a, b], count) in wanted.chain(skeleton.inner_edges.iter().map(|edge| (edge, 2))) {
        if uses.get(&[a.min(b), a.max(b)]) != Some(&count) {
            let Point2 { coords } = skeleton.points[a];
            return Err(MeshError::Rim { x: coords.x, y: coords.y });
        }
    }
    Ok(())
}

/// The triangles must fill the skeleton, no more and no less.
fn check_coverage(
    skeleton: &Skeleton<'_>,
    points: &[Point2<f64>],
    elements: &[[usize; 3]],
) -> Result<(), MeshError> {
    let area = |&[a, b, c]: &[usize; 3]| (points[b] - points[a]).perp(&(points[c] - points[a])).abs() / 2.0;
    let covered = elements.iter().map(area).sum::<f64>() / skeleton.area;
    if (covered - 1.0).abs() < 1e-9 { Ok(()) } else { Err(MeshError::Coverage { covered }) }
}

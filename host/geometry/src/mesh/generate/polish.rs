//! Better angles where smoothing left bad ones.

use nalgebra::{Point2, Rotation2, Vector2};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Sine of the angle below which triangles are looked at: 32 degrees.
const GOOD: f64 = 0.53;
/// Times that all bad triangles are looked at.
const ROUNDS: usize = 3;
/// Directions in which a node is tried.
const DIRECTIONS: usize = 8;
/// Times that the step is halved.
const HALVINGS: usize = 5;

/// Moves the inner nodes of bad triangles to where the worst triangle round them is best. `fixed`
/// nodes stay; elements run counter-clockwise.
pub(super) fn polish(points: &mut [Point2<f64>], elements: &[[usize; 3]], fixed: usize) {
    for _ in 0..ROUNDS {
        for (node, star) in stars_of_bad(points, elements, fixed) {
            improve(points, node, &star);
        }
    }
}

/// The inner nodes of bad triangles, ascending, each with all triangles round it.
fn stars_of_bad(
    points: &[Point2<f64>],
    elements: &[[usize; 3]],
    fixed: usize,
) -> Vec<(usize, Vec<[usize; 3]>)> {
    let bad = elements.par_iter().filter(|element| sine(points, element) < GOOD);
    let mut nodes: Vec<usize> = bad.flat_map_iter(|element| *element).filter(|node| *node >= fixed).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let mut star_of = vec![usize::MAX; points.len()];
    nodes.iter().enumerate().for_each(|(star, &node)| star_of[node] = star);
    let mut stars: Vec<_> = nodes.into_iter().map(|node| (node, Vec::new())).collect();
    for element in elements {
        for &node in element {
            if let Some((_, star)) = stars.get_mut(star_of[node]) {
                star.push(*element);
            }
        }
    }
    stars
}

/// Sine of the smallest angle, which is that between the two longest edges; negative if the
/// triangle is turned over.
fn sine(points: &[Point2<f64>], element: &[usize; 3]) -> f64 {
    let [p, q, r] = element.map(|node| points[node]);
    let doubled_area = (q - p).perp(&(r - p));
    let [a, b, c] = [(q - p).norm_squared(), (r - q).norm_squared(), (p - r).norm_squared()];
    let shortest = a.min(b).min(c);
    doubled_area / (a * b * c / shortest).sqrt()
}

fn improve(points: &mut [Point2<f64>], node: usize, star: &[[usize; 3]]) {
    let worst = |points: &[Point2<f64>]| star.iter().map(|e| sine(points, e)).fold(f64::INFINITY, f64::min);
    let start = points[node];
    let reach = star.iter().flatten().map(|&other| (points[other] - start).norm()).fold(0.0, f64::max);
    let mut best = (worst(points), start);
    for halving in 0..HALVINGS {
        let step = Vector2::new(reach * 0.25 / f64::from(1 << halving), 0.0);
        let from = best.1;
        for direction in 0..DIRECTIONS {
            points[node] = from + Rotation2::new(TAU * direction as f64 / DIRECTIONS as f64) * step;
            let value = worst(points);
            if value > best.0 {
                best = (value, points[node]);
            }
        }
        points[node] = best.1;
    }
}

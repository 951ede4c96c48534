//! The boundary of a cutout: smoothed along the surface, with nodes where electrodes begin and end.

use super::{closest::Closest, error::CutError, surface::Surface};
use nalgebra::{Point3, center};

/// Samples of the boundary for each edge of the mesh.
const SAMPLES_PER_EDGE: f64 = 4.0;
/// Rounds of smoothing with weights 1/4, 1/2, 1/4: together a Gaussian of half an edge.
const SMOOTHING: usize = 8;
/// A node of the old boundary closer to a target than this share of an edge takes its place.
const SNAP: f64 = 0.02;
/// Width of an electrode where none is asked for, as a share of the distance between centres.
const WIDTH: f64 = 0.25;
/// Edges under an electrode where no edge length is asked for.
const EDGES: f64 = 3.0;
/// Least number of edges under an electrode.
pub(super) const EDGES_OF_ELECTRODE: f64 = 2.0;

/// A closed line on the surface, walked with the cutout on its left.
pub(super) struct Curve {
    /// Where the line lies after smoothing, at equal steps of the old line.
    samples: Vec<Point3<f64>>,
    /// Length of the old line between samples.
    step: f64,
    /// Length of the smoothed line up to each sample, and in all: `[sample]`, one more.
    lengths: Vec<f64>,
}

/// What electrodes are to lie on the boundary.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) electrodes: usize,
    pub(super) width: f64,
    pub(super) edge: f64,
    /// Arc length of the first electrode's middle.
    pub(super) first: f64,
}

/// A node of the final boundary.
pub(super) struct Target {
    /// Arc length on the old line.
    old: f64,
    /// Where it goes.
    pub(super) point: Point3<f64>,
    /// Electrodes that begin and end there, from 0.
    pub(super) begins: Option<usize>,
    pub(super) ends: Option<usize>,
}

impl Curve {
    /// The line through these nodes, smoothed over about half an `edge`.
    pub(super) fn smoothed(surface: &Surface, around: &[usize], edge: f64, onto: &Closest) -> Self {
        let old: Vec<Point3<f64>> = around.iter().map(|&node| surface.points[node]).collect();
        let total = *lengths(&old).last().unwrap_or(&0.0);
        let count = (SAMPLES_PER_EDGE * total / edge).ceil().max(12.0) as usize;
        let step = total / count as f64;
        let mut samples = resampled(&old, count);
        for _ in 0..SMOOTHING {
            let middles: Vec<_> =
                (0..count).map(|i| center(&samples[i], &samples[(i + 1) % count])).collect();
            samples = (0..count).map(|i| center(&middles[(i + count - 1) % count], &middles[i])).collect();
        }
        samples.iter_mut().for_each(|sample| *sample = onto.point(*sample));
        Self { lengths: lengths(&samples), samples, step }
    }

    /// Length of the smoothed line.
    pub(super) fn length(&self) -> f64 {
        self.lengths[self.samples.len()]
    }

    /// Arc length of the sample that lies most nearly in a direction from the middle of the line, after
    /// `seen` has turned it into the plane of sight.
    pub(super) fn towards_top(&self, seen: impl Fn(Point3<f64>) -> Point3<f64>) -> f64 {
        let flat: Vec<_> = self.samples.iter().map(|&sample| seen(sample).xy().coords).collect();
        let middle = flat.iter().sum::<nalgebra::Vector2<f64>>() / flat.len() as f64;
        let up = |i: usize| (flat[i] - middle).y / (flat[i] - middle).norm().max(f64::MIN_POSITIVE);
        let best = (0..flat.len()).max_by(|&a, &b| up(a).total_cmp(&up(b)));
        best.map_or(0.0, |i| self.lengths[i])
    }

    /// Nodes for electrodes of equal distances, clockwise as seen from outside, and for edges in between.
    pub(super) fn targets(&self, layout: &Layout) -> Vec<Target> {
        let pitch = self.length() / layout.electrodes as f64;
        let under = (layout.width / layout.edge).ceil().max(EDGES_OF_ELECTRODE) as usize;
        let between = ((pitch - layout.width) / layout.edge).ceil().max(1.0) as usize;
        let mut targets = Vec::new();
        for place in 0..layout.electrodes {
            // The line runs counter-clockwise, electrodes are numbered clockwise.
            let electrode = (layout.electrodes - place) % layout.electrodes;
            let begin = layout.first + pitch * place as f64 - layout.width / 2.0;
            for i in 0..under {
                targets.push(self.target(begin + layout.width * i as f64 / under as f64));
            }
            let at = targets.len() - under;
            targets[at].begins = Some(electrode);
            for i in 0..between {
                let along = layout.width + (pitch - layout.width) * i as f64 / between as f64;
                targets.push(self.target(begin + along));
            }
            let at = targets.len() - between;
            targets[at].ends = Some(electrode);
        }
        targets
    }

    fn target(&self, s: f64) -> Target {
        let count = self.samples.len();
        let s = s.rem_euclid(self.length());
        let i = self.lengths.partition_point(|&length| length <= s).clamp(1, count) - 1;
        let share = (s - self.lengths[i]) / (self.lengths[i + 1] - self.lengths[i]).max(f64::MIN_POSITIVE);
        let (from, to) = (self.samples[i], self.samples[(i + 1) % count]);
        Target {
            old: (i as f64 + share) * self.step,
            point: from + (to - from) * share,
            begins: None,
            ends: None,
        }
    }
}

/// Splits the old boundary where the targets are, and fixes those nodes: `[target]`.
pub(super) fn insert(
    surface: &mut Surface,
    around: &[usize],
    targets: &[Target],
    edge_length: f64,
) -> Vec<usize> {
    let points: Vec<_> = around.iter().map(|&node| surface.points[node]).collect();
    let starts = lengths(&points);
    let mut order: Vec<usize> = (0..targets.len()).collect();
    order.sort_by(|&a, &b| targets[a].old.total_cmp(&targets[b].old));
    let mut nodes = vec![0; targets.len()];
    let (mut edge, mut before) = (0, (around[0], 0.0));
    for target in order {
        let s = targets[target].old;
        while edge + 1 < around.len() && starts[edge + 1] <= s {
            edge += 1;
            before = (around[edge], starts[edge]);
        }
        let next = around[(edge + 1) % around.len()];
        before = node_at(surface, before, (next, starts[edge + 1]), (s, SNAP * edge_length));
        nodes[target] = before.0;
        surface.fixed[before.0] = true;
    }
    nodes
}

/// The node before or next, if it is free and closer than `reach`, or a new one between; with its arc length.
fn node_at(
    surface: &mut Surface,
    before: (usize, f64),
    next: (usize, f64),
    (s, reach): (f64, f64),
) -> (usize, f64) {
    let near = [before, next].into_iter().find(|it| (it.1 - s).abs() <= reach && !surface.fixed[it.0]);
    near.unwrap_or_else(|| {
        let share = ((s - before.1) / (next.1 - before.1)).clamp(1e-9, 1.0 - 1e-9);
        let (from, to) = (surface.points[before.0], surface.points[next.0]);
        (surface.split(before.0, next.0, from + (to - from) * share), s)
    })
}

/// Refuses electrodes that do not fit on a boundary, and edges too coarse for them.
pub(super) fn check(length: f64, electrodes: usize, width: f64, edge: f64) -> Result<(), CutError> {
    let refuse = |option, value: f64, allowed: String| {
        Err(CutError::Value { option, value: format!("{:.3} mm", value * 1e3), allowed })
    };
    let pitch = length / electrodes as f64;
    let finest = length / MOST_RIM_EDGES;
    let (narrowest, widest) = (EDGES_OF_ELECTRODE * finest, 0.9 * pitch);
    if !(narrowest..=widest).contains(&width) {
        let boundary = format!("on a boundary of {:.1} mm with {electrodes} electrodes", length * 1e3);
        let range = format!("{:.3} mm to {:.3} mm", narrowest * 1e3, widest * 1e3);
        return refuse("width", width, format!("{range} {boundary}"));
    }
    let coarsest = width / EDGES_OF_ELECTRODE;
    if !(finest..=coarsest * (1.0 + 1e-9)).contains(&edge) {
        let why = "so that two edges lie under each electrode";
        return refuse(
            "edge_length",
            edge,
            format!("{:.3} mm to {:.3} mm, {why}", finest * 1e3, coarsest * 1e3),
        );
    }
    Ok(())
}

/// Width of electrodes that nobody gave: a share of their pitch, but no less than the mesh can show.
pub(super) fn usual_width(length: f64, electrodes: usize) -> f64 {
    (WIDTH * length / electrodes as f64).max(EDGES_OF_ELECTRODE * finest_usual(length))
}

/// Edge length that nobody gave, for electrodes of this width.
pub(super) fn usual_edge(length: f64, width: f64) -> f64 {
    (width / EDGES).max(finest_usual(length))
}

/// A little above the finest, for smoothing makes a boundary shorter or longer.
fn finest_usual(length: f64) -> f64 {
    1.05 * length / MOST_RIM_EDGES
}

/// So many edges round a disc make about 200,000 triangles.
const MOST_RIM_EDGES: f64 = 1050.0;

fn lengths(points: &[Point3<f64>]) -> Vec<f64> {
    let mut lengths = vec![0.0];
    for i in 0..points.len() {
        lengths.push(lengths[i] + (points[(i + 1) % points.len()] - points[i]).norm());
    }
    lengths
}

/// Points at equal distances along a closed line, from its first point on.
fn resampled(points: &[Point3<f64>], count: usize) -> Vec<Point3<f64>> {
    let starts = lengths(points);
    let total = starts[points.len()];
    let mut edge = 0;
    let sample = |i: usize| {
        let s = total * i as f64 / count as f64;
        while edge + 1 < points.len() && starts[edge + 1] <= s {
            edge += 1;
        }
        let share = (s - starts[edge]) / (starts[edge + 1] - starts[edge]).max(f64::MIN_POSITIVE);
        let (from, to) = (points[edge], points[(edge + 1) % points.len()]);
        from + (to - from) * share
    };
    (0..count).map(sample).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_number_of_electrodes_has_a_width_and_an_edge_length_that_fit_even_as_the_boundary_is_smoothed() {
        for electrodes in 4..=250 {
            let edge = usual_edge(0.25, usual_width(0.25, electrodes));
            for length in [0.24, 0.25, 0.26] {
                let width = usual_width(length, electrodes);
                let fitting = edge.min(width / EDGES_OF_ELECTRODE);
                assert_eq!(check(length, electrodes, width, fitting), Ok(()), "{electrodes} on {length}");
            }
        }
    }

    #[test]
    fn electrodes_narrower_than_the_mesh_can_show_are_refused_with_what_fits() {
        let error = check(0.25, 16, 1e-4, 3e-5).unwrap_err().to_string();
        assert!(error.contains("`width` is 0.100 mm; allowed: 0.476 mm to 14.06"), "{error}");
    }
}

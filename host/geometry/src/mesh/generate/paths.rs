//! Closed curves that edges must follow, and the nodes on them.

use super::{MOST_NODES, MeshError, size_field::SizeField};
use crate::{
    outline::Curve,
    sheet::{ElectrodeModel, Place, Sheet},
};
use nalgebra::Point2;
use std::borrow::Cow;

/// Edges on an electrode of the rim, at least.
const EDGES_ON_ELECTRODE: f64 = 3.0;
/// Edges round an electrode inside, or a curve without corners, at least.
const EDGES_ROUND: f64 = 12.0;

/// A closed curve that edges must follow.
pub(super) struct Path<'a> {
    pub(super) curve: Cow<'a, Curve>,
    /// All round, each from where the one before ends.
    pub(super) stretches: Vec<Stretch>,
    /// The electrode that it goes round.
    pub(super) disc: Option<Disc>,
}

/// An electrode inside.
#[derive(Clone, Copy)]
pub(super) struct Disc {
    pub(super) electrode: usize,
    pub(super) centre: Point2<f64>,
    pub(super) radius: f64,
}

/// A part of a curve between two places that must carry a node.
pub(super) struct Stretch {
    pub(super) from: f64,
    pub(super) length: f64,
    /// The longest edge it may have.
    pub(super) longest: f64,
    /// The electrode that covers it.
    pub(super) electrode: Option<usize>,
}

/// The rim, the holes, and the circles round electrodes inside; edges on electrodes are to be at
/// most `edge` long in space.
pub(super) fn paths<'a>(sheet: &'a Sheet, model: &ElectrodeModel, edge: f64) -> Vec<Path<'a>> {
    let of_sheet = |curve, stretches| Path { curve: Cow::Borrowed(curve), stretches, disc: None };
    let rim = of_sheet(sheet.outline.rim(), stretches_of_rim(sheet, model, edge));
    let bare = |_, length| (length, None);
    let holes =
        sheet.outline.holes().iter().map(|hole| of_sheet(hole, stretches(hole, hole.corners(), bare)));
    let discs = sheet.places.iter().enumerate().filter_map(|(electrode, place)| match (*place, model) {
        (Place::Inside(centre), ElectrodeModel::Complete { width, .. }) => {
            let scale = sheet.embedding.scale(centre);
            let disc = Disc { electrode, centre, radius: width[electrode] / 2.0 / scale };
            Some(circle(disc, edge / scale))
        }
        _ => None,
    });
    std::iter::once(rim).chain(holes).chain(discs).collect()
}

fn circle(disc: Disc, edge: f64) -> Path<'static> {
    let curve = Curve::circle(disc.centre, disc.radius);
    let mut stretches = stretches(&curve, Vec::new(), |_, length| (length, None));
    stretches[0].longest = stretches[0].longest.min(edge);
    Path { curve: Cow::Owned(curve), stretches, disc: Some(disc) }
}

/// Nodes at corners and at the ends of electrodes; a point electrode's ends are one.
fn stretches_of_rim(sheet: &Sheet, model: &ElectrodeModel, edge: f64) -> Vec<Stretch> {
    let rim = sheet.outline.rim();
    let ends = sheet.on_rim().flat_map(|(electrode, centre)| {
        let half = model.width(electrode) / 2.0;
        [centre - half, centre + half]
    });
    let breaks = ends.chain(rim.corners()).map(|s| s.rem_euclid(rim.length())).collect();
    stretches(rim, breaks, |middle, length| {
        let electrode = sheet
            .on_rim()
            .find(|&(electrode, centre)| rim.along(middle, centre) < model.width(electrode) / 2.0)
            .map(|(electrode, _)| electrode);
        let longest = electrode.map_or(length, |electrode| {
            let edge = edge / sheet.embedding.scale(rim.point(middle));
            edge.min(model.width(electrode) / EDGES_ON_ELECTRODE)
        });
        (longest.min(length), electrode)
    })
}

/// The stretches of a curve between `breaks`; `of` says, by middle and length, what the longest edge
/// and the electrode of each are.
fn stretches(
    curve: &Curve,
    mut breaks: Vec<f64>,
    of: impl Fn(f64, f64) -> (f64, Option<usize>),
) -> Vec<Stretch> {
    let round = curve.length();
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * round);
    if breaks.len() > 1 && breaks[0] + round - breaks[breaks.len() - 1] < 1e-9 * round {
        breaks.pop();
    }
    if breaks.is_empty() {
        return vec![Stretch { from: 0.0, length: round, longest: round / EDGES_ROUND, electrode: None }];
    }
    let stretch = |i: usize| {
        let from = breaks[i];
        let to = breaks.get(i + 1).copied().unwrap_or(breaks[0] + round);
        let (longest, electrode) = of((from + to) / 2.0, to - from);
        Stretch { from, length: to - from, longest, electrode }
    };
    (0..breaks.len()).map(stretch).collect()
}

/// Steps per edge in which edges are counted along a curve.
const STEPS: f64 = 4.0;

impl Stretch {
    /// Arc lengths of its nodes without the last. Edges are as long as wanted, but all longer or
    /// shorter by one factor, so that they fill the stretch.
    pub(super) fn nodes(&self, curve: &Curve, size_field: &SizeField) -> Result<Vec<f64>, MeshError> {
        let edges_up_to = self.count_edges(curve, size_field)?;
        let (_, edges) = edges_up_to[edges_up_to.len() - 1];
        let least = (self.length / self.longest - 1e-9).ceil();
        let count = (edges - 0.25).ceil().max(least).max(1.0);
        let mut step = 0;
        let node = |i: usize| {
            let target = edges * i as f64 / count;
            while edges_up_to[step + 1].1 < target {
                step += 1;
            }
            let [(s0, e0), (s1, e1)] = [edges_up_to[step], edges_up_to[step + 1]];
            self.from + s0 + (s1 - s0) * (target - e0) / (e1 - e0)
        };
        Ok((0..count as usize).map(node).collect())
    }

    /// How many edges, and parts of one, fit up to each of many small steps.
    fn count_edges(&self, curve: &Curve, size_field: &SizeField) -> Result<Vec<(f64, f64)>, MeshError> {
        let middle = curve.point(self.from + self.length / 2.0);
        let around = size_field.around(&size_field.sources, middle, self.length / 2.0);
        let wanted = |s: f64| size_field.with(&around.sources, curve.point(self.from + s)).min(self.longest);
        let mut edges_up_to = vec![(0.0, 0.0)];
        let (mut s, mut edges) = (0.0, 0.0);
        while s < self.length {
            let step = (wanted(s) / STEPS).min(self.length - s);
            edges += step / wanted(s + step / 2.0);
            s += step;
            edges_up_to.push((s, edges));
            if edges > MOST_NODES as f64 {
                return Err(MeshError::TooManyNodes);
            }
        }
        Ok(edges_up_to)
    }
}

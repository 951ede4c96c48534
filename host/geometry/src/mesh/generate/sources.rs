//! What asks for short edges before there are any: electrodes, corners close to them, tight bends,
//! and narrow parts of the sheet.

use super::{MeshError, paths::Path, size_field::Source};
use crate::{
    outline::Curve,
    sheet::{Place, Sheet},
};

/// Edges as short as wanted at electrodes, which also must be short where electrodes are close to
/// each other or to a rim.
pub(super) fn by_electrodes(sheet: &Sheet, edge: f64) -> Vec<Source> {
    let at = |place: &Place| match *place {
        Place::Rim(s) => sheet.outline.rim_point(s),
        Place::Inside(point) => point,
    };
    let centres: Vec<_> = sheet.places.iter().map(at).collect();
    let source = |electrode: usize| {
        let at = centres[electrode];
        let others = centres.iter().enumerate().filter(|(other, _)| *other != electrode);
        let apart = others.map(|(_, other)| (other - at).norm()).fold(f64::INFINITY, f64::min);
        let from_rim = match sheet.places[electrode] {
            Place::Rim(_) => f64::INFINITY,
            Place::Inside(_) => sheet.outline.depth(at),
        };
        let size = edge / sheet.embedding.scale(at);
        Source { at, size: size.min(apart / 2.0).min(from_rim / 1.5) }
    };
    (0..centres.len()).map(source).collect()
}

/// Pairs of places across from each other at most. A star of 200 spikes has 39,000 and takes some seconds, one of 500 has
/// 243,000 and would take minutes.
pub(super) const MOST_ACROSS: usize = 60_000;

/// Edges of a path itself, where others are to be `edge` long. `left` pairs of places may yet lie across from each other.
pub(super) fn by_path(
    sheet: &Sheet,
    path: &Path<'_>,
    paths: &[Path<'_>],
    edge: f64,
    left: &mut usize,
) -> Result<Vec<Source>, MeshError> {
    let curve = &*path.curve;
    let mut sources = Vec::new();
    for stretch in &path.stretches {
        let ends = [stretch.from, stretch.from + stretch.length];
        sources.extend(ends.map(|s| Source { at: curve.point(s), size: stretch.longest }));
    }
    for s in samples(curve, edge) {
        sources.push(Source { at: curve.point(s), size: curve.curvature_radius(s) / 2.0 });
        sources.extend(by_narrowness(sheet, paths, curve, s, edge, left)?);
    }
    Ok(sources)
}

/// Arc lengths to look at: corners, and between them at most half an edge apart.
fn samples(curve: &Curve, edge: f64) -> Vec<f64> {
    // A multiple of four finds the ends of an ellipse's axes.
    let count = 4 * ((curve.length() / edge / 2.0).ceil() as usize).max(4);
    let even = (0..count).map(|i| curve.length() * i as f64 / count as f64);
    curve.corners().into_iter().chain(even).collect()
}

/// Two points of a path lie across from each other if they are this many times further apart along
/// it: beside a corner they are not, unless it is sharper than 28 degrees.
const ROUND_ABOUT: f64 = 4.0;

/// Two edges must fit between a point of a path and what lies across from it.
fn by_narrowness(
    sheet: &Sheet,
    paths: &[Path<'_>],
    curve: &Curve,
    s: f64,
    edge: f64,
    left: &mut usize,
) -> Result<Vec<Source>, MeshError> {
    let at = curve.point(s);
    // The point itself is as near as rounding has it.
    let range = 1e-9 * curve.length()..2.0 * edge;
    let mut sources = Vec::new();
    for other in paths.iter().map(|path| &*path.curve) {
        for foot in other.feet(at).filter(|foot| range.contains(&foot.distance)) {
            let elsewhere = !std::ptr::eq(curve, other);
            let across = elsewhere || curve.along(s, foot.arc_length) > ROUND_ABOUT * foot.distance;
            if across {
                *left = left.checked_sub(1).ok_or(MeshError::TooNarrow)?;
            }
            if across && sheet.outline.depth(nalgebra::center(&at, &foot.point)) > 0.0 {
                let size = foot.distance / 2.0;
                sources.extend([at, foot.point].map(|at| Source { at, size }));
            }
        }
    }
    Ok(sources)
}

//! How long edges are to be at each point of the flat sheet.
//!
//! Away from electrodes and narrow parts they are all the same there, so that the lattice stays
//! regular: a regular one is the more exact by an order, because the error of its equations on a
//! field u is in proportion to the Laplacian of the Laplacian of u, which is 0. Laid onto a
//! hemisphere, edges have the wanted length on average: 0.71 of it at the rim, where electrodes are
//! and fields vary most, and 1.41 on top.

use crate::sheet::Sheet;
use nalgebra::Point2;

/// Edges may grow by this much per distance from where they must be short.
const GROWTH: f64 = 0.25;

/// A place where edges must be short.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    pub(super) at: Point2<f64>,
    pub(super) size: f64,
}

impl Source {
    fn allows(&self, point: Point2<f64>) -> f64 {
        self.size + GROWTH * (point - self.at).norm()
    }
}

/// Wanted edge lengths, in metres of the flat sheet.
#[derive(Debug)]
pub(super) struct SizeField {
    /// The longest edge anywhere.
    pub(super) longest: f64,
    pub(super) sources: Vec<Source>,
}

impl SizeField {
    /// Edges up to `longest`, and shorter near `sources` that ask for it.
    pub(super) fn new(longest: f64, sources: impl Iterator<Item = Source>) -> Self {
        Self { longest, sources: sources.filter(|source| source.size < 0.9 * longest).collect() }
    }

    pub(super) fn at(&self, point: Point2<f64>) -> f64 {
        self.with(&self.sources, point)
    }

    /// Wanted edge length at a point that only `sources` matter to.
    pub(super) fn with(&self, sources: &[Source], point: Point2<f64>) -> f64 {
        sources.iter().map(|source| source.allows(point)).fold(self.longest, f64::min)
    }

    /// What is wanted within `radius` of a point that only `sources` matter to.
    pub(super) fn around(&self, sources: &[Source], point: Point2<f64>, radius: f64) -> Around {
        let change = GROWTH * radius;
        let longest = (self.with(sources, point) + change).min(self.longest);
        let matters = |source: &&Source| source.allows(point) - change < longest;
        let sources: Vec<_> = sources.iter().filter(matters).copied().collect();
        let least = |source: &Source| (source.allows(point) - change).max(source.size);
        let shortest = sources.iter().map(least).fold(self.longest, f64::min);
        Around { sources, shortest, longest }
    }
}

/// Wanted edge lengths in the neighbourhood of a point.
pub(super) struct Around {
    /// Those that matter somewhere there.
    pub(super) sources: Vec<Source>,
    /// Wanted nowhere shorter than this.
    pub(super) shortest: f64,
    /// Wanted nowhere longer than this.
    pub(super) longest: f64,
}

/// Edge length of the flat sheet at which edges have length `edge` in space, on average.
pub(super) fn flattened(edge: f64, sheet: &Sheet) -> f64 {
    edge * (sheet.outline.area() / sheet.embedding.area(&sheet.outline)).sqrt()
}

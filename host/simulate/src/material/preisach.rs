//! Preisach operator with a continuous density, by its Everett function.
//!
//! The Everett function E(a, b) is the share of contacts that close up to a and open from there down to b.
//! The state is the list of turning points that later ones have not wiped out (Mayergoyz, "Mathematical
//! Models of Hysteresis and Their Applications", 2003, section 1.2).

use super::curve::{Loading, Release};

/// Nodes of the table along each side.
const NODES: usize = 65;
/// Steps of the integral behind each entry.
const STEPS: usize = 64;
/// Most pairs of turning points that a place remembers; the smallest loop goes first.
const MAX_PAIRS: usize = 16;

/// E(a, b), tabulated over the roots of a and b/a, where it is smooth.
#[derive(Debug)]
pub(super) struct Everett {
    pub(super) loading: Loading,
    table: Vec<f64>,
}

impl Everett {
    pub(super) fn new(loading: Loading, release: Release) -> Self {
        let node = |i: usize| (i as f64 / (NODES - 1) as f64).powi(2);
        let entry = |i: usize| integral(&loading, &release, node(i / NODES), node(i % NODES));
        Self { loading, table: (0..NODES * NODES).map(entry).collect() }
    }

    /// Share of contacts that close up to `a` and open again from there down to `b`.
    fn share(&self, a: f64, b: f64) -> f64 {
        if a <= 0.0 || b >= a {
            return 0.0;
        }
        if b <= 0.0 {
            return self.loading.closed(a);
        }
        let ([i, u], [j, v]) = (place(a), place(b / a));
        let (i, j) = (i as usize, j as usize);
        let at = |i: usize, j: usize| self.table[i * NODES + j];
        let near = at(i, j) * (1.0 - v) + at(i, j + 1) * v;
        let far = at(i + 1, j) * (1.0 - v) + at(i + 1, j + 1) * v;
        near * (1.0 - u) + far * u
    }
}

/// Cell and place in it, of a number from 0 to 1.
fn place(value: f64) -> [f64; 2] {
    let along = value.clamp(0.0, 1.0).sqrt() * (NODES - 1) as f64;
    let cell = along.floor().min((NODES - 2) as f64);
    [cell, along - cell]
}

/// Contacts that close between `ratio * a` and `a`, each counted by what of it opens at `ratio * a`.
fn integral(loading: &Loading, release: &Release, a: f64, ratio: f64) -> f64 {
    let low = ratio * a;
    let node = |i: usize| (low.sqrt() + (a.sqrt() - low.sqrt()) * i as f64 / STEPS as f64).powi(2);
    let part = |i: usize| {
        let (from, to) = (node(i), node(i + 1));
        let middle = 0.5 * (from + to);
        let open = if middle > 0.0 { release.open(low / middle) } else { 1.0 };
        (loading.closed(to) - loading.closed(from)) * open
    };
    (0..STEPS).map(part).sum()
}

/// State of one place.
#[derive(Clone, Debug, Default)]
pub(super) struct Preisach {
    /// Highest and then lowest pressure of each loop that still counts, largest loop first.
    pairs: Vec<[f64; 2]>,
}

impl Preisach {
    /// Moves to a pressure, 0 to 1, and gives the share of contacts that are closed.
    pub(super) fn apply(&mut self, everett: &Everett, pressure: f64) -> f64 {
        let last = self.pairs.last().map_or(0.0, |pair| pair[1]);
        if pressure > last {
            self.rise(pressure);
        } else if pressure < last {
            self.fall(pressure);
        }
        self.closed(everett)
    }

    /// Loops below the new pressure are wiped out.
    fn rise(&mut self, pressure: f64) {
        while self.pairs.last().is_some_and(|pair| pair[0] <= pressure) {
            self.pairs.pop();
        }
        if self.pairs.len() == MAX_PAIRS {
            self.pairs.pop();
        }
        self.pairs.push([pressure; 2]);
    }

    /// Loops above the new pressure are wiped out.
    fn fall(&mut self, pressure: f64) {
        while let [.., before, _] = &self.pairs[..]
            && before[1] >= pressure
        {
            self.pairs.pop();
        }
        if let Some(pair) = self.pairs.last_mut() {
            pair[1] = pressure;
        }
    }

    fn closed(&self, everett: &Everett) -> f64 {
        let mut low = 0.0;
        let change = |pair: &[f64; 2]| {
            let from = std::mem::replace(&mut low, pair[1]);
            everett.share(pair[0], from) - everett.share(pair[0], pair[1])
        };
        self.pairs.iter().map(change).sum()
    }
}

//! Which elements share an edge, and which way round they lie.

use rayon::prelude::*;

/// Pairs of elements that share an edge, ascending; of an edge with more than two elements, each
/// pair that follows another.
#[must_use]
pub fn neighbours(elements: &[[usize; 3]]) -> Vec<[usize; 2]> {
    pairs(&edges(elements))
}

/// [`neighbours`] and [`orientation`], for little more than one of them.
#[must_use]
pub fn neighbours_and_orientation(elements: &[[usize; 3]]) -> (Vec<[usize; 2]>, Vec<f64>) {
    let edges = edges(elements);
    (pairs(&edges), orientation_over(&edges, elements.len()))
}

fn pairs(edges: &[Edge]) -> Vec<[usize; 2]> {
    let mut pairs: Vec<[usize; 2]> = edges
        .par_windows(2)
        .filter(|pair| pair[0].nodes == pair[1].nodes)
        .map(|pair| [pair[0].element(), pair[1].element()])
        .collect();
    pairs.par_sort_unstable();
    pairs
}

/// One edge of an element: its nodes ascending, and whether the element passes it that way round.
///
/// Numbers are half as long as usize, which is half the memory to go through.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Edge {
    nodes: [u32; 2],
    element: u32,
    pub(crate) ascending: bool,
}

impl Edge {
    pub(crate) fn nodes(&self) -> [usize; 2] {
        self.nodes.map(|node| node as usize)
    }

    pub(crate) fn element(&self) -> usize {
        self.element as usize
    }
}

/// Every edge of every element, ascending: those of the same nodes are together.
///
/// They are counted into a bucket for each lower node, and only the buckets are sorted.
pub(crate) fn edges(elements: &[[usize; 3]]) -> Vec<Edge> {
    let all = || elements.iter().enumerate().flat_map(|(element, &corners)| edges_of(element, corners));
    let nodes = elements.iter().flatten().max().map_or(0, |last| last + 1);
    let mut free = vec![0; nodes + 1];
    all().for_each(|edge| free[edge.nodes()[0] + 1] += 1);
    (0..nodes).for_each(|node| free[node + 1] += free[node]);
    let mut edges = vec![Edge::default(); 3 * elements.len()];
    for edge in all() {
        let free = &mut free[edge.nodes()[0]];
        edges[*free] = edge;
        *free += 1;
    }
    edges.par_chunk_by_mut(|a, b| a.nodes[0] == b.nodes[0]).for_each(<[Edge]>::sort_unstable);
    edges
}

fn edges_of(element: usize, [a, b, c]: [usize; 3]) -> [Edge; 3] {
    [(a, b), (b, c), (c, a)].map(|(a, b)| Edge {
        nodes: [a.min(b) as u32, a.max(b) as u32],
        element: element as u32,
        ascending: a < b,
    })
}

/// Edges of one element only.
pub(super) fn alone(edges: &[Edge]) -> impl Iterator<Item = &Edge> {
    edges.chunk_by(|a, b| a.nodes == b.nodes).filter(|edges| edges.len() == 1).map(|edges| &edges[0])
}

/// Nodes of each edge of the boundaries: those of one element only, ascending.
#[must_use]
pub fn boundary_edges(elements: &[[usize; 3]]) -> Vec<[usize; 2]> {
    alone(&edges(elements)).map(Edge::nodes).collect()
}

/// For each element 1, or -1 if it lies the other way round than most of its part of the mesh:
/// `[element]`. On a surface with one side only there is no such sign, and some neighbours differ.
#[must_use]
pub fn orientation(elements: &[[usize; 3]]) -> Vec<f64> {
    orientation_over(&edges(elements), elements.len())
}

/// [`orientation`] of as many elements as have these edges.
pub(super) fn orientation_over(edges: &[Edge], elements: usize) -> Vec<f64> {
    let adjacent = Adjacency::with_turns(edges, elements);
    let mut signs = vec![0.0; elements];
    for start in 0..elements {
        if signs[start] == 0.0 {
            orient_part(start, &adjacent, &mut signs);
        }
    }
    signs
}

fn orient_part(start: usize, adjacent: &Adjacency<i8>, signs: &mut [f64]) {
    signs[start] = 1.0;
    let mut part = vec![start];
    let mut next = 0;
    while let Some(&element) = part.get(next) {
        next += 1;
        for (other, turn) in adjacent.of(element) {
            if signs[other] == 0.0 {
                signs[other] = signs[element] * f64::from(turn);
                part.push(other);
            }
        }
    }
    if part.iter().map(|&element| signs[element]).sum::<f64>() < 0.0 {
        part.iter().for_each(|&element| signs[element] = -signs[element]);
    }
}

/// Neighbours of each element, each with a value of its own.
#[derive(Clone, Debug)]
pub struct Adjacency<V> {
    starts: Vec<usize>,
    entries: Vec<(u32, V)>,
}

impl<V: Copy> Adjacency<V> {
    /// From pairs of `count` things.
    pub fn new(count: usize, pairs: impl Iterator<Item = ([usize; 2], V)> + Clone, nothing: V) -> Self {
        let mut starts = vec![0; count + 1];
        pairs.clone().for_each(|([a, b], _)| {
            starts[a + 1] += 1;
            starts[b + 1] += 1;
        });
        (0..count).for_each(|i| starts[i + 1] += starts[i]);
        let mut free = starts.clone();
        let mut entries = vec![(0, nothing); starts[count]];
        for ([a, b], value) in pairs {
            entries[free[a]] = (b as u32, value);
            entries[free[b]] = (a as u32, value);
            free[a] += 1;
            free[b] += 1;
        }
        Self { starts, entries }
    }

    /// Neighbours of one.
    pub fn of(&self, index: usize) -> impl Iterator<Item = (usize, V)> {
        let entries = &self.entries[self.starts[index]..self.starts[index + 1]];
        entries.iter().map(|&(other, value)| (other as usize, value))
    }
}

impl Adjacency<i8> {
    /// Elements with 1 for a neighbour that lies the same way round, else -1.
    fn with_turns(edges: &[Edge], elements: usize) -> Self {
        let pairs = edges.windows(2).filter(|pair| pair[0].nodes == pair[1].nodes).map(|pair| {
            let turn = if pair[0].ascending == pair[1].ascending { -1 } else { 1 };
            ([pair[0].element(), pair[1].element()], turn)
        });
        Self::new(elements, pairs, 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four triangles round node 4 of a square.
    const FAN: [[usize; 3]; 4] = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];

    #[test]
    fn neighbours_share_an_edge_and_not_only_a_node() {
        assert_eq!(neighbours(&FAN), [[0, 1], [0, 3], [1, 2], [2, 3]]);
    }

    #[test]
    fn edges_of_one_element_are_the_boundary() {
        assert_eq!(boundary_edges(&FAN), [[0, 1], [0, 3], [1, 2], [2, 3]]);
        assert_eq!(boundary_edges(&FAN[..1]), [[0, 1], [0, 4], [1, 4]]);
    }

    #[test]
    fn an_element_that_lies_the_other_way_round_is_found() {
        let mut elements = FAN;
        elements[2].swap(0, 1);
        assert_eq!(orientation(&elements), [1.0, 1.0, -1.0, 1.0]);
    }
}

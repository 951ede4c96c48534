//! Nodes, elements and groups as they are read.

use super::{
    super::{
        Group, Imported, Problem,
        cursor::{Cursor, Scalar},
    },
    Shape,
};
use nalgebra::Point3;
use std::collections::{BTreeMap, HashMap};

/// A physical group: dimension and number.
pub(super) type Physical = (usize, i64);

/// What was read so far.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) mesh: Imported,
    numbers: NodeNumbers,
    pub(super) names: HashMap<Physical, String>,
    /// Physical groups of each entity (dimension, number).
    pub(super) entities: HashMap<(usize, i64), Vec<i64>>,
    groups: BTreeMap<Physical, Group>,
}

impl Contents {
    /// Takes over the nodes of a file and their numbers there.
    pub(super) fn set_nodes(
        &mut self,
        nodes: Vec<Point3<f64>>,
        numbers: &[usize],
        cursor: &Cursor,
    ) -> Result<(), Problem> {
        if !self.mesh.nodes.is_empty() {
            return Err(cursor.wrong("a section", &"Nodes", "one section of this name"));
        }
        let twice = |number| cursor.wrong("the number of a node", &number, "a number that comes once");
        self.numbers = NodeNumbers::new(numbers.iter().copied()).map_err(twice)?;
        self.mesh.nodes = nodes;
        Ok(())
    }

    /// Nodes of an element, as places among the nodes; those it does not have are 0.
    pub(super) fn corners(
        &self,
        shape: Shape,
        number: Scalar,
        cursor: &mut Cursor,
    ) -> Result<[usize; 3], Problem> {
        let mut corners = [0; 3];
        for corner in &mut corners[..shape.corners()] {
            let found = cursor.natural(number, "the node of an element")?;
            let place = self.numbers.place(found);
            *corner = place.ok_or_else(|| {
                cursor.wrong("the node of an element", &found, "the number of a node in $Nodes before it")
            })?;
        }
        Ok(corners)
    }

    /// Adds an element to the mesh and to its groups.
    pub(super) fn add(&mut self, shape: Shape, corners: [usize; 3], groups: &[i64]) {
        let place = self.mesh.triangles.len();
        if shape == Shape::Triangle {
            self.mesh.triangles.push(corners);
        }
        for &group in groups {
            self.add_to_group(shape, corners, place, group);
        }
    }

    /// Adds an element to a group; `place` is where it is among the triangles, if it is one.
    pub(super) fn add_to_group(&mut self, shape: Shape, corners: [usize; 3], place: usize, group: i64) {
        // A negative number means the opposite orientation, 0 means no group.
        let group = match group.checked_abs() {
            None | Some(0) => return,
            Some(number) => self.groups.entry((shape.dimension(), number)).or_default(),
        };
        match shape {
            Shape::Point => group.nodes.push(corners[0]),
            Shape::Line => group.edges.push([corners[0], corners[1]]),
            Shape::Triangle => group.triangles.push(place),
        }
    }

    /// Gives the groups their names, and joins those of one name.
    pub(super) fn finish(mut self) -> Imported {
        let mut places = HashMap::new();
        for ((dimension, number), group) in self.groups {
            let default = || format!("{}_{number}", ["point", "curve", "surface"][dimension]);
            let name = self.names.remove(&(dimension, number)).unwrap_or_else(default);
            let groups = &mut self.mesh.groups;
            let place = *places.entry(name.clone()).or_insert(groups.len());
            if place == groups.len() {
                groups.push(Group { name, ..Group::default() });
            }
            groups[place].nodes.extend(group.nodes);
            groups[place].edges.extend(group.edges);
            groups[place].triangles.extend(group.triangles);
        }
        for group in &mut self.mesh.groups {
            group.triangles.sort_unstable();
            group.triangles.dedup();
        }
        self.mesh
    }
}

/// What a file calls each node: any numbers, in any order.
#[derive(Default)]
struct NodeNumbers {
    /// Number in the file and place among the nodes, by number.
    sorted: Vec<(usize, usize)>,
}

impl NodeNumbers {
    /// Of `numbers` in the order of the nodes; the number if one comes twice.
    fn new(numbers: impl Iterator<Item = usize>) -> Result<Self, usize> {
        let mut sorted: Vec<_> = numbers.enumerate().map(|(place, number)| (number, place)).collect();
        sorted.sort_unstable();
        match sorted.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            Some(pair) => Err(pair[0].0),
            None => Ok(Self { sorted }),
        }
    }

    fn place(&self, number: usize) -> Option<usize> {
        // Mostly they run without gaps.
        let guess = number.checked_sub(self.sorted.first()?.0)?;
        let found = match self.sorted.get(guess) {
            Some(entry) if entry.0 == number => guess,
            _ => self.sorted.binary_search_by_key(&number, |entry| entry.0).ok()?,
        };
        Some(self.sorted[found].1)
    }
}

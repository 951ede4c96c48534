//! Nodes and edges that a mesh must have: its boundaries, and electrodes inside.

use super::{
    MOST_NODES, MeshError,
    paths::{Disc, Path, paths},
    size_field::{SizeField, Source, flattened},
    sources,
};
use crate::{
    outline::{Curve, Outline},
    sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
};
use nalgebra::Point2;
use std::{f64::consts::PI, ops::Range};

/// Nodes and edges that a mesh must have.
pub(super) struct Skeleton<'a> {
    pub(super) outline: &'a Outline,
    /// Electrodes inside, of the complete model.
    discs: Vec<Disc>,
    /// Electrodes inside, of the point model.
    lone: Range<usize>,
    /// Where the nodes lie in the flat sheet: `[node]`. Those of the outer boundary come first.
    pub(super) points: Vec<Point2<f64>>,
    /// Mean length of the edges at each node: `[node]`.
    spacings: Vec<f64>,
    /// Edges of the boundaries: each belongs to one element.
    pub(super) boundary_edges: Vec<[usize; 2]>,
    /// Edges round electrodes inside: each belongs to two elements.
    pub(super) inner_edges: Vec<[usize; 2]>,
    /// Where each electrode touches: `[electrode]`.
    pub(super) touches: Vec<Touch>,
    /// Area within the boundaries, m^2.
    pub(super) area: f64,
}

/// Where an electrode touches the nodes of a skeleton.
#[derive(Clone, Debug)]
pub(super) enum Touch {
    Node(usize),
    Edges(Vec<[usize; 2]>),
    /// All that these nodes lie round.
    Disc(Range<usize>),
}

impl<'a> Skeleton<'a> {
    pub(super) fn new(
        sheet: &'a Sheet,
        model: &ElectrodeModel,
        edges: EdgeLengths,
    ) -> Result<Self, MeshError> {
        let (edge, paths) = (flattened(edges.skin, sheet), paths(sheet, model, edges.electrodes));
        let mut sources = sources::by_electrodes(sheet, edges.electrodes);
        let mut left = sources::MOST_ACROSS;
        for path in &paths {
            sources.extend(sources::by_path(sheet, path, &paths, edge, &mut left)?);
        }
        let size_field = SizeField::new(edge, sources.into_iter());
        let mut skeleton = Self {
            outline: &sheet.outline,
            discs: Vec::new(),
            lone: 0..0,
            points: Vec::new(),
            spacings: Vec::new(),
            boundary_edges: Vec::new(),
            inner_edges: Vec::new(),
            touches: vec![Touch::Edges(Vec::new()); sheet.places.len()],
            area: 0.0,
        };
        paths.iter().try_for_each(|path| skeleton.follow(path, &size_field))?;
        if matches!(model, ElectrodeModel::Point) {
            skeleton.place_points(sheet, &size_field);
        }
        Ok(skeleton)
    }

    /// Puts nodes and edges on a closed curve.
    fn follow(&mut self, path: &Path<'_>, size_field: &SizeField) -> Result<(), MeshError> {
        let start = self.points.len();
        let mut covered = Vec::new();
        for stretch in &path.stretches {
            let nodes = stretch.nodes(&path.curve, size_field)?;
            covered.extend(nodes.iter().map(|_| stretch.electrode));
            self.points.extend(nodes.into_iter().map(|s| path.curve.point(s)));
        }
        if self.points.len() > MOST_NODES {
            return Err(MeshError::TooManyNodes);
        }
        let count = covered.len();
        let edges = (0..count).map(|i| [start + i, start + (i + 1) % count]);
        match path.disc {
            Some(disc) => self.go_round(disc, start..start + count),
            None => self.enclose(start..start + count),
        }
        for (edge, electrode) in edges.clone().zip(covered) {
            if let Some(Touch::Edges(of_electrode)) = electrode.map(|electrode| &mut self.touches[electrode])
            {
                of_electrode.push(edge);
            }
        }
        let length = |i: usize| (self.points[start + (i + 1) % count] - self.points[start + i]).norm();
        let spacing = |i: usize| (length(i) + length((i + count - 1) % count)) / 2.0;
        self.spacings.extend((0..count).map(spacing));
        if path.disc.is_some() {
            self.inner_edges.extend(edges);
        } else {
            self.boundary_edges.extend(edges);
        }
        Ok(())
    }

    /// The first nodes go round the sheet, others round holes.
    fn enclose(&mut self, nodes: Range<usize>) {
        let area = Curve::polygon(&self.points[nodes.clone()]).area();
        self.area += if nodes.start == 0 { area } else { -area };
    }

    /// Moves the nodes round an electrode out a little, so that they enclose the circle's area.
    fn go_round(&mut self, disc: Disc, nodes: Range<usize>) {
        let points = &mut self.points[nodes.clone()];
        let stretch = (PI * disc.radius.powi(2) / Curve::polygon(points).area()).sqrt();
        points.iter_mut().for_each(|point| *point = disc.centre + (*point - disc.centre) * stretch);
        self.discs.push(disc);
        self.touches[disc.electrode] = Touch::Disc(nodes);
    }

    /// Point electrodes: the node that is there on the boundary, or one more inside.
    fn place_points(&mut self, sheet: &Sheet, size_field: &SizeField) {
        let first = self.points.len();
        for (electrode, place) in sheet.places.iter().enumerate() {
            let node = match *place {
                Place::Rim(s) => self.nearest(sheet.outline.rim_point(s), first),
                Place::Inside(point) => {
                    self.points.push(point);
                    self.spacings.push(size_field.at(point));
                    self.points.len() - 1
                }
            };
            self.touches[electrode] = Touch::Node(node);
        }
        self.lone = first..self.points.len();
    }

    fn nearest(&self, point: Point2<f64>, of_first: usize) -> usize {
        let distance = |node: usize| (self.points[node] - point).norm_squared();
        let nearest = (0..of_first).min_by(|&a, &b| distance(a).total_cmp(&distance(b)));
        nearest.expect("every boundary has nodes")
    }

    /// What its nodes ask of the edges around them.
    pub(super) fn sources(&self) -> impl Iterator<Item = Source> + '_ {
        self.points.iter().zip(&self.spacings).map(|(&at, &size)| Source { at, size })
    }

    /// Distance to the nearest boundary, electrode's boundary or point electrode; negative off the sheet.
    pub(super) fn clearance(&self, point: Point2<f64>) -> f64 {
        let discs = self.discs.iter().map(|disc| ((point - disc.centre).norm() - disc.radius).abs());
        let lone = self.points[self.lone.clone()].iter().map(|node| (point - node).norm());
        discs.chain(lone).fold(self.outline.depth(point), f64::min)
    }
}

//! Surface: where on a skin something lies, flat or curved, seen through the true skin's mesh.

use dermatome_geometry::{
    mesh::{Mesh, neighbours::boundary_edges, triangle},
    outline::Outline,
};
use dermatome_model::{pixels::element_patches, skin::Shape};
use nalgebra::{Point2, Point3, Unit, Vector3};

/// A skin's surface.
#[derive(Clone, Debug)]
pub(crate) struct Surface<'a> {
    /// The true skin's mesh.
    pub(crate) mesh: &'a Mesh,
    outline: Option<&'a Outline>,
    /// Centre of gravity of each triangle: `[element]`.
    pub(super) centroids: Vec<Point3<f64>>,
    /// Area of each triangle, m^2: `[element]`.
    pub(crate) areas: Vec<f64>,
    /// Edges of the mesh that belong to one triangle only; empty where the outline says more.
    boundary: Vec<[Point3<f64>; 2]>,
    deepest: f64,
    /// Largest extent along x, y or z, m: what errors in per cent refer to.
    pub(super) diameter: f64,
    /// Centre of gravity, m.
    pub(super) centre: Point3<f64>,
}

impl<'a> Surface<'a> {
    /// The surface of `shape`, of which `mesh` is the true skin's mesh.
    #[must_use]
    pub(crate) fn new(shape: &'a Shape, mesh: &'a Mesh) -> Self {
        let corners = || (0..mesh.elements.len()).map(|element| mesh.corners(element));
        let (centroids, areas): (Vec<_>, Vec<f64>) =
            corners().map(|corners| (triangle::centroid(corners), triangle::area(corners))).unzip();
        let outline = shape.flat().ok();
        let moment: Vector3<f64> = centroids.iter().zip(&areas).map(|(c, &area)| c.coords * area).sum();
        let mut surface = Self {
            mesh,
            outline,
            boundary: if outline.is_some() { Vec::new() } else { boundary(mesh) },
            deepest: f64::INFINITY,
            diameter: outline.map_or_else(|| largest_extent(mesh), Outline::diameter),
            centre: Point3::from(moment / areas.iter().sum::<f64>()),
            centroids,
            areas,
        };
        // The origin is the deepest point of a disc, a rectangle, an ellipse; nodes only come close.
        let candidates = mesh.nodes.iter().copied().chain(outline.map(|_| Point3::origin()));
        surface.deepest = candidates.map(|point| surface.depth(point)).fold(0.0, f64::max);
        surface
    }

    /// Whether the skin is flat.
    #[must_use]
    pub(crate) fn is_flat(&self) -> bool {
        self.outline.is_some()
    }

    /// Area of the skin, m^2.
    #[must_use]
    pub(super) fn area(&self) -> f64 {
        self.areas.iter().sum()
    }

    /// Distance to the boundary, m, negative beyond a flat one; infinite on a closed surface.
    #[must_use]
    pub(super) fn depth(&self, point: Point3<f64>) -> f64 {
        match self.outline {
            Some(outline) => outline.depth(Point2::new(point.x, point.y)),
            None => self.boundary.iter().map(|edge| distance(point, edge)).fold(f64::INFINITY, f64::min),
        }
    }

    /// How far out a point lies: 0 at the deepest place of the skin (and anywhere on a closed
    /// surface), 1 at the boundary. On a disc it is the share of the radius.
    #[must_use]
    pub(crate) fn normalised_radius(&self, point: Point3<f64>) -> f64 {
        if self.deepest.is_finite() { (1.0 - self.depth(point) / self.deepest).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// The point of the surface that is closest, or nearly.
    #[must_use]
    pub(super) fn onto(&self, point: Point3<f64>) -> Point3<f64> {
        if self.is_flat() {
            return point;
        }
        let element = self.nearest_element(point);
        let normal = triangle::normal(self.mesh.corners(element));
        point - normal * (point - self.centroids[element]).dot(&normal)
    }

    fn nearest_element(&self, point: Point3<f64>) -> usize {
        let distance = |element: &usize| (self.centroids[*element] - point).norm_squared();
        let elements = 0..self.centroids.len();
        elements.min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
    }

    /// Directions at a point of the surface: away from the skin's centre, and across.
    #[must_use]
    pub(super) fn directions(&self, point: Point3<f64>) -> [Unit<Vector3<f64>>; 2] {
        let normal = if self.is_flat() {
            Vector3::z()
        } else {
            triangle::normal(self.mesh.corners(self.nearest_element(point)))
        };
        let along = |direction: Vector3<f64>| direction - normal * direction.dot(&normal);
        let small = 1e-3 * self.diameter;
        let radial = Unit::try_new(along(point - self.centre), small)
            .or_else(|| Unit::try_new(along(Vector3::x()), 0.5))
            .unwrap_or_else(Vector3::y_axis);
        [radial, Unit::new_normalize(normal.cross(&radial))]
    }

    /// Places all over the skin, about `spacing` apart: on a flat one a square grid through the origin
    /// and a row on the rim itself, else the middles of patches.
    #[must_use]
    pub(super) fn places(&self, spacing: f64) -> Vec<Point3<f64>> {
        match self.outline {
            Some(outline) => {
                let mut places = self.grid(outline, spacing);
                places.extend(on_rim(outline, spacing));
                places
            }
            None => {
                let count = (self.area() / (spacing * spacing)).round().max(1.0) as usize;
                element_patches(self.mesh, count).centres.iter().map(|&centre| self.onto(centre)).collect()
            }
        }
    }

    fn grid(&self, outline: &Outline, spacing: f64) -> Vec<Point3<f64>> {
        let steps = |axis: usize| {
            let (low, high) = extent(self.mesh, axis);
            (low / spacing).floor() as i64..=(high / spacing).ceil() as i64
        };
        let at = |row: i64, column: i64| Point3::new(column as f64 * spacing, row as f64 * spacing, 0.0);
        steps(1)
            .flat_map(|row| steps(0).map(move |column| at(row, column)))
            .filter(|place| outline.depth(Point2::new(place.x, place.y)) > spacing / 2.0)
            .collect()
    }
}

fn on_rim(outline: &Outline, spacing: f64) -> impl Iterator<Item = Point3<f64>> + '_ {
    let perimeter = outline.perimeter();
    let count = (perimeter / spacing).round().max(1.0) as u32;
    (0..count).map(move |i| {
        let point = outline.rim_point(perimeter * f64::from(i) / f64::from(count));
        Point3::new(point.x, point.y, 0.0)
    })
}

/// Largest extent along x, y or z, m.
pub(crate) fn largest_extent(mesh: &Mesh) -> f64 {
    (0..3).map(|axis| extent(mesh, axis)).map(|(low, high)| high - low).fold(0.0, f64::max)
}

/// Smallest and largest coordinate of all nodes.
pub(crate) fn extent(mesh: &Mesh, axis: usize) -> (f64, f64) {
    let along = mesh.nodes.iter().map(|node| node[axis]);
    along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
}

fn boundary(mesh: &Mesh) -> Vec<[Point3<f64>; 2]> {
    boundary_edges(&mesh.elements).into_iter().map(|edge| edge.map(|node| mesh.nodes[node])).collect()
}

/// From a point to an edge.
fn distance(point: Point3<f64>, [from, to]: &[Point3<f64>; 2]) -> f64 {
    let along = to - from;
    let share = (point - from).dot(&along) / along.norm_squared();
    (point - (from + along * share.clamp(0.0, 1.0))).norm()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use dermatome_geometry::{
        embedding::Embedding,
        mesh::{ElectrodeContact, Lattice, generate},
        sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
    };

    const RADIUS: f64 = 0.1;

    fn disc_mesh() -> (Sheet, Mesh) {
        let outline = Outline::disc(RADIUS);
        let places = (0..8).map(|i| Place::Rim(f64::from(i) * outline.perimeter() / 8.0)).collect();
        let sheet = Sheet { outline, embedding: Embedding::Flat, places };
        let edges = EdgeLengths { skin: 0.01, electrodes: 0.01 };
        let mesh = generate(&sheet, &ElectrodeModel::Point, edges, Lattice::default()).unwrap();
        (sheet, mesh)
    }

    pub(in super::super) fn disc_surface() -> (Shape, Mesh) {
        let (sheet, mesh) = disc_mesh();
        (Shape::Sheet(sheet), mesh)
    }

    /// The disc drawn up to half a sphere: the middle becomes the pole, the rim the equator.
    pub(in super::super) fn hemisphere() -> Mesh {
        let (_, mut mesh) = disc_mesh();
        for node in &mut mesh.nodes {
            let (share, turn) = (node.coords.norm() / RADIUS, node.y.atan2(node.x));
            let tilt = share.min(1.0) * std::f64::consts::FRAC_PI_2;
            *node = Point3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), tilt.cos()) * RADIUS;
        }
        mesh
    }

    #[test]
    fn on_a_disc_the_normalised_radius_is_the_share_of_the_radius() {
        let (shape, mesh) = disc_surface();
        let surface = Surface::new(&shape, &mesh);
        for share in [0.0, 0.3, 0.8, 1.0] {
            let place = Point3::new(0.0, share * RADIUS, 0.0);
            assert!((surface.normalised_radius(place) - share).abs() < 1e-12);
            assert_eq!(surface.onto(place), place);
        }
        assert!((surface.diameter - 2.0 * RADIUS).abs() < 1e-12);
        assert!(surface.centre.coords.norm() < 1e-4 * RADIUS);
    }

    #[test]
    fn places_on_a_disc_form_a_grid_and_a_row_on_the_rim() {
        let (shape, mesh) = disc_surface();
        let places = Surface::new(&shape, &mesh).places(0.02);
        // Integer points with x^2 + y^2 < 4.5^2, and the perimeter of 0.628 m in steps of 0.02 m.
        assert_eq!(places.len(), 69 + 31);
        assert_eq!(places.iter().filter(|place| place.coords.norm() > 0.0999).count(), 31);
        assert!(places.contains(&Point3::origin()));
    }

    #[test]
    fn directions_are_unit_tangents_at_right_angles_even_at_the_centre() {
        let mesh = hemisphere();
        let shape = Shape::Mesh { mesh: Box::new(mesh.clone()), outline: None };
        let surface = Surface::new(&shape, &mesh);
        for place in
            [Point3::new(0.0, 0.0, RADIUS), Point3::new(0.06, 0.0, 0.08), Point3::new(0.0, 0.098, 0.01)]
        {
            let [radial, across] = surface.directions(surface.onto(place));
            let outwards = place.coords.normalize();
            assert!(radial.dot(&across).abs() < 1e-12);
            assert!(radial.dot(&outwards).abs() < 0.2 && across.dot(&outwards).abs() < 0.2);
        }
        // Beside the pole, away from the centre is away from the pole.
        let [radial, _] = surface.directions(Point3::new(0.06, 0.0, 0.08));
        assert!(radial.x > 0.7, "{radial:?}");
    }

    #[test]
    fn a_curved_skin_knows_its_boundary_and_spreads_places_over_its_surface() {
        let mesh = hemisphere();
        let shape = Shape::Mesh { mesh: Box::new(mesh.clone()), outline: None };
        let surface = Surface::new(&shape, &mesh);
        assert!(!surface.is_flat());
        assert!((surface.centre.z - RADIUS / 2.0).abs() < 0.02 * RADIUS, "{:?}", surface.centre);
        assert_eq!(surface.normalised_radius(Point3::new(RADIUS, 0.0, 0.0)), 1.0);
        assert!(surface.normalised_radius(Point3::new(0.0, 0.0, RADIUS)) < 0.02);
        let places = surface.places(0.02);
        assert_eq!(places.len(), (surface.area() / 0.0004).round() as usize);
        for place in &places {
            assert!((place.coords.norm() / RADIUS - 1.0).abs() < 0.02, "{place}");
        }
        let nearest = |a: &Point3<f64>| {
            places.iter().map(|b| (a - b).norm()).filter(|&d| d > 0.0).fold(f64::INFINITY, f64::min)
        };
        assert!(places.iter().map(nearest).fold(f64::INFINITY, f64::min) > 0.008);
    }

    #[test]
    fn a_closed_surface_has_no_boundary() {
        let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let elements = vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];
        let electrodes = (0..4).map(ElectrodeContact::Node).collect();
        let mesh = Mesh { nodes: nodes.map(Point3::from).to_vec(), elements, electrodes };
        let shape = Shape::Mesh { mesh: Box::new(mesh.clone()), outline: None };
        let surface = Surface::new(&shape, &mesh);
        assert_eq!(surface.normalised_radius(Point3::new(0.2, 0.2, 0.0)), 0.0);
    }
}

use super::*;
use crate::{embedding::Embedding, mesh::soundness::require_sound, outline::Outline, sheet::Place};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A shape about 1 m large, with the largest curvature of its rim, 1/m.
fn shapes() -> impl Strategy<Value = (Outline, Embedding, f64)> {
    let flat = |outline, curvature| (outline, Embedding::Flat, curvature);
    prop_oneof![
        Just(flat(Outline::disc(0.5), 2.0)),
        (0.4..1.0).prop_map(move |height| flat(Outline::rectangle(1.0, height), 0.0)),
        (0.4..1.0).prop_map(move |height: f64| flat(Outline::ellipse(1.0, height), 2.0 / height.powi(2))),
        (0.05..0.15, 0.2..0.8).prop_map(move |(half, x)| flat(holed(half, x), 0.0)),
        Just((Outline::disc(0.5), Embedding::Hemisphere { radius: 0.5 }, 2.0)),
        (0.2..0.5, 1.0..6.0).prop_map(|(radius, angle): (f64, f64)| {
            (Outline::rectangle(radius * angle, 0.7), Embedding::Cylinder { radius }, 0.0)
        }),
        (0.3..1.2, 0.3..0.6, 1.0..6.0).prop_map(|(half_angle, inner, angle): (f64, f64, f64)| {
            let to_apex = (inner + inner + 0.6) / 2.0;
            let outline = Outline::sector(inner, inner + 0.6, angle * half_angle.sin());
            (outline, Embedding::Cone { half_angle, to_apex }, 1.0 / inner)
        }),
    ]
}

/// A slanted quadrilateral with a square hole.
fn holed(half: f64, x: f64) -> Outline {
    let rim = [[0.0, 0.0], [1.0, 0.0], [1.1, 0.8], [0.0, 0.7]].map(Point2::from);
    let corners =
        [[x - half, 0.2], [x + half, 0.2], [x + half, 0.2 + 2.0 * half], [x - half, 0.2 + 2.0 * half]];
    Outline::polygon(&rim, &[corners.map(Point2::from).to_vec()]).unwrap()
}

/// Eight electrodes round the rim, and one inside where there is room.
fn places(outline: &Outline, first: f64) -> Vec<Place> {
    let at = |i: usize| Place::Rim(outline.perimeter() * (first + i as f64 / 8.0));
    let inside = Some(outline.middle()).filter(|&middle| outline.depth(middle) > 0.1);
    (0..8).map(at).chain(inside.map(Place::Inside)).collect()
}

/// Nodes where they lie on the flat sheet.
fn flat(mesh: &Mesh, embedding: &Embedding) -> Vec<Point2<f64>> {
    mesh.nodes.iter().map(|&node| embedding.flatten(node)).collect()
}

fn lengths<T>(elements: &[[usize; 3]], distance: impl Fn(usize, usize) -> T) -> Vec<T> {
    elements.iter().flat_map(|&[a, b, c]| [distance(a, b), distance(b, c), distance(c, a)]).collect()
}

fn is_where_asked(mesh: &Mesh, sheet: &Sheet, model: &ElectrodeModel, electrode: usize, edge: f64) -> bool {
    let contact = &mesh.electrodes[electrode];
    let place = match sheet.places[electrode] {
        Place::Rim(s) => sheet.embedding.lay(sheet.outline.rim_point(s)),
        Place::Inside(point) => sheet.embedding.lay(point),
    };
    let wide = (mesh.width(contact) / model.width(electrode) - 1.0).abs() < 0.1;
    // The mean of nodes is off the middle where edges differ, and off the rim where it bends.
    let close = (mesh.centre(contact) - place).norm();
    match (contact, sheet.places[electrode]) {
        (ElectrodeContact::Node(_), Place::Inside(_)) => close < 1e-12,
        (ElectrodeContact::Node(_), Place::Rim(_)) => close < edge * 1e-6,
        (ElectrodeContact::Edges(_), Place::Rim(_)) => wide && close < 0.3 * model.width(electrode),
        (ElectrodeContact::Faces(_), Place::Inside(_)) => wide && close < 0.15 * model.width(electrode),
        _ => false,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_shape_is_covered_once_by_triangles_of_the_wanted_size_with_its_electrodes(
        (outline, embedding, curvature) in shapes(),
        first in 0.0..1.0,
        cover in prop_oneof![Just(0.0), 0.2..0.6],
        fineness in 20.0..60.0,
        angle in 0.0..1.0,
        shift in 0.0..1.0,
    ) {
        let places = places(&outline, first);
        let model = if cover == 0.0 { ElectrodeModel::Point } else {
            let width = places.iter().map(|place| match place {
                Place::Rim(_) => cover * outline.perimeter() / 8.0,
                Place::Inside(_) => 0.1,
            });
            ElectrodeModel::Complete { width: width.collect(), contact_impedance: vec![0.1; places.len()] }
        };
        let sheet = Sheet { outline, embedding, places };
        let edges = EdgeLengths { skin: 1.0 / fineness, electrodes: 1.0 / fineness };
        let lattice = Lattice { angle, shift };
        let mesh = generate(&sheet, &model, edges, lattice).unwrap();
        prop_assert_eq!(&generate(&sheet, &model, edges, lattice).unwrap(), &mesh, "the same twice");

        // Turned the same way round, and with no edge in more than two, triangles overlap only if
        // their areas are more than the sheet's.
        let found = require_sound(&mesh.nodes, &mesh.elements, false);
        prop_assert!(found.is_ok(), "{:?}", found.unwrap_err());
        let nodes = flat(&mesh, &sheet.embedding);
        let area = |&[a, b, c]: &[usize; 3]| (nodes[b] - nodes[a]).perp(&(nodes[c] - nodes[a])) / 2.0;
        prop_assert!(mesh.elements.iter().all(|element| area(element) > 0.0), "all counter-clockwise");
        let covered: f64 = mesh.elements.iter().map(area).sum();
        let longest = lengths(&mesh.elements, |a, b| (nodes[a] - nodes[b]).norm()).into_iter().fold(0.0, f64::max);
        // Between an arc and its chord of length l lies an area of l^3 / 12 over the radius.
        let chords = sheet.outline.perimeter() * longest.powi(2) * curvature / 12.0;
        prop_assert!((covered - sheet.outline.area()).abs() <= chords + 1e-9, "{covered} {chords}");

        let mut all = lengths(&mesh.elements, |a, b| (mesh.nodes[a] - mesh.nodes[b]).norm());
        all.sort_by(f64::total_cmp);
        let median = all[all.len() / 2] * fineness;
        // Narrow patches of cones have shorter ones.
        prop_assert!((0.5..1.1).contains(&median), "{median}");

        prop_assert_eq!(mesh.electrodes.len(), sheet.places.len());
        for electrode in 0..sheet.places.len() {
            prop_assert!(is_where_asked(&mesh, &sheet, &model, electrode, 1.0 / fineness), "electrode {electrode}");
        }
    }
}

/// At an edge of a twentieth of the diameter lattice lines lay on the borders of the squares that are
/// filled one by one, and points there came twice.
#[test]
fn lattice_points_on_the_borders_of_squares_come_once() {
    for edge in [0.1, 0.05, 0.025, 0.02, 0.0125] {
        let outline = Outline::disc(0.5);
        let places = (0..8).map(|i| Place::Rim(f64::from(i) * outline.perimeter() / 8.0)).collect();
        let sheet = Sheet { outline, embedding: Embedding::Hemisphere { radius: 0.5 }, places };
        let edges = EdgeLengths { skin: edge, electrodes: edge };
        let mesh = generate(&sheet, &ElectrodeModel::Point, edges, Lattice::default());
        assert!(mesh.is_ok(), "{edge}: {:?}", mesh.err());
    }
}

/// It took minutes, and with 5,000 corners nobody waited for the end.
#[test]
fn a_star_of_thousands_of_spikes_is_refused_at_once_and_one_of_a_hundred_is_meshed() {
    let star = |corners: usize| {
        let corner = |i: usize| {
            let (angle, radius) =
                (TAU * i as f64 / corners as f64, if i.is_multiple_of(2) { 0.45 } else { 0.5 });
            Point2::new(radius * angle.cos(), radius * angle.sin())
        };
        let outline = Outline::polygon(&(0..corners).map(corner).collect::<Vec<_>>(), &[]).unwrap();
        let places = (0..8).map(|i| Place::Rim(f64::from(i) * outline.perimeter() / 8.0)).collect();
        let sheet = Sheet { outline, embedding: Embedding::Flat, places };
        let edges = EdgeLengths { skin: 0.08, electrodes: 0.08 };
        generate(&sheet, &ElectrodeModel::Point, edges, Lattice::default())
    };
    assert!(star(200).is_ok());
    assert_eq!(star(5000).map(drop), Err(MeshError::TooNarrow));
}

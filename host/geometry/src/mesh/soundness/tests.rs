use super::*;
use proptest::prelude::*;

type Sheet = (Vec<Point3<f64>>, Vec<[usize; 3]>);

/// A square of `cells` by `cells` cells of two triangles each, without the cells that `omit` names.
fn square(cells: usize, omit: impl Fn(usize, usize) -> bool) -> Sheet {
    let side = cells + 1;
    let nodes = (0..side * side).map(|n| Point3::new((n % side) as f64, (n / side) as f64, 0.0)).collect();
    let mut elements = Vec::new();
    for (x, y) in (0..cells * cells).map(|cell| (cell % cells, cell / cells)).filter(|&(x, y)| !omit(x, y)) {
        let corner = y * side + x;
        elements.push([corner, corner + 1, corner + side + 1]);
        elements.push([corner, corner + side + 1, corner + side]);
    }
    (nodes, elements)
}

fn whole(_: usize, _: usize) -> bool {
    false
}

fn tetrahedron() -> Sheet {
    let nodes = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Point3::from);
    (nodes.to_vec(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
}

fn refused((nodes, elements): &Sheet) -> (MeshFault, String) {
    let fault = require_sound(nodes, elements, false).expect_err("must be refused");
    let message = fault.to_string();
    (fault, message)
}

#[test]
fn a_plain_sheet_is_sound_and_its_rim_is_one_ordered_loop() {
    let (nodes, elements) = square(2, whole);
    let found = require_sound(&nodes, &elements, false).unwrap();
    assert_eq!(found.boundary_loops, [[0, 1, 2, 5, 8, 7, 6, 3]]);
    assert_eq!(found.boundaries, [Boundary { edges: 8, length: 8.0 }]);
    assert_eq!(found.parts, [Part { elements: 8, first: 0 }]);
    assert!(found.holes().is_empty() && found.flipped == 0 && !found.one_sided);
}

#[test]
fn a_closed_surface_has_no_rim_and_is_sound() {
    let (nodes, elements) = tetrahedron();
    let found = require_sound(&nodes, &elements, false).unwrap();
    assert!(found.boundaries.is_empty() && found.flipped == 0 && !found.one_sided);
}

#[test]
fn large_holes_are_reported_and_the_longest_loop_comes_first() {
    // The hole's nodes have lower numbers than the rim's last ones; length decides.
    let (nodes, elements) = square(9, |x, y| (2..5).contains(&x) && (1..3).contains(&y));
    let (nodes, elements) = without_loose(&nodes, elements);
    let found = require_sound(&nodes, &elements, false).unwrap();
    assert_eq!(found.boundaries[0], Boundary { edges: 36, length: 36.0 });
    assert_eq!(found.holes(), [Boundary { edges: 10, length: 10.0 }]);
    assert_eq!(found.boundary_loops[0].len(), 36);
}

fn without_loose(nodes: &[Point3<f64>], mut elements: Vec<[usize; 3]>) -> Sheet {
    let mut numbers = vec![usize::MAX; nodes.len()];
    let mut kept = Vec::new();
    for node in elements.iter_mut().flatten() {
        if numbers[*node] == usize::MAX {
            numbers[*node] = kept.len();
            kept.push(nodes[*node]);
        }
        *node = numbers[*node];
    }
    (kept, elements)
}

#[test]
fn notes_name_holes_flipped_triangles_seams_and_the_lack_of_a_rim() {
    let (nodes, mut elements) = square(5, |x, y| x == 2 && y == 2);
    elements[7].swap(0, 1);
    assert_eq!(
        inspect(&nodes, &elements).notes(),
        [
            "a hole of 4 edges, 4 m around",
            "number of triangles flipped against the others: 1; it does not matter"
        ]
    );
    let (nodes, elements) = tetrahedron();
    assert_eq!(inspect(&nodes, &elements).notes(), ["the surface is closed: it has no rim"]);
    let (nodes, elements) = square(2, whole);
    assert!(inspect(&nodes, &elements).notes().is_empty());
}

#[test]
fn a_missing_triangle_is_a_crack_unless_cracks_are_allowed() {
    let (nodes, mut elements) = square(60, whole);
    elements.remove(3060);
    let (fault, message) = refused(&(nodes.clone(), elements.clone()));
    assert!(matches!(fault, MeshFault::Crack { edges: 3, others: 0, .. }), "{fault:?}");
    assert_eq!(
        message,
        "a crack: the hole of 3 edges at node 1555, (30, 25, 0), is only 3.41421 around; there is no other"
    );
    assert_eq!(require_sound(&nodes, &elements, true).unwrap().cracks, [1]);
}

#[test]
fn a_missing_triangle_of_a_closed_surface_is_a_crack_too() {
    // A box of 110 by 110 cells on each of six sides, welded of six squares.
    let (side, triangles) = square(110, whole);
    let on_face = |face: usize, p: &Point3<f64>| {
        let across = (face % 2 * 110) as f64;
        [Point3::new(p.x, p.y, across), Point3::new(p.x, across, p.y), Point3::new(across, p.x, p.y)]
            [face / 2]
    };
    let corners: Vec<_> = (0..6).flat_map(|face| side.iter().map(move |p| on_face(face, p))).collect();
    let welded = weld::weld(&corners, 1e-6);
    let elements: Vec<_> = (0..6)
        .flat_map(|face| triangles.iter().map(move |corners| corners.map(|node| node + face * 111 * 111)))
        .map(|corners| corners.map(|node| welded.numbers[node]))
        .collect();
    assert!(require_sound(&welded.points, &elements, false).unwrap().boundaries.is_empty());
    let (fault, _) = refused(&(welded.points.clone(), elements[1..].to_vec()));
    assert!(matches!(fault, MeshFault::Crack { edges: 3, .. }), "{fault:?}");
}

#[test]
fn a_seam_that_is_not_welded_is_refused_unless_cracks_are_allowed() {
    // The middle node has a copy for the triangles to its right.
    let (mut nodes, mut elements) = square(4, whole);
    nodes.push(nodes[12]);
    for corners in elements.iter_mut().filter(|corners| corners.iter().any(|&node| node % 5 > 2)) {
        corners.iter_mut().filter(|node| **node == 12).for_each(|node| *node = 25);
    }
    let (fault, message) = refused(&(nodes.clone(), elements.clone()));
    assert_eq!(fault, MeshFault::Seam { nodes: [12, 25], at: nodes[12], others: 0 });
    assert_eq!(
        message,
        "an open seam: nodes 12 and 25 of the boundary both lie at (2, 2, 0); welding joins them; there is no other"
    );
    let allowed = require_sound(&nodes, &elements, true).unwrap();
    assert_eq!(allowed.holes(), [Boundary { edges: 4, length: 4.0 }]);
    assert_eq!(allowed.notes()[1], "number of places with two nodes of the rim, open seams: 1");
}

#[test]
fn a_single_missing_triangle_is_a_crack_in_a_coarse_mesh_too_but_a_larger_hole_is_none() {
    let (nodes, mut elements) = square(5, whole);
    elements.remove(24);
    assert!(matches!(refused(&(nodes.clone(), elements.clone())).0, MeshFault::Crack { edges: 3, .. }));
    elements.remove(24);
    assert_eq!(require_sound(&nodes, &elements, false).unwrap().holes().len(), 1);
    let (nodes, elements) = tetrahedron();
    assert_eq!(require_sound(&nodes, &elements[1..], false).unwrap().boundaries.len(), 1);
}

#[test]
fn a_degenerate_triangle_is_named_with_its_corners() {
    let (mut nodes, mut elements) = square(2, whole);
    elements[5] = [4, 5, 5];
    let (fault, message) = refused(&(nodes.clone(), elements.clone()));
    assert!(
        matches!(fault, MeshFault::Degenerate { triangle: Triangle { number: 5, .. }, others: 0 }),
        "{fault:?}"
    );
    assert_eq!(
        message,
        "triangle 5 (counted from 0) with the corners (1, 1, 0), (2, 1, 0) and (2, 1, 0) is degenerate: it has no \
         area, or an angle below 0.01 degrees; there is no other"
    );
    // Two needles: node 4 moves almost onto the diagonal's other triangle.
    (nodes, elements) = square(2, whole);
    nodes[1] = Point3::new(0.5, 0.5 + 1e-5, 0.0);
    assert_eq!(inspect(&nodes, &elements).degenerate, [0]);
    nodes[1] = Point3::new(0.5, 0.5 - 1e-3, 0.0);
    assert!(inspect(&nodes, &elements).degenerate.is_empty());
}

#[test]
fn a_duplicate_triangle_is_named_in_whatever_order_its_corners_come() {
    let (nodes, mut elements) = square(2, whole);
    let [a, b, c] = elements[2];
    elements.push([c, a, b]);
    elements.push([b, a, c]);
    let (fault, message) = refused(&(nodes, elements));
    assert!(matches!(fault, MeshFault::Duplicate { first: 2, others: 1, .. }), "{fault:?}");
    assert!(
        message.contains("triangle 8 (counted from 0)") && message.contains("same corners as triangle 2"),
        "{message}"
    );
}

#[test]
fn a_fin_on_the_sheet_makes_an_edge_of_three_triangles() {
    let (mut nodes, mut elements) = square(2, whole);
    nodes.push(Point3::new(1.0, 0.5, 1.0));
    elements.push([1, 4, 9]);
    let (fault, message) = refused(&(nodes, elements));
    assert!(matches!(fault, MeshFault::NonManifold { nodes: [1, 4], count: 3, others: 0, .. }), "{fault:?}");
    assert!(
        message.starts_with(
            "3 triangles share the edge between nodes 1 and 4, at most 2 may; one is triangle 8"
        )
    );
}

#[test]
fn separate_parts_are_counted_and_the_smaller_is_named() {
    let (mut nodes, mut elements) = square(2, whole);
    let other = square(1, whole);
    elements.extend(other.1.iter().map(|corners| corners.map(|node| node + 9)));
    nodes.extend(other.0.iter().map(|node| node + nalgebra::Vector3::new(5.0, 0.0, 0.0)));
    let (fault, _) = refused(&(nodes.clone(), elements.clone()));
    assert!(matches!(fault, MeshFault::Disconnected { parts: 2, largest: 8, next: 2, .. }), "{fault:?}");
    assert_eq!(
        inspect(&nodes, &elements).parts,
        [Part { elements: 8, first: 0 }, Part { elements: 2, first: 8 }]
    );
}

#[test]
fn two_fans_that_meet_in_one_node_are_a_bow_tie() {
    let (nodes, elements) = square(2, |x, y| x != y);
    let (nodes, elements) = without_loose(&nodes, elements);
    let (fault, message) = refused(&(nodes.clone(), elements.clone()));
    assert!(matches!(fault, MeshFault::BowTie { node: 2, others: 0, .. }), "{fault:?}");
    assert!(message.starts_with("the triangles at node 2, (1, 1, 0), meet only in that node"), "{message}");
    // Each fan has a rim of its own.
    assert_eq!(inspect(&nodes, &elements).boundary_loops.len(), 2);
}

#[test]
fn nodes_that_are_not_numbers_not_there_or_not_used_are_refused() {
    let (mut nodes, mut elements) = square(2, whole);
    nodes.push(Point3::new(7.0, 8.0, 9.0));
    assert_eq!(
        refused(&(nodes.clone(), elements.clone())).1,
        "node 9 at (7, 8, 9) is the corner of no triangle; there is no other"
    );
    nodes[4].y = f64::NAN;
    assert_eq!(
        refused(&(nodes.clone(), elements.clone())).1,
        "node 4 lies at (1, NaN, 0); all coordinates must be finite"
    );
    nodes[4].y = 1e200;
    assert!(matches!(refused(&(nodes.clone(), elements.clone())).0, MeshFault::NotFinite { node: 4, .. }));
    elements[3][1] = 10;
    assert_eq!(
        refused(&(nodes.clone(), elements)).1,
        "triangle 3 names node 10; the mesh has 10 nodes, counted from 0"
    );
    assert_eq!(refused(&(nodes, Vec::new())).0, MeshFault::Empty);
}

#[test]
fn a_moebius_strip_is_one_sided_and_sound() {
    let around = 12;
    let node = |i: usize| {
        let (turn, half) = ((i / 2 % around) as f64 / around as f64 * std::f64::consts::TAU, i % 2);
        let across = if half == 0 { -0.3 } else { 0.3 };
        let out = 1.0 + across * (turn / 2.0).cos();
        Point3::new(out * turn.cos(), out * turn.sin(), across * (turn / 2.0).sin())
    };
    let nodes: Vec<_> = (0..2 * around).map(node).collect();
    // After one turn the two sides are exchanged.
    let number = |i: usize, half: usize| if i < around { 2 * i + half } else { 1 - half };
    let elements: Vec<_> = (0..around)
        .flat_map(|i| {
            let [a, b, c, d] = [number(i, 0), number(i, 1), number(i + 1, 0), number(i + 1, 1)];
            [[a, c, b], [b, c, d]]
        })
        .collect();
    let found = require_sound(&nodes, &elements, false).unwrap();
    assert!(found.one_sided);
    assert_eq!(found.notes(), ["the surface has only one side, like a Moebius strip"]);
    assert_eq!(found.boundaries.len(), 1);
    assert_eq!(found.boundaries[0].edges, 2 * around);
}

#[test]
fn hundred_thousand_triangles_around_one_edge_take_no_quadratic_time() {
    let count = 100_000;
    let mut nodes = vec![Point3::origin(), Point3::new(0.0, 0.0, 1.0)];
    nodes.extend((0..count).map(|i| {
        let turn = f64::from(i) / f64::from(count);
        Point3::new(turn.cos(), turn.sin(), 0.5)
    }));
    let elements: Vec<_> = (2..nodes.len()).map(|node| [0, 1, node]).collect();
    let found = inspect(&nodes, &elements);
    assert_eq!(found.non_manifold.len(), 1);
    assert_eq!(found.boundary_loops.iter().map(Vec::len).sum::<usize>(), 2 * elements.len());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn turning_triangles_over_changes_nothing_but_their_count(
        over in prop::collection::vec(any::<bool>(), 50),
        hole in any::<bool>(),
    ) {
        let omit = |x, y| hole && x == 2 && y == 2;
        let (nodes, elements) = square(5, omit);
        let mut turned = elements.clone();
        for (corners, _) in turned.iter_mut().zip(&over).filter(|(_, over)| **over) {
            corners.swap(0, 2);
        }
        let (before, after) = (inspect(&nodes, &elements), inspect(&nodes, &turned));
        let count = over[..elements.len()].iter().filter(|&&over| over).count();
        prop_assert_eq!(after.flipped, count.min(elements.len() - count));
        prop_assert_eq!(before, Soundness { flipped: 0, ..after });
    }

    #[test]
    fn numbering_changes_nothing_but_the_numbers(
        (nodes, elements) in (Just((0..36).collect::<Vec<usize>>()).prop_shuffle(), Just((0..50).collect::<Vec<usize>>()).prop_shuffle()),
    ) {
        let (plain_nodes, plain_elements) = square(5, whole);
        let plain = inspect(&plain_nodes, &plain_elements);
        let mut moved_nodes = plain_nodes.clone();
        nodes.iter().zip(&plain_nodes).for_each(|(&to, &node)| moved_nodes[to] = node);
        let moved_elements: Vec<_> = elements.iter().map(|&e| plain_elements[e].map(|node| nodes[node])).collect();
        let moved = require_sound(&moved_nodes, &moved_elements, false).unwrap();
        prop_assert_eq!(&moved.boundaries, &plain.boundaries);
        let on_rim: std::collections::BTreeSet<_> = plain.boundary_loops[0].iter().map(|&node| nodes[node]).collect();
        prop_assert_eq!(moved.boundary_loops[0].iter().copied().collect::<std::collections::BTreeSet<_>>(), on_rim);
        // In order around the rim: all edges have length 1.
        let around = &moved.boundary_loops[0];
        for place in 0..around.len() {
            let (a, b) = (moved_nodes[around[place]], moved_nodes[around[(place + 1) % around.len()]]);
            prop_assert!(((a - b).norm() - 1.0).abs() < 1e-12);
        }
    }
}

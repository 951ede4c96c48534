//! Electrode movement: how measurements respond when an electrode slides along the rim or, from inside, over the skin,
//! and the covariance that this adds to the data space (Soleimani, Gomez-Laberge and Adler 2006; EIDORS
//! `jacobian_movement` and `prior_movement`).
//!
//! Movements m join the image as further unknowns with the prior mu^2 R_m, and are then dropped from
//! it. In data space that is one more term, J G J' + J_m (mu^2 R_m)^-1 J_m': measurements that
//! change as if an electrode had moved count less.

use super::Whitening;
use crate::{
    forward::{Admittivity, Fields},
    pixels::tangents,
};
use dermatome_geometry::mesh::{
    ElectrodeContact, Mesh,
    neighbours::{boundary_edges, orientation},
};
use dermatome_shared::stimulation::Step;
use faer::{
    Mat, Side,
    linalg::solvers::{Llt, SolveCore},
};
use nalgebra::{Matrix3, Point3, Vector3};
use std::collections::{HashMap, HashSet};

/// How measurements respond to the movement of electrodes.
#[derive(Clone, Debug)]
pub struct Movement {
    /// d voltage / d movement in units of half the skin's larger side: `[measurement][move]`, as [`moves`].
    pub responses: Mat<f64>,
    /// Whether all electrodes are on the rim, and move once each.
    pub is_on_rim: bool,
}

/// d voltage / d movement, per metre: `[step][move]`, as [`moves`].
///
/// The electrode's nodes move together in a straight line while all others stay, so only the elements
/// that touch it change (Gomez-Laberge and Adler 2008).
#[must_use]
pub fn jacobian<T: Admittivity>(mesh: &Mesh, admittivity: T, fields: &Fields<T>, steps: &[Step]) -> Mat<T> {
    let columns: Vec<Vec<T>> =
        moves(mesh).iter().map(|moved| column(mesh, admittivity, fields, steps, moved)).collect();
    Mat::from_fn(steps.len(), columns.len(), |step, moved| columns[moved][step])
}

/// Nodes of an electrode, and a unit direction in which it moves.
#[derive(Clone, Debug)]
pub struct Move {
    /// Nodes that move together.
    pub nodes: Vec<usize>,
    /// Unit vector in the skin.
    pub direction: Vector3<f64>,
}

/// Whether all electrodes lie on the rim.
#[must_use]
pub fn are_on_rim(mesh: &Mesh) -> bool {
    let rim: HashSet<usize> = boundary_edges(&mesh.elements).into_iter().flatten().collect();
    mesh.electrodes.iter().flat_map(ElectrodeContact::nodes).all(|node| rim.contains(&node))
}

/// How electrodes move, in their order: one on the rim along it, all the same way round; one inside in two directions
/// that are square to each other.
#[must_use]
pub fn moves(mesh: &Mesh) -> Vec<Move> {
    let signs = orientation(&mesh.elements);
    let rim = rim_directions(mesh, &signs);
    let of = |contact: &ElectrodeContact| {
        let mut nodes: Vec<usize> = contact.nodes().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let along: Vector3<f64> = nodes.iter().filter_map(|node| rim.get(node)).sum();
        let on_rim = nodes.iter().all(|node| rim.contains_key(node));
        let directions = match along.try_normalize(0.0).filter(|_| on_rim) {
            Some(direction) => vec![direction],
            None => tangents(&normal(mesh, &signs, &nodes)).to_vec(),
        };
        directions.into_iter().map(move |direction| Move { nodes: nodes.clone(), direction })
    };
    mesh.electrodes.iter().flat_map(of).collect()
}

/// Normal of the skin round these nodes.
fn normal(mesh: &Mesh, signs: &[f64], nodes: &[usize]) -> Vector3<f64> {
    let touches = |element: &[usize; 3]| element.iter().any(|node| nodes.contains(node));
    let area = |(element, sign): (&[usize; 3], &f64)| {
        let [a, b, c] = mesh.points(*element);
        (b - a).cross(&(c - a)) * *sign
    };
    let areas = mesh.elements.iter().zip(signs).filter(|(element, _)| touches(element)).map(area);
    areas.sum::<Vector3<f64>>().normalize()
}

/// Sum of the rim edges at each node of the rim, all passed the same way round.
fn rim_directions(mesh: &Mesh, signs: &[f64]) -> HashMap<usize, Vector3<f64>> {
    let mut edges: HashMap<[usize; 2], (usize, [usize; 2])> = HashMap::new();
    for (&[a, b, c], sign) in mesh.elements.iter().zip(signs) {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let passed = if *sign > 0.0 { [from, to] } else { [to, from] };
            edges.entry([from.min(to), from.max(to)]).or_insert((0, passed)).0 += 1;
        }
    }
    let mut directions = HashMap::new();
    for (_, [from, to]) in edges.into_values().filter(|(uses, _)| *uses == 1) {
        let edge = mesh.nodes[to] - mesh.nodes[from];
        for node in [from, to] {
            *directions.entry(node).or_insert_with(Vector3::zeros) += edge;
        }
    }
    directions
}

fn column<T: Admittivity>(
    mesh: &Mesh,
    admittivity: T,
    fields: &Fields<T>,
    steps: &[Step],
    moved: &Move,
) -> Vec<T> {
    let electrodes = fields.electrodes();
    let mut gram = vec![T::default(); electrodes * electrodes];
    let touched = |(_, element): &(usize, &[usize; 3])| element.iter().any(|node| moved.nodes.contains(node));
    for (number, element) in mesh.elements.iter().enumerate().filter(touched) {
        let shifts =
            element.map(|node| if moved.nodes.contains(&node) { moved.direction } else { Vector3::zeros() });
        let change = admittance_change(mesh.points(*element), shifts, fields.sheet().tensor(number));
        add_products(&mut gram, element.map(|node| fields.at(node)), &change);
    }
    let at = |a: usize, b: usize| admittivity * gram[a * electrodes + b];
    let entry = |step: &Step| {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        (at(sp, dm) - at(sp, dp)) - (at(sm, dm) - at(sm, dp))
    };
    steps.iter().map(entry).collect()
}

/// Adds u_a' `change` u_b for the fields of all pairs of electrodes: `[electrode][electrode]`.
fn add_products<T: Admittivity>(gram: &mut [T], corners: [&[T]; 3], change: &[[f64; 3]; 3]) {
    let electrodes = corners[0].len();
    for (a, row) in gram.chunks_exact_mut(electrodes).enumerate() {
        let left: [T; 3] = std::array::from_fn(|j| (0..3).map(|i| corners[i][a] * change[i][j]).sum());
        for (b, sum) in row.iter_mut().enumerate() {
            *sum = *sum + (0..3).map(|j| left[j] * corners[j][b]).sum();
        }
    }
}

/// Change of an element's local admittance when its corners shift.
///
/// With e_i the edge opposite corner i, A the area, and C the sheet's tensor turned by a right angle in the plane,
/// K_ij = e_i . C e_j / (4 A).
fn admittance_change(
    corners: [Point3<f64>; 3],
    shifts: [Vector3<f64>; 3],
    sheet: Option<Matrix3<f64>>,
) -> [[f64; 3]; 3] {
    let edge = |i: usize| corners[(i + 2) % 3] - corners[(i + 1) % 3];
    let shift = |i: usize| shifts[(i + 2) % 3] - shifts[(i + 1) % 3];
    let doubled = edge(1).cross(&edge(2));
    let doubled_shift = shift(1).cross(&edge(2)) + edge(1).cross(&shift(2));
    let double_area = doubled.norm();
    let growth = doubled.dot(&doubled_shift) / double_area.powi(2);
    let turn = (doubled / double_area).cross_matrix();
    let turned = sheet.map_or(Matrix3::identity(), |tensor| turn.transpose() * tensor * turn);
    let entry = |i: usize, j: usize| {
        let product = |a: Vector3<f64>, b: Vector3<f64>| a.dot(&(turned * b));
        let products =
            product(shift(i), edge(j)) + product(edge(i), shift(j)) - product(edge(i), edge(j)) * growth;
        products / (2.0 * double_area)
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

/// What unknown movement adds to the data space: J_m (mu^2 R_m)^-1 J_m', `[measurement][measurement]`.
///
/// `weight` is mu. R_m is 2.1 on the diagonal and, if all electrodes are on the rim, -1 between those that follow each
/// other: shifts of the whole rim are nearly free (EIDORS `prior_movement`).
#[must_use]
pub fn covariance(movement: &Movement, weight: f64, whitening: &Whitening) -> Mat<f64> {
    let whitened = whitening.transposed(&movement.responses);
    let mut solution = whitened.clone();
    let factor = Llt::new(prior(whitened.nrows(), weight, movement.is_on_rim).as_ref(), Side::Lower);
    factor
        .expect("2.1 exceeds the sum of its neighbours")
        .solve_in_place_with_conj(faer::Conj::No, solution.as_mut());
    whitened.transpose() * solution
}

/// mu^2 R_m: `[move][move]`.
#[must_use]
pub fn prior(moves: usize, weight: f64, is_on_rim: bool) -> Mat<f64> {
    let mut prior = Mat::zeros(moves, moves);
    for moved in 0..moves {
        prior[(moved, moved)] += 2.1 * weight * weight;
        if is_on_rim {
            let next = (moved + 1) % moves;
            prior[(moved, next)] -= weight * weight;
            prior[(next, moved)] -= weight * weight;
        }
    }
    prior
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        forward::{ForwardModel, SheetTensors},
        inverse::targets::half_side,
        model::{forward_model, mesh},
        skin::Skin,
    };
    use dermatome_geometry::mesh::Lattice;
    use num_complex::Complex64;
    use std::path::Path;

    fn skin(model: &str) -> Skin {
        let text = include_str!("../../../../models/disc-210mm/skin.toml");
        let text = match model {
            "point" => text
                .replace("model = \"complete\"", "model = \"point\"")
                .replace("width = \"11 mm\"", "")
                .replace("contact_impedance = \"0.18 ohm m\"", ""),
            "grain" => text.replace(
                "\"5.88 mS\"",
                "\"5.88 mS\"\nsheet_conductivity_across = \"2 mS\"\ngrain = \"25 deg\"\nconductivity_map = [[0, 0, 1], [0.1, 0, 2]]",
            ),
            _ => text.to_owned(),
        };
        let mut skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
        skin.edges = skin.edges.scaled(2.5);
        skin
    }

    fn shifted(mesh: &Mesh, moved: &Move, distance: f64) -> Mesh {
        let mut mesh = mesh.clone();
        moved.nodes.iter().for_each(|&node| mesh.nodes[node] += moved.direction * distance);
        mesh
    }

    #[test]
    fn movement_jacobian_agrees_with_differences_on_shifted_nodes() {
        for model in ["complete", "point", "grain"] {
            let skin = skin(model);
            let mesh = mesh(&skin, 1.0, Lattice::default()).unwrap();
            // A map stays with its elements, however their nodes are shifted.
            let sheet = SheetTensors::new(&skin.material, &mesh);
            let impedance = vec![0.18 * skin.material.sheet_conductivity; 16];
            let voltages = |mesh: &Mesh| {
                let forward: ForwardModel = ForwardModel::on_sheet(mesh, &impedance, sheet.clone()).unwrap();
                forward.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&skin.steps())
            };
            let forward: ForwardModel = forward_model(&skin, &mesh).unwrap();
            let fields = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
            let jacobian = jacobian(&mesh, 1.0, &fields, &skin.steps());
            let step = 1e-5 * half_side(&mesh);
            for (electrode, moved) in moves(&mesh).iter().enumerate().step_by(5) {
                let (ahead, behind) =
                    (voltages(&shifted(&mesh, moved, step)), voltages(&shifted(&mesh, moved, -step)));
                let largest = jacobian.col(electrode).norm_max();
                for (i, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                    let difference = (a - b) / (2.0 * step);
                    assert!(
                        (jacobian[(i, electrode)] - difference).abs() < 1e-6 * largest,
                        "{model} {electrode} {i}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_sheet_with_capacitance_moves_its_complex_voltages() {
        let skin = skin("complete");
        let mesh = mesh(&skin, 1.0, Lattice::default()).unwrap();
        let admittivity = Complex64::new(1.0, 0.4);
        let solved = |mesh: &Mesh| {
            let forward: ForwardModel<Complex64> = forward_model(&skin, mesh).unwrap();
            forward.solve(&vec![admittivity; mesh.elements.len()]).unwrap()
        };
        let jacobian = jacobian(&mesh, admittivity, &solved(&mesh), &skin.steps());
        let moved = &moves(&mesh)[3];
        let step = 1e-5 * half_side(&mesh);
        let [ahead, behind] =
            [step, -step].map(|step| solved(&shifted(&mesh, moved, step)).voltages(&skin.steps()));
        let largest = jacobian.col(3).iter().map(|value| value.norm()).fold(0.0, f64::max);
        for (i, (a, b)) in ahead.iter().zip(&behind).enumerate() {
            assert!((jacobian[(i, 3)] - (a - b) / (2.0 * step)).norm() < 1e-6 * largest);
        }
    }

    /// An electrode placed a little further along the rim, on a mesh of its own. Both meshes err, and
    /// the nodes move along the chord, so this only shows that direction and scale are right.
    #[test]
    fn moving_nodes_stands_for_placing_the_electrode_elsewhere() {
        let mut skin = skin("complete");
        skin.edges = skin.edges.scaled(0.3);
        let answer = |skin: &Skin| {
            let mesh = mesh(skin, 1.0, Lattice::default()).unwrap();
            let forward: ForwardModel = forward_model(skin, &mesh).unwrap();
            let fields = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
            (jacobian(&mesh, 1.0, &fields, &skin.steps()), fields.voltages(&skin.steps()))
        };
        let (jacobian, _) = answer(&skin);
        let shift = 2e-3;
        let placed = |by: f64| {
            let mut skin = skin.clone();
            let crate::skin::Shape::Sheet(sheet) = &mut skin.shape else { panic!("a sheet") };
            let dermatome_geometry::sheet::Place::Rim(s) = &mut sheet.places[4] else { panic!("on the rim") };
            *s += by;
            answer(&skin).1
        };
        let (ahead, behind) = (placed(shift), placed(-shift));
        let differences: Vec<f64> = ahead.iter().zip(&behind).map(|(a, b)| (a - b) / (2.0 * shift)).collect();
        let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>().sqrt();
        let error = norm(&mut differences.iter().enumerate().map(|(i, d)| d - jacobian[(i, 4)]));
        let relative = error / norm(&mut differences.iter().copied());
        println!("moved nodes against a moved electrode: {:.1} %", 100.0 * relative);
        assert!(relative < 0.1, "{relative}");
    }

    /// Responses of electrodes of the designed hemisphere, most of them inside, agree with differences too.
    #[test]
    fn an_electrode_inside_a_curved_skin_moves_two_ways_in_it() {
        let text = include_str!("../../../../models/hemisphere-210mm-designed/skin.toml");
        let mut skin = Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap();
        skin.edges = skin.edges.scaled(2.0);
        let mesh = mesh(&skin, 1.0, Lattice::default()).unwrap();
        let moves = moves(&mesh);
        assert_eq!(moves.len(), 3 + 2 * 13);
        assert!(!are_on_rim(&mesh));
        let solved = |mesh: &Mesh| {
            let forward: ForwardModel = forward_model(&skin, mesh).unwrap();
            forward.solve(&vec![1.0; mesh.elements.len()]).unwrap()
        };
        let jacobian = jacobian(&mesh, 1.0, &solved(&mesh), &skin.steps());
        let step = 1e-5 * half_side(&mesh);
        for ways in moves.windows(2).filter(|ways| ways[0].nodes == ways[1].nodes) {
            let middle: Vector3<f64> = ways[0].nodes.iter().map(|&node| mesh.nodes[node].coords).sum();
            // The centre of the ball is the origin, so a place is its normal.
            let upright =
                ways.iter().map(|way| way.direction.dot(&middle.normalize()).abs()).fold(0.0, f64::max);
            assert!(upright < 0.05 && ways[0].direction.dot(&ways[1].direction).abs() < 1e-9, "{upright}");
        }
        for (column, moved) in moves.iter().enumerate().step_by(6) {
            let [ahead, behind] =
                [step, -step].map(|step| solved(&shifted(&mesh, moved, step)).voltages(&skin.steps()));
            let largest = jacobian.col(column).norm_max();
            for (i, (a, b)) in ahead.iter().zip(&behind).enumerate() {
                assert!(
                    (jacobian[(i, column)] - (a - b) / (2.0 * step)).abs() < 1e-6 * largest,
                    "{column} {i}"
                );
            }
        }
    }
}

//! The forward model and its Jacobian for every kind of electrode, element and admittivity.

use dermatome::{
    forward::{Admittivity, Fields, ForwardModel, electrode_unknown},
    jacobian::jacobian,
    mesh::{ElectrodeContact, Lattice, Mesh},
    model, pixels,
    skin::Skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use faer::{Mat, linalg::solvers::Solve};
use nalgebra::Point3;
use num_complex::Complex64;
use std::path::Path;

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");

fn coarse_disc() -> Mesh {
    let skin = Skin::parse(Path::new("disc.toml"), DISC).unwrap().made().unwrap();
    model::mesh(&skin, 3.0, Lattice::default()).unwrap()
}

/// A disc whose electrodes 1 to 5 are points, 6 to 10 edges, 11 points inside, the rest as they were,
/// and the last one a patch of triangles in the middle.
fn every_electrode() -> Mesh {
    let mut mesh = coarse_disc();
    let rim_node = |contact: &ElectrodeContact| contact.nodes().next().unwrap();
    for electrode in 0..5 {
        mesh.electrodes[electrode] = ElectrodeContact::Node(rim_node(&mesh.electrodes[electrode]));
    }
    mesh.electrodes[10] = ElectrodeContact::Node(nearest(&mesh, Point3::new(0.04, 0.03, 0.0)));
    let middle = nearest(&mesh, Point3::new(-0.03, 0.0, 0.0));
    let faces = mesh.elements.iter().copied().filter(|element| element.contains(&middle)).collect();
    mesh.electrodes[15] = ElectrodeContact::Faces(faces);
    mesh
}

fn nearest(mesh: &Mesh, to: Point3<f64>) -> usize {
    let distance = |node: usize| (mesh.nodes[node] - to).norm();
    (0..mesh.nodes.len()).min_by(|&a, &b| distance(a).total_cmp(&distance(b))).unwrap()
}

/// The same mesh bent, so that no two elements lie in one plane.
fn bent(mut mesh: Mesh) -> Mesh {
    mesh.nodes.iter_mut().for_each(|node| node.z = 0.3 * node.x - 5.0 * node.y * node.y);
    mesh
}

/// Every other element turned round.
fn turned(mut mesh: Mesh) -> Mesh {
    mesh.elements.iter_mut().step_by(2).for_each(|element| element.swap(0, 2));
    mesh
}

/// Nodes numbered from the other end, so that another one is held at 0 V.
fn backwards(mut mesh: Mesh) -> Mesh {
    let last = mesh.nodes.len() - 1;
    mesh.nodes.reverse();
    mesh.elements.iter_mut().flatten().for_each(|node| *node = last - *node);
    for contact in &mut mesh.electrodes {
        match contact {
            ElectrodeContact::Node(node) => *node = last - *node,
            ElectrodeContact::Edges(edges) => {
                edges.iter_mut().flatten().for_each(|node| *node = last - *node);
            }
            ElectrodeContact::Faces(faces) => {
                faces.iter_mut().flatten().for_each(|node| *node = last - *node);
            }
        }
    }
    mesh
}

fn steps() -> Vec<Step> {
    pattern(16, 1, 1, Driven::Measured).collect()
}

fn forward<T: Admittivity>(mesh: &Mesh, impedance: impl Fn(usize) -> T) -> ForwardModel<T> {
    let impedance: Vec<T> = (0..mesh.electrodes.len()).map(impedance).collect();
    ForwardModel::new(mesh, &impedance).unwrap()
}

fn unequal(electrode: usize) -> f64 {
    1e-3 * (1.0 + electrode as f64)
}

fn unequal_complex(electrode: usize) -> Complex64 {
    Complex64::new(unequal(electrode), -4e-4 * electrode as f64)
}

fn real(mesh: &Mesh) -> Vec<f64> {
    (0..mesh.elements.len()).map(|e| 1.0 + 0.5 * (e as f64).sin()).collect()
}

fn complex(mesh: &Mesh) -> Vec<Complex64> {
    (0..mesh.elements.len())
        .map(|e| Complex64::new(1.0 + 0.5 * (e as f64).sin(), 0.7 * (e as f64).cos()))
        .collect()
}

/// Voltages by a dense solution of the complete system matrix, the ground's row replaced.
fn dense_voltages(mesh: &Mesh, model: &ForwardModel<Complex64>, admittivity: &[Complex64]) -> Vec<Complex64> {
    let unknowns = 1 + (0..16).map(|e| electrode_unknown(mesh, e)).max().unwrap().max(mesh.nodes.len() - 1);
    let mut matrix = Mat::<Complex64>::zeros(unknowns, unknowns);
    for (row, col, value) in model.system_matrix(admittivity).unwrap() {
        matrix[(row, col)] += value;
    }
    let ground = electrode_unknown(mesh, 3);
    (0..unknowns).for_each(|col| matrix[(ground, col)] = Complex64::ZERO);
    matrix[(ground, ground)] = Complex64::ONE;
    let electrode = |electrode: u8| electrode_unknown(mesh, electrode.into());
    let steps = steps();
    let currents = Mat::from_fn(unknowns, steps.len(), |row, column| {
        let step = &steps[column];
        let into = |driven: u8| if row == electrode(driven) && row != ground { 1.0 } else { 0.0 };
        Complex64::from(into(step.drive_plus) - into(step.drive_minus))
    });
    let potentials = matrix.partial_piv_lu().solve(&currents);
    let voltage = |(column, step): (usize, &Step)| {
        potentials[(electrode(step.sense_plus), column)] - potentials[(electrode(step.sense_minus), column)]
    };
    steps.iter().enumerate().map(voltage).collect()
}

fn largest<T: Admittivity + Into<Complex64>>(values: &[T]) -> f64 {
    values.iter().map(|&value| value.into().norm()).fold(0.0, f64::max)
}

#[test]
fn complex_voltages_agree_with_a_dense_solution() {
    let mesh = bent(every_electrode());
    let model = forward(&mesh, unequal_complex);
    let admittivity = complex(&mesh);
    let voltages = model.solve(&admittivity).unwrap().voltages(&steps());
    let expected = dense_voltages(&mesh, &model, &admittivity);
    let errors: Vec<_> = voltages.iter().zip(&expected).map(|(a, b)| *a - *b).collect();
    assert!(largest(&errors) < 1e-11 * largest(&expected), "{:e}", largest(&errors));
}

#[test]
fn a_complex_model_of_real_numbers_is_the_real_model() {
    let mesh = every_electrode();
    let exact = forward(&mesh, unequal).solve(&real(&mesh)).unwrap().voltages(&steps());
    let as_complex: Vec<_> = real(&mesh).into_iter().map(Complex64::from).collect();
    let voltages =
        forward(&mesh, |e| Complex64::from(unequal(e))).solve(&as_complex).unwrap().voltages(&steps());
    let errors: Vec<_> = voltages.iter().zip(&exact).map(|(a, b)| a - b).collect();
    assert!(largest(&errors) < 1e-12 * largest(&exact), "{:e}", largest(&errors));
}

#[test]
fn neither_orientation_nor_the_order_of_nodes_matters() {
    let mesh = bent(every_electrode());
    let voltages = |mesh: &Mesh| forward(mesh, unequal).solve(&real(mesh)).unwrap().voltages(&steps());
    let expected = voltages(&mesh);
    for changed in [turned(mesh.clone()), backwards(mesh.clone())] {
        let errors: Vec<_> = voltages(&changed).iter().zip(&expected).map(|(a, b)| a - b).collect();
        assert!(largest(&errors) < 1e-11 * largest(&expected), "{:e}", largest(&errors));
    }
}

#[test]
fn contact_impedance_of_a_driven_electrode_is_read_in_full() {
    // Between two driven electrodes lie both contacts; a contact of 1 m / width is so many relative ohms.
    let mesh = coarse_disc();
    let width = |e: usize| match &mesh.electrodes[e] {
        ElectrodeContact::Edges(edges) => {
            edges.iter().map(|&[a, b]| (mesh.nodes[a] - mesh.nodes[b]).norm()).sum::<f64>()
        }
        _ => unreachable!("the disc has edges"),
    };
    let two_terminal = |scale: f64| {
        let fields = forward(&mesh, |_| scale).solve(&vec![1.0; mesh.elements.len()]).unwrap();
        fields.voltage(Step { drive_plus: 1, drive_minus: 9, sense_plus: 1, sense_minus: 9 })
    };
    let (low, high) = (two_terminal(10.0), two_terminal(20.0));
    let expected = 10.0 / width(1) + 10.0 / width(9);
    assert!(((high - low) / expected - 1.0).abs() < 1e-3, "{} {expected}", high - low);
}

/// Central differences of every step's voltage by one element's admittivity.
fn slopes<T: Admittivity>(model: &ForwardModel<T>, admittivity: &[T], element: usize) -> Vec<T> {
    let at = |change: f64| {
        let mut changed = admittivity.to_vec();
        changed[element] = changed[element] + T::from(change);
        model.solve(&changed).unwrap().voltages(&steps())
    };
    at(1e-4).into_iter().zip(at(-1e-4)).map(|(up, down)| (up - down) * (1.0 / 2e-4)).collect()
}

fn assert_jacobian<T: Admittivity + Into<Complex64>>(
    what: &str,
    mesh: &Mesh,
    model: &ForwardModel<T>,
    admittivity: &[T],
) {
    let fields: Fields<T> = model.solve(admittivity).unwrap();
    let jacobian = jacobian(mesh, &fields, &steps(), &pixels::per_element(mesh));
    let under_electrode = mesh.electrodes[15].nodes().next().unwrap();
    let under = mesh.elements.iter().position(|element| element.contains(&under_electrode)).unwrap();
    for element in [7, mesh.elements.len() / 2, under] {
        let expected = slopes(model, admittivity, element);
        let errors: Vec<T> =
            expected.iter().enumerate().map(|(m, &slope)| jacobian[(m, element)] - slope).collect();
        let error = largest(&errors) / largest(&expected);
        println!("{what:<32} element {element:>4}: Jacobian against finite differences {error:.1e}");
        assert!(error < 1e-6, "{what}: element {element}: {error:e}");
    }
}

#[test]
fn jacobian_agrees_with_finite_differences_for_every_element_and_electrode() {
    let flat = every_electrode();
    for (place, mesh) in [("flat", flat.clone()), ("bent", bent(flat.clone())), ("turned", turned(flat))] {
        assert_jacobian(&format!("{place}, real"), &mesh, &forward(&mesh, unequal), &real(&mesh));
        let model = forward(&mesh, unequal_complex);
        assert_jacobian(&format!("{place}, complex"), &mesh, &model, &complex(&mesh));
    }
}

#[test]
fn a_skin_with_capacitance_measures_in_phase_voltages() {
    let skin = |extra: &str| {
        let text = DISC.replace("\n[electrodes]", &format!("{extra}\n[electrodes]"));
        let mut skin = Skin::parse(Path::new("disc.toml"), &text).unwrap().made().unwrap();
        skin.edges = skin.edges.scaled(2.0);
        skin
    };
    // omega C / G = 1: the voltage of the sheet falls to (1 - j) / 2, the contacts stay real.
    let capacitance = 5.88e-3 / (std::f64::consts::TAU * 50e3);
    let skin_with = skin(&format!("sheet_capacitance = {capacitance}"));
    assert!((skin_with.admittivity() - Complex64::new(1.0, 1.0)).norm() < 1e-12);
    let with = model::Model::build(&skin_with, |_| ()).unwrap();
    let without = model::Model::build(&skin(""), |_| ()).unwrap();
    for (a, b) in with.voltages.iter().zip(&without.voltages) {
        assert!((a / b - 0.5).abs() < 0.1, "{a} {b}");
    }
}

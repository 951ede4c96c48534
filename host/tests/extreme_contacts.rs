//! Contacts from perfect to open: voltages against their limits, and refusals of what cannot be right.

use dermatome::{
    forward::{Admittivity, ForwardError, ForwardModel},
    mesh::{ElectrodeContact, Lattice, Mesh},
    model::{self, Model},
    skin::Skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use num_complex::Complex64;
use std::path::Path;

const DISC: &str = include_str!("../../models/disc-210mm/skin.toml");

fn disc(contact_impedance: &str, ground: u8) -> Skin {
    let text = DISC
        .replace("\"0.18 ohm m\"", contact_impedance)
        .replace("ground = 1", &format!("ground = {ground}"));
    let mut skin = Skin::parse(Path::new("disc.toml"), &text).unwrap().made().unwrap();
    skin.edges = skin.edges.scaled(2.0);
    skin
}

fn mesh() -> Mesh {
    model::mesh(&disc("\"0.18 ohm m\"", 1), 1.0, Lattice::default()).unwrap()
}

fn steps() -> Vec<Step> {
    pattern(16, 1, 1, Driven::Measured).collect()
}

fn voltages<T: Admittivity>(mesh: &Mesh, impedance: &[T], admittivity: T) -> Vec<T> {
    let model = ForwardModel::new(mesh, impedance).unwrap();
    model.solve(&vec![admittivity; mesh.elements.len()]).unwrap().voltages(&steps())
}

/// Largest difference over the largest expected value.
fn largest_error<T: Admittivity>(values: &[T], expected: &[T]) -> f64 {
    let largest = expected.iter().map(|v| v.size()).fold(0.0, f64::max);
    values.iter().zip(expected).map(|(&a, &b)| (a - b).size()).fold(0.0, f64::max) / largest
}

#[test]
fn ever_better_contacts_converge_to_a_perfect_one() {
    let mesh = mesh();
    let with = |z: f64| voltages(&mesh, &[z; 16], 1.0);
    // To first order in the impedance, so that its square, 1e-8 of the electrode's width, is left.
    let limit: Vec<f64> = with(1e-6).iter().zip(with(2e-6)).map(|(one, two)| 2.0 * one - two).collect();
    for z in [1e-9, 1e-12, 1e-15, 6e-18, 1e-30, 1e-200, 1e-300] {
        let error = largest_error(&with(z), &limit);
        println!("contacts of {z:.0e} m: {error:.1e} off the limit");
        assert!(error < 1e-6, "{z:e}: {error:e}");
        if z < 1e-100 {
            continue;
        }
        let complex = voltages(&mesh, &[Complex64::new(z, -z); 16], Complex64::new(1.0, 0.5));
        let limit: Vec<_> = limit.iter().map(|v| *v / Complex64::new(1.0, 0.5)).collect();
        assert!(largest_error(&complex, &limit) < 1e-6, "complex {z:e}");
    }
}

/// A point electrode has no metal, so that one without current is no electrode.
#[test]
fn an_open_electrode_leaves_the_other_voltages_as_they_are_without_it() {
    let mesh = mesh();
    let mut without = mesh.clone();
    without.electrodes[3] = ElectrodeContact::Node(mesh.electrodes[3].nodes().next().unwrap());
    let others = |values: &[f64]| -> Vec<f64> {
        let of_others = |(step, _): &(Step, &f64)| !step.to_bytes().contains(&3);
        steps().into_iter().zip(values).filter(of_others).map(|(_, v)| *v).collect()
    };
    let impedance = |z: f64| -> Vec<f64> { (0..16).map(|e| if e == 3 { z } else { 1e-3 }).collect() };
    let expected = others(&voltages(&without, &impedance(1.0), 1.0));
    for z in [1e9, 1e12, 1e15, 1e100, 1e300] {
        let error = largest_error(&others(&voltages(&mesh, &impedance(z), 1.0)), &expected);
        println!("an electrode of {z:.0e} m: {error:.1e}");
        assert!(error < 1e-12 + 1.0 / z, "{z:e}: {error:e}");
    }
    // Current through it meets its contact, and nothing else counts.
    let fields = ForwardModel::new(&mesh, &impedance(1e12)).unwrap().solve(&vec![1.0; mesh.elements.len()]);
    let driven =
        fields.unwrap().voltage(Step { drive_plus: 3, drive_minus: 9, sense_plus: 3, sense_minus: 9 });
    assert!((driven * mesh.width(&mesh.electrodes[3]) / 1e12 - 1.0).abs() < 1e-11, "{driven}");
}

#[test]
fn skin_files_with_perfect_contacts_and_with_an_open_ground_have_the_voltages_of_their_limits() {
    let built = |contact: &str| Model::build(&disc(contact, 5), |_| ()).unwrap();
    let (small, tiny) = (built("\"1e-6 ohm m\""), built("\"1e-15 ohm m\""));
    let error = largest_error(&tiny.voltages, &small.voltages);
    assert!(error < 1e-4, "{error:e}");
    let each = |fifth: &str| {
        let each: Vec<_> = (1..=16).map(|e| if e == 5 { fifth } else { "0.18" }).collect();
        format!("[{}]", each.join(", "))
    };
    let (open, wide_open) = (built(&each("1e6")), built(&each("1e12")));
    let others = |model: &Model| -> Vec<f64> {
        let steps = model.steps.iter().zip(&model.voltages);
        steps.filter(|(step, _)| !step.to_bytes().contains(&4)).map(|(_, v)| *v).collect()
    };
    let error = largest_error(&others(&wide_open), &others(&open));
    assert!(error < 1e-5, "{error:e}");
}

#[test]
fn what_cannot_be_right_is_refused_by_name() {
    let mesh = mesh();
    let mut impedance = [1e-3; 16];
    impedance[6] = 0.0;
    let error = ForwardModel::new(&mesh, &impedance).unwrap_err();
    assert_eq!(error, ForwardError::ContactImpedance { electrode: 6, size: 0.0 });
    assert!(error.to_string().contains("of electrode 7 comes to 0e0 m"), "{error}");

    // An island that conducts as the rest does, behind a moat that hardly conducts: rounding alone says at what
    // potential it is.
    let away = |element: usize| {
        let [a, b, c] = mesh.corners(element);
        ((a.coords + b.coords + c.coords) / 3.0).norm()
    };
    let island = |moat: f64| -> Vec<f64> {
        let conductivity = |e| if (0.03..0.05).contains(&away(e)) { moat } else { 1.0 };
        (0..mesh.elements.len()).map(conductivity).collect()
    };
    let model: ForwardModel = ForwardModel::new(&mesh, &[1e-3; 16]).unwrap();
    assert!(model.solve(&island(1e-3)).is_ok());
    let error = model.solve(&island(1e-14)).unwrap_err();
    assert!(matches!(error, ForwardError::Rounding { error } if error > 1e-9), "{error}");
}

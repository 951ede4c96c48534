//! Every stage against EIDORS' numbers on EIDORS' own meshes: see tests/data/eidors/README.md.

use dermatome::{
    forward::{Fields, ForwardModel},
    inverse::reconstruction_matrix,
    jacobian::jacobian,
    mesh::{ElectrodeContact, Mesh},
    pixels,
    prior::{HighPass, Prior},
    skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use faer::{Col, Mat};
use nalgebra::Point3;
use std::{collections::HashMap, fs::File, io::BufReader, path::Path};

/// One reference file with the model it describes.
struct Reference {
    arrays: npyz::npz::NpzArchive<BufReader<File>>,
}

impl Reference {
    fn open(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/eidors").join(name);
        Self { arrays: npyz::npz::NpzArchive::open(path).unwrap() }
    }

    fn floats(&mut self, key: &str) -> Vec<f64> {
        self.arrays.by_name(key).unwrap().expect(key).into_vec().unwrap()
    }

    /// 1-based indices, made 0-based.
    fn indices(&mut self, key: &str) -> Vec<usize> {
        let values: Vec<i32> = self.arrays.by_name(key).unwrap().expect(key).into_vec().unwrap();
        values.into_iter().map(|value| value as usize - 1).collect()
    }

    fn mesh(&mut self, complete: bool) -> Mesh {
        let shape = self.arrays.by_name("nodes").unwrap().expect("nodes").shape().to_vec();
        let point = |p: &[f64]| Point3::new(p[0], p[1], p.get(2).copied().unwrap_or(0.0));
        let nodes = self.floats("nodes").chunks(shape[1] as usize).map(point).collect();
        let elements: Vec<_> = self.indices("elems").chunks(3).map(|e| [e[0], e[1], e[2]]).collect();
        let electrode_nodes = self.indices("elec_nodes");
        let per_electrode = electrode_nodes.len() / 16;
        let contact = |nodes: &[usize]| match complete {
            false => ElectrodeContact::Node(nodes[0]),
            true => ElectrodeContact::Edges(rim_edges(&elements, nodes)),
        };
        let electrodes = electrode_nodes.chunks(per_electrode).map(contact).collect();
        Mesh { nodes, elements, electrodes }
    }

    fn forward(&mut self, mesh: &Mesh) -> ForwardModel {
        let impedance = self.floats("z_contact");
        ForwardModel::new(mesh, &impedance).unwrap()
    }
}

/// Edges between the given nodes that belong to one element only.
fn rim_edges(elements: &[[usize; 3]], nodes: &[usize]) -> Vec<[usize; 2]> {
    let mut uses: HashMap<[usize; 2], usize> = HashMap::new();
    for element in elements {
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            let edge = [element[a].min(element[b]), element[a].max(element[b])];
            *uses.entry(edge).or_default() += 1;
        }
    }
    let on_rim = |edge: &[usize; 2]| uses[edge] == 1 && edge.iter().all(|node| nodes.contains(node));
    let mut edges: Vec<_> = uses.keys().copied().filter(on_rim).collect();
    edges.sort_unstable();
    edges
}

fn steps() -> Vec<Step> {
    pattern(16, 1, 1, Driven::Skipped).collect()
}

/// Largest difference relative to the largest expected value; printed, so that anyone can see it with
/// `cargo test -p dermatome --test eidors -- --nocapture`.
fn assert_agrees(model: &str, what: &str, got: &[f64], expected: &[f64], allowed: f64) {
    assert_eq!(got.len(), expected.len());
    let largest = expected.iter().fold(0.0, |max: f64, value| max.max(value.abs()));
    let error = got.iter().zip(expected).fold(0.0, |max: f64, (a, b)| max.max((a - b).abs())) / largest;
    println!("{model:<18} {what:<26} relative error {error:.1e} (allowed {allowed:.0e})");
    assert!(error < allowed, "{model}, {what}: {error:e}");
}

fn rows(matrix: &Mat<f64>) -> Vec<f64> {
    (0..matrix.nrows()).flat_map(|i| (0..matrix.ncols()).map(move |j| matrix[(i, j)])).collect()
}

fn homogeneous(reference: &mut Reference, mesh: &Mesh) -> Fields {
    reference.forward(mesh).solve(&vec![1.0; mesh.elements.len()]).unwrap()
}

const MODELS: [(&str, bool); 5] = [
    ("a2c_pem.npz", false),
    ("b2C_cem.npz", true),
    ("c2c_pem.npz", false),
    ("c2c_cem.npz", true),
    ("hemi_256_pem.npz", false),
];

#[test]
fn voltages_agree_to_1e_10_for_homogeneous_and_inhomogeneous_conductivity() {
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        let mesh = reference.mesh(complete);
        let forward = reference.forward(&mesh);
        let voltages = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&steps());
        assert_agrees(name, "voltages", &voltages, &reference.floats("vh"), 1e-10);
        let voltages = forward.solve(&reference.floats("sigma_i")).unwrap().voltages(&steps());
        assert_agrees(name, "voltages, inhomogeneous", &voltages, &reference.floats("vi"), 1e-10);
    }
}

#[test]
fn node_potentials_agree_to_1e_10() {
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        let mesh = reference.mesh(complete);
        let fields = homogeneous(&mut reference, &mesh);
        let unknowns = mesh.nodes.len() + if complete { 16 } else { 0 };
        // Stimulation k: -1 A into electrode k, +1 A into k + 1; EIDORS holds a node at 0 V.
        let ground = reference.floats("gnd_node")[0] as usize - 1;
        let driven = |node: usize, k: usize| fields.at(node)[(k + 1) % 16] - fields.at(node)[k];
        let potentials = Mat::from_fn(unknowns, 16, |node, k| driven(node, k) - driven(ground, k));
        assert_agrees(name, "node potentials", &rows(&potentials), &reference.floats("nodev_h"), 1e-10);
    }
}

#[test]
fn system_matrix_agrees_to_1e_10() {
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        let mesh = reference.mesh(complete);
        let mut matrix = HashMap::<(usize, usize), f64>::new();
        let ones = vec![1.0; mesh.elements.len()];
        for (row, col, value) in reference.forward(&mesh).system_matrix(&ones).unwrap() {
            *matrix.entry((row, col)).or_default() += value;
        }
        let places: Vec<_> = reference.indices("E_row").into_iter().zip(reference.indices("E_col")).collect();
        let got: Vec<f64> = places.iter().map(|place| matrix.remove(place).unwrap_or(0.0)).collect();
        assert_agrees(name, "system matrix", &got, &reference.floats("E_val"), 1e-10);
        assert!(matrix.values().all(|value| value.abs() < 1e-12), "{name}: entries EIDORS does not have");
    }
}

#[test]
fn jacobian_agrees_to_1e_10() {
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        let mesh = reference.mesh(complete);
        let fields = homogeneous(&mut reference, &mesh);
        let jacobian = jacobian(&mesh, &fields, &steps(), &pixels::per_element(&mesh));
        assert_agrees(name, "Jacobian", &rows(&jacobian), &reference.floats("J"), 1e-10);
    }
}

#[test]
fn laplace_prior_is_eidors_own() {
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        let mesh = reference.mesh(complete);
        let elements = pixels::per_element(&mesh);
        let prior = Prior::Laplace { pixels: mesh.elements.len(), neighbours: elements.neighbours };
        let mut entries = HashMap::<(usize, usize), f64>::new();
        for (row, col, value) in prior.entries().unwrap() {
            *entries.entry((row, col)).or_default() += value;
        }
        let places = reference.indices("L_row").into_iter().zip(reference.indices("L_col"));
        let expected: HashMap<_, _> = places.zip(reference.floats("L_val")).collect();
        assert_eq!(entries, expected, "{name}");
    }
}

/// The first 4 x 4 entries that EIDORS 3.11's own unit test of `prior_gaussian_HPF` expects on this
/// mesh. EIDORS integrates over pixels by counting the points of a 128 x 128 grid, we by their area
/// and second moment, and these pixels are as large as the filter.
#[test]
fn gaussian_high_pass_is_near_eidors_own() {
    const EXPECTED: [f64; 4] =
        [0.562_239_752_317_943, -0.117_068_756_722_254, -0.025_875_127_622_824, -0.117_068_756_722_254];
    let mesh = Reference::open("a2c_pem.npz").mesh(false);
    let filter = HighPass::new(&pixels::per_element(&mesh), 0.1).filter().unwrap();
    let got: Vec<f64> = (0..4).map(|j| filter[(0, j)]).collect();
    assert_agrees("a2c_pem.npz", "Gaussian high-pass", &got, &EXPECTED, 0.15);
}

/// Image of EIDORS' own data with a prior of ours.
fn image(
    reference: &mut Reference,
    complete: bool,
    kind: skin::Prior,
    normalised: bool,
    key: &str,
) -> Vec<f64> {
    let mesh = reference.mesh(complete);
    let fields = homogeneous(reference, &mesh);
    let elements = pixels::per_element(&mesh);
    let mut jacobian = jacobian(&mesh, &fields, &steps(), &elements);
    let (vh, vi) = (reference.floats("vh"), reference.floats("vi"));
    let scale: Vec<f64> = vh.iter().map(|v| if normalised { 1.0 / v } else { 1.0 }).collect();
    for pixel in 0..jacobian.ncols() {
        (0..208).for_each(|m| jacobian[(m, pixel)] *= scale[m]);
    }
    let weights = vec![1.0; 208];
    let prior = Prior::new(kind, &elements, &jacobian, &weights);
    let hyperparameter = reference.floats(key)[0];
    let matrix = reconstruction_matrix(&jacobian, &prior, &weights, hyperparameter).unwrap();
    let difference = Col::from_fn(208, |m| (vi[m] - vh[m]) * scale[m]);
    (&matrix * &difference).iter().copied().collect()
}

#[test]
fn images_agree_to_1e_8() {
    let kinds = [
        (skin::Prior::Laplace, false, "laplace_n0"),
        (skin::Prior::Laplace, true, "laplace_n1I"),
        (skin::Prior::Tikhonov, false, "tikhonov_n0"),
        (skin::Prior::Noser { exponent: 0.5 }, false, "noser_n0"),
    ];
    for (name, complete) in MODELS {
        let mut reference = Reference::open(name);
        for (kind, normalised, key) in kinds {
            let image = image(&mut reference, complete, kind, normalised, &format!("hp_{key}"));
            assert_agrees(
                name,
                &format!("image, {key}"),
                &image,
                &reference.floats(&format!("x_{key}")),
                1e-8,
            );
        }
    }
}

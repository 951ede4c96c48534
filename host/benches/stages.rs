//! Every stage from skin to reconstruction matrix, at sizes from 600 to a million elements, with
//! time and largest memory: `cargo bench -p dermatome --bench stages`. docs/performance.md holds a
//! run and how it compares with other programs.

use dermatome::{
    forward::{Fields, ForwardModel},
    inverse::reconstruction_matrix,
    jacobian::jacobian,
    mesh::{Lattice, Mesh},
    model::{Model, forward_model, mesh, pixels_on},
    pixels::Pixels,
    prior::Prior,
    sheet::EdgeLengths,
    skin::{ImageLayout, Method, Skin},
};
use divan::{AllocProfiler, Bencher, black_box};
use std::path::Path;

#[global_allocator]
static MEMORY: AllocProfiler = AllocProfiler::system();

/// Elements, roughly; what else belongs to a size says [`Size::skin`].
const SIZES: [Size; 6] = [Size(600), Size(2_400), Size(4_080), Size(20_500), Size(200_000), Size(1_000_000)];

fn main() {
    divan::main();
}

#[derive(Clone, Copy)]
struct Size(usize);

impl std::fmt::Display for Size {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{}", self.0)
    }
}

impl Size {
    /// A disc of about so many elements, point electrodes, adjacent pattern: 16 electrodes and one
    /// pixel for each element up to 20,500, above that 32 electrodes and 2,000 patches.
    fn skin(self) -> Skin {
        let small = self.0 <= 20_500;
        let text = include_str!("../../models/disc-210mm/skin.toml")
            .replace("model = \"complete\"", "model = \"point\"")
            .replace("width = \"11 mm\"", "")
            .replace("contact_impedance = \"0.18 ohm m\"", "")
            .replace("count = 16", if small { "count = 16" } else { "count = 32" });
        let mut skin = Skin::parse(Path::new("bench.toml"), &text)
            .expect("the shipped skin is valid")
            .made()
            .expect("the shipped skin is valid");
        skin.image = if small { ImageLayout::Elements } else { ImageLayout::ElementPatches { count: 2_000 } };
        let area = skin.shape.flat().expect("a disc is flat").area();
        let edge = (area / (0.433 * self.0 as f64)).sqrt();
        skin.edges = EdgeLengths { skin: edge, electrodes: edge };
        skin
    }

    fn mesh(self) -> (Skin, Mesh) {
        let skin = self.skin();
        let mesh = mesh(&skin, 1.0, Lattice::default()).expect("a disc has a mesh");
        (skin, mesh)
    }

    fn fields(self) -> (Skin, Mesh, Fields) {
        let (skin, mesh) = self.mesh();
        let fields = solve(&skin, &mesh);
        (skin, mesh, fields)
    }
}

fn solve(skin: &Skin, mesh: &Mesh) -> Fields {
    let forward: ForwardModel = forward_model(skin, mesh).expect("a mesh has a forward model");
    forward.solve(&vec![1.0; mesh.elements.len()]).expect("a homogeneous skin has a solution")
}

fn pixels(skin: &Skin, mesh: &Mesh) -> Pixels {
    pixels_on(skin, mesh).expect("every pixel has elements")
}

#[divan::bench(args = SIZES, max_time = 10)]
fn stage_1_mesh(bencher: Bencher<'_, '_>, size: Size) {
    let skin = size.skin();
    bencher.bench_local(|| mesh(black_box(&skin), 1.0, Lattice::default()));
}

#[divan::bench(args = SIZES, max_time = 10)]
fn stage_2_pixels(bencher: Bencher<'_, '_>, size: Size) {
    let (skin, mesh) = size.mesh();
    bencher.bench_local(|| pixels(&skin, black_box(&mesh)));
}

#[divan::bench(args = SIZES, max_time = 10)]
fn stage_3_forward(bencher: Bencher<'_, '_>, size: Size) {
    let (skin, mesh) = size.mesh();
    bencher.bench_local(|| solve(&skin, black_box(&mesh)));
}

#[divan::bench(args = SIZES, max_time = 10)]
fn stage_4_jacobian(bencher: Bencher<'_, '_>, size: Size) {
    let (skin, mesh, fields) = size.fields();
    let (pixels, steps) = (pixels(&skin, &mesh), skin.steps());
    bencher.bench_local(|| jacobian(&mesh, black_box(&fields), &steps, &pixels));
}

#[divan::bench(args = SIZES, max_time = 10)]
fn stage_5_matrix(bencher: Bencher<'_, '_>, size: Size) {
    let skin = size.skin();
    let model = Model::build(&skin, |_| ()).expect("the shipped skin has a model");
    let Method::OneStep(kind) = skin.inverse.method else { panic!("the shipped skin has a prior") };
    let (jacobian, weights) = (&model.jacobian, &model.weights);
    bencher.bench_local(|| {
        let prior = Prior::new(kind, &model.pixels, black_box(jacobian), weights);
        reconstruction_matrix(jacobian, &prior, weights, model.hyperparameter)
    });
}

#[divan::bench(args = SIZES, max_time = 20)]
fn skin_to_matrix(bencher: Bencher<'_, '_>, size: Size) {
    let skin = size.skin();
    bencher.bench_local(|| Model::build(black_box(&skin), |_| ()));
}

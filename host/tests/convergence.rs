//! Point electrodes on the rim of a homogeneous disc have a closed form: the voltage between rim
//! points r and s for a current from p to q is ln(|rq| |sp| / (|rp| |sq|)) / pi at unit current and
//! conductivity, because the potential of a pair of point currents on a rim is logarithmic. The
//! stereographic projection is conformal, so a hemisphere with the same rim has the same voltages.
//!
//! `cargo test -p dermatome --test convergence -- --nocapture` prints the errors.

use dermatome::{
    embedding::Embedding,
    forward::ForwardModel,
    mesh::{Lattice, Mesh, generate},
    outline::Outline,
    sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use std::f64::consts::PI;

const RADIUS: f64 = 0.1;
const ELECTRODES: u8 = 16;

fn steps() -> Vec<Step> {
    pattern(ELECTRODES, 1, 1, Driven::Skipped).collect()
}

fn sheet(embedding: Embedding) -> Sheet {
    let outline = Outline::disc(RADIUS);
    let spacing = outline.perimeter() / f64::from(ELECTRODES);
    let places = (0..ELECTRODES).map(|i| Place::Rim(f64::from(i) * spacing)).collect();
    Sheet { outline, embedding, places }
}

/// What the closed form says: `[step]`.
fn exact(sheet: &Sheet) -> Vec<f64> {
    let centres: Vec<_> = sheet.on_rim().map(|(_, s)| sheet.outline.rim_point(s)).collect();
    let log_distance = |a: u8, b: u8| (centres[usize::from(a)] - centres[usize::from(b)]).norm().ln();
    let voltage = |step: Step| {
        let [dp, dm, sp, sm] = step.to_bytes();
        (log_distance(sp, dm) - log_distance(sp, dp) - log_distance(sm, dm) + log_distance(sm, dp)) / PI
    };
    steps().into_iter().map(voltage).collect()
}

fn mesh(sheet: &Sheet, skin: f64, electrodes: f64) -> Mesh {
    generate(sheet, &ElectrodeModel::Point, EdgeLengths { skin, electrodes }, Lattice::default()).unwrap()
}

/// Largest relative error of any voltage.
fn error(sheet: &Sheet, mesh: &Mesh) -> f64 {
    let forward: ForwardModel = ForwardModel::new(mesh, &[0.0; ELECTRODES as usize]).unwrap();
    let voltages = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap().voltages(&steps());
    let errors = voltages.iter().zip(exact(sheet)).map(|(v, e)| ((v - e) / e).abs());
    errors.fold(0.0, f64::max)
}

/// Edge length that makes about so many triangles.
fn edge_for(sheet: &Sheet, elements: f64) -> f64 {
    (sheet.embedding.area(&sheet.outline) / elements * 4.0 / 3_f64.sqrt()).sqrt()
}

/// Errors at about 4,096, 16,384 and 65,536 elements, with edges at electrodes shorter by a factor.
fn errors(name: &str, sheet: &Sheet, finer: f64) -> [f64; 3] {
    // Grading takes four per cent of the elements.
    let share = if finer > 1.0 { 0.96 } else { 1.0 };
    [4_096.0, 16_384.0, 65_536.0].map(|wanted| {
        let edge = edge_for(sheet, share * wanted);
        let mesh = mesh(sheet, edge, edge / finer);
        let (elements, error) = (mesh.elements.len() as f64, error(sheet, &mesh));
        println!(
            "{name:<10}  edges at electrodes {finer} x shorter  {elements:>6} elements  error {error:.1e}"
        );
        assert!((elements / wanted - 1.0).abs() < 0.1, "{elements} where {wanted} were wanted");
        error
    })
}

#[test]
fn point_electrodes_converge_to_the_closed_form_at_second_order() {
    for (name, embedding) in
        [("disc", Embedding::Flat), ("hemisphere", Embedding::Hemisphere { radius: RADIUS })]
    {
        let sheet = sheet(embedding);
        let even = errors(name, &sheet, 1.0);
        assert!(even[1] <= 6.6e-4 && even[2] <= 1.7e-4, "{name}: {even:?}");
        assert!(even[0] / even[2] > 14.0, "{name}: {even:?} is not second order");
        let graded = errors(name, &sheet, 4.0);
        assert!(graded.iter().zip(even).all(|(graded, even)| *graded < even / 1.8), "{name}: {graded:?}");
    }
}

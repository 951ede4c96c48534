//! The complete electrode model against an independent solution without any mesh: a series of
//! Legendre polynomials for the current density under each electrode.
//!
//! A current density j into the rim of a homogeneous disc of radius R and unit conductivity makes
//! the potential u(t) = -(R / pi) Int ln|2 sin((t - s) / 2)| j(s) ds on the rim (harmonic by
//! harmonic: cos ns gives R / n cos nt). Under electrode l, at potential U_l and with contact
//! impedance z_l, U_l = u + z_l j; elsewhere j = 0. With j = Sum_p c_lp P_p(x) along each electrode,
//! x from -1 to 1, that is tested with each P_q (Galerkin's method). The coefficients fall like
//! 1 / p^4; doubling their number shows how exact the solution is.
//!
//! `cargo test -p dermatome --test complete_electrode -- --nocapture` prints the errors.

use dermatome::{
    embedding::Embedding,
    forward::ForwardModel,
    mesh::{Lattice, generate},
    model::{driven_error, mesh},
    outline::Outline,
    sheet::{EdgeLengths, ElectrodeModel, Place, Sheet},
    skin::Skin,
};
use dermatome_shared::stimulation::{Driven, Step, pattern};
use faer::{Mat, linalg::solvers::Solve};
use std::{
    f64::consts::{LN_2, PI, TAU},
    path::Path,
};

const RADIUS: f64 = 0.105;
const ELECTRODES: usize = 16;

/// Electrodes at equal distances round a disc.
struct Disc {
    /// Length of rim covered, m: `[electrode]`.
    widths: Vec<f64>,
    /// Contact impedance times sheet conductivity, m: `[electrode]`.
    impedances: Vec<f64>,
}

impl Disc {
    fn angle(&self, electrode: usize) -> f64 {
        TAU * electrode as f64 / ELECTRODES as f64
    }

    /// Half the angle that an electrode covers.
    fn half_angle(&self, electrode: usize) -> f64 {
        self.widths[electrode] / RADIUS / 2.0
    }

    /// Electrode potentials for unit current into each electrode and out of all evenly, by a series of
    /// `order` polynomials: `[electrode][driven]`, but for a constant that each driven one has.
    fn potentials(&self, order: usize) -> Mat<f64> {
        let unknowns = ELECTRODES * order;
        let quadrature = Legendre::new(order);
        let mut matrix = Mat::zeros(unknowns + ELECTRODES, unknowns + ELECTRODES);
        for l in 0..ELECTRODES {
            for m in 0..ELECTRODES {
                let coupling = self.coupling(l, m, &quadrature);
                for (q, p) in (0..order).flat_map(|q| (0..order).map(move |p| (q, p))) {
                    matrix[(l * order + q, m * order + p)] = coupling[(q, p)];
                }
            }
            for q in 0..order {
                matrix[(l * order + q, l * order + q)] += self.impedances[l] * 2.0 / (2 * q + 1) as f64;
            }
            // U_l appears with the constant polynomial, which alone carries current.
            matrix[(l * order, unknowns + l)] = -2.0;
            matrix[(unknowns + l, l * order)] = self.widths[l];
        }
        // The mean of u over the rim is 0, which fixes the constant.
        let even = 1.0 / ELECTRODES as f64;
        let currents = Mat::from_fn(unknowns + ELECTRODES, ELECTRODES, |row, driven| match row {
            row if row < unknowns => 0.0,
            row => f64::from(u8::from(row - unknowns == driven)) - even,
        });
        matrix.partial_piv_lu().solve(&currents).subrows(unknowns, ELECTRODES).to_owned()
    }

    /// -(R / pi) IntInt ln|2 sin((t - s) / 2)| P_q(x) P_p(y) dx ds with t on electrode l and s on m:
    /// `[q][p]`.
    fn coupling(&self, l: usize, m: usize, legendre: &Legendre) -> Mat<f64> {
        let (a, b) = (self.half_angle(l), self.half_angle(m));
        let between = self.angle(l) - self.angle(m);
        let smooth = |x: f64, y: f64| {
            let turn = between + a * x - b * y;
            match (l == m, x == y) {
                (false, _) => (2.0 * (turn / 2.0).sin()).abs().ln(),
                (true, false) => ((2.0 * (turn / 2.0).sin()) / (x - y)).abs().ln(),
                (true, true) => a.ln(),
            }
        };
        let mut integral = legendre.integrate(smooth);
        if l == m {
            let order = integral.nrows();
            integral += Mat::from_fn(order, order, log_integral);
        }
        integral * faer::Scale(-RADIUS / PI * b)
    }
}

/// IntInt ln|x - y| P_q(x) P_p(y) dx dy over -1 to 1. The inner integral is
/// 2 / (2p + 1) (Q_(p+1)(x) - Q_(p-1)(x)) with Legendre's functions of the second kind, and
/// Int P_q Q_n dx = (1 - (-1)^(q+n)) / ((q - n)(q + n + 1)).
fn log_integral(q: usize, p: usize) -> f64 {
    let (q, p) = (q.min(p) as f64, q.max(p) as f64);
    let of_second_kind = |n: f64| {
        if (q + n) % 2.0 == 0.0 { 0.0 } else { 2.0 / ((q - n) * (q + n + 1.0)) }
    };
    match p {
        0.0 => 4.0 * LN_2 - 6.0,
        _ => 2.0 / (2.0 * p + 1.0) * (of_second_kind(p + 1.0) - of_second_kind(p - 1.0)),
    }
}

/// Gauss' quadrature with values of the polynomials at its nodes.
struct Legendre {
    nodes: Vec<f64>,
    weights: Vec<f64>,
    /// `[order][node]`
    values: Mat<f64>,
}

impl Legendre {
    fn new(order: usize) -> Self {
        let count = 2 * order;
        let nodes: Vec<f64> = (0..count).map(|i| Self::root(count, i)).collect();
        let weight = |&x: &f64| {
            let [_, slope] = Self::value_and_slope(count, x);
            2.0 / ((1.0 - x * x) * slope * slope)
        };
        let weights = nodes.iter().map(weight).collect();
        let values = Mat::from_fn(order, count, |p, i| Self::value_and_slope(p, nodes[i])[0]);
        Self { nodes, weights, values }
    }

    /// By Newton's method.
    fn root(count: usize, i: usize) -> f64 {
        let start = (PI * (i as f64 + 0.75) / (count as f64 + 0.5)).cos();
        (0..20).fold(start, |x, _| {
            let [value, slope] = Self::value_and_slope(count, x);
            x - value / slope
        })
    }

    fn value_and_slope(order: usize, x: f64) -> [f64; 2] {
        let (mut before, mut value) = (0.0, 1.0);
        for n in 0..order {
            let n = n as f64;
            (before, value) = (value, ((2.0 * n + 1.0) * x * value - n * before) / (n + 1.0));
        }
        [value, order as f64 * (before - x * value) / (1.0 - x * x)]
    }

    /// IntInt f(x, y) P_q(x) P_p(y) dx dy: `[q][p]`.
    fn integrate(&self, f: impl Fn(f64, f64) -> f64) -> Mat<f64> {
        let count = self.nodes.len();
        let weighted = Mat::from_fn(count, count, |i, j| {
            self.weights[i] * self.weights[j] * f(self.nodes[i], self.nodes[j])
        });
        &self.values * weighted * self.values.transpose()
    }
}

fn steps(driven: Driven) -> Vec<Step> {
    pattern(ELECTRODES as u8, 1, 1, driven).collect()
}

/// Voltages by the series: `[step]`.
fn by_series(disc: &Disc, order: usize, driven: Driven) -> Vec<f64> {
    let potentials = disc.potentials(order);
    let voltage = |step: Step| {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        potentials[(sp, dp)] - potentials[(sp, dm)] - potentials[(sm, dp)] + potentials[(sm, dm)]
    };
    steps(driven).into_iter().map(voltage).collect()
}

/// Voltages by finite elements: number of elements, `[step]`.
fn by_elements(disc: &Disc, edges: EdgeLengths, driven: Driven) -> (usize, Vec<f64>) {
    let places = (0..ELECTRODES).map(|l| Place::Rim(RADIUS * disc.angle(l))).collect();
    let sheet = Sheet { outline: Outline::disc(RADIUS), embedding: Embedding::Flat, places };
    let model =
        ElectrodeModel::Complete { width: disc.widths.clone(), contact_impedance: disc.impedances.clone() };
    let mesh = generate(&sheet, &model, edges, Lattice::default()).unwrap();
    let forward: ForwardModel = ForwardModel::new(&mesh, &disc.impedances).unwrap();
    let fields = forward.solve(&vec![1.0; mesh.elements.len()]).unwrap();
    (mesh.elements.len(), fields.voltages(&steps(driven)))
}

fn largest_relative_error(values: &[f64], exact: &[f64]) -> f64 {
    values.iter().zip(exact).map(|(value, exact)| ((value - exact) / exact).abs()).fold(0.0, f64::max)
}

#[test]
fn voltages_of_the_complete_model_agree_with_a_series_solution() {
    let like_disc_210mm = Disc { widths: vec![0.011; ELECTRODES], impedances: vec![1.06e-3; ELECTRODES] };
    let unequal = Disc {
        widths: (0..ELECTRODES).map(|l| 0.006 + 0.001 * l as f64).collect(),
        impedances: (0..ELECTRODES).map(|l| 3e-4 * 1.3_f64.powi(l as i32)).collect(),
    };
    for (name, disc) in [("as disc-210mm", like_disc_210mm), ("all different", unequal)] {
        let exact = by_series(&disc, 32, Driven::Skipped);
        let certainty = largest_relative_error(&by_series(&disc, 16, Driven::Skipped), &exact);
        println!("{name:<14} series of 16 against 32 polynomials: {certainty:.1e}");
        assert!(certainty < 1e-7, "{name}: {certainty:e}");
        let errors = [3.2e-3, 1.6e-3, 0.8e-3].map(|skin| {
            let (elements, voltages) =
                by_elements(&disc, EdgeLengths { skin, electrodes: skin / 4.0 }, Driven::Skipped);
            let error = largest_relative_error(&voltages, &exact);
            println!("{name:<14} {elements:>6} elements: largest relative error {error:.1e}");
            error
        });
        assert!(errors[2] < 1e-4, "{name}: {errors:?}");
        // Of second order at first: 3.7 and 3.9 times less. Then the edges at electrodes, where fields are
        // singular, weigh more.
        assert!(errors[0] / errors[1] > 3.5, "{name}: {errors:?}");
    }
}

/// What is measured on a driven electrode is to a good part the spreading of its current, whose density is
/// singular at the electrode's edges.
#[test]
fn voltages_on_driven_electrodes_need_short_edges() {
    let measured = |impedance: f64, share: f64| {
        let disc = Disc { widths: vec![0.011; ELECTRODES], impedances: vec![impedance; ELECTRODES] };
        let exact = by_series(&disc, 32, Driven::Measured);
        let edges = EdgeLengths { skin: 4.5e-3, electrodes: 4.5e-3 * share };
        let (elements, voltages) = by_elements(&disc, edges, Driven::Measured);
        let error = largest_relative_error(&voltages, &exact);
        println!(
            "{impedance:.1e} m, edges {share:>6} of the skin's: {elements:>6} elements, error {error:.1e}"
        );
        error
    };
    let skin = include_str!("../../models/disc-210mm/skin.toml")
        .replace("pattern = \"adjacent\"", "pattern = \"adjacent\"\ndriven = \"measured\"");
    let skin = Skin::parse(Path::new("disc.toml"), &skin).unwrap().made().unwrap();
    let mesh = mesh(&skin, 1.0, Lattice::default()).unwrap();
    let estimated = driven_error(&skin, &mesh).unwrap().unwrap();
    let error = measured(1.06e-3, 1.0);
    println!("disc-210mm: estimated error {estimated:.1e}");
    assert!(error > 0.03 && (0.5..2.0).contains(&(estimated / error)), "{estimated:e} of {error:e}");
    for impedance in [1.06e-2, 1.06e-3, 1.06e-4] {
        let errors = [1.0, 0.25, 1.0 / 16.0].map(|share| measured(impedance, share));
        assert!(errors[2] < errors[0] / 6.0, "{errors:?}");
    }
}

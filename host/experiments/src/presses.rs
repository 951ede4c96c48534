//! Presses at known places of a skin that its model does not know, as somebody would record them to learn from.

use dermatome_frames::{
    learn::presses::{Positions, Recording},
    recorded::read::Frames,
};
use dermatome_geometry::{
    mesh::{Mesh, neighbours::boundary_edges, triangle},
    sheet::ElectrodeModel,
};
use dermatome_model::{inverse::targets::half_side, model::ModelError, pixels::samples, skin::Skin};
use dermatome_simulate::{
    Noise, TrueSkin,
    noise::{root_mean_square, share},
};
use nalgebra::{Point3, Vector3};
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// Frames of the untouched skin.
const UNTOUCHED: usize = 16;
/// Spots of the sheet that conduct better or worse.
const SPOTS: usize = 12;
/// By how much at most: the logarithm of three.
const SPOT_HEIGHT: f64 = 1.1;
/// How wide a spot is, and a finger, in halves of the larger side.
const SPOT_WIDTH: f64 = 0.3;
const FINGER: f64 = 0.08;
/// Standard deviation of the logarithm of a measurement's gain.
const GAIN: f64 = 0.2;
/// Places that are tried for one.
const TRIES: usize = 1000;
/// Farthest that a place is recorded off the skin, m.
const OFF: f64 = 0.003;

/// Presses of a finger, and frames of the untouched skin, whose mean is the presses' reference.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedPresses {
    /// The presses, with places in space.
    pub recording: Recording,
    /// The untouched skin.
    pub untouched: Frames,
}

/// Presses at random places of a skin whose sheet conducts up to three times better or worse from place to place, whose
/// contact impedances are the skin file's times factors whose logarithms have a standard deviation of one, and whose
/// measurements have gains of their own; of up to three times one depth, recorded up to 3 mm off the skin.
pub fn of_odd_skin(skin: &Skin, count: usize, noise: Noise) -> Result<RecordedPresses, ModelError> {
    let mut random = Pcg64Mcg::seed_from_u64(noise.seed);
    let odd = OddSkin::new(skin, noise.snr_db, &mut random)?;
    let mesh = odd.truth.mesh();
    let untouched: Vec<Complex64> =
        (0..UNTOUCHED).flat_map(|_| odd.measure(&odd.sheet, &mut random)).collect();
    let radius = FINGER * half_side(mesh);
    let (mut values, mut positions) = (Vec::new(), Vec::new());
    for _ in 0..count {
        let (at, outwards) = place(mesh, radius, &mut random);
        let depth = 0.5 * 3f64.powf(random.random());
        let conductivity = odd.pressed(at, radius, depth);
        values.extend(odd.measure(&conductivity, &mut random));
        positions.push((at + outwards * random.random_range(-OFF..OFF)).into());
    }
    let frames = |values, frames| Frames { values, frames, measurements: odd.gains.len(), complex: false };
    let untouched = frames(untouched, UNTOUCHED);
    let recording = Recording {
        pressed: frames(values, count),
        unpressed: frames(untouched.mean(), 1),
        positions: Positions::InSpace(positions),
        forces: None,
    };
    Ok(RecordedPresses { recording, untouched })
}

/// A skin that its model does not know.
struct OddSkin {
    truth: TrueSkin,
    skin: Skin,
    snr_db: f64,
    /// Of the untouched sheet, relative: `[element]`.
    sheet: Vec<f64>,
    /// Of the measurements: `[step]`.
    gains: Vec<f64>,
}

impl OddSkin {
    fn new(skin: &Skin, snr_db: f64, random: &mut Pcg64Mcg) -> Result<Self, ModelError> {
        // Point electrodes have none.
        let own: &[f64] = match &skin.electrodes.model {
            ElectrodeModel::Complete { contact_impedance, .. } => contact_impedance,
            ElectrodeModel::Point => &[],
        };
        let contacts: Vec<Complex64> =
            own.iter().map(|contact| Complex64::from(contact * normal(random).exp())).collect();
        let truth = TrueSkin::with_contacts(skin, &contacts, skin.drive.frequency, 0.0)?;
        let mesh = truth.mesh();
        let width = SPOT_WIDTH * half_side(mesh);
        let spots: Vec<(Point3<f64>, f64)> = (0..SPOTS)
            .map(|_| (place(mesh, 0.0, random).0, if random.random() { SPOT_HEIGHT } else { -SPOT_HEIGHT }))
            .collect();
        let of_sheet = |middle: Point3<f64>| {
            let near = |(spot, height): &(Point3<f64>, f64)| {
                height * (-(middle - spot).norm_squared() / width.powi(2)).exp()
            };
            spots.iter().map(near).sum::<f64>().clamp(-SPOT_HEIGHT, SPOT_HEIGHT).exp()
        };
        let sheet = middles(mesh).map(of_sheet).collect();
        let gains = skin.steps().iter().map(|_| (GAIN * normal(random)).exp()).collect();
        Ok(Self { truth, skin: skin.clone(), snr_db, sheet, gains })
    }

    fn measure(&self, conductivity: &[f64], random: &mut Pcg64Mcg) -> Vec<Complex64> {
        let voltages = self.truth.voltages(conductivity, &self.skin.steps());
        let noise = root_mean_square(voltages.iter().copied()) * share(self.snr_db);
        let value = |(v, gain): (&f64, &f64)| Complex64::from(gain * v + noise * normal(random));
        voltages.iter().zip(&self.gains).map(value).collect()
    }

    /// The sheet under a round finger.
    fn pressed(&self, at: Point3<f64>, radius: f64, depth: f64) -> Vec<f64> {
        let mesh = self.truth.mesh();
        let under = |point: Point3<f64>| (1.0 - ((point - at).norm() / radius).powi(2)).max(0.0).sqrt();
        let pressed = |(element, (sheet, middle)): (usize, (&f64, Point3<f64>))| {
            if (middle - at).norm() > 2.0 * radius {
                return *sheet;
            }
            let (sum, points) = samples(mesh.corners(element))
                .fold((0.0, 0.0), |(sum, points), point| (sum + under(point), points + 1.0));
            sheet * (1.0 + depth * sum / points)
        };
        self.sheet.iter().zip(middles(mesh)).enumerate().map(pressed).collect()
    }
}

fn middles(mesh: &Mesh) -> impl Iterator<Item = Point3<f64>> + '_ {
    (0..mesh.elements.len()).map(|element| triangle::centroid(mesh.corners(element)))
}

fn normal(random: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(random)
}

/// A random point of a mesh, farther from its rim than `rim`, m, and the normal there. Of a mesh that is too narrow for
/// that, one of those farthest from it.
fn place(mesh: &Mesh, rim: f64, random: &mut Pcg64Mcg) -> (Point3<f64>, Vector3<f64>) {
    let areas: Vec<f64> =
        (0..mesh.elements.len()).map(|element| triangle::area(mesh.corners(element))).collect();
    let all: f64 = areas.iter().sum();
    let edge = boundary_edges(&mesh.elements);
    let from_rim = |place: Point3<f64>| {
        let nodes = edge.iter().flatten().map(|&node| (mesh.nodes[node] - place).norm());
        nodes.fold(f64::INFINITY, f64::min)
    };
    let mut farthest = (f64::NEG_INFINITY, Point3::origin(), Vector3::zeros());
    for _ in 0..TRIES {
        let mut left = random.random::<f64>() * all;
        let element = areas.iter().position(|area| {
            left -= area;
            left <= 0.0
        });
        let Some(element) = element else { continue };
        let [a, b, c] = mesh.corners(element);
        let (u, v): (f64, f64) = (random.random(), random.random());
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        let place = a + (b - a) * u + (c - a) * v;
        let (distance, normal) = (from_rim(place), triangle::normal([a, b, c]));
        if distance > rim {
            return (place, normal);
        }
        if distance > farthest.0 {
            farthest = (distance, place, normal);
        }
    }
    (farthest.1, farthest.2)
}

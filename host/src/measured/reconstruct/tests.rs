use super::*;
use crate::measured::order::SenseOrder;
use dermatome_shared::{
    image::Geometry,
    stimulation::{Step, pattern},
};
use num_complex::Complex64;
use std::f64::consts::PI;

const RADIUS: f64 = 0.05;
const SIDE: u8 = 24;

/// A linear skin: each step senses the pixels near the straight line between its pairs' middles,
/// with a Gaussian profile, and the image is the back-projection of the difference data.
struct Toy {
    steps: Vec<Step>,
    voltages: Vec<f64>,
    geometry: Geometry,
    /// `[step][pixel]`
    sensitivity: Vec<Vec<f64>>,
}

impl Toy {
    fn new() -> Self {
        let steps: Vec<_> = pattern(16, 1, 1).collect();
        let geometry = disc();
        let centres = pixel_centres(&geometry);
        let sensitivity = steps.iter().map(|step| sensitivity(step, &centres)).collect();
        // U-shaped, and different for every electrode.
        let voltages = steps.iter().map(|step| (1.0 + f64::from(step.drive_minus)) * u_shape(step)).collect();
        Self { steps, voltages, geometry, sensitivity }
    }

    fn reconstruct(
        &self,
        reference: &Frames,
        frames: &Frames,
        used: &Arrangement,
        polarity: Polarity,
    ) -> Result<Vec<FrameResult>, ReconstructError> {
        let matrix = |dv: &[f64]| self.back_projection(dv);
        let model = Model {
            steps: &self.steps,
            electrodes: 16,
            voltages: &self.voltages,
            geometry: self.geometry.clone(),
            rim: &[],
            matrix: &matrix,
        };
        reconstruct(&model, reference, frames, used, polarity)
    }

    /// Each pixel: mean of the differences, weighted by sensitivity, above the mean of all pixels.
    fn back_projection(&self, dv: &[f64]) -> Vec<f64> {
        let pixels = self.sensitivity[0].len();
        let of_pixel = |p: usize| {
            let weights = self.sensitivity.iter().map(|row| row[p]);
            let (sum, weight) =
                weights.zip(dv).fold((0.0, 0.0), |(s, w), (weight, dv)| (s + weight * dv, w + weight));
            sum / weight
        };
        let image: Vec<f64> = (0..pixels).map(of_pixel).collect();
        let mean = image.iter().sum::<f64>() / pixels as f64;
        image.iter().map(|value| value - mean).collect()
    }

    /// Voltages with an object of this conductivity change at x, y.
    fn touched(&self, x: f64, y: f64, change: f64) -> Vec<f64> {
        let centres = pixel_centres(&self.geometry);
        let object: Vec<f64> =
            centres.iter().map(|c| gauss(c[0] - x, 0.006) * gauss(c[1] - y, 0.006)).collect();
        let dv = |row: &Vec<f64>| row.iter().zip(&object).map(|(s, o)| s * o).sum::<f64>() * change;
        self.voltages.iter().zip(&self.sensitivity).map(|(v, row)| v + dv(row)).collect()
    }
}

fn gauss(distance: f64, width: f64) -> f64 {
    (-(distance / width).powi(2) / 2.0).exp()
}

fn electrode(k: f64) -> [f64; 2] {
    let angle = PI / 2.0 - 2.0 * PI * k / 16.0;
    [RADIUS * angle.cos(), RADIUS * angle.sin()]
}

fn sensitivity(step: &Step, centres: &[[f64; 2]]) -> Vec<f64> {
    let [from, to] = [step.drive_minus, step.sense_plus].map(|first| electrode(f64::from(first) + 0.5));
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    let distance = |c: &[f64; 2]| ((c[0] - from[0]) * along[1] - (c[1] - from[1]) * along[0]) / length;
    centres.iter().map(|centre| gauss(distance(centre), 0.005)).collect()
}

fn u_shape(step: &Step) -> f64 {
    let apart = f64::from(step.sense_plus.abs_diff(step.drive_minus));
    1.0 / (PI * apart / 16.0).sin().powi(2)
}

fn disc() -> Geometry {
    let pitch = 2.0 * RADIUS as f32 / f32::from(SIDE);
    let grid = PixelGrid { columns: SIDE, rows: SIDE, pitch, left: -RADIUS as f32, top: RADIUS as f32 };
    let mut mask = vec![0_u8; grid.mask_bytes()];
    for cell in 0..grid.cells() {
        let [x, y] = centre(&grid, cell);
        if x.hypot(y) < RADIUS {
            mask[cell / 8] |= 1 << (cell % 8);
        }
    }
    Geometry { grid, mask: mask.into_iter().collect() }
}

fn centre(grid: &PixelGrid, cell: usize) -> [f64; 2] {
    let side = usize::from(SIDE);
    grid.position((cell % side) as f32 + 0.5, (cell / side) as f32 + 0.5).map(f64::from)
}

fn pixel_centres(geometry: &Geometry) -> Vec<[f64; 2]> {
    pixel_cells(&geometry.mask).map(|cell| centre(&geometry.grid, cell)).collect()
}

/// Frames as an instrument of complex gain `gain` files them.
fn filed(toy: &Toy, frames: &[Vec<f64>], arrangement: &Arrangement, gain: Complex64) -> Frames {
    let map = arrangement.index_map(&toy.steps, 16, 208).unwrap();
    let mut values = vec![Complex64::default(); 208 * frames.len()];
    for (frame, file) in frames.iter().zip(values.chunks_exact_mut(208)) {
        for (place, value) in map.iter().zip(frame) {
            file[place.index] = gain * if place.flipped { -value } else { *value };
        }
    }
    Frames { values, frames: frames.len(), measurements: 208, complex: true }
}

#[test]
fn an_object_is_placed_right_whatever_the_instrument() {
    let toy = Toy::new();
    let frames = [toy.touched(0.02, -0.01, 0.01), toy.touched(-0.015, 0.02, -0.01)];
    let relative = Arrangement { sense: SenseOrder::Relative, rotation: 5, mirrored: true };
    for used in [Arrangement::default(), relative] {
        for gain in [Complex64::from(1.0), Complex64::from(-4e6), Complex64::from_polar(1e-3, 2.0)] {
            let reference = filed(&toy, &[toy.voltages.clone(), toy.voltages.clone()], &used, gain);
            let frames = filed(&toy, &frames, &used, gain);
            let results = toy.reconstruct(&reference, &frames, &used, Polarity::Auto).unwrap();
            let up = results[0].objects[0];
            assert!((up.x_mm - 20.0).abs() < 2.0 && (up.y_mm + 10.0).abs() < 2.0, "{up:?}");
            assert!(
                (up.angle_degrees + 26.6).abs() < 6.0 && (up.radius_percent - 44.7).abs() < 5.0,
                "{up:?}"
            );
            assert_eq!((results[0].polarity, results[1].polarity), (Polarity::Up, Polarity::Down));
            let down = results[1].objects[0];
            assert!((down.x_mm + 15.0).abs() < 2.0 && (down.y_mm - 20.0).abs() < 2.0, "{down:?}");
            assert!(results[0].peak > 0.0 && results[1].peak < 0.0);
            assert!((down.peak - results[1].peak).abs() < 1e-6 * results[1].peak.abs());
        }
    }
}

#[test]
fn the_polarity_asked_for_is_looked_for() {
    let toy = Toy::new();
    let plain = Arrangement::default();
    let file = |frames: &[Vec<f64>]| filed(&toy, frames, &plain, 1.0.into());
    let frames = file(&[toy.touched(0.02, -0.01, 0.01)]);
    let reference = file(std::slice::from_ref(&toy.voltages));
    let result = |polarity| toy.reconstruct(&reference, &frames, &plain, polarity).unwrap().remove(0);
    assert_eq!(result(Polarity::Up), result(Polarity::Auto));
    let down = result(Polarity::Down);
    assert!(down.peak < 0.0 && down.peak.abs() < result(Polarity::Up).peak);
}

#[test]
fn an_unchanged_frame_shows_nothing() {
    let toy = Toy::new();
    let plain = Arrangement::default();
    let reference = filed(&toy, std::slice::from_ref(&toy.voltages), &plain, 1.0.into());
    let result = toy.reconstruct(&reference, &reference, &plain, Polarity::Auto).unwrap().remove(0);
    assert_eq!(result.peak, 0.0);
    assert!(result.objects.is_empty());
}

#[test]
fn frames_that_do_not_fit_are_refused() {
    let toy = Toy::new();
    let plain = Arrangement::default();
    let frames = |measurements: usize, value: f64| Frames {
        values: vec![value.into(); measurements],
        frames: 1,
        measurements,
        complex: false,
    };
    let error = |reference, measured| {
        toy.reconstruct(&reference, &measured, &plain, Polarity::Auto).unwrap_err().to_string()
    };
    assert!(error(frames(208, 1.0), frames(256, 1.0)).contains("256 measurements each, the reference 208"));
    assert!(error(frames(16, 1.0), frames(16, 1.0)).contains("allowed are 208"));
    assert!(error(frames(208, 0.0), frames(208, 1.0)).contains("every measurement of the reference is zero"));
}

#[test]
fn few_of_many_frames_are_evenly_spaced_and_keep_the_ends() {
    assert_eq!(evenly_spaced(3, 20), [0, 1, 2]);
    assert_eq!(evenly_spaced(11, 3), [0, 5, 10]);
    assert_eq!(evenly_spaced(5, 1), [0]);
    let many = evenly_spaced(1_000_000, 20);
    assert_eq!((many.len(), many[0], many[19]), (20, 0, 999_999));
    assert!(many.windows(2).all(|pair| pair[0] < pair[1]));
}

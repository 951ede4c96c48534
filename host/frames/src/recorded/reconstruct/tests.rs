use super::*;
use crate::recorded::order::SenseOrder;
use dermatome_model::skin::Skin;
use dermatome_simulate::{Noise, Press, Script, SimulatedSkin};
use num_complex::Complex64;
use std::path::Path;

/// A coarse skin, its model, and a simulation of it on another mesh.
struct Toy {
    model: Model,
    simulated: SimulatedSkin,
    voltages: Vec<f64>,
}

impl Toy {
    fn new() -> Self {
        let text = include_str!("../../../../../models/square-50mm/skin.toml");
        let mut skin = Skin::parse(Path::new("skin.toml"), text).unwrap().made().unwrap();
        skin.edges = skin.edges.scaled(2.0);
        let model = Model::build(&skin, |_| ()).unwrap();
        let (script, noise) = (Script::round(skin.shape.flat().unwrap()), Noise { snr_db: 200.0, seed: 1 });
        let simulated = SimulatedSkin::new(&skin, script, noise).unwrap();
        let voltages = simulated.voltages(&model.steps, &[]);
        Self { model, simulated, voltages }
    }

    fn reconstruct(
        &self,
        reference: &Frames,
        frames: &Frames,
        used: &Arrangement,
        polarity: Polarity,
    ) -> Result<Vec<FrameResult>, ReconstructError> {
        reconstruct(&self.model, Reference::Mean(reference), frames, used, polarity)
    }

    /// Voltages with an object of this conductivity change at x, y.
    fn touched(&self, x: f64, y: f64, change: f64) -> Vec<f64> {
        let press = Press::finger([x, y], 0.004, change);
        self.simulated.voltages(&self.model.steps, &[press])
    }
}

/// Frames as an instrument of complex gain `gain` files them.
fn filed(toy: &Toy, frames: &[Vec<f64>], arrangement: &Arrangement, gain: Complex64) -> Frames {
    let map = arrangement.index_map(&toy.model.steps, 16, 208).unwrap();
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
    let frames = [toy.touched(0.012, -0.006, 0.5), toy.touched(-0.008, 0.012, -0.5)];
    let relative = Arrangement { sense: SenseOrder::Relative, rotation: 5, mirrored: true };
    for used in [Arrangement::default(), relative] {
        for gain in [Complex64::from(1.0), Complex64::from(-4e6), Complex64::from_polar(1e-3, 2.0)] {
            let reference = filed(&toy, &[toy.voltages.clone(), toy.voltages.clone()], &used, gain);
            let frames = filed(&toy, &frames, &used, gain);
            let results = toy.reconstruct(&reference, &frames, &used, Polarity::Auto).unwrap();
            let up = results[0].objects[0];
            assert!((up.x_mm - 12.0).abs() < 1.0 && (up.y_mm + 6.0).abs() < 1.0, "{up:?}");
            assert!(
                (up.angle_degrees + 26.6).abs() < 6.0 && (up.radius_percent - 53.7).abs() < 5.0,
                "{up:?}"
            );
            assert_eq!((results[0].polarity, results[1].polarity), (Polarity::Up, Polarity::Down));
            let down = results[1].objects[0];
            assert!((down.x_mm + 8.0).abs() < 1.0 && (down.y_mm - 12.0).abs() < 1.0, "{down:?}");
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
    let frames = file(&[toy.touched(0.012, -0.006, 0.5)]);
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

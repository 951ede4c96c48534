//! The simulated skin: presses -> conductivity -> true voltages -> noisy codes.

use super::{Press, Script, TrueSkin};
use crate::{model::ModelError, skin::Skin};
use dermatome_shared::{frame::FrameFlags, stimulation::Step, units::AdcCode};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64Mcg;

/// Signed codes of the lock-in: a 12-bit converter summed over 16 samples.
const CODE_BITS: i32 = 16;
/// The largest untouched voltage fills this share of the converter's range.
const FILL: f64 = 0.8;

/// Measurement noise: white, Gaussian, the same on every step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// Signal-to-noise ratio, dB: root mean square of the untouched voltages over all steps,
    /// against the noise's standard deviation.
    pub snr_db: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// A skin being pressed by a script.
#[derive(Debug)]
pub struct SimulatedSkin {
    truth: TrueSkin,
    script: Script,
    noise: Noise,
    random: Pcg64Mcg,
    /// Scale of the running patch, found from its steps on first use.
    converter: Option<Converter>,
}

#[derive(Clone, Debug)]
struct Converter {
    steps: Vec<Step>,
    untouched: Vec<f64>,
    noise: f64,
    codes_per_unit: f64,
}

impl SimulatedSkin {
    /// Meshes the skin; ready to be scanned.
    pub fn new(skin: &Skin, script: Script, noise: Noise) -> Result<Self, ModelError> {
        let truth = TrueSkin::new(skin)?;
        Ok(Self { truth, script, noise, random: Pcg64Mcg::seed_from_u64(noise.seed), converter: None })
    }

    /// Elements of the simulation's own mesh.
    #[must_use]
    pub fn elements(&self) -> usize {
        self.truth.mesh().elements.len()
    }

    /// One scan, `script_time` seconds into the script, or of the untouched skin.
    pub fn measure(&mut self, steps: &[Step], script_time: Option<f64>) -> (Vec<AdcCode>, FrameFlags) {
        let converter = self.converter_for(steps);
        let presses = script_time.map(|time| self.script.presses(time)).unwrap_or_default();
        let voltages =
            if presses.is_empty() { converter.untouched.clone() } else { self.voltages(steps, &presses) };
        let noise =
            Normal::new(0.0, converter.noise).expect("a standard deviation is finite and not negative");
        let mut flags = FrameFlags::default();
        let limit = 2_f64.powi(CODE_BITS - 1) - 1.0;
        let mut convert = |voltage: f64| {
            let code = ((voltage + noise.sample(&mut self.random)) * converter.codes_per_unit).round();
            if code.abs() > limit {
                flags.insert(FrameFlags::SATURATED);
            }
            AdcCode(code.clamp(-limit, limit) as i32)
        };
        let codes = voltages.iter().map(|&voltage| convert(voltage)).collect();
        (codes, flags)
    }

    /// True voltages under these presses: `[step]`, at unit current and conductivity.
    #[must_use]
    pub fn voltages(&self, steps: &[Step], presses: &[Press]) -> Vec<f64> {
        self.truth.voltages(&self.truth.conductivity(presses), steps)
    }

    /// Gain and noise for a stimulation table, set once, as a board sets its gain.
    fn converter_for(&mut self, steps: &[Step]) -> Converter {
        if let Some(converter) = self.converter.as_ref().filter(|converter| converter.steps == steps) {
            return converter.clone();
        }
        let untouched = self.voltages(steps, &[]);
        let largest = untouched.iter().fold(0.0, |max: f64, v| max.max(v.abs()));
        let mean_square = untouched.iter().map(|v| v * v).sum::<f64>() / untouched.len() as f64;
        let converter = Converter {
            steps: steps.to_vec(),
            untouched,
            noise: mean_square.sqrt() * 10_f64.powf(-self.noise.snr_db / 20.0),
            codes_per_unit: FILL * 2_f64.powi(CODE_BITS - 1) / largest,
        };
        self.converter.insert(converter).clone()
    }
}

//! Check of a whole file of frames against a skin: what is wrong with it, and what to change.
//!
//! The file is taken to hold the skin's stimulation table, or the full square, in its own electrode
//! numbers. What is `expected` of any pairs, by the model or by good frames, follows from the transfer impedances of
//! the electrodes, so any numbering can be tried, whatever the table. A [`reading`] says how the file is read; `likeness` how
//! like the model the frame is then; `causes` looks for what makes it more like: other orders, rotations, mirroring,
//! exchanged electrodes, an offset, potentials, values in other places of the frame. Then [`polarity`],
//! [`electrodes`], [`gain`], [`reciprocity`] and [`signal`] look for faults of the instrument, and [`findings`] puts
//! it all in words.

mod causes;
pub mod electrodes;
mod expected;
pub mod findings;
pub mod gain;
mod likeness;
pub mod numbering;
pub mod offset;
pub mod polarity;
pub mod reading;
pub mod reciprocity;
pub mod signal;
pub mod wiring;

pub use expected::{Expected, GoodFramesError, KnownBy};

use super::{
    diagnose::DEAD,
    order::{Arrangement, OrderError},
    read::Frames,
    statistics::median,
};
use causes::Explained;
use dermatome_model::stimulation::Repetition;
use dermatome_shared::stimulation::Step;
use electrodes::ElectrodeCheck;
use findings::Finding;
use gain::PairGain;
use likeness::Comparison;
use num_complex::Complex64;
use numbering::Numbering;
use offset::Offset;
use polarity::Polarity;
use reading::Misplacement;
use reciprocity::Agreement;
use serde::Serialize;
use signal::{Repeats, Saturation, Steadiness};

/// Of a magnitude that is smaller than so many standard errors noise says more than the skin.
const BLUR: f64 = 3.0;

/// A voltage of the model whose magnitude, with the blur, is so many times the blur has a certain sign.
const CLEAR: f64 = 2.0;

/// Everything that was found out about a file. Steps and electrodes count from 0; electrodes are
/// numbered as the file does.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// What they are compared with.
    pub compared_with: KnownBy,
    /// Frames in the file.
    pub frames: usize,
    /// Measurements in each.
    pub measurements: usize,
    /// Whether they are complex.
    pub complex: bool,
    /// Whether a frame is the full square, of which the pattern's measurements are used.
    pub square: bool,
    /// Whether the square holds potentials of electrodes; all else is about their differences then.
    pub single_ended: bool,
    /// Correlation of log magnitudes with what is expected as the file is read, before anything is explained.
    pub plain_correlation: f64,
    /// Order and electrode numbers.
    pub numbering: Numbering,
    /// Signs.
    pub polarity: Polarity,
    /// What stands in other places of the frame than where it belongs.
    pub misplaced: Vec<Misplacement>,
    /// A constant in every value.
    pub offset: Option<Offset>,
    /// Pairs that read too much or too little throughout.
    pub gains: Vec<PairGain>,
    /// Each electrode: `[electrode]`.
    pub electrodes: Vec<ElectrodeCheck>,
    /// Correlation of log magnitudes with what is expected without the electrodes that are off.
    pub sound_correlation: f64,
    /// Steps whose mean is zero.
    pub dead_steps: Vec<usize>,
    /// Steps with drive and sense exchanged.
    pub reciprocity: Option<Agreement>,
    /// Steps that differ in direction only, or not at all.
    pub reversal: Option<Agreement>,
    /// Noise and drift; needs a few frames.
    pub steadiness: Option<Steadiness>,
    /// Values at the end of the range.
    pub saturation: Option<Saturation>,
    /// Frames that come more than once.
    pub repeats: Repeats,
    /// What is left unlike the model: mean magnitude of the logarithm of measured over expected, between steps that are
    /// the same but for a turn,
    pub scatter: f64,
    /// and of all such steps together.
    pub bias: f64,
    /// What looks wrong, and what to change; whoever shows it says which settings do that.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

/// Checks frames of an untouched skin, or of one that is touched here and there, as `used` reads them.
pub fn check(expected: &Expected, frames: &Frames, used: Arrangement) -> Result<Check, OrderError> {
    let reference = Reference::of(frames);
    let comparison = Comparison::new(expected, &reference);
    let causes = causes::find(&comparison, used)?;
    let last = &causes[causes.len() - 1];
    let apart =
        last.reading.potentials.map(|_| reading::apart(expected, frames, &last.reading)).transpose()?;
    let single_ended = apart.is_some();
    let frames = apart.as_ref().unwrap_or(frames);
    let readings = Readings::of(expected, frames, last)?;
    let wired: Vec<Step> = expected.steps.iter().map(|&step| last.reading.wiring.step(step)).collect();
    let electrodes = electrodes::check(expected, &readings);
    let mut check = Check {
        compared_with: expected.known_by(),
        frames: frames.frames,
        measurements: frames.measurements,
        complex: frames.complex,
        square: frames.measurements != expected.steps.len(),
        polarity: Polarity::of(expected, &readings),
        sound_correlation: electrodes::sound_correlation(expected, &readings, &electrodes),
        electrodes: electrodes.clone(),
        dead_steps: readings.dead(),
        reciprocity: Agreement::of(&wired, &readings, &[Repetition::Reciprocal]),
        reversal: Agreement::of(&wired, &readings, &[Repetition::Reversed, Repetition::Identical]),
        steadiness: Steadiness::of(frames, &readings),
        saturation: Saturation::of(frames, &readings),
        repeats: Repeats::of(frames),
        single_ended,
        numbering: Numbering::of(&comparison, last, used)?,
        plain_correlation: causes[0].likeness.correlation(),
        misplaced: last.reading.misplaced.clone(),
        offset: Offset::of(&causes),
        gains: gains_of_sound(&electrodes, last, gain::find(expected, &wired, &readings)),
        scatter: last.likeness.scatter,
        bias: last.likeness.bias,
        findings: Vec::new(),
    };
    check.findings = findings::all(expected, &check);
    Ok(check)
}

/// Pairs of which no electrode is off or exchanged with another.
fn gains_of_sound(
    electrodes: &[ElectrodeCheck],
    explained: &Explained,
    mut gains: Vec<PairGain>,
) -> Vec<PairGain> {
    let exchanged = &explained.reading.exchanged;

    let is_off = |&electrode: &u8| {
        let electrode = electrodes[usize::from(electrode)];
        let is_exchanged = exchanged.iter().any(|it| it.electrodes.contains(&electrode.electrode));
        electrode.drive_is_off() || electrode.sense_is_off() || is_exchanged
    };
    gains.retain(|gain| !gain.electrodes.iter().any(is_off));
    gains
}

/// Mean of the frames: `[index in a frame]`.
struct Reference {
    values: Vec<Complex64>,
    /// Standard deviation of the noise of one frame, along the mean; 0 where there are too few frames.
    noise: Vec<f64>,
    /// Times that noise is what it may well add to the mean.
    blur: f64,
}

impl Reference {
    fn of(frames: &Frames) -> Self {
        let blur = BLUR / (frames.frames as f64).sqrt();
        Self { values: frames.mean(), noise: signal::noise(frames), blur }
    }

    /// The value in a place, minus another one or an offset, and what noise may add to it.
    fn value(&self, place: usize, other: Option<usize>, offset: Complex64) -> (Complex64, f64) {
        let blur = |place: usize| self.blur * self.noise[place];
        match other {
            Some(other) => (self.values[place] - self.values[other], blur(place).hypot(blur(other))),
            None => (self.values[place] - offset, blur(place)),
        }
    }
}

/// The reference step by step, read as explained: `[step]`, in the file's electrode numbers.
struct Readings {
    /// Index in a frame.
    indices: Vec<usize>,
    measured: Vec<Complex64>,
    /// Of one frame.
    noise: Vec<f64>,
    /// Magnitude below which neither size nor sign say much.
    blur: Vec<f64>,
    /// What the model says of the electrodes behind the file's numbers.
    model: Vec<f64>,
    /// Signed logarithm of measured over model, without what its class has in common.
    residuals: Vec<f64>,
    /// Logarithms of magnitude, model and measured.
    logarithms: Vec<(f64, f64)>,
    /// Magnitude up to which a measurement is dead.
    floor: f64,
}

impl Readings {
    fn of(expected: &Expected, frames: &Frames, explained: &Explained) -> Result<Self, OrderError> {
        let Explained { reading, likeness } = explained;
        let reference = Reference::of(frames);
        let places = reading.places(&expected.steps, expected.electrodes, frames.measurements)?;
        let indices: Vec<usize> = places.into_iter().map(|(place, _)| place).collect();
        let measured: Vec<_> =
            indices.iter().map(|&index| reference.values[index] - reading.offset).collect();
        Ok(Self {
            blur: likeness.unknown.iter().map(|unknown| unknown * likeness.gain).collect(),
            noise: indices.iter().map(|&index| reference.noise[index]).collect(),
            floor: DEAD * median(measured.iter().map(|value| value.norm())),
            model: expected.steps.iter().map(|&step| expected.voltage(reading.wiring.step(step))).collect(),
            residuals: likeness.residuals.clone(),
            logarithms: likeness.logarithms().collect(),
            measured,
            indices,
        })
    }

    fn is_dead(&self, step: usize) -> bool {
        self.measured[step].norm() <= self.floor
    }

    fn dead(&self) -> Vec<usize> {
        (0..self.measured.len()).filter(|&step| self.is_dead(step)).collect()
    }

    /// Whether neither noise nor the model's errors leave the sign of a step uncertain.
    fn is_clear(&self, step: usize) -> bool {
        let (model, measured) = self.logarithms[step];
        let blur = self.blur[step];
        // Logarithms are of magnitudes together with the blur.
        self.measured[step].norm() > blur
            && (model - measured).exp() * self.measured[step].norm().hypot(blur) > CLEAR * blur
    }

    /// What was measured, zero where the sign is not certain.
    fn clear(&self) -> Vec<Complex64> {
        let value = |step: usize| if self.is_clear(step) { self.measured[step] } else { Complex64::ZERO };
        (0..self.measured.len()).map(value).collect()
    }
}

#[cfg(test)]
mod tests;

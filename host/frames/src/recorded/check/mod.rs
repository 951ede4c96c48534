//! Check of a whole file of frames against a skin: what is wrong with it, and what to change.
//!
//! The file is taken to hold the skin's stimulation table, or the full square, in its own electrode
//! numbers. The model's voltage of any pairs follows from the transfer impedances of the electrodes,
//! so any numbering can be tried, whatever the table: [`numbering`] tries other orders, rotations,
//! mirroring and exchanged electrodes. Then [`offset`], [`polarity`], [`electrodes`], [`reciprocity`]
//! and [`signal`] look for faults of the instrument, and [`findings`] puts it all in words.

pub mod electrodes;
pub mod findings;
pub mod numbering;
pub mod offset;
pub mod polarity;
pub mod reciprocity;
pub mod signal;
mod single_ended;

use super::{
    diagnose::DEAD,
    order::{Arrangement, OrderError},
    read::Frames,
    statistics::{median, pearson},
};
use dermatome_geometry::mesh::Lattice;
use dermatome_model::{
    forward::{Admittivity, Fields},
    model::{ModelError, forward_model, mesh},
    skin::Skin,
    stimulation::Repetition,
};
use dermatome_shared::stimulation::Step;
use electrodes::ElectrodeCheck;
use findings::Finding;
use num_complex::Complex64;
use numbering::{Numbering, Wiring};
use offset::Offset;
use polarity::Polarity;
use reciprocity::Agreement;
use serde::Serialize;
use signal::{Repeats, Saturation, Steadiness};

/// Of a magnitude that is smaller than so many standard errors noise says more than the skin.
const BLUR: f64 = 3.0;

/// What a skin should measure: its table, and in-phase voltages between any electrodes.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Stimulation table: `[step]`.
    pub steps: Vec<Step>,
    electrodes: u8,
    /// Potential at one electrode for unit current into another, relative: `[at][driven]`.
    transfer: Vec<f64>,
}

impl Expected {
    /// Solves the untouched skin.
    pub fn of(skin: &Skin) -> Result<Self, ModelError> {
        let admittivity = skin.admittivity();
        if admittivity.im == 0.0 { solve(skin, admittivity.re) } else { solve(skin, admittivity) }
    }

    /// From transfer impedances `[at][driven]`.
    #[must_use]
    pub fn new(steps: Vec<Step>, electrodes: u8, transfer: impl Fn(usize, usize) -> f64) -> Self {
        let n = usize::from(electrodes);
        Self { steps, electrodes, transfer: (0..n * n).map(|i| transfer(i / n, i % n)).collect() }
    }

    /// Number of electrodes.
    #[must_use]
    pub fn electrodes(&self) -> u8 {
        self.electrodes
    }

    /// Voltage of any step, relative.
    #[must_use]
    pub fn voltage(&self, step: Step) -> f64 {
        let [dp, dm, sp, sm] = step.to_bytes().map(usize::from);
        let at = |at: usize, driven: usize| self.transfer[at * usize::from(self.electrodes) + driven];
        (at(sp, dp) - at(sp, dm)) - (at(sm, dp) - at(sm, dm))
    }
}

fn solve<T: Admittivity>(skin: &Skin, admittivity: T) -> Result<Expected, ModelError> {
    let mesh = mesh(skin, 1.0, Lattice::default())?;
    let fields: Fields<T> = forward_model(skin, &mesh)?.solve(&vec![admittivity; mesh.elements.len()])?;
    let transfer = |at, driven| fields.transfer(at, driven).in_phase();
    Ok(Expected::new(skin.steps(), skin.electrodes.count, transfer))
}

/// Everything that was found out about a file. Steps and electrodes count from 0; electrodes are
/// numbered as the file does.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
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
    /// Order and electrode numbers.
    pub numbering: Numbering,
    /// Signs.
    pub polarity: Polarity,
    /// A constant in every value.
    pub offset: Option<Offset>,
    /// Each electrode: `[electrode]`.
    pub electrodes: Vec<ElectrodeCheck>,
    /// Correlation of log magnitudes with the model without the electrodes that are off.
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
    /// What looks wrong, and what to change; whoever shows it says which settings do that.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

/// Checks frames of an untouched skin, or of one that is touched here and there, as `used` reads them.
pub fn check(expected: &Expected, frames: &Frames, used: Arrangement) -> Result<Check, OrderError> {
    let differences = single_ended::differences(expected, frames, used)?;
    let single_ended = differences.is_some();
    let frames = differences.as_ref().unwrap_or(frames);
    let mut reference = Reference::of(frames);
    let offset = offset::find(expected, &reference, used)?;
    if let Some(offset) = &offset {
        reference.values = offset.without(&reference.values);
    }
    let (numbering, wiring) = numbering::find(expected, &reference, used)?;
    let readings = Readings::of(expected, &reference, &wiring)?;
    let electrodes = electrodes::check(expected, &readings);
    let mut check = Check {
        frames: frames.frames,
        measurements: frames.measurements,
        complex: frames.complex,
        square: frames.measurements != expected.steps.len(),
        polarity: Polarity::of(expected, &readings),
        sound_correlation: electrodes::sound_correlation(expected, &readings, &electrodes),
        electrodes,
        dead_steps: readings.dead(),
        reciprocity: Agreement::of(&expected.steps, &readings, &[Repetition::Reciprocal]),
        reversal: Agreement::of(&expected.steps, &readings, &[Repetition::Reversed, Repetition::Identical]),
        steadiness: Steadiness::of(frames, &readings),
        saturation: Saturation::of(frames, &readings),
        repeats: Repeats::of(frames),
        single_ended,
        numbering,
        offset,
        findings: Vec::new(),
    };
    check.findings = findings::all(expected, &check);
    Ok(check)
}

/// Mean of the frames: `[index in a frame]`.
struct Reference {
    values: Vec<Complex64>,
    /// Standard deviation of the noise of one frame, along the mean; 0 where there are too few frames.
    noise: Vec<f64>,
    frames: usize,
}

impl Reference {
    fn of(frames: &Frames) -> Self {
        Self { values: frames.mean(), noise: signal::noise(frames), frames: frames.frames }
    }
}

/// The reference step by step: `[step]`, in the file's electrode numbers.
struct Readings {
    /// Index in a frame.
    indices: Vec<usize>,
    measured: Vec<Complex64>,
    /// Of one frame.
    noise: Vec<f64>,
    /// Magnitude that noise alone may give the mean.
    blur: Vec<f64>,
    /// What the model says of the electrodes behind the file's numbers.
    model: Vec<f64>,
    /// Magnitude up to which a measurement is dead.
    floor: f64,
}

impl Readings {
    fn of(expected: &Expected, reference: &Reference, wiring: &Wiring) -> Result<Self, OrderError> {
        let steps = &expected.steps;
        let indices = wiring.arrangement.file_indices(steps, expected.electrodes, reference.values.len())?;
        let measured: Vec<_> = indices.iter().map(|&index| reference.values[index]).collect();
        let noise: Vec<f64> = indices.iter().map(|&index| reference.noise[index]).collect();
        let blur = BLUR / (reference.frames as f64).sqrt();
        Ok(Self {
            blur: noise.iter().map(|noise| blur * noise).collect(),
            noise,
            floor: DEAD * median(measured.iter().map(|value| value.norm())),
            model: steps.iter().map(|&step| expected.voltage(wiring.step(step))).collect(),
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

    /// What was measured, zero where noise decides the sign.
    fn clear(&self) -> Vec<Complex64> {
        let steps = self.measured.iter().zip(&self.blur);
        steps.map(|(value, &blur)| if value.norm() > blur { *value } else { Complex64::ZERO }).collect()
    }

    /// Logarithms of magnitude, model and measured, both blurred by the noise; `None` where one of them is zero.
    fn logarithms(&self) -> Vec<Option<(f64, f64)>> {
        let magnitudes = |step: usize| {
            let (model, measured) = (self.model[step].abs(), self.measured[step].norm());
            (model > 0.0 && measured > self.floor).then_some((model, measured))
        };
        let steps = 0..self.measured.len();
        let scale = median(steps.clone().filter_map(magnitudes).map(|(model, measured)| measured / model));
        let of_step = |step: usize| {
            let (model, measured) = magnitudes(step)?;
            let blur = self.blur[step];
            Some((model.hypot(blur / scale).ln(), measured.hypot(blur).ln()))
        };
        steps.map(of_step).collect()
    }

    /// Logarithm of recorded over model magnitude, against their median: `[step]`.
    fn residuals(&self) -> Vec<Option<f64>> {
        let ratios: Vec<_> = self
            .logarithms()
            .into_iter()
            .map(|pair| pair.map(|(model, measured)| measured - model))
            .collect();
        let median = median(ratios.iter().flatten().copied());
        ratios.into_iter().map(|ratio| ratio.map(|ratio| ratio - median)).collect()
    }

    fn correlation(&self) -> f64 {
        pearson(&self.logarithms().into_iter().flatten().collect::<Vec<_>>())
    }
}

#[cfg(test)]
mod tests;

//! Sample rig: a sample, an instrument and a board, all simulated; what the board shows is what counts.
//!
//! The true skin is solved on a mesh of its own with the [`Artefacts`] of the rig; its voltages become codes, and the
//! codes go through the patch and the code that a board runs ([`Observer`]). Nothing here reconstructs in floating
//! point.

use super::ExperimentError;
use crate::{
    deform::{slip, stretch},
    evaluate::electrodes::{spacing, with_errors},
};
use dermatome_model::{
    metrics::{Target, thesis},
    model::Model,
    skin::Skin,
};
use dermatome_shared::{contact::Contact, frame::Frame, reference::DEFAULT_TARE_FRAMES};
use dermatome_simulate::{
    Noise, Rig, TrueSkin,
    noise::root_mean_square,
    rig::{Observer, SETTLED},
};
use nalgebra::Point3;
use num_complex::Complex64;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use std::f64::consts::PI;

/// Frames averaged for each load (thesis section 4.1.1).
pub(super) const FRAMES: u16 = DEFAULT_TARE_FRAMES;
/// A contact's peak is at least so many standard deviations of the noise in the noisiest pixel.
const CLEAR_OF_NOISE: f64 = 6.0;

/// What is wrong with the simulated measurements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Artefacts {
    /// Signal-to-noise ratio of one frame, dB, as in [`Noise`].
    pub(super) snr_db: f64,
    /// Standard deviation of the electrodes' places along the rim, share of their spacing.
    pub(super) electrode_shift: f64,
    /// Standard deviation of the contact impedances against the model's, relative.
    pub(super) impedance: f64,
    /// What each load does besides pressing: each electrode slips by this length along the rim, m, one way or the
    /// other, and the sheet is longer by this share in one direction, both against the tare.
    pub(super) slip: f64,
    pub(super) stretch: f64,
}

impl Artefacts {
    /// Salt water: noise, and electrodes glued in by hand.
    pub(super) const SALINE: Self =
        Self { snr_db: 60.0, electrode_shift: 0.01, impedance: 0.1, slip: 0.0, stretch: 0.0 };
    /// Electrodes pressed or pierced into a sheet, both of which a load moves.
    pub(super) const SHEET: Self =
        Self { snr_db: 60.0, electrode_shift: 0.02, impedance: 0.2, slip: 0.5e-3, stretch: 0.01 };

    /// The same in frames that follow each other at once, in which nothing moves.
    pub(super) const MOVING: Self = Self { slip: 0.0, stretch: 0.0, ..Self::SHEET };

    /// In words.
    pub(super) fn words(&self) -> String {
        let mut words = format!(
            "white noise at {} dB in each frame; true electrodes off by {} % of their spacing (s.d.), contact \
             impedances by {} %",
            self.snr_db,
            100.0 * self.electrode_shift,
            100.0 * self.impedance
        );
        if self.slip > 0.0 || self.stretch > 0.0 {
            words += &format!(
                "; with each load, anew, each electrode slips by {} mm one way or the other, and the sheet stretches by {} % in \
                 one direction",
                1e3 * self.slip,
                100.0 * self.stretch
            );
        }
        words
    }
}

/// A skin of the thesis with the artefacts of its rig, observed by one board.
#[derive(Debug)]
pub(super) struct SampleRig {
    /// As the model has it.
    pub(super) skin: Skin,
    /// With errors.
    true_skin: Skin,
    rig: Rig,
    observer: Observer,
    artefacts: Artefacts,
    random: Pcg64Mcg,
    /// Frames averaged in [`Self::show`].
    averaged: u16,
    /// Mean codes of the tare: `[step]`.
    reference: Vec<f64>,
    /// -1 where a fall of conductivity is looked for.
    sign: f64,
}

/// What the board shows of one load: the mean over the frames averaged.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Shown {
    /// Relative conductivity change, upright: `[pixel]`.
    pub(super) image: Vec<f64>,
    /// Contacts in that image, by the board's code, strongest first.
    pub(super) contacts: Vec<Contact>,
    /// dV/V, thesis equation 3.2.
    pub(super) voltage_change: f64,
}

impl SampleRig {
    /// Puts a skin on the rig, to be shown by the mean of so many frames; it is not tared yet.
    ///
    /// The threshold of contacts is set clear of the noise of that mean.
    pub(super) fn new(
        mut skin: Skin,
        artefacts: Artefacts,
        averaged: u16,
        seed: u64,
    ) -> Result<Self, ExperimentError> {
        // The thesis sets its reference once; a board's would follow slow drift.
        skin.drift_time = Some(0.0);
        let model = Model::build(&skin, |_| ())?;
        let noise = model.image_noise(artefacts.snr_db) / f64::from(averaged).sqrt();
        skin.contact_threshold = CLEAR_OF_NOISE * noise;
        let observer = Observer::with_model(&skin, model)?;
        let shift = artefacts.electrode_shift * spacing(&skin).unwrap_or(0.0);
        let true_skin = with_errors(&skin, shift, artefacts.impedance, seed)?;
        let noise = Noise { snr_db: artefacts.snr_db, seed };
        Ok(Self {
            rig: Rig::new(&true_skin, &observer.patch(), noise)?,
            skin,
            true_skin,
            observer,
            artefacts,
            random: Pcg64Mcg::seed_from_u64(!seed),
            averaged,
            reference: Vec::new(),
            sign: 1.0,
        })
    }

    /// The same with inverted polarity: looking for a fall of conductivity.
    pub(super) fn inverted(self) -> Self {
        Self { sign: -1.0, ..self }
    }

    /// What its images are made with.
    pub(super) fn model(&self) -> &Model {
        self.observer.model()
    }

    /// The true skin.
    pub(super) fn truth(&self) -> &TrueSkin {
        self.rig.truth()
    }

    /// Elements of the true skin.
    pub(super) fn elements(&self) -> usize {
        self.rig.skin().elements()
    }

    /// Larger side of the skin, m.
    pub(super) fn side(&self) -> f64 {
        self.model().pixels.larger_side()
    }

    /// Averages the reference over a sheet of this relative conductivity, `[element]` of the true skin.
    pub(super) fn tare(&mut self, conductivity: &[f64]) {
        let frames = self.rig.tare(conductivity);
        self.reference = mean_codes(&frames);
        self.observer.tare(&frames);
    }

    /// Shows a sheet of this relative conductivity, `[element]` of the true skin.
    pub(super) fn show(&mut self, conductivity: &[f64]) -> Result<Shown, ExperimentError> {
        let phasors = match self.moved()? {
            Some(truth) => self.rig.solve_on(&truth, conductivity),
            None => self.rig.solve(conductivity),
        };
        let frames = self.rig.scans(&phasors, self.averaged);
        let mut image = vec![0.0; self.model().pixels.count()];
        let sign = self.sign / f64::from(self.averaged);
        for frame in &frames {
            let seen = self.observer.observe(frame).image();
            image.iter_mut().zip(seen).for_each(|(sum, value)| *sum += sign * value.to_f64());
        }
        let voltage_change = voltage_change(&mean_codes(&frames), &self.reference);
        Ok(Shown { contacts: self.observer.contacts(&image), voltage_change, image })
    }

    /// What a scan meets on a sheet of this relative conductivity, for [`Self::glance`].
    pub(super) fn solve(&self, conductivity: &[f64]) -> Vec<Complex64> {
        self.rig.solve(conductivity)
    }

    /// Contacts that the board reports of one single frame.
    pub(super) fn glance(&mut self, phasors: &[Complex64]) -> Vec<Contact> {
        let frame = self.rig.scan(phasors);
        self.observer.observe(&frame).contacts().to_vec()
    }

    /// Contacts that the board reports once it had time to find all.
    pub(super) fn settle(&mut self, phasors: &[Complex64]) -> Vec<Contact> {
        (1..SETTLED).for_each(|_| {
            self.glance(phasors);
        });
        self.glance(phasors)
    }

    /// The true skin as a load leaves it, if loads move anything.
    fn moved(&mut self) -> Result<Option<TrueSkin>, ExperimentError> {
        let Artefacts { slip: by, stretch: share, .. } = self.artefacts;
        if by == 0.0 && share == 0.0 {
            return Ok(None);
        }
        let truth = self.rig.truth();
        let slipped = slip(truth.mesh(), by, &mut self.random)?;
        let nodes = stretch(&slipped, share, self.random.random_range(0.0..PI));
        Ok(Some(truth.moved(&self.true_skin, nodes)?))
    }

    /// Root mean square of what the artefacts of one load alone do to the voltages, share of each voltage.
    pub(super) fn artefacts_alone(&mut self) -> Result<f64, ExperimentError> {
        let untouched = vec![1.0; self.elements()];
        let Some(truth) = self.moved()? else { return Ok(0.0) };
        let steps = self.model().steps.len();
        let [before, after] = [self.rig.solve(&untouched), self.rig.solve_on(&truth, &untouched)];
        let pairs = before.iter().zip(&after).take(steps);
        let least = 0.01 * before.iter().take(steps).map(|voltage| voltage.norm()).fold(0.0, f64::max);
        let changes: Vec<f64> = pairs
            .filter(|(before, _)| before.norm() >= least)
            .map(|(before, after)| (after.re - before.re) / before.re)
            .collect();
        Ok(root_mean_square(changes.into_iter()))
    }

    /// The thesis' figures of what was shown, the load's centre being at `at`.
    pub(super) fn figures(&self, shown: &Shown, at: [f64; 2]) -> Option<thesis::Figures> {
        let target =
            Target { position: Point3::new(at[0], at[1], 0.0), amount: 1.0, skin_centre: Point3::origin() };
        thesis::figures(&shown.image, &self.model().pixels, &target)
    }
}

impl Shown {
    /// Offset of the strongest contact from where the load is, m.
    pub(super) fn offset(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let contact = self.contacts.first()?;
        Some([0, 1].map(|axis| f64::from(contact.position[axis]) - at[axis]))
    }
}

/// Mean codes of some frames: `[step]`.
fn mean_codes(frames: &[Frame]) -> Vec<f64> {
    let mut sums = vec![0.0; frames.first().map_or(0, |frame| frame.codes.len())];
    for frame in frames {
        let parts = frame.codes.iter().map(|code| f64::from(code.0) / frames.len() as f64);
        sums.iter_mut().zip(parts).for_each(|(sum, part)| *sum += part);
    }
    sums
}

/// dV/V of the steps that read at least a hundredth of what the largest reads: across a corner there is
/// next to nothing to divide by.
fn voltage_change(codes: &[f64], reference: &[f64]) -> f64 {
    let largest = reference.iter().fold(0.0, |largest: f64, code| largest.max(code.abs()));
    let worth = |code: &f64| if code.abs() < 0.01 * largest { 0.0 } else { *code };
    thesis::relative_voltage_change(codes, &reference.iter().map(worth).collect::<Vec<_>>())
}

//! Bench: a sample, an instrument and a board, all simulated; what the board shows is what counts.
//!
//! The true skin is solved on a mesh of its own with the artefacts of the [`Setup`]; its voltages
//! become codes, and the codes go through the patch and the code that a board runs
//! ([`pipeline::process`]). Nothing here reconstructs in floating point.

use super::ExperimentError;
use crate::evaluate::electrodes::{spacing, with_errors};
use dermatome_geometry::sheet::ElectrodeModel;
use dermatome_model::{
    metrics::{Target, thesis},
    model::Model,
    quantize,
    skin::Skin,
};
use dermatome_shared::{
    contact::{self, Contact},
    patch::PatchView,
    pipeline::{self, PipelineState},
    reference::DEFAULT_TARE_FRAMES,
    units::RelativeConductivity,
};
use dermatome_simulate::{
    Noise, Script, SimulatedSkin,
    board::{Scan, ScanTable},
};
use nalgebra::Point3;
use num_complex::Complex64;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

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
    /// Standard deviation by which each contact impedance differs from its value at the tare, anew for
    /// each load, relative.
    pub(super) disturbance: f64,
}

impl Artefacts {
    /// Salt water: noise, and electrodes glued in by hand.
    pub(super) const SALINE: Self =
        Self { snr_db: 60.0, electrode_shift: 0.01, impedance: 0.1, disturbance: 0.0 };
    /// Electrodes pressed or pierced into a sheet, which a load moves a little.
    pub(super) const SHEET: Self =
        Self { snr_db: 60.0, electrode_shift: 0.02, impedance: 0.2, disturbance: 0.05 };

    /// The same in frames that follow each other at once, in which nothing is knocked.
    pub(super) const MOVING: Self = Self { disturbance: 0.0, ..Self::SHEET };

    /// In words.
    pub(super) fn words(&self) -> String {
        let mut words = format!(
            "white noise at {} dB in each frame; true electrodes off by {} % of their spacing (s.d.), contact \
             impedances by {} %",
            self.snr_db,
            100.0 * self.electrode_shift,
            100.0 * self.impedance
        );
        if self.disturbance > 0.0 {
            words += &format!(", and by another {} % anew for each load", 100.0 * self.disturbance);
        }
        words
    }
}

/// A skin on the bench.
#[derive(Debug)]
pub(super) struct Bench {
    /// As the model has it.
    pub(super) skin: Skin,
    /// What its images are made with.
    pub(super) model: Model,
    patch: Vec<u8>,
    /// With errors.
    true_skin: Skin,
    simulated: SimulatedSkin,
    table: ScanTable,
    state: PipelineState,
    artefacts: Artefacts,
    random: Pcg64Mcg,
    /// Frames averaged in [`Self::show`].
    averaged: u16,
    sequence: u32,
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

impl Bench {
    /// Puts a skin on the bench, to be shown by the mean of so many frames; it is not tared yet.
    ///
    /// The threshold of contacts is set clear of the noise of that mean.
    pub(super) fn new(
        mut skin: Skin,
        artefacts: Artefacts,
        averaged: u16,
        seed: u64,
    ) -> Result<Self, ExperimentError> {
        // The thesis sets its reference once; a board's would follow slow drift.
        skin.drift_time = 0.0;
        let model = Model::build(&skin, |_| ())?;
        let noise = model.image_noise(artefacts.snr_db) / f64::from(averaged).sqrt();
        skin.contact_threshold = CLEAR_OF_NOISE * noise;
        let patch = quantize::patch(&skin, &model)?;
        let shift = artefacts.electrode_shift * spacing(&skin).unwrap_or(0.0);
        let true_skin = with_errors(&skin, shift, artefacts.impedance, seed)?;
        let still = Script::still(&[], skin.shape.flat().map_err(dermatome_model::model::ModelError::from)?)
            .expect("nothing to refuse");
        let noise = Noise { snr_db: artefacts.snr_db, seed };
        let simulated = SimulatedSkin::new(&true_skin, still, noise)?;
        let view = PatchView::open(&patch).map_err(quantize::PatchBuildError::Invalid)?;
        let table = ScanTable::new(&view, view.header.drive);
        Ok(Self {
            skin,
            model,
            patch,
            true_skin,
            simulated,
            table,
            state: PipelineState::default(),
            artefacts,
            random: Pcg64Mcg::seed_from_u64(!seed),
            averaged,
            sequence: 0,
            reference: Vec::new(),
            sign: 1.0,
        })
    }

    /// The same, looking for a fall of conductivity.
    pub(super) fn upside_down(self) -> Self {
        Self { sign: -1.0, ..self }
    }

    /// The true skin.
    pub(super) fn truth(&self) -> &dermatome_simulate::TrueSkin {
        self.simulated.truth()
    }

    /// Elements of the true skin.
    pub(super) fn elements(&self) -> usize {
        self.simulated.elements()
    }

    /// Larger side of the skin, m.
    pub(super) fn side(&self) -> f64 {
        self.model.pixels.larger_side()
    }

    /// Averages the reference over a sheet of this relative conductivity, `[element]` of the true skin.
    pub(super) fn tare(&mut self, conductivity: &[f64]) {
        self.state = PipelineState::default();
        self.state.start_tare(FRAMES);
        let phasors = self.simulated.solve(&self.table, conductivity);
        self.reference = self.frames(&phasors, FRAMES, |_| ());
    }

    /// Shows a sheet of this relative conductivity, `[element]` of the true skin.
    pub(super) fn show(&mut self, conductivity: &[f64]) -> Result<Shown, ExperimentError> {
        self.disturb()?;
        let phasors = self.simulated.solve(&self.table, conductivity);
        let mut image = vec![0.0; self.model.pixels.count()];
        let sign = self.sign / f64::from(self.averaged);
        let codes = self.frames(&phasors, self.averaged, |state| {
            for (sum, value) in image.iter_mut().zip(state.image()) {
                *sum += sign * value.to_f64();
            }
        });
        let voltage_change = voltage_change(&codes, &self.reference);
        Ok(Shown { contacts: self.contacts(&image), voltage_change, image })
    }

    /// What a scan sees of a sheet of this relative conductivity, for [`Self::glance`].
    pub(super) fn solve(&self, conductivity: &[f64]) -> Vec<Complex64> {
        self.simulated.solve(&self.table, conductivity)
    }

    /// Contacts that the board reports of one single frame.
    pub(super) fn glance(&mut self, phasors: &[Complex64]) -> Vec<Contact> {
        let scan = self.simulated.read(&self.table, phasors);
        self.process(&scan);
        self.state.contacts().to_vec()
    }

    /// Scans go through the board's code; gives their mean codes: `[step]`.
    fn frames(&mut self, phasors: &[Complex64], count: u16, mut see: impl FnMut(&PipelineState)) -> Vec<f64> {
        let mut sums = vec![0.0; self.table.steps.len()];
        for _ in 0..count {
            let scan = self.simulated.read(&self.table, phasors);
            sums.iter_mut()
                .zip(&scan.codes)
                .for_each(|(sum, code)| *sum += f64::from(code.0) / f64::from(count));
            self.process(&scan);
            see(&self.state);
        }
        sums
    }

    /// One scan through the board's code.
    fn process(&mut self, scan: &Scan) {
        self.sequence += 1;
        let period_us = 1e6 / f64::from(self.table.drive.frame_rate);
        let frame = scan.frame(self.sequence, (f64::from(self.sequence) * period_us) as u64);
        let view = PatchView::open(&self.patch).expect("the patch was valid when it was made");
        pipeline::process(&view, &mut self.state, &frame);
    }

    fn contacts(&self, image: &[f64]) -> Vec<Contact> {
        let view = PatchView::open(&self.patch).expect("the patch was valid when it was made");
        let codes: Vec<_> = image.iter().map(|&value| RelativeConductivity::from_f64(value)).collect();
        contact::find(&view.surface(), &codes, view.header.contact_threshold).to_vec()
    }

    /// Every contact impedance changes a little.
    fn disturb(&mut self) -> Result<(), ExperimentError> {
        let ElectrodeModel::Complete { contact_impedance, .. } = &self.true_skin.electrodes.model else {
            return Ok(());
        };
        if self.artefacts.disturbance == 0.0 {
            return Ok(());
        }
        let knocked: Vec<Complex64> = contact_impedance
            .iter()
            .map(|impedance| {
                let by: f64 = StandardNormal.sample(&mut self.random);
                Complex64::from(impedance * (self.artefacts.disturbance * by).exp())
            })
            .collect();
        Ok(self.simulated.change_contacts(&self.true_skin, &knocked)?)
    }

    /// The thesis' figures of what was shown, the load's centre being at `at`.
    pub(super) fn figures(&self, shown: &Shown, at: [f64; 2]) -> Option<thesis::Figures> {
        let target =
            Target { position: Point3::new(at[0], at[1], 0.0), amount: 1.0, skin_centre: Point3::origin() };
        thesis::figures(&shown.image, &self.model.pixels, &target)
    }
}

impl Shown {
    /// Offset of the strongest contact from where the load is, m.
    pub(super) fn offset(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        let contact = self.contacts.first()?;
        Some([0, 1].map(|axis| f64::from(contact.position[axis]) - at[axis]))
    }
}

/// dV/V of the steps that read at least a hundredth of what the largest reads: across a corner there is
/// next to nothing to divide by.
fn voltage_change(codes: &[f64], reference: &[f64]) -> f64 {
    let largest = reference.iter().fold(0.0, |largest: f64, code| largest.max(code.abs()));
    let worth = |code: &f64| if code.abs() < 0.01 * largest { 0.0 } else { *code };
    thesis::relative_voltage_change(codes, &reference.iter().map(worth).collect::<Vec<_>>())
}

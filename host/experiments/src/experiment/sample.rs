//! Samples: the thesis' skins with their materials, as it drove them.

use super::{
    ExperimentError,
    sample_rig::{Artefacts, FRAMES, SampleRig},
};
use dermatome_model::skin::Skin;
use dermatome_shared::{contact::Contact, drive::Component};
use dermatome_simulate::{Load, Press, Sheet, material::Material};
use std::path::Path;

/// Full amplitude of the thesis' instrument, A: 4 mA from peak to peak (section 3.4).
const FULL_AMPLITUDE: f64 = 2e-3;
/// Frames per second (tables 4.1 and 5.5).
pub(super) const FRAME_RATE: f64 = 4.73;
/// Weight of the prior on electrode movement in the matrix of sheets that loads move, as in skin files. EIDORS' 10
/// leaves much of it in the images of Sample 2, whose plain data have a weak prior.
const ELECTRODE_MOVEMENT: f64 = 3.0;

/// A sample of the thesis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) name: &'static str,
    /// Its experiment of static loading.
    pub(super) loading: [&'static str; 2],
    skin: (&'static str, &'static str),
    pub(super) material: &'static str,
    /// Frequency, Hz; share of the full amplitude, with attenuators.
    drive: (f64, f64),
    /// What of the voltages is measured.
    component: Component,
    /// The thesis' table, as it stands there.
    as_written: &'static str,
    /// What of it is done otherwise here, and why.
    otherwise: &'static str,
    /// Weight of electrode movement in the matrix of a specimen, if it is there.
    electrode_movement: Option<f64>,
    pub(super) found: Found,
}

/// What the thesis found (tables 4.2, 5.3 and 6.1).
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// kPa.
    pub(super) range: f64,
    /// %.
    pub(super) hysteresis: f64,
    /// % of the rated output.
    pub(super) repeatability: Option<f64>,
    /// Mean and standard deviation in x and in y, share of the sample's length.
    pub(super) centre: [[f64; 2]; 2],
    /// Readings in a trial, up and down.
    pub(super) readings: u32,
    /// Position error, share of the length (table 6.1).
    pub(super) position_error: f64,
}

pub(super) const SQUARE_50: (&str, &str) =
    ("models/square-50mm/skin.toml", include_str!("../../../../models/square-50mm/skin.toml"));
pub(super) const SQUARE_210: (&str, &str) =
    ("models/square-210mm/skin.toml", include_str!("../../../../models/square-210mm/skin.toml"));
pub(super) const DISC_210: (&str, &str) =
    ("models/disc-210mm/skin.toml", include_str!("../../../../models/disc-210mm/skin.toml"));

/// A skin that comes with the program, by its path and text.
pub(super) fn shipped((path, text): (&str, &str)) -> Result<Skin, ExperimentError> {
    Ok(Skin::parse(Path::new(path), text)?.made()?)
}

/// Sample 1: conductive rubber on copper.
pub(super) const ONE: Sample = Sample {
    name: "Sample 1",
    loading: ["loading-1", "Static loading: Sample 1, rubber on copper"],
    skin: SQUARE_50,
    material: "sample-1",
    drive: (12.5e3, 0.1),
    component: Component::Real,
    as_written: "gain 5, amplitude 100 % behind 20 dB, real part, hyperparameter 0.032",
    otherwise: "",
    electrode_movement: Some(ELECTRODE_MOVEMENT),
    found: Found {
        range: 35.0,
        hysteresis: 34.5,
        repeatability: None,
        centre: [[0.046, 0.042], [0.022, 0.050]],
        readings: 25,
        position_error: 0.046,
    },
};

/// Sample 2: two layers of non-woven microfibre.
pub(super) const TWO: Sample = Sample {
    name: "Sample 2",
    loading: ["loading-2", "Static loading: Sample 2, non-woven microfibre"],
    skin: SQUARE_210,
    material: "sample-2",
    drive: (50e3, 0.0782),
    component: Component::Real,
    as_written: "gain 3, amplitude 7.82 %, absolute value, hyperparameter 0.150",
    otherwise: "The part in phase is measured instead of the absolute value, which would take the sign from this skin's plain \
                differences; the sheet is a resistor and has no other part. ",
    electrode_movement: Some(ELECTRODE_MOVEMENT),
    found: Found {
        range: 65.0,
        hysteresis: 20.03,
        repeatability: None,
        centre: [[0.001, 0.122], [0.032, 0.099]],
        readings: 25,
        position_error: 0.032,
    },
};

/// Sample 3: woven fabric, one layer.
pub(super) const THREE_SINGLE: Sample = Sample {
    name: "Sample 3, single",
    loading: ["loading-3-single", "Static loading: Sample 3, one layer of woven fabric"],
    skin: DISC_210,
    material: "sample-3-single",
    drive: (50e3, 0.475),
    component: Component::Magnitude,
    as_written: "gain 4, amplitude 45 to 50 %, absolute value, hyperparameter 0.15",
    otherwise: "",
    electrode_movement: Some(ELECTRODE_MOVEMENT),
    found: Found {
        range: 20.0,
        hysteresis: 41.0,
        repeatability: Some(26.96),
        centre: [[0.0379, 0.0465], [0.1574, 0.0887]],
        readings: 33,
        position_error: 0.157,
    },
};

/// Sample 3: woven fabric, two layers.
pub(super) const THREE_DUAL: Sample = Sample {
    name: "Sample 3, dual",
    loading: ["loading-3-dual", "Static loading: Sample 3, two layers of woven fabric"],
    material: "sample-3-dual",
    found: Found {
        range: 65.0,
        hysteresis: 47.0,
        repeatability: Some(11.17),
        centre: [[-0.0261, 0.1025], [0.1409, 0.0638]],
        readings: 33,
        position_error: 0.141,
    },
    ..THREE_SINGLE
};

/// A sample on the rig, with its history.
#[derive(Debug)]
pub(super) struct Specimen {
    pub(super) rig: SampleRig,
    sheet: Sheet,
}

impl Sample {
    /// Its skin, driven as in the thesis.
    pub(super) fn skin(&self) -> Result<Skin, ExperimentError> {
        let mut skin = shipped(self.skin)?;
        self.drive(&mut skin);
        skin.drive.component = self.component;
        Ok(skin)
    }

    /// Drives a skin as this sample was driven.
    pub(super) fn drive(&self, skin: &mut Skin) {
        (skin.drive.frequency, skin.drive.amplitude) = (self.drive.0, self.drive.1 * FULL_AMPLITUDE);
        skin.drive.frame_rate = FRAME_RATE;
    }

    /// The same imaged as if electrodes never moved, as in the thesis.
    pub(super) fn without_movement(&self) -> Self {
        Self { electrode_movement: None, ..*self }
    }

    /// A fresh specimen, tared.
    pub(super) fn specimen(&self, artefacts: Artefacts, seed: u64) -> Result<Specimen, ExperimentError> {
        let material = Material::named(self.material)?;
        let mut skin = self.skin()?;
        skin.inverse.electrode_movement = self.electrode_movement;
        let mut specimen = Specimen {
            rig: SampleRig::new(skin, artefacts, FRAMES, seed)?,
            sheet: Sheet::new(&material, seed),
        };
        specimen.tare();
        Ok(specimen)
    }

    /// Current and frames, in words.
    pub(super) fn drive_words(&self) -> String {
        let (frequency, share) = self.drive;
        format!(
            "{} kHz, {:.3} mA, {FRAME_RATE} frames per second, as in the thesis' table.",
            frequency / 1e3,
            share * FULL_AMPLITUDE * 1e3
        )
    }

    /// How it was driven and imaged, in words.
    pub(super) fn acquisition(&self) -> String {
        let part =
            if self.component == Component::Magnitude { "absolute values" } else { "the part in phase" };
        format!(
            "{}: {} Mean of {FRAMES} frames for each load, reference set once, {part}, Laplace prior. The table: {}. {}The gain is \
             not that of the table: the simulated board finds its own, and any cancels in difference data. Nor is the \
             hyperparameter, which belongs to the scaling of EIDORS: that of {} is used. The matrix knows that electrodes move \
             (electrode_movement = {ELECTRODE_MOVEMENT}), which the thesis' did not.",
            self.name,
            self.drive_words(),
            self.as_written,
            self.otherwise,
            self.skin.0
        )
    }
}

impl Specimen {
    /// Sets the reference on the sheet at rest.
    pub(super) fn tare(&mut self) {
        let conductivity = self.at_rest(0.0);
        self.rig.tare(&conductivity);
    }

    /// The sheet without load after so many seconds.
    pub(super) fn at_rest(&mut self, seconds: f64) -> Vec<f64> {
        self.under(&[], seconds)
    }

    /// Relative conductivity of the sheet under these presses after so many seconds.
    pub(super) fn under(&mut self, presses: &[Press], seconds: f64) -> Vec<f64> {
        let pressure = self.rig.truth().pressure(presses);
        self.sheet.respond(&pressure, seconds)
    }

    /// What the board shows after these presses were held for some seconds.
    pub(super) fn hold(
        &mut self,
        presses: &[Press],
        seconds: f64,
    ) -> Result<super::sample_rig::Shown, ExperimentError> {
        let conductivity = self.under(presses, seconds);
        self.rig.show(&conductivity)
    }

    /// Contacts that the board reports in so many frames once these presses were held for some seconds: `[frame]`.
    pub(super) fn watch(&mut self, presses: &[Press], seconds: f64, frames: u16) -> Vec<Vec<Contact>> {
        let conductivity = self.under(presses, seconds);
        let phasors = self.rig.solve(&conductivity);
        (0..frames).map(|_| self.rig.glance(&phasors)).collect()
    }
}

/// The thesis' insulated contact of 4 cm^2 under a mean pressure, kPa.
pub(super) fn cube(position: [f64; 2], pressure_kpa: f64) -> Press {
    let footprint = dermatome_simulate::Footprint::Square { side: 0.02 };
    Press::new(footprint, position, Load::Pressure(pressure_kpa * 1e3))
}

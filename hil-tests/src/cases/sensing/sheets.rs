//! Sheets: what is left of a voltage beside the noise, over all sheet resistances, in the range of the current source that
//! the board takes.

use super::{
    super::Failure,
    ensure,
    session::{self, Session, front_end},
};
use crate::{
    rig::{Rig, RigError},
    world::{
        Setup, WorldHandle,
        parameters::Stray,
        readings::{FULL_DRIVE_CODES, Readings, first_sample},
    },
};
use dermatome::{sheet::ElectrodeModel, skin::Skin};
use dermatome_shared::{
    acquire::FrontEnd,
    drive::{Component, Drive},
    patch::PatchView,
    scan::multiplexer_word,
};

/// A sheet, and how a person would drive it: with what the source's compliance and the converter take, for so long that
/// small voltages rise above the noise.
#[derive(Clone, Copy)]
struct Sheet {
    /// Ohm per square.
    ohms: f64,
    /// Length of the leads, m: half a metre shunts a large resistance.
    leads: f64,
    /// A.
    amplitude: f64,
    /// Hz.
    frequency: f64,
    /// Carrier periods for each voltage.
    periods: u8,
}

const SHEETS: [Sheet; 6] = [
    Sheet { ohms: 10.0, leads: 0.5, amplitude: 1e-3, frequency: 12.5e3, periods: 16 },
    Sheet { ohms: 100.0, leads: 0.5, amplitude: 1e-3, frequency: 50e3, periods: 4 },
    Sheet { ohms: 1e3, leads: 0.5, amplitude: 0.55e-3, frequency: 50e3, periods: 1 },
    Sheet { ohms: 10e3, leads: 0.5, amplitude: 48e-6, frequency: 12.5e3, periods: 2 },
    Sheet { ohms: 30e3, leads: 0.1, amplitude: 15e-6, frequency: 12.5e3, periods: 2 },
    Sheet { ohms: 100e3, leads: 0.1, amplitude: 4.5e-6, frequency: 12.5e3, periods: 32 },
];
/// Length of the rig's leads, m.
const RIG_LEADS: f64 = 0.5;
/// How long a switched voltage settles on the board, s: sheet and leads of the last one make 0.1 ms.
const SETTLING: f64 = 320e-6;
/// Least signal to noise of any channel, dB.
const LEAST: f64 = 60.0;
/// Frames of each sheet, and of the last one on the board.
const FRAMES: usize = 12;
const BOARD_FRAMES: usize = 4;
/// Clocks of the converter from a trigger to its sample.
const SAMPLE_CLOCKS: f64 = 14.5;
/// Largest error of a voltage in the small range, of the largest voltage.
const ERROR: f64 = 5e-3;

impl Sheet {
    /// In place of the rig's own sheet and leads, with contacts in proportion.
    fn before(&self, rig: &Setup) -> Result<Setup, RigError> {
        let mut skin = Skin::clone(&rig.skin);
        if let ElectrodeModel::Complete { contact_impedance, .. } = &mut skin.electrodes.model {
            let times = self.ohms * skin.material.sheet_conductivity;
            contact_impedance.iter_mut().for_each(|impedance| *impedance *= times);
        }
        skin.material.sheet_conductivity = 1.0 / self.ohms;
        skin.drive.frequency = self.frequency;
        skin.drive.amplitude = self.amplitude;
        skin.drive.component = Component::Magnitude;
        skin.drive.settling = SETTLING * self.frequency;
        skin.drive.integration = self.periods;
        let mut setup = rig.with_skin(skin)?;
        let Stray { to_ground, between } = setup.analogue.stray;
        let share = self.leads / RIG_LEADS;
        setup.analogue.stray = Stray { to_ground: to_ground * share, between: between * share };
        Ok(setup)
    }
}

/// All sheets through the circuit and the firmware's acquisition; the last one on the emulated board as well.
pub(super) fn all(rig: &Rig) -> Result<String, Failure> {
    // Few periods, for time's sake.
    let last = Sheet { periods: 2, ..SHEETS[SHEETS.len() - 1] };
    let world = rig.emulated().world().ok_or_else(|| Failure::wrong("the rig has no `[world]`"))?;
    let (session, mut link) = Session::before(rig, last.before(world.setup())?)?;
    let (front_end, drive) = front_end(&mut link)?;
    let error = error(&session, &session::voltages(&mut link, BOARD_FRAMES)?, drive);
    ensure(session.world.conditions().in_small_range, || "the board stays in its large range".to_owned())?;
    ensure(error <= ERROR, || format!("voltages at {} ohm are off by {:.2} %", last.ohms, 100.0 * error))?;
    let mut lines = Vec::new();
    for sheet in &SHEETS {
        let (worst, median, range) =
            signal_to_noise(sheet.before(world.setup())?, &session.patch(), &front_end)?;
        let line = format!("{} ohm {worst:.1} ({median:.1}) dB, {range}", sheet.ohms);
        ensure(worst >= LEAST, || line.clone())?;
        lines.push(line);
    }
    let error = 100.0 * error;
    Ok(format!("worst (median) channel: {}; voltages of the last one off by {error:.2} %", lines.join("; ")))
}

/// Largest error of the mean voltages, of the largest one, against the circuit at the carrier's frequency.
fn error(session: &Session, frames: &[Vec<[f64; 2]>], drive: Drive) -> f64 {
    let words: Vec<u16> = session.patch().steps().map(multiplexer_word).collect();
    let truth = words.iter().map(|&word| session.world.truth(word).norm() * f64::from(drive.amplitude));
    let mean = |step: usize| frames.iter().map(|frame| frame[step][0]).sum::<f64>() / frames.len() as f64;
    let errors = truth.clone().enumerate().map(|(step, truth)| (mean(step) - truth).abs());
    errors.fold(0.0, f64::max) / truth.fold(0.0, f64::max)
}

/// Worst and median channel of a sheet, dB, and the range of the source that it takes.
fn signal_to_noise(
    setup: Setup,
    patch: &PatchView<'_>,
    front_end: &FrontEnd,
) -> Result<(f64, f64, &'static str), Failure> {
    let drive = setup.skin.drive.for_board();
    let world = WorldHandle::new(setup);
    let board = Readings {
        world: &world,
        front_end: *front_end,
        full_drive_codes: FULL_DRIVE_CODES,
        first_sample: first_sample(SAMPLE_CLOCKS),
    };
    let responses = board.responses(patch, &drive);
    let frames = board.frames(patch, &drive, &responses, FRAMES, 1);
    let frames = frames.ok_or_else(|| Failure::wrong("the board cannot make the carrier"))?;
    let ratios = session::signal_to_noise(&frames);
    let range = if world.conditions().in_small_range { "29 uA" } else { "1 mA" };
    Ok((ratios[0], ratios[ratios.len() / 2], range))
}

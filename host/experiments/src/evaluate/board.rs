//! The board on a true skin: contacts found in the voltages, by its own code.

use super::{EvaluateError, Options, find::Found};
use dermatome_model::{
    model::Model,
    quantize::PatchBuildError,
    skin::{FoundIn, Skin},
};
use dermatome_simulate::{
    Noise, Rig,
    rig::{Observer, RigError, SETTLED},
};
use num_complex::Complex64;

/// The board on a true skin with the patch of `model`, whose skin is `skin`; none if contacts are found in the image, with
/// the reason if that is because no board takes the model.
pub(super) fn on(
    true_skin: &Skin,
    skin: &Skin,
    model: &Model,
    options: &Options,
) -> Result<(Option<Board>, Option<PatchBuildError>), EvaluateError> {
    let found_in = options.found_in.unwrap_or(skin.contacts_found_in);
    if found_in == FoundIn::Image {
        return Ok((None, None));
    }
    let skin = Skin { contacts_found_in: found_in, ..skin.clone() };
    let noise = Noise { snr_db: options.snr_db.unwrap_or(f64::INFINITY), seed: options.seed };
    match Board::new(true_skin, &skin, model, noise) {
        Ok(board) if board.has_places() => check(options).map(|()| (Some(board), None)),
        Ok(_) => Ok((None, None)),
        Err(RigError::Model(error)) => Err(error.into()),
        Err(RigError::Patch(error)) if options.found_in.is_some() => Err(error.into()),
        Err(RigError::Patch(error)) => Ok((None, Some(error))),
    }
}

/// Refuses what means nothing where contacts are found in the voltages.
fn check(options: &Options) -> Result<(), EvaluateError> {
    let unsuited = |option, why| Err(EvaluateError::Unsuited { option, why });
    if options.threshold.is_some() {
        return unsuited(
            "threshold",
            "contacts are found in the voltages, where noise decides; allowed: `false_alarms` under `[contact]` of the skin \
             file, or `found_in` image",
        );
    }
    if options.contrast < 0.0 {
        return unsuited(
            "contrast",
            "no press lowers the conductivity, so that no contact in the voltages does; allowed: a change above 0, or \
             `found_in` image",
        );
    }
    Ok(())
}

/// A board that was tared on the untouched true skin.
#[derive(Debug)]
pub(super) struct Board {
    pub(super) rig: Rig,
    observer: Observer,
}

impl Board {
    fn new(true_skin: &Skin, skin: &Skin, model: &Model, noise: Noise) -> Result<Self, RigError> {
        let mut observer = Observer::with_model(skin, model.clone())?;
        let mut rig = Rig::new(true_skin, &observer.patch(), noise)?;
        let untouched = rig.truth().conductivity(&[]);
        observer.tare(&rig.tare(&untouched));
        Ok(Self { rig, observer })
    }

    /// Whether it looks for contacts in the voltages: a skin of very few pixels has no places for that.
    fn has_places(&self) -> bool {
        self.observer.patch().header.has_places()
    }

    /// The contacts once scans that meet these phasors, `[slot]`, have come for a while, strongest first. Noise follows from a
    /// number above zero.
    #[must_use]
    pub(super) fn contacts(&self, phasors: &[Complex64], number: u64) -> Vec<Found> {
        let frames = self.rig.numbered_scans(phasors, SETTLED, number);
        self.observer.glance(&frames).contacts().iter().map(Found::from).collect()
    }
}

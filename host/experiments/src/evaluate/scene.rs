//! Scene: a true skin, what measures it, and what finds contacts there.

use super::{
    board::Board,
    find::{Found, FoundBy, ImageFinder},
    surface::Surface,
    target::Discs,
};
use dermatome_model::{metrics::detectability::Detectability, model::Model};
use dermatome_simulate::{
    TrueSkin,
    rig::{IdealRig, Measured},
};
use nalgebra::Point3;

/// Finds the contacts of one skin.
#[derive(Debug)]
pub(super) enum Finder<'a> {
    Voltages(&'a Board),
    Image(ImageFinder<'a>),
}

impl Finder<'_> {
    /// What it finds them in.
    #[must_use]
    pub(super) fn found_by(&self) -> FoundBy {
        match self {
            Self::Voltages(_) => FoundBy::Voltages,
            Self::Image(finder) => finder.found_by(),
        }
    }
}

/// Everything that single targets and pairs need.
pub(super) struct Scene<'a> {
    pub(super) surface: &'a Surface<'a>,
    pub(super) rig: IdealRig<'a>,
    pub(super) finder: Finder<'a>,
    pub(super) model: &'a Model,
    /// The true skin, if the model is of its flattened one: what is found is laid onto it from above.
    pub(super) flattened: Option<&'a TrueSkin>,
    pub(super) discs: Discs,
    pub(super) spacing: f64,
    pub(super) detectability: Option<Detectability>,
}

/// What is seen of a sheet.
pub(super) struct Seen {
    /// Its image, in which targets are positive.
    pub(super) measured: Measured,
    /// Its contacts on the true skin, strongest first.
    pub(super) contacts: Vec<Found>,
}

impl Scene<'_> {
    /// What is seen of a sheet of this relative conductivity, `[element]`. The noise follows from `frame`, a number above
    /// zero.
    pub(super) fn see(&self, conductivity: &[f64], frame: u64) -> Seen {
        match &self.finder {
            Finder::Voltages(board) => {
                let phasors = board.rig.solve(conductivity);
                let measured = self.rig.read(board.rig.in_phase(&phasors), frame);
                Seen { measured, contacts: self.on_truth(board.contacts(&phasors, frame)) }
            }
            Finder::Image(finder) => {
                let measured = self.upright(self.rig.measure(conductivity, frame));
                let contacts = self.on_truth(finder.contacts(&measured.image));
                Seen { measured, contacts }
            }
        }
    }

    /// Where the model has a point of the true skin.
    pub(super) fn seen(&self, point: Point3<f64>) -> Point3<f64> {
        if self.flattened.is_some() { Point3::new(point.x, point.y, 0.0) } else { point }
    }

    /// Contacts of the model, laid onto the true skin.
    fn on_truth(&self, mut contacts: Vec<Found>) -> Vec<Found> {
        if let Some(truth) = self.flattened {
            contacts
                .iter_mut()
                .for_each(|contact| contact.centre = truth.lay([contact.centre.x, contact.centre.y]));
        }
        contacts
    }

    /// With an image in which the targets are positive.
    fn upright(&self, mut measured: Measured) -> Measured {
        if self.discs.contrast < 0.0 {
            measured.image.iter_mut().for_each(|value| *value = -*value);
        }
        measured
    }
}

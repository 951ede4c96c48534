//! Single targets, one at a time, all over the skin.

use super::{
    Watch,
    find::Found,
    scene::{Scene, Seen},
};
use dermatome_model::metrics::{Target, detectability::AtPlace, greit, thesis};
use nalgebra::Point3;
use rayon::prelude::*;

/// One target and what its image is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Single {
    /// Centre of the target's change, m: its middle, unless the rim cuts it.
    pub position: Point3<f64>,
    /// How far out it lies: 0 at the deepest place of the skin, 1 at the rim.
    pub normalised_radius: f64,
    /// Contacts found, strongest first.
    pub contacts: Vec<Found>,
    /// Area of the strongest contact's region of interest over the target's; none in the voltages.
    pub contact_area: Option<f64>,
    /// dV/V, thesis equation 3.2.
    pub relative_voltage_change: f64,
    /// What one frame tells at most of it, by the model; none without noise.
    pub detectability: Option<AtPlace>,
    /// The thesis' figures; none where the image shows nothing of the target's sign.
    pub thesis: Option<thesis::Figures>,
    /// GREIT's figures, likewise.
    pub greit: Option<greit::Figures>,
}

impl Single {
    /// Distance of the strongest contact from the target, m; `None` if it was missed.
    #[must_use]
    pub fn position_error(&self) -> Option<f64> {
        self.contacts.first().map(|contact| (contact.centre - self.position).norm())
    }

    /// Standard deviation that the board states of the strongest contact's place, m; `None` in the image.
    #[must_use]
    pub fn stated_deviation(&self) -> Option<f64> {
        Some(self.contacts.first()?.evidence?.position_deviation)
    }

    /// Whether the strongest contact is off by no more than twice of that.
    #[must_use]
    pub fn is_as_stated(&self) -> Option<bool> {
        Some(self.position_error()? <= 2.0 * self.stated_deviation()?)
    }
}

/// Tries a target at every place, until told to stop.
pub(super) fn try_all(scene: &Scene<'_>, watch: &dyn Watch) -> Vec<Single> {
    let places = scene.surface.places(scene.spacing);
    watch.begin("targets", places.len());
    let attempt = |(frame, &place): (u64, &Point3<f64>)| {
        let single = watch.go_on().then(|| try_one(scene, place, frame))?;
        watch.step();
        Some(single)
    };
    let numbered: Vec<_> = (1..).zip(&places).collect();
    numbered.into_par_iter().filter_map(attempt).collect()
}

fn try_one(scene: &Scene<'_>, place: Point3<f64>, frame: u64) -> Single {
    let change = scene.discs.at(scene.surface, &[place]);
    let Seen { measured, contacts } = scene.see(&change.conductivity, frame);
    let target = Target {
        position: scene.seen(change.centre),
        amount: change.amount,
        skin_centre: scene.seen(scene.surface.centre),
    };
    let area = change.amount / scene.discs.contrast.abs();
    Single {
        position: change.centre,
        normalised_radius: scene.surface.normalised_radius(change.centre),
        contact_area: contacts.first().and_then(|contact| Some(contact.area? / area)),
        contacts,
        relative_voltage_change: measured.relative_voltage_change,
        detectability: scene
            .detectability
            .as_ref()
            .and_then(|all| all.nearest(scene.seen(change.centre)).copied()),
        thesis: thesis::figures(&measured.image, &scene.model.pixels, &target),
        greit: greit::figures(&measured.image, &scene.model.pixels, &target),
    }
}

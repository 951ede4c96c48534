//! Single targets, one at a time, all over the skin.

use super::{Scene, Watch, find::Found};
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
    /// Contacts found, m, strongest first.
    pub contacts: Vec<Point3<f64>>,
    /// Area of the strongest contact's region of interest over the target's.
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
        self.contacts.first().map(|contact| (contact - self.position).norm())
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
    let measured = scene.rig.measure(&change.conductivity, frame);
    let image = scene.upright(measured.image);
    let target = Target {
        position: scene.seen(change.centre),
        amount: change.amount,
        skin_centre: scene.seen(scene.surface.centre),
    };
    let contacts = scene.contacts(&image);
    let area = change.amount / scene.discs.contrast.abs();
    Single {
        position: change.centre,
        normalised_radius: scene.surface.normalised_radius(change.centre),
        contact_area: contacts.first().map(|contact| contact.area / area),
        contacts: contacts.iter().map(|contact| contact.centre).collect(),
        relative_voltage_change: measured.relative_voltage_change,
        detectability: scene
            .detectability
            .as_ref()
            .and_then(|all| all.nearest(scene.seen(change.centre)).copied()),
        thesis: thesis::figures(&image, &scene.model.pixels, &target),
        greit: greit::figures(&image, &scene.model.pixels, &target),
    }
}

impl Scene<'_> {
    /// Contacts in an image, on the true skin.
    pub(super) fn contacts(&self, image: &[f64]) -> Vec<Found> {
        let mut found = self.finder.contacts(image);
        if let Some(truth) = self.flattened {
            found
                .iter_mut()
                .for_each(|contact| contact.centre = truth.lay([contact.centre.x, contact.centre.y]));
        }
        found
    }

    /// Where the model has a point of the true skin.
    fn seen(&self, point: Point3<f64>) -> Point3<f64> {
        if self.flattened.is_some() { Point3::new(point.x, point.y, 0.0) } else { point }
    }

    /// An image in which the targets are positive.
    pub(super) fn upright(&self, mut image: Vec<f64>) -> Vec<f64> {
        if self.discs.contrast < 0.0 {
            image.iter_mut().for_each(|value| *value = -*value);
        }
        image
    }
}

//! Touches: pictures of fingers on the hemisphere (thesis Figs 5.10 and 5.11), pressed through Sample 3's material.

use super::DIAMETER;
use crate::{
    experiment::{
        ExperimentError,
        report::{Report, mean_and_deviation, number},
        sample::THREE_SINGLE,
    },
    scenes::{matched, place},
};
use dermatome_model::skin::{Skin, electrodes_in_plane};
use dermatome_patch::layout::Layout;
use dermatome_shared::{contact::Contact, frame::Frame};
use dermatome_simulate::{
    Footprint, Load, Noise, Press, Rig, Sheet,
    material::Material,
    rig::{Observer, SETTLED},
};
use dermatome_view::sheet::{Panel, Scale, Sheet as Images, reconstruction_sheet};
use nalgebra::Point3;

/// Force of a finger, N, and its radius, m: 20 kPa, at which the fabric saturates.
const FORCE: f64 = 10.0;
const RADIUS: f64 = 0.06 * DIAMETER;
/// How long it presses, s.
const HOLD: f64 = 2.0;
/// Signal-to-noise ratio of a frame, dB.
const SNR_DB: f64 = 60.0;

/// A hemisphere that is touched, and its observers, each with the skin whose model it has.
pub(super) struct TouchRig {
    rig: Rig,
    observers: Vec<(Skin, Observer)>,
    material: Material,
}

/// Fingers and what was seen of them.
pub(super) struct Touch {
    name: String,
    truth: Vec<Point3<f64>>,
    /// Area of one finger on the hemisphere, mean, m^2.
    area: f64,
    /// By observer.
    seen: Vec<Seen>,
}

/// What one model shows of a frame, by the board's code.
struct Seen {
    image: Vec<f64>,
    contacts: Vec<Contact>,
    /// Areas of the image's regions of interest, m^2.
    regions: Vec<f64>,
    /// The contacts on the hemisphere.
    laid: Vec<Point3<f64>>,
}

impl TouchRig {
    /// The true skin, and skins whose models it is seen through; the first one's patch says how it is scanned.
    pub(super) fn new(true_skin: &Skin, skins: Vec<Skin>) -> Result<Self, ExperimentError> {
        let observers = skins.iter().map(Observer::new).collect::<Result<Vec<_>, _>>()?;
        let noise = Noise { snr_db: SNR_DB, seed: 1 };
        let rig = Rig::new(true_skin, &observers[0].patch(), noise)?;
        let material = Material::named(THREE_SINGLE.material)?;
        Ok(Self { rig, observers: skins.into_iter().zip(observers).collect(), material })
    }

    /// What is pressed how, in words.
    pub(super) fn words(&self) -> String {
        format!(
            "The pictures' fingers press with {FORCE} N for {HOLD} s on {:.1} mm of radius (20 kPa, where the fabric \
             saturates) through the material of Sample 3's single layer (models/materials/{}.toml), each time on a fresh \
             specimen with a reference of its own. The last of six frames at {SNR_DB} dB.",
            RADIUS * 1e3,
            THREE_SINGLE.material
        )
    }

    /// Presses fingers at places given by their direction as seen from above and their way down from the pole, degrees.
    pub(super) fn touch(&mut self, name: &str, places: &[[f64; 2]]) -> Touch {
        let from_above = places.iter().map(|[direction, down]| {
            let (sine, cosine) = direction.to_radians().sin_cos();
            let away = DIAMETER / 2.0 * down.to_radians().sin();
            [away * cosine, away * sine]
        });
        let finger = Footprint::Finger { radius: RADIUS };
        let presses: Vec<_> =
            from_above.map(|at| Press::new(finger.clone(), at, Load::Force(FORCE))).collect();
        let mut sheet = Sheet::new(&self.material, 1);
        let rest = sheet.respond(&self.rig.truth().pressure(&[]), 0.0);
        let frames = self.rig.tare(&rest);
        self.observers.iter_mut().for_each(|(_, observer)| observer.tare(&frames));
        let pressed = sheet.respond(&self.rig.truth().pressure(&presses), HOLD);
        let phasors = self.rig.solve(&pressed);
        let frames = self.rig.scans(&phasors, SETTLED);
        let truth: Vec<_> = presses.iter().map(|press| self.rig.truth().lay(press.position)).collect();
        let tilts = places.iter().map(|[_, down]| finger.area() / down.to_radians().cos());
        Touch {
            name: name.to_owned(),
            area: tilts.sum::<f64>() / places.len() as f64,
            truth,
            seen: self.observers.iter().map(|(_, observer)| self.see(observer, &frames)).collect(),
        }
    }

    fn see(&self, observer: &Observer, frames: &[Frame]) -> Seen {
        let state = observer.glance(frames);
        let image: Vec<f64> = state.image().iter().map(|value| value.to_f64()).collect();
        let contacts = state.contacts().to_vec();
        // A flat model's contacts lie in its plane.
        let lay = |contact: &Contact| match place(contact) {
            at if at.z == 0.0 => self.rig.truth().lay([at.x, at.y]),
            at => at,
        };
        Seen {
            regions: observer.contacts(&image).iter().map(|region| f64::from(region.area)).collect(),
            image,
            laid: contacts.iter().map(lay).collect(),
            contacts,
        }
    }

    /// Touches as one of the models sees them, in mS per square as in the thesis, PNG.
    pub(super) fn draw(&self, observer: usize, touches: &[Touch]) -> Result<Vec<u8>, ExperimentError> {
        let failed = |error: &dyn std::fmt::Display| ExperimentError::Draw(error.to_string());
        let (skin, by) = &self.observers[observer];
        let layout = &Layout::from(&by.model().surface().map_err(|error| failed(&error))?);
        let panels = touches.iter().map(|touch| {
            let Seen { image, contacts, .. } = &touch.seen[observer];
            Panel {
                caption: vec![format!("{}: {} found", touch.name, contacts.len())],
                values: image,
                found: contacts.iter().map(Contact::from_above).collect(),
                truth: touch.truth.iter().map(|centre| ([centre.x, centre.y], RADIUS)).collect(),
                maximum: None,
            }
        });
        let electrodes = &electrodes_in_plane(&skin.shape);
        let scale = Scale::millisiemens(skin.material.sheet_conductivity);
        let sheet = Images { title: "", layout, electrodes, scale, columns: 5, panels: panels.collect() };
        reconstruction_sheet(&sheet).encode().map_err(|error| failed(&error))
    }
}

impl Touch {
    /// How many contacts a model shows, and the distance of each finger from its own, m.
    pub(super) fn found(&self, observer: usize) -> (usize, Vec<Option<f64>>) {
        let laid = &self.seen[observer].laid;
        (laid.len(), matched(&self.truth, laid))
    }
}

/// Position and size of the pictures' contacts.
pub(super) fn tabulate(report: &mut Report, touches: &[Touch], observers: &[&str]) {
    let mut rows = Vec::new();
    for touch in touches {
        for (observer, name) in observers.iter().enumerate() {
            let (count, errors) = touch.found(observer);
            let errors: Vec<f64> = errors.into_iter().flatten().collect();
            let areas: Vec<f64> = touch.seen[observer].regions.iter().map(|area| 1e4 * area).collect();
            rows.push(vec![
                format!("{}, {name}", touch.name),
                count.to_string(),
                number(1e3 * mean_and_deviation(&errors)[0]),
                number(mean_and_deviation(&areas)[0]),
                number(1e4 * touch.area),
            ]);
        }
    }
    report.table(
        "The pictures' contacts",
        &[
            "",
            "found",
            "position error, mean, mm",
            "region of interest in the image, mean, cm²",
            "finger, cm²",
        ],
        rows,
    );
}

#[cfg(test)]
mod tests {
    use super::super::skins;
    use super::*;

    #[test]
    fn a_touch_is_one_contact_where_it_is_and_the_flat_model_puts_it_too_close_to_the_pole() {
        let [skin, truth] = skins().unwrap();
        let flat = skin.flattened().unwrap();
        let mut rig = TouchRig::new(&truth, vec![skin, flat]).unwrap();
        for direction in [90.0, 250.0] {
            let touch = rig.touch("touch", &[[direction, 50.0]]);
            let [surface, flat] = [0, 1].map(|observer| touch.found(observer));
            let [Some(near)] = surface.1[..] else { panic!("{:?}", surface.1) };
            assert_eq!(surface.0, 1);
            assert!(near < 0.015, "{direction}: {near}");
            if let [Some(far)] = flat.1[..] {
                assert!(far > 2.0 * near, "{direction}: {near} {far}");
            }
        }
        let pole = rig.touch("pole", &[[0.0, 0.0]]);
        assert!((pole.truth[0].z - 0.105).abs() < 1e-3, "{}", pole.truth[0]);
        assert!(pole.found(0).0 <= 1);
    }
}

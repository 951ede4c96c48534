//! Every shipped skin, as the board would run it at its own settings and 60 dB: silent while nobody
//! presses, one contact near the finger when somebody does.

use dermatome::{
    metrics::detectability::Sought,
    model::Model,
    quantize,
    sheet::ElectrodeModel,
    simulate::{Noise, Press, Rig, instrument::Instrument, rig::Observer},
    skin::Skin,
};
use dermatome_shared::{contact::Contact, frame::FrameFlags, health::Health, patch::PatchView};
use std::path::Path;

/// A shipped skin and the board that observes it.
struct Shipped {
    skin: Skin,
    board: Observer,
}

impl Shipped {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
        let skin = Skin::load(&path).unwrap().made().unwrap();
        Self { board: Observer::new(&skin).unwrap(), skin }
    }

    /// Contacts of 10 frames with these presses, after a tare of 20.
    fn contacts(&self, presses: &[Press], seed: u64) -> Vec<Vec<Contact>> {
        let mut board = self.board.clone();
        let mut rig = Rig::new(&self.skin, &board.patch(), Noise { snr_db: 60.0, seed }).unwrap();
        let untouched = rig.truth().conductivity(&[]);
        board.tare(&rig.tare(&untouched));
        let phasors = rig.solve(&rig.truth().conductivity(presses));
        rig.scans(&phasors, 10).iter().map(|frame| board.observe(frame).contacts().to_vec()).collect()
    }
}

/// What the sheet adds to a test is known from a coarser mesh than the one that is measured.
#[test]
fn tests_of_electrodes_read_the_contact_impedances_of_the_skin_file() {
    for name in SKINS {
        let shipped = Shipped::new(name);
        let ElectrodeModel::Complete { width, contact_impedance } = &shipped.skin.electrodes.model else {
            panic!("{name} has point electrodes")
        };
        let expected = contact_impedance[0] / width[0];
        let patch = shipped.board.patch();
        let mut rig = Rig::new(&shipped.skin, &patch, Noise { snr_db: 80.0, seed: 1 }).unwrap();
        let frame = rig.play(None);
        let amplitude = patch.header.drive.amplitude;
        let volts_per_code = rig.skin().front_end().unwrap().volts_per_code;
        let (mut health, flags) = Health::examine(&patch, patch.header.drive.frequency, &frame);
        health.measure_contacts(&patch, volts_per_code / amplitude, &frame.tests);
        let worst = health
            .contact_impedance
            .iter()
            .fold(0.0, |max: f64, &z| max.max((f64::from(z) - expected).abs()));
        let sheet = 1.0 / shipped.skin.material.sheet_conductivity;
        println!("{name}: {expected:.1} ohm to {worst:.2} ohm, sheet of {sheet:.0} ohm per square");
        assert_eq!(flags, FrameFlags::default(), "{name}");
        assert!(worst < 0.03 * sheet, "{name}: {:?}", health.contact_impedance);
        assert!(health.reciprocity_error.unwrap() < 0.01, "{name}");
    }
}

const SKINS: [&str; 3] = ["disc-210mm", "square-50mm", "square-210mm"];

#[test]
fn fixed_point_costs_at_most_three_parts_in_a_thousand_of_the_peak() {
    for name in SKINS.iter().chain(&[
        "hemisphere-120mm",
        "hemisphere-210mm",
        "hemisphere-210mm-designed",
        "saline-215mm",
    ]) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
        let skin = Skin::load(&path).unwrap().made().unwrap();
        let model = Model::build(&skin, |_| ()).unwrap();
        let patch = quantize::patch(&skin, &model).unwrap();
        let view = PatchView::validate(&patch).unwrap();
        let error = quantize::fixed_point_error(&model, &view, 3000).unwrap().measured_percent;
        println!("{name}: {error:.3} %");
        assert!(error <= 0.3, "{name}: {error} %");
    }
}

#[test]
fn an_untouched_skin_reports_no_contact() {
    for name in SKINS {
        let shipped = Shipped::new(name);
        for seed in 0..5 {
            let found = shipped.contacts(&[], seed);
            assert!(found.iter().flatten().next().is_none(), "{name}, seed {seed}: {found:?}");
        }
    }
}

#[test]
fn a_finger_is_one_contact_within_four_per_cent_of_the_diameter() {
    for name in SKINS {
        let shipped = Shipped::new(name);
        let [x, y] = shipped.skin.shape.flat().unwrap().half_size();
        let places = [[0.0, 0.0], [0.4, 0.1], [-0.3, 0.5], [0.1, -0.6], [-0.55, -0.2]];
        let mut worst: f64 = 0.0;
        for (seed, [u, v]) in (0..).zip(places) {
            let press = Press::finger([u * x, v * y], 0.12 * x, 1.0);
            for contacts in shipped.contacts(std::slice::from_ref(&press), seed) {
                let contact = contacts.first().unwrap_or_else(|| panic!("{name}: no contact at {u}, {v}"));
                let error = dermatome::metrics::position_error(contact.position, press.position);
                worst = worst.max(error / shipped.skin.shape.flat().unwrap().diameter());
                assert_eq!(contacts.len(), 1, "{name} at {u}, {v}: {contacts:?}");
            }
        }
        println!("{name}: at most {:.2} % of the diameter off", 100.0 * worst);
        assert!(worst < 0.04, "{name}: {worst}");
    }
}

#[test]
fn the_designed_hemisphere_hears_a_finger_at_its_deafest_place_better_than_one_with_electrodes_on_its_rim() {
    let found = ["hemisphere-210mm", "hemisphere-210mm-designed"].map(|name| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
        let model = Model::build(&Skin::load(&path).unwrap().made().unwrap(), |_| ()).unwrap();
        let found = model.detectability(&Sought::finger(model.pixels.larger_side(), 60.0));
        let least = found.worst().unwrap().significance;
        println!("{name}: {least:.1}, {:.1}, {:.2} mm", found.median(), found.worst_deviation() * 1e3);
        (least, found.worst_deviation())
    });
    assert!(found[1].0 > 3.0 * found[0].0 && found[1].1 < 0.6 * found[0].1, "{found:?}");
}

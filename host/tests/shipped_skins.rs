//! Every shipped skin, as the board would run it at its own settings and 60 dB: silent while nobody
//! presses, one contact near the finger when somebody does.

use dermatome::{
    model::Model,
    quantize,
    sheet::ElectrodeModel,
    simulate::{Noise, Press, Script, SimulatedSkin, board::ScanTable},
    skin::Skin,
};
use dermatome_shared::{
    contact::Contacts,
    frame::{Frame, FrameFlags},
    health::Health,
    patch::PatchView,
    pipeline::{PipelineState, process},
};
use std::path::Path;

/// A patch at work on a simulated skin.
struct Bench {
    skin: Skin,
    patch: Vec<u8>,
}

impl Bench {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
        let skin = Skin::load(&path).unwrap().made().unwrap();
        let model = Model::build(&skin, |_| ()).unwrap();
        let patch = quantize::patch(&skin, &model).unwrap();
        Self { skin, patch }
    }

    /// Contacts of 10 frames with these presses, after a tare of 20.
    fn contacts(&self, presses: &[Press], seed: u64) -> Vec<Contacts> {
        let script = Script::still(presses, self.skin.shape.flat().unwrap()).unwrap();
        let noise = Noise { snr_db: 60.0, seed };
        let mut simulated = SimulatedSkin::new(&self.skin, script, noise).unwrap();
        let patch = PatchView::validate(&self.patch).unwrap();
        let mut state = PipelineState::default();
        state.start_tare(20);
        let table = ScanTable::new(&patch, patch.header.drive);
        let mut frame = |time| {
            let codes = simulated.measure(&table, time).codes.into_iter().collect();
            process(&patch, &mut state, &Frame { codes, ..Frame::default() });
            state.contacts().clone()
        };
        (0..20).for_each(|_| drop(frame(None)));
        (0..10).map(|_| frame(Some(0.0))).collect()
    }
}

/// What the sheet adds to a test is known from a coarser mesh than the one that is measured.
#[test]
fn tests_of_electrodes_read_the_contact_impedances_of_the_skin_file() {
    for name in SKINS {
        let bench = Bench::new(name);
        let ElectrodeModel::Complete { width, contact_impedance } = &bench.skin.electrodes.model else {
            panic!("{name} has point electrodes")
        };
        let expected = contact_impedance[0] / width[0];
        let script = Script::still(&[], bench.skin.shape.flat().unwrap()).unwrap();
        let mut simulated = SimulatedSkin::new(&bench.skin, script, Noise { snr_db: 80.0, seed: 1 }).unwrap();
        let patch = PatchView::validate(&bench.patch).unwrap();
        let scan = simulated.measure(&ScanTable::new(&patch, patch.header.drive), None);
        let frame = Frame {
            codes: scan.codes.into_iter().collect(),
            tests: scan.tests.into_iter().collect(),
            ..Frame::default()
        };
        let amplitude = patch.header.drive.amplitude;
        let (mut health, flags) = Health::examine(&patch, patch.header.drive.frequency, &frame);
        health.measure_contacts(&patch, simulated.front_end().volts_per_code / amplitude, &frame.tests);
        let worst = health
            .contact_impedance
            .iter()
            .fold(0.0, |max: f64, &z| max.max((f64::from(z) - expected).abs()));
        let sheet = 1.0 / bench.skin.material.sheet_conductivity;
        println!("{name}: {expected:.1} ohm to {worst:.2} ohm, sheet of {sheet:.0} ohm per square");
        assert_eq!(flags, FrameFlags::default(), "{name}");
        assert!(worst < 0.03 * sheet, "{name}: {:?}", health.contact_impedance);
        assert!(health.reciprocity_error.unwrap() < 0.01, "{name}");
    }
}

const SKINS: [&str; 3] = ["disc-210mm", "square-50mm", "square-210mm"];

#[test]
fn an_untouched_skin_reports_no_contact() {
    for name in SKINS {
        let bench = Bench::new(name);
        for seed in 0..5 {
            let found = bench.contacts(&[], seed);
            assert!(found.iter().flatten().next().is_none(), "{name}, seed {seed}: {found:?}");
        }
    }
}

#[test]
fn a_finger_is_one_contact_within_four_per_cent_of_the_diameter() {
    for name in SKINS {
        let bench = Bench::new(name);
        let [x, y] = bench.skin.shape.flat().unwrap().half_size();
        let places = [[0.0, 0.0], [0.4, 0.1], [-0.3, 0.5], [0.1, -0.6], [-0.55, -0.2]];
        let mut worst: f64 = 0.0;
        for (seed, [u, v]) in (0..).zip(places) {
            let press = Press::finger([u * x, v * y], 0.12 * x, 1.0);
            for contacts in bench.contacts(std::slice::from_ref(&press), seed) {
                let contact = contacts.first().unwrap_or_else(|| panic!("{name}: no contact at {u}, {v}"));
                let error = dermatome::metrics::position_error(contact.position, press.position);
                worst = worst.max(error / bench.skin.shape.flat().unwrap().diameter());
                assert_eq!(contacts.len(), 1, "{name} at {u}, {v}: {contacts:?}");
            }
        }
        println!("{name}: at most {:.2} % of the diameter off", 100.0 * worst);
        assert!(worst < 0.04, "{name}: {worst}");
    }
}

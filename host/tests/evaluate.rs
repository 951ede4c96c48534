//! Figures of merit over every shipped skin, at its own settings and 60 dB.

use dermatome::{
    evaluate::{Length, Options, Watch, evaluate, report::Report},
    model::Model,
    skin::Skin,
};
use std::path::Path;

struct Patient;

impl Watch for Patient {
    fn begin(&self, _: &'static str, _: usize) {}
    fn step(&self) {}
    fn go_on(&self) -> bool {
        true
    }
}

fn report(name: &str) -> Report {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models").join(name).join("skin.toml");
    let skin = Skin::load(&path).unwrap().made().unwrap();
    let model = Model::build(&skin, |_| ()).unwrap();
    let options = Options {
        spacing: Some(Length::Share(0.14)),
        diameter: Length::Share(0.1),
        contrast: 1.0,
        snr_db: Some(60.0),
        seed: 1,
        electrode_error: Length::Metres(0.0),
        impedance_error: 0.0,
        found_in: None,
        threshold: None,
    };
    Report::new(&evaluate(&skin, &model, &options, &Patient).unwrap())
}

#[test]
fn targets_all_over_every_shipped_skin_are_found_where_they_are() {
    // Largest position error within 80 % of the way to the rim, per cent of the diameter, and the
    // largest distance at which two contacts side by side at the centre are not yet two.
    for (name, error, apart) in
        [("disc-210mm", 2.5, 40.0), ("square-50mm", 3.5, 45.0), ("square-210mm", 4.5, 60.0)]
    {
        let report = report(name);
        for ring in report.rings.iter().filter(|ring| ring.to_percent <= 80.0) {
            assert_eq!(ring.missed, 0, "{name}: {ring:?}");
            let worst = ring.position_error_percent.unwrap().max;
            assert!(worst < error, "{name}: {worst} % at {} %", ring.from_percent);
        }
        let centre = &report.pair_rings[0].across;
        assert!(centre.distance_percent.unwrap().max < apart, "{name}: {centre:?}");
        assert!(report.total.false_contacts < report.total.targets / 5, "{name}: {:?}", report.total);
    }
}

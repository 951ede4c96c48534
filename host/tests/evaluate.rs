//! Figures of merit over every shipped skin, at its own settings and 60 dB.

use dermatome::{
    evaluate::{Length, Options, Watch, evaluate, report::Report},
    model::Model,
    skin::{FoundIn, Skin},
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

fn report(name: &str, found_in: FoundIn) -> Report {
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
        found_in: Some(found_in),
        threshold: None,
    };
    Report::new(&evaluate(&skin, &model, &options, &Patient).unwrap())
}

#[test]
fn targets_all_over_every_shipped_skin_are_found_where_they_are() {
    use FoundIn::{Image, Voltages};
    // Largest position error within 80 % of the way to the rim, per cent of the diameter, and the
    // largest distance at which two contacts side by side at the centre are not yet two.
    for (name, found_in, error, apart) in [
        ("disc-210mm", Image, 2.5, 40.0),
        ("square-50mm", Image, 3.5, 45.0),
        ("square-210mm", Image, 4.5, 60.0),
        ("disc-210mm", Voltages, 4.0, 20.0),
        ("square-50mm", Voltages, 2.0, 25.0),
        ("square-210mm", Voltages, 2.0, 25.0),
    ] {
        let report = report(name, found_in);
        let inner = || report.rings.iter().filter(|ring| ring.to_percent <= 80.0);
        let worst = inner().map(|ring| ring.position_error_percent.unwrap().max).fold(0.0, f64::max);
        let centre = report.pair_rings[0].across.distance_percent.unwrap().max;
        let false_contacts = report.total.false_contacts;
        println!("{name}, {found_in:?}: {worst:.2} % off, {centre:.1} % apart, {false_contacts} false");
        assert!(inner().all(|ring| ring.missed == 0), "{name}, {found_in:?}: {:?}", report.rings);
        assert!(worst < error, "{name}, {found_in:?}: {worst} %");
        assert!(centre < apart, "{name}, {found_in:?}: {centre} %");
        assert!(false_contacts < report.total.targets / 5, "{name}, {found_in:?}: {false_contacts}");
        if found_in == Voltages {
            assert!(inner().all(|ring| ring.exactly_one == ring.targets), "{name}: {:?}", report.rings);
            let stated = inner().map(|ring| ring.within_two_stated_percent.unwrap());
            assert!(stated.fold(100.0, f64::min) > 80.0, "{name}: {:?}", report.rings);
        }
    }
}

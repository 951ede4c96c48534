use super::*;
use crate::quantize::{PatchBuildError, patch, patch_with};
use dermatome_shared::calibration::{Calibration, CalibrationPoint};
use std::path::Path;

fn skin(rules: &str) -> Skin {
    let text = include_str!("../../../../../models/disc-210mm/skin.toml");
    Skin::parse(Path::new("skin.toml"), &format!("{text}\n{rules}")).unwrap().made().unwrap()
}

const BUMPER: &str = "[[reflexes]]\nname = \"bumper\"\npin = 1\nstrength = 0.5\n";
const MIDDLE: &str = "centre = [\"20 mm\", \"-10 mm\"]\nradius = \"40 mm\"\n";

#[test]
fn a_rule_reads_loads_in_its_region_alike_and_hardly_those_elsewhere() {
    let skin = skin(&format!("{BUMPER}{MIDDLE}{}", BUMPER.replace("bumper", "all")));
    let model = Model::build(&skin, |_| ()).unwrap();
    let bytes = patch(&skin, &model).unwrap();
    let view = PatchView::validate(&bytes).unwrap();
    let [middle, all] = &reflex_reports(&skin, &model, &view)[..] else { panic!("two rules") };
    assert!(middle.inside[0] > 0.8 && middle.inside[1] < 1.2 && middle.outside < 0.2, "{middle:?}");
    assert!(all.inside[0] > 0.75 && all.inside[1] < 1.3 && all.outside == 0.0, "{all:?}");
    assert!(middle.noise < 0.1 && all.noise < 0.1, "{} {}", middle.noise, all.noise);
    // A change that all voltages have in common, and one of the sheet that grows along it, read nearly nothing.
    let (voltages, divisors) = (model.measurements(), model.divisors());
    let smooth = smooth_responses(&model);
    for (rule, row) in view.reflex_rows().enumerate() {
        let reads = |of: &dyn Fn(usize) -> f64| -> f64 {
            row.weights.iter().enumerate().map(|(m, weight)| f64::from(weight) * of(m)).sum()
        };
        assert!(reads(&|m| 0.1 * voltages[m] / divisors[m]).abs() < 0.02, "{rule}");
        for change in 0..smooth.ncols() {
            let read = reads(&|m| 0.1 * smooth[(m, change)]);
            assert!(read.abs() < 0.1, "{rule} {change}: {read}");
        }
    }
    // The places of the cells are those of the region, each in one.
    for (number, place) in view.places().iter().enumerate() {
        let centre = model.pixels.centres[usize::from(place.pixel)];
        let has_it = |row: &ReflexRow<_>| row.places[number / 8] >> (number % 8) & 1 == 1;
        let cells = view.reflex_rows().take(8).filter(has_it).count();
        assert_eq!(cells, usize::from(skin.reflexes[0].region.beyond(&centre) <= 0.0));
    }
}

#[test]
fn an_area_is_counted_in_cells_that_make_up_its_region() {
    let area = "area = \"20 cm2\"\npressed_above = 0.1\n";
    let text = BUMPER.replace("strength = 0.5\n", area);
    let skin = skin(&format!("{text}{MIDDLE}{}", BUMPER.replace("bumper", "all")));
    let model = Model::build(&skin, |_| ()).unwrap();
    let bytes = patch(&skin, &model).unwrap();
    let view = PatchView::validate(&bytes).unwrap();
    let rules: Vec<_> = view.reflex_rules().map(|rule| rule.rows).collect();
    assert_eq!(rules, [8, 8]);
    let areas: Vec<f64> = view.reflex_rows().map(|row| f64::from(row.area)).take(8).collect();
    let whole = std::f64::consts::PI * 0.04 * 0.04;
    assert!((areas.iter().sum::<f64>() / whole - 1.0).abs() < 0.03, "{areas:?}");
    assert!(areas.iter().all(|&area| (0.4..2.5).contains(&(8.0 * area / whole))), "{areas:?}");
}

#[test]
fn rules_that_a_skin_cannot_have_say_why() {
    let force = BUMPER.replace("strength = 0.5", "force = \"5 N\"");
    let built = |rules: &str| {
        let skin = skin(rules);
        let model = Model::build(&skin, |_| ()).unwrap();
        patch(&skin, &model).map(|_| ())
    };
    let far = format!("{BUMPER}{}", MIDDLE.replace("20 mm", "2 m"));
    let refused = |rules: &str| match built(rules) {
        Err(PatchBuildError::Reflex(error)) => error,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(&force), ReflexError::NotCalibrated { name: "bumper".into() });
    assert_eq!(refused(&far), ReflexError::Empty { name: "bumper".into() });
    let area = BUMPER.replace("strength = 0.5", "area = 1e-3\npressed_above = 0.1");
    let areas: String = ["a", "b", "c", "d"].map(|name| area.replace("bumper", name)).concat();
    assert!(built(&areas).is_ok(), "two cells each");
    let mut image = skin(BUMPER);
    image.contacts_found_in = FoundIn::Image;
    let model = Model::build(&image, |_| ()).unwrap();
    assert_eq!(patch(&image, &model).unwrap_err(), ReflexError::FoundInImage.into());
    // With a calibration the limit is known in newtons.
    let skin = skin(&force);
    let points = [CalibrationPoint { strength: 1.0, pressure: 50e3 }].into_iter().collect();
    let stored = Stored::curve(Calibration { points, load_share: Some(0.5) });
    let bytes = patch_with(&skin, &model, &stored).unwrap();
    let view = PatchView::validate(&bytes).unwrap();
    let radius = f64::from(view.header.detection.radius);
    let newtons = 50e3 * 0.5 * std::f64::consts::PI * radius * radius;
    let limit = reflex_reports(&skin, &model, &view)[0].limit;
    assert!((limit * newtons / 5.0 - 1.0).abs() < 1e-4, "{limit}");
}

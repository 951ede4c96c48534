//! `dermatome calibrate` with presses at several places: the field of gain, through files and the board's own arithmetic.

mod program;

use dermatome::{
    model::Model,
    quantize,
    simulate::{
        Noise, Press, Rig as SkinRig,
        rig::{Observer, SETTLED},
    },
    skin::Skin,
};
use dermatome_shared::{contact::Contact, patch::PatchView};
use program::{Desk, TINY};
use serde_json::Value;
use std::fmt::Write;

/// Radius of the skin, m.
const RADIUS: f64 = 0.05;
/// Pressure that doubles the conductivity in the middle of the indenter, kPa.
const DOUBLING: f64 = 40.0;

/// How much more a press changes the sheet at a place.
fn gain(x: f64) -> f64 {
    1.0 + 0.3 * x / RADIUS
}

/// So many places, evenly over the inner nine tenths of the radius, turned, m.
fn places(count: usize, turn: f64) -> Vec<[f64; 2]> {
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let place = |number: usize| {
        let radius = 0.85 * RADIUS * ((number as f64 + 0.5) / count as f64).sqrt();
        let (sin, cos) = (golden * number as f64 + turn).sin_cos();
        [radius * cos, radius * sin]
    };
    (0..count).map(place).collect()
}

/// A skin that reads more on one side than its model does, under a board.
struct Uneven {
    skin: Skin,
    model: Model,
    rig: SkinRig,
}

impl Uneven {
    fn new(desk: &Desk) -> Self {
        let skin = Skin::load(&desk.path("skin.toml")).unwrap().made().unwrap();
        let model = Model::build(&skin, |_| ()).unwrap();
        let board = Observer::with_model(&skin, model.clone()).unwrap();
        let rig = SkinRig::new(&skin, &board.patch(), Noise { snr_db: 70.0, seed: 4 }).unwrap();
        Self { skin, model, rig }
    }

    /// The contact under a press on a board with this patch.
    fn contact(&mut self, patch: &[u8], [x, y]: [f64; 2], kpa: f64) -> Contact {
        let mut board = Observer::with_patch(self.model.clone(), patch.to_vec()).unwrap();
        let untouched = self.rig.truth().conductivity(&[]);
        board.tare(&self.rig.tare(&untouched));
        let truth = self.rig.truth();
        let pressed = truth.conductivity(&[Press::finger([x, y], 0.008, kpa / DOUBLING)]);
        let middle =
            |element: usize| truth.mesh().corners(element).iter().map(|corner| corner.x).sum::<f64>() / 3.0;
        let uneven =
            pressed.iter().enumerate().map(|(element, value)| 1.0 + (value - 1.0) * gain(middle(element)));
        let phasors = self.rig.solve(&uneven.collect::<Vec<_>>());
        let frames = self.rig.scans(&phasors, SETTLED + 4);
        *board.glance(&frames).contacts().first().expect("a press shows")
    }

    /// Readings of presses at some places, as `--readings` takes them.
    fn readings(&mut self, patch: &[u8], places: &[[f64; 2]]) -> String {
        let mut text = String::from("pressure_kpa,strength,x_mm,y_mm\n");
        for (number, &[x, y]) in places.iter().enumerate() {
            let kpa = [10.0, 20.0, 30.0][number % 3];
            let strength = self.contact(patch, [x, y], kpa).strength;
            writeln!(text, "{kpa},{strength},{:.3},{:.3}", 1e3 * x, 1e3 * y).unwrap();
        }
        text
    }

    /// Root mean square by which a pressure that a board states is off.
    fn error(&mut self, patch: &[u8], places: &[[f64; 2]]) -> f64 {
        let mut off = |&place: &[f64; 2]| {
            let pressure = self.contact(patch, place, 20.0).pressure.expect("calibrated");
            (f64::from(pressure) / 20e3).ln().powi(2)
        };
        (places.iter().map(&mut off).sum::<f64>() / places.len() as f64).sqrt()
    }
}

#[test]
fn a_board_reads_the_same_press_alike_everywhere_once_it_was_pressed_at_several_places() {
    let desk = Desk::with_patch();
    let plain = desk.read("skin.dermatome");
    let mut skin = Uneven::new(&desk);
    assert!(PatchView::validate(&plain).unwrap().header.has_places() && skin.skin.name == "tiny");
    desk.write("readings.csv", skin.readings(&plain, &places(24, 0.0)));
    let calibrate = ["calibrate", "skin.dermatome", "--readings", "readings.csv", "--json", "report.json"];
    let done = desk.run(&[&calibrate[..], &["--out", "field.dermatome"]].concat()).success();
    assert!(done.out.contains("field of gain 0.") && done.out.contains("from 24 places"), "{done:?}");
    let report = desk.report("report.json");
    let of = |key: &str| report["field"][key].as_f64().unwrap();
    assert!(of("least") < 0.85 && of("largest") > 1.15, "{report}");
    assert!(of("left_out_percent") < 0.7 * of("left_out_without_percent"), "{report}");
    let done = desk.run(&[&calibrate[..], &["--no-field", "--out", "plain.dermatome"]].concat()).success();
    assert!(
        !done.out.contains("field of gain") && desk.report("report.json")["field"] == Value::Null,
        "{done:?}"
    );
    let other = places(16, 1.0);
    let [without, with] =
        ["plain", "field"].map(|name| skin.error(&desk.read(&format!("{name}.dermatome")), &other));
    println!("20 kPa at 16 other places, root mean square error: {without:.3}, with the field {with:.3}");
    assert!(with < 0.65 * without, "{without} {with}");
    // Same length, same format: only rows are other ones.
    assert_eq!(desk.read("plain.dermatome").len(), desk.read("field.dermatome").len());
}

/// Readings of a skin that reads as `gain` says, loaded and unloaded at each place.
fn made_up(places: &[[f64; 2]]) -> String {
    let mut text = String::from("pressure_kpa,strength,x_mm,y_mm\n");
    for [x, y] in places {
        for kpa in [0.0, 10.0, 20.0, 30.0, 20.0, 10.0] {
            writeln!(text, "{kpa},{:.6},{:.3},{:.3}", 0.02 * kpa * gain(*x), 1e3 * x, 1e3 * y).unwrap();
        }
    }
    text
}

#[test]
fn a_patch_that_finds_contacts_in_an_image_of_its_own_pixels_is_evened_out_as_well() {
    let desk = Desk::with_patch();
    let mut skin = Uneven::new(&desk);
    // As a learnt one is.
    let hearing = Skin { contact_threshold: 0.01, ..skin.skin.clone() };
    let learnt = quantize::learnt_patch(&hearing, &skin.model).unwrap();
    desk.write("learnt.dermatome", &learnt);
    desk.write("readings.csv", skin.readings(&learnt, &places(24, 0.0)));
    let calibrate = ["calibrate", "learnt.dermatome", "--readings", "readings.csv"];
    let done = desk.run(&[&calibrate[..], &["--out", "field.dermatome"]].concat()).success();
    assert!(done.out.contains("field of gain 0.") && done.out.contains("from 24 places"), "{done:?}");
    desk.run(&[&calibrate[..], &["--no-field", "--out", "plain.dermatome"]].concat()).success();
    let other = places(16, 1.0);
    let [without, with] =
        ["plain", "field"].map(|name| skin.error(&desk.read(&format!("{name}.dermatome")), &other));
    println!("20 kPa at 16 other places in the image: {without:.3}, with the field {with:.3}");
    assert!(with < 0.8 * without, "{without} {with}");
}

#[test]
fn presses_that_make_no_field_still_make_a_curve() {
    let desk = Desk::with_patch();
    let calibrate = ["calibrate", "skin.dermatome", "--readings", "readings.csv", "--out", "new.dermatome"];
    desk.write("readings.csv", made_up(&[[0.0, 0.0]]));
    let done = desk.run(&calibrate).success();
    assert!(
        done.out.contains(
            "no field of gain: the skin was pressed at 1 place; allowed: 4 or more, all over the skin"
        ),
        "{done:?}"
    );
    let at_one = desk.read("new.dermatome");
    desk.write("readings.csv", made_up(&[[0.0, 0.0], [0.001, 0.0]]));
    assert!(desk.run(&calibrate).success().out.contains("pressed at 1 place;"));
    desk.write("readings.csv", made_up(&places(3, 0.0)));
    let done = desk.run(&calibrate).success();
    assert!(done.out.contains("no field of gain: the skin was pressed at 3 places;"), "{done:?}");
    let places_of = |bytes: &[u8]| PatchView::validate(bytes).unwrap().places().mantissas().to_vec();
    assert_eq!(places_of(&at_one), places_of(&desk.read("skin.dermatome")));
    assert_eq!(places_of(&desk.read("new.dermatome")), places_of(&at_one));
    // A skin that reads alike everywhere.
    let even = |place: &[f64; 2]| {
        [0.0, 10.0, 20.0, 30.0]
            .map(|kpa| format!("{kpa},{},{},{}", 0.02 * kpa, 1e3 * place[0], 1e3 * place[1]))
    };
    let lines: Vec<String> = places(8, 0.0).iter().flat_map(even).collect();
    desk.write("readings.csv", format!("pressure_kpa,strength,x_mm,y_mm\n{}\n", lines.join("\n")));
    let done = desk.run(&calibrate).success();
    let gains = done.out.split("field of gain ").nth(1).unwrap_or_default();
    assert!(
        done.out.contains("no field of gain: with one,") || gains.starts_with("1.00 to 1.00"),
        "{done:?}"
    );
}

#[test]
fn places_off_the_skin_and_half_known_ones_are_refused_and_nothing_is_written() {
    let desk = Desk::with_patch();
    let before = (desk.read("skin.dermatome"), desk.files());
    for (line, words) in [
        ("20,0.4,80,0", "reading 2 (counted from 1) is at x = 80.0 mm, y = 0.0 mm, 3"),
        (
            "20,0.4,,5",
            "line 3, column `x_mm` is nothing; allowed: a number, or nothing in x_mm, y_mm and z_mm",
        ),
        ("20,0.4,5,", "line 3, column `y_mm` is nothing"),
        ("20,0.4,inf,5", "line 3, column `x_mm` is \"inf\"; allowed: a finite number"),
        ("20,0.4,left,5", "line 3, column `x_mm` is \"left\"; allowed: a number"),
    ] {
        desk.write(
            "readings.csv",
            format!("pressure_kpa,strength,x_mm,y_mm\n10,0.2,0,0\n{line}\n30,0.6,0,0\n"),
        );
        let refused = desk.run(&["calibrate", "skin.dermatome", "--readings", "readings.csv"]).refused();
        assert!(refused.contains("`readings.csv`") && refused.contains(words), "{refused}");
        assert_eq!(desk.read("skin.dermatome"), before.0);
        std::fs::remove_file(desk.path("readings.csv")).unwrap();
        assert_eq!(desk.files(), before.1);
    }
}

#[test]
fn a_recording_says_where_it_was_pressed_and_its_readings_make_a_field_once() {
    let desk = Desk::with_patch();
    let plain = desk.read("skin.dermatome");
    let (mut loads, mut lines) = (String::from("time_s,pressure_kpa\n"), String::new());
    let mut number = 0;
    for [x, y] in places(9, 0.5) {
        for kpa in [0.0, 10.0, 20.0, 30.0, 20.0, 10.0, 0.0] {
            writeln!(loads, "{number},{kpa}").unwrap();
            for frame in (20 * number..20 * number + 20).filter(|_| kpa > 0.0) {
                // A board places a press to within a millimetre.
                let [x_mm, y_mm] = [x, y].map(|at| 1e3 * at + 0.8 * f64::from(frame % 3 - 1));
                let strength = 0.02 * kpa * gain(x);
                let time = f64::from(frame) / 20.0;
                writeln!(lines, "{frame}\t{time}\t{x_mm}\t{y_mm}\t0.0\t2000.00\t{strength:.6}").unwrap();
            }
            number += 1;
        }
    }
    desk.write("loads.csv", loads);
    desk.write("contacts.tsv", &lines);
    let of = [
        "calibrate",
        "skin.dermatome",
        "--recording",
        "contacts.tsv",
        "--loads",
        "loads.csv",
        "--save",
        "r.csv",
    ];
    let done = desk.run(&[&of[..], &["--json", "report.json"]].concat()).success();
    assert!(done.out.contains(": 9 trials,") && done.out.contains("from 9 places"), "{done:?}");
    let calibrated = desk.read("skin.dermatome");
    assert!(desk.report("report.json")["field"]["left_out_percent"].as_f64().unwrap() < 6.0);

    // Its readings do the same to the patch as it was, and nothing to the one that has the field already.
    let again = ["calibrate", "skin.dermatome", "--readings", "r.csv"];
    let refused = desk.run(&again).refused();
    assert!(
        refused.contains("readings `r.csv` were taken in units 0x")
            && refused.contains("allowed: the patch that they were taken with, as it was then"),
        "{refused}"
    );
    assert_eq!(desk.read("skin.dermatome"), calibrated);
    desk.write("skin.dermatome", &plain);
    desk.run(&again).success();
    assert_eq!(desk.read("skin.dermatome"), calibrated);

    // Built again with its calibration, it is the same to the byte; with other places it is not, and a warning says so.
    let build = ["build", "skin.toml", "-o", "skin.dermatome", "--preserve-calibration", "skin.dermatome"];
    let done = desk.run(&build).success();
    assert!(desk.read("skin.dermatome") == calibrated && done.err.is_empty(), "{done:?}");
    desk.write("skin.toml", TINY.replace("[contact]", "[contact]\nfound_in = \"image\""));
    let done = desk.run(&build).success();
    assert!(done.err.contains("or other places") && done.err.contains("a field of gain is lost"), "{done:?}");

    let torn = lines.replacen("\t0.0\t2000.00\t", "\tup\t2000.00\t", 1);
    desk.write("contacts.tsv", torn);
    let refused = desk.run(&of).refused();
    assert!(refused.contains("column `z_mm` is \"up\"; allowed: a number"), "{refused}");
}

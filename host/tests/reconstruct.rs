//! `dermatome reconstruct`: what it makes of frames whose presses are known, whatever they are compared with.
#![cfg(unix)]

mod program;

use dermatome::{
    simulate::{Press, TrueSkin},
    skin::Skin,
};
use program::{Desk, TINY, row, tiny_voltages, with};
use serde_json::Value;
use std::path::Path;

/// Where single fingers press, m.
const PLACES: [[f64; 2]; 4] = [[0.02, -0.01], [-0.025, 0.005], [0.0, 0.03], [0.01, 0.012]];
/// Radius of the fingers, m.
const RADIUS: f64 = 0.008;
/// Farthest that a finger is found from where it is, mm: in images of ratios, in images of plain differences, where near
/// electrodes are louder, and fitted.
const NEAR: f64 = 5.0;
const NEAR_PLAIN: f64 = 7.0;
const NEAR_FITTED: f64 = 1.0;

/// Voltages of the tiny skin, without noise.
struct Bench {
    skin: Skin,
    truth: TrueSkin,
}

impl Bench {
    fn new() -> Self {
        let skin = Skin::parse(Path::new("tiny.toml"), TINY).unwrap().made().unwrap();
        Self { truth: TrueSkin::new(&skin).unwrap(), skin }
    }

    fn frame(&self, fingers: &[[f64; 2]]) -> Vec<f64> {
        let presses: Vec<Press> = fingers.iter().map(|&at| Press::finger(at, RADIUS, 0.8)).collect();
        self.truth.voltages(&self.truth.conductivity(&presses), &self.skin.steps())
    }

    fn fingers(&self) -> Vec<Vec<f64>> {
        PLACES.iter().map(|&place| self.frame(&[place])).collect()
    }
}

/// A folder with a skin of normalised and one of plain differences.
fn desk() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk.write("plain.toml", plain());
    desk
}

fn plain() -> String {
    with(TINY, "normalised = true", "normalised = false")
}

fn table(frames: &[Vec<f64>]) -> String {
    frames.iter().map(|frame| row(frame)).collect()
}

/// What `reconstruct` reports of `frames.csv`.
fn reconstructed(desk: &Desk, skin: &str, more: &[&str]) -> Value {
    let command = ["reconstruct", skin, "--frames", "frames.csv", "--json", "r.json"];
    desk.run(&[&command[..], more].concat()).success();
    desk.report("r.json")
}

/// The strongest object of each frame, mm, with its peak.
fn found(report: &Value) -> Vec<[f64; 3]> {
    let frames = report["frames"].as_array().unwrap();
    let object =
        |frame: &Value| ["x_mm", "y_mm", "peak"].map(|key| frame["objects"][0][key].as_f64().unwrap());
    frames.iter().map(object).collect()
}

fn off_mm(at: &[f64], place: [f64; 2]) -> f64 {
    (at[0] - place[0] * 1e3).hypot(at[1] - place[1] * 1e3)
}

/// Each finger's distance from where it is found, mm.
fn errors(report: &Value) -> Vec<f64> {
    let found = found(report);
    assert_eq!(found.len(), PLACES.len());
    found.iter().zip(PLACES).map(|(found, place)| off_mm(&found[..2], place)).collect()
}

#[track_caller]
fn all_near(errors: &[f64], near: f64) {
    assert!(errors.iter().all(|&error| error < near), "{errors:.2?}");
}

#[test]
fn with_the_same_reference_for_each_frame_all_is_as_with_one() {
    let (desk, bench) = (desk(), Bench::new());
    let untouched = bench.frame(&[]);
    desk.write("one.csv", row(&untouched));
    desk.write("each.csv", table(&vec![untouched; PLACES.len()]));
    desk.write("frames.csv", table(&bench.fingers()));
    for (skin, near) in [("skin.toml", NEAR), ("plain.toml", NEAR_PLAIN)] {
        let one = reconstructed(&desk, skin, &["--reference", "one.csv", "--fit", "8mm"]);
        let each = reconstructed(&desk, skin, &["--reference", "each.csv", "--each", "--fit", "8mm"]);
        assert_eq!(one["frames"], each["frames"], "{skin}");
        assert_eq!(one["fingers"], each["fingers"], "{skin}");
        println!("{skin}: {:.2?} mm", errors(&one));
        all_near(&errors(&one), near);
    }
}

#[test]
fn each_frame_is_compared_with_its_own_reference_however_the_instrument_drifts() {
    let (desk, bench) = (desk(), Bench::new());
    let untouched = bench.frame(&[]);
    // All measurements drift by up to a tenth, each otherwise from frame to frame.
    let drifted = |frame: usize, values: &[f64]| -> Vec<f64> {
        let gain = |m: usize| 1.0 + 0.1 * ((frame * 7 + m * 3) as f64).sin();
        values.iter().enumerate().map(|(m, value)| value * gain(m)).collect()
    };
    let references: Vec<_> = (0..PLACES.len()).map(|frame| drifted(frame, &untouched)).collect();
    let pressed: Vec<_> = bench.fingers().iter().enumerate().map(|(frame, v)| drifted(frame, v)).collect();
    desk.write("references.csv", table(&references));
    desk.write("frames.csv", table(&pressed));
    let each = reconstructed(&desk, "skin.toml", &["--reference", "references.csv", "--each"]);
    let mean = reconstructed(&desk, "skin.toml", &["--reference", "references.csv"]);
    println!("each {:.2?}, mean {:.2?} mm", errors(&each), errors(&mean));
    all_near(&errors(&each), NEAR);
    assert!(errors(&mean).iter().all(|&error| error > 2.0 * NEAR), "{:.1?}", errors(&mean));
    // Ratios to a frame's own reference hold nothing of its gains.
    desk.write("frames.csv", table(&bench.fingers()));
    desk.write("one.csv", row(&untouched));
    let still = reconstructed(&desk, "skin.toml", &["--reference", "one.csv"]);
    for (each, still) in found(&each).iter().zip(found(&still)) {
        assert!((0..3).all(|i| (each[i] - still[i]).abs() < 1e-4), "{each:?} {still:?}");
    }
}

#[test]
fn differences_without_a_reference_show_what_the_frames_against_it_show() {
    let (desk, bench) = (desk(), Bench::new());
    let less = |frame: Vec<f64>, by: &[f64]| frame.iter().zip(by).map(|(v, r)| v - r).collect::<Vec<_>>();
    let (untouched, model) = (bench.frame(&[]), tiny_voltages());
    let differences: Vec<_> = bench.fingers().into_iter().map(|frame| less(frame, &untouched)).collect();
    // The same changes of a skin that is as its model has it, so that the image's scale is the same as well.
    let of_model = |difference: &Vec<f64>| difference.iter().zip(&model).map(|(d, m)| d + m).collect();
    let frames: Vec<Vec<f64>> = differences.iter().map(of_model).collect();
    desk.write("reference.csv", row(&model));
    desk.write("frames.csv", table(&frames));
    let against = reconstructed(&desk, "plain.toml", &["--reference", "reference.csv", "--fit", "8mm"]);
    desk.write("frames.csv", table(&differences));
    let alone = reconstructed(&desk, "plain.toml", &["--differences", "--fit", "8mm"]);
    assert_eq!((&alone["reference_file"], &alone["reference_frames"]), (&Value::Null, &0.into()));
    for (alone, against) in found(&alone).iter().zip(found(&against)) {
        assert!((0..3).all(|i| (alone[i] - against[i]).abs() < 1e-4), "{alone:?} {against:?}");
    }
    let [alone_fit, against_fit] = [&alone, &against].map(fitted);
    for (alone, against) in alone_fit.iter().flatten().zip(against_fit.iter().flatten()) {
        assert!((0..3).all(|i| (alone[i] - against[i]).abs() < 1e-3), "{alone:?} {against:?}");
    }
    println!("{:.2?} mm", errors(&alone));
    all_near(&errors(&alone), NEAR_PLAIN);
    // In another unit all is as much larger, at the same places.
    let counts = |difference: &Vec<f64>| difference.iter().map(|value| 1e4 * value).collect();
    desk.write("frames.csv", table(&differences.iter().map(counts).collect::<Vec<_>>()));
    for (counts, alone) in
        found(&reconstructed(&desk, "plain.toml", &["--differences"])).iter().zip(found(&alone))
    {
        assert!((counts[2] / alone[2] / 1e4 - 1.0).abs() < 1e-6, "{counts:?} {alone:?}");
        assert!((0..2).all(|i| (counts[i] - alone[i]).abs() < 1e-4), "{counts:?} {alone:?}");
    }
}

/// Fingers fitted to each frame: place, mm, and strength.
fn fitted(report: &Value) -> Vec<Vec<[f64; 3]>> {
    let finger = |it: &Value| ["x_mm", "y_mm", "strength"].map(|key| it[key].as_f64().unwrap());
    let of_frame = |fingers: &Value| fingers.as_array().unwrap().iter().map(finger).collect();
    report["fingers"].as_array().unwrap().iter().map(of_frame).collect()
}

#[test]
fn fingers_are_fitted_to_frames_as_many_as_press() {
    let (desk, bench) = (desk(), Bench::new());
    let pressed: [&[[f64; 2]]; 4] = [&[], &PLACES[..1], &[PLACES[0], PLACES[1]], &[PLACES[1], [0.02, 0.02]]];
    desk.write("idle.csv", row(&bench.frame(&[])));
    desk.write("frames.csv", pressed.map(|fingers| row(&bench.frame(fingers))).concat());
    for option in ["--fit", "--resolve"] {
        let report = reconstructed(&desk, "skin.toml", &["--reference", "idle.csv", option, "8mm"]);
        let fingers = fitted(&report);
        println!("{fingers:.2?}");
        assert_eq!(fingers.iter().map(Vec::len).collect::<Vec<_>>(), [0, 1, 2, 2]);
        for (fingers, places) in fingers.iter().zip(pressed) {
            for &place in places {
                let nearest = fingers.iter().map(|it| off_mm(&it[..2], place)).fold(f64::MAX, f64::min);
                assert!(nearest < NEAR_FITTED, "{place:?}: {fingers:.2?}");
            }
        }
    }
}

#[test]
fn where_no_board_is_involved_a_skin_may_have_more_pixels_than_one_takes() {
    let (desk, bench) = (desk(), Bench::new());
    desk.write("fine.toml", with(TINY, "columns = 16", "columns = 64"));
    desk.write("idle.csv", row(&bench.frame(&[])));
    desk.write("frames.csv", table(&bench.fingers()));
    let refused = desk.run(&["build", "fine.toml"]).refused();
    assert!(refused.contains("1024") || refused.contains("1,024"), "{refused}");
    let more = ["--reference", "idle.csv", "--fit", "8mm", "--png", "fine.png"];
    let [fine, coarse] = ["fine.toml", "skin.toml"].map(|skin| {
        let report = reconstructed(&desk, skin, &[&more[..], &["--force"]].concat());
        println!("{skin}: {:.2?} mm", errors(&report));
        all_near(&errors(&report), NEAR);
        report
    });
    assert!(desk.read("fine.png").starts_with(b"\x89PNG"));
    for (fine, coarse) in fitted(&fine).iter().flatten().zip(fitted(&coarse).iter().flatten()) {
        assert!((fine[0] - coarse[0]).hypot(fine[1] - coarse[1]) < 1.0, "{fine:.2?} {coarse:.2?}");
    }
}

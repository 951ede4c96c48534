//! What `calibrate` stored in a patch, and `build` of the same skin afterwards.
#![cfg(unix)]

mod program;

use dermatome_shared::patch::PatchView;
use program::{Desk, TINY};

/// Two trials with hysteresis.
fn readings() -> String {
    let mut text = String::from("pressure_kpa,strength\n");
    for _ in 0..2 {
        let loads = (0..=8).chain((0..8).rev()).map(f64::from);
        for (index, load) in loads.enumerate() {
            let back = if index > 8 { 0.25 * (load / 8.0) * (1.0 - load / 8.0) } else { 0.0 };
            text += &format!("{},{:.6}\n", load, 0.06 * load + back);
        }
    }
    text
}

/// A skin's patch, calibrated.
fn calibrated() -> Desk {
    let desk = Desk::with_patch();
    desk.write("readings.csv", readings());
    desk.run(&["calibrate", "skin.dermatome", "--readings", "readings.csv"]).success();
    desk
}

/// Points of the curve and plays.
fn stored(bytes: &[u8]) -> (usize, usize) {
    let patch = PatchView::validate(bytes).unwrap();
    (patch.header.calibration.points.len(), patch.play_operators().count())
}

#[test]
fn a_calibrated_patch_is_not_overwritten_by_one_that_is_not() {
    let desk = calibrated();
    let before = desk.read("skin.dermatome");
    let (points, plays) = stored(&before);
    assert!(points > 3 && plays > 0, "{points} {plays}");
    let shown = desk.run(&["inspect", "skin.dermatome"]).success().out;
    assert!(
        shown.contains(&format!("calibration   {points} points up to 8 kPa, {plays} play operators")),
        "{shown}"
    );
    let words = desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).refused();
    let counts = format!("({points} points, {plays} play operators)");
    assert!(words.contains("`skin.dermatome` was calibrated") && words.contains(&counts), "{words}");
    assert!(
        words.contains("allowed: `--preserve-calibration skin.dermatome`, another `--output`"),
        "{words}"
    );
    assert_eq!(desk.read("skin.dermatome"), before);
    desk.run(&["build", "skin.toml", "-o", "other.dermatome"]).success();
    assert_eq!(stored(&desk.read("other.dermatome")), (0, 0));
    desk.run(&["build", "skin.toml", "--no-patch"]).success();
}

#[test]
fn built_again_with_its_calibration_a_patch_is_the_same_to_the_byte() {
    let desk = calibrated();
    let before = desk.read("skin.dermatome");
    let keep = ["--keep-calibration", "skin.dermatome", "--json", "build.json"];
    let build = [&["build", "skin.toml", "-o", "skin.dermatome"][..], &keep].concat();
    let done = desk.run(&build).success();
    assert!(
        done.out.contains("play operators, preserved from skin.dermatome") && done.err.is_empty(),
        "{done:?}"
    );
    assert!(desk.read("skin.dermatome") == before, "the patch changed");
    let calibration = desk.report("build.json")["calibration"].clone();
    let (points, plays) = stored(&before);
    assert_eq!((&calibration["points"], &calibration["plays"]), (&points.into(), &plays.into()));
    assert_eq!(calibration["kept_from"], "skin.dermatome");

    // With another matrix it is kept too, with a warning.
    desk.write("skin.toml", TINY.replace("hyperparameter = 0.03", "hyperparameter = 0.1"));
    let done = desk.run(&build).success();
    assert!(
        done.err
            .contains("warning: the calibration was made with another reconstruction matrix or other places"),
        "{done:?}"
    );
    assert!(desk.read("skin.dermatome") != before);
    assert_eq!(stored(&desk.read("skin.dermatome")), (points, plays));
}

#[test]
fn a_curve_of_the_skin_file_is_no_loss() {
    let desk = Desk::empty();
    desk.write("skin.toml", format!("{TINY}[calibration]\nstrength = [0.5]\npressure = [\"10 kPa\"]\n"));
    let build = ["build", "skin.toml", "-o", "skin.dermatome"];
    desk.run(&build).success();
    assert_eq!(stored(&desk.read("skin.dermatome")), (1, 0));
    desk.run(&build).success();
    // Without it in the file, it would be lost.
    desk.write("skin.toml", TINY);
    assert!(desk.run(&build).refused().contains("(1 points, 0 play operators)"));
}

#[test]
fn calibrations_that_cannot_be_kept_are_refused() {
    let desk = calibrated();
    desk.write("palm.toml", TINY.replace("\"tiny\"", "\"palm\""));
    desk.write("text", "no patch");
    desk.run(&["build", "skin.toml", "-o", "plain.dermatome"]).success();
    let refused = |skin: &str, from: &str| {
        desk.run(&["build", skin, "-o", "new.dermatome", "--keep-calibration", from]).refused()
    };
    let other = refused("palm.toml", "skin.dermatome");
    assert!(other.contains("`skin.dermatome` is a patch of `tiny`; allowed: one of `palm`"), "{other}");
    let none = refused("skin.toml", "plain.dermatome");
    assert!(none.contains("`plain.dermatome` holds no calibration to keep"), "{none}");
    assert!(refused("skin.toml", "missing.dermatome").contains("cannot read patch `missing.dermatome`"));
    assert!(refused("skin.toml", "text").contains("`text`"));
    assert!(!desk.files().contains(&"new.dermatome".to_owned()));
}

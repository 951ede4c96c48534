//! `dermatome design` as a user runs it.

mod program;

use program::{Desk, TINY};

#[test]
fn a_design_is_a_skin_file_that_build_takes_and_its_figures_are_those_of_that_skin() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    let told = desk.run(&["design", "skin.toml", "--noise", "50", "--json", "design.json"]).success();
    assert!(told.out.contains("smallest d' (5.8 is detected)"), "{}", told.out);
    let report = desk.report("design.json");
    let least = |of: &str| report[of]["smallest_significance"].as_f64().unwrap();
    assert!(least("after") > least("before"), "{report}");
    assert_eq!((report["name"].as_str(), report["electrodes"].as_u64()), (Some("tiny-designed"), Some(8)));
    let text = String::from_utf8(desk.read("tiny-designed.toml")).unwrap();
    assert!(
        text.contains("# A coarse skin of 8 electrodes") && text.contains("placement = \"points\""),
        "{text}"
    );
    desk.run(&["build", "tiny-designed.toml"]).success();

    // What it says of the new skin is what it says of it as the skin to begin with.
    let arguments =
        ["design", "tiny-designed.toml", "--noise", "50", "--name", "again", "--json", "again.json"];
    desk.run(&arguments).success();
    let again = desk.report("again.json")["before"]["smallest_significance"].as_f64().unwrap();
    // Its finger is 4 % of a size that pixels on another mesh make a little different.
    assert!((again / least("after") - 1.0).abs() < 1e-3, "{again} {report}");
}

#[test]
fn what_cannot_be_designed_is_refused_before_anything_is_written() {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk.write("there.toml", "mine");
    let cases: [(&[&str], &str); 6] = [
        (
            &["skin.toml", "--out", "there.toml"],
            "`there.toml` is there already; allowed: another `--out`, or `--force`",
        ),
        (&["skin.toml", "--electrodes", "5"], "`--electrodes` is 5; allowed: 6 to 16"),
        (&["skin.toml", "--electrodes", "17"], "`--electrodes` is 17; allowed: 6 to 16"),
        (&["skin.toml", "--radius", "40%"], "`--radius` is 39.96 mm; allowed here: 1.00 mm to 24.97 mm"),
        (&["skin.toml", "--name", "a b"], "`--name` is \"a b\"; allowed: 1 to 32 letters"),
        (&["skin.toml", "--out", "nowhere/skin.toml"], "nowhere/skin.toml"),
    ];
    for (arguments, expected) in cases {
        let words = desk.run(&[&["design"], arguments].concat()).refused();
        assert!(words.contains(expected), "{arguments:?}: {words}");
    }
    assert_eq!(desk.read("there.toml"), b"mine");
    assert_eq!(desk.files(), ["skin.toml", "there.toml"]);
}

//! `dermatome evaluate` as a user runs it.

mod program;

use insta::{Settings, assert_snapshot};
use program::{Desk, TINY, shape, transcript};

/// Snapshots with these filters.
fn filtered(filters: &[(&str, &str)], check: impl FnOnce()) {
    let mut settings = Settings::clone_current();
    settings.set_omit_expression(true);
    filters.iter().for_each(|(text, instead)| settings.add_filter(text, *instead));
    settings.bind(check);
}

fn desk() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", TINY);
    desk
}

#[test]
fn what_evaluate_prints_and_reports_of_contacts_in_the_voltages() {
    let desk = desk();
    let command = ["evaluate", "skin.toml", "--noise", "none", "--spacing", "25%", "--diameter", "15%"];
    let done = desk.run(&[&command[..], &["--json", "e.json"]].concat()).success();
    let figures = [(r" {2,}", "  "), (r"-?\d+\.\d+", "[NUMBER]")];
    filtered(&figures, || assert_snapshot!("evaluate", done.out));
    let report = desk.report("e.json");
    filtered(&[], || assert_snapshot!("evaluate_json", shape(&report)));
    assert_eq!(report["contacts_found_in"], "voltages");
    assert_eq!(report["contacts_found_by"], "board");
}

#[test]
fn an_option_says_what_contacts_are_found_in() {
    let desk = desk();
    desk.write("image.toml", TINY.to_owned() + "\nfound_in = \"image\"\n");
    let found = |more: &[&str]| {
        let out = desk.run(&[&["evaluate", "--spacing", "30%"], more].concat()).success().out;
        let line = out.lines().nth(1).unwrap().to_owned();
        line.split("contacts found in the ").nth(1).unwrap().to_owned()
    };
    let [voltages, image] = ["voltages, by the board's code after six scans", "board's image, by its code"];
    assert_eq!(found(&["skin.toml"]), voltages);
    assert_eq!(found(&["skin.toml", "--found-in", "image", "--threshold", "0"]), image);
    assert_eq!(found(&["image.toml", "--contrast=-0.5"]), image);
    assert_eq!(found(&["image.toml", "--found-in", "voltages"]), voltages);
}

#[test]
fn a_skin_of_more_pixels_than_a_board_takes_says_so() {
    let desk = desk();
    desk.write(
        "skin.toml",
        TINY.replace("columns = 16", "pixels = \"elements\"")
            .replace("8 mm\"\n[material]", "2 mm\"\n[material]"),
    );
    let done = desk.run(&["evaluate", "skin.toml", "--spacing", "40%", "--json", "e.json"]).success();
    assert!(done.out.contains("contacts found in the f64 image"), "{}", done.out);
    let why = "no board finds contacts in the voltages: `image.pixels` gives";
    assert!(done.out.contains(why), "{}", done.out);
    let report = desk.report("e.json");
    assert!(report["no_board"].as_str().unwrap().starts_with("`image.pixels` gives"), "{report}");
    let asked = desk.run(&["evaluate", "skin.toml", "--found-in", "voltages"]).refused();
    assert!(asked.contains("--found-in is voltages, which takes a board: `image.pixels` gives"), "{asked}");
}

#[test]
fn what_does_not_fit_a_skin_is_refused_with_what_to_do() {
    let desk = desk();
    desk.write(
        "points.toml",
        TINY.replace(
            "model = \"complete\"\nwidth = \"8 mm\"\ncontact_impedance = \"0.18 ohm m\"",
            "model = \"point\"",
        ),
    );
    let words = transcript(
        &desk,
        &[
            &["evaluate", "missing.toml"],
            &["evaluate", "skin.toml", "--diameter", "80%"],
            &["evaluate", "skin.toml", "--spacing", "0.01mm"],
            &["evaluate", "skin.toml", "--electrode-error", "200%"],
            &["evaluate", "points.toml", "--impedance-error", "10"],
            &["evaluate", "skin.toml", "--png", "missing/e.png"],
            &["evaluate", "skin.toml", "--threshold", "0"],
            &["evaluate", "skin.toml", "--contrast=-0.5"],
            &["evaluate", "skin.toml", "--found-in", "tea"],
        ],
    );
    filtered(&[], || assert_snapshot!("errors_evaluate", words));
}

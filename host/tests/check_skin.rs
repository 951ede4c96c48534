//! `dermatome check --skin` as a user runs it: a board whose patch is not quite of the skin it is on.

mod program;

use program::{Desk, TINY, with};

/// A coarse rectangle whose sides tell where its wires begin: 16 electrodes, all of them on the rim.
fn sheet() -> String {
    let changes = [
        ("name = \"tiny\"", "name = \"sheet\""),
        (DISC, RECTANGLE),
        ("edge_length = \"8 mm\"", "edge_length = \"6 mm\""),
        ("5.88 mS", "5.0 mS"),
        ("count = 8", "count = 16"),
        ("placement = \"rim\"", "placement = \"rim\"\nfirst = \"90 deg\""),
        ("width = \"8 mm\"", "width = \"6 mm\""),
    ];
    changes.iter().fold(TINY.to_owned(), |text, (line, other)| with(&text, line, other))
}

const DISC: &str = "kind = \"disc\"\ndiameter = \"100 mm\"";
const RECTANGLE: &str = "kind = \"rectangle\"\nwidth = \"100 mm\"\nheight = \"60 mm\"";

/// A desk with the sheet's file and patch.
fn desk() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", sheet());
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk
}

/// What `check --skin` says of a board with that patch on a skin of this file; its findings.
fn findings(desk: &Desk, real: &str) -> Vec<String> {
    desk.write("real.toml", real);
    desk.write("store.dermatome", desk.read("skin.dermatome"));
    let (_board, port) = desk.board("real.toml", &["--store", "store.dermatome"]);
    let done =
        desk.run(&["check", "--port", &port, "--skin", "skin.toml", "--frames", "5", "--json", "check.json"]);
    let found = done
        .out
        .lines()
        .filter_map(|line| line.strip_prefix("wrong: "))
        .map(str::to_owned)
        .collect::<Vec<_>>();
    assert_eq!(done.status.success(), found.is_empty(), "{done:#?}");
    found
}

#[test]
fn a_sheet_of_another_conductivity_is_named_with_its_own_and_no_contact_is_blamed() {
    let desk = desk();
    assert_eq!(findings(&desk, &sheet()), [""; 0]);
    let model = &desk.report("check.json")["model"];
    assert!(model["correlation"].as_f64().unwrap() > 0.99, "{model}");
    for (real, ratio) in [("1.5 mS", "0.3"), ("7.0 mS", "1.4"), ("15.0 mS", "3.0")] {
        let found = findings(&desk, &with(&sheet(), "5.0 mS", real));
        assert_eq!(found.len(), 1, "{real}: {found:#?}");
        assert!(found[0].contains(&format!("the sheet conducts {ratio}")), "{real}: {found:#?}");
        let told = desk.report("check.json")["model"]["sheet_conductivity_s"].as_f64().unwrap();
        let real: f64 = real.trim_end_matches(" mS").parse().unwrap();
        assert!((1e3 * told / real - 1.0).abs() < 0.05, "{told}");
    }
}

#[test]
fn wires_that_begin_elsewhere_are_told_and_no_contact_is_blamed() {
    let desk = desk();
    // Mirrored, a rectangle is the same as begun elsewhere.
    for other in ["first = \"0 deg\"", "first = \"60 deg\"\ndirection = \"counter-clockwise\""] {
        let found = findings(&desk, &with(&sheet(), "first = \"90 deg\"", other));
        assert_eq!(found.len(), 1, "{other}: {found:#?}");
        let words = ["another order fits the model better", "use the wire of electrode", "as the first"];
        assert!(words.iter().all(|words| found[0].contains(words)), "{other}: {found:#?}");
    }
}

#[test]
fn a_skin_of_another_shape_is_told_from_the_one_of_the_file() {
    let desk = desk();
    let disc = with(&sheet(), RECTANGLE, DISC);
    let found = findings(&desk, &disc);
    let says = |words: &str| found.iter().any(|found| found.contains(words));
    assert!(says("resemble the model only weakly") || says("of the voltages over"), "{found:#?}");
    assert!(!says("touches worse"), "{found:#?}");
}

#[test]
fn the_patch_of_another_skin_and_other_steps_are_named() {
    let desk = desk();
    desk.write("other.toml", sheet().replace("\"sheet\"", "\"other\""));
    let (_board, port) = desk.board("skin.toml", &["--store", "skin.dermatome"]);
    let done = desk.run(&["check", "--port", &port, "--skin", "other.toml", "--frames", "3"]);
    assert!(
        done.out.contains("the board's patch is of `sheet`, skin file `other.toml` is of `other`"),
        "{done:#?}"
    );
    desk.write("opposite.toml", sheet().replace("\"adjacent\"", "\"opposite\""));
    let words = desk.run(&["check", "--port", &port, "--skin", "opposite.toml"]).refused();
    assert!(words.contains("measures other steps than skin file `opposite.toml`"), "{words}");
}

#[test]
fn a_skin_of_point_electrodes_is_compared_though_its_contacts_cannot_be_fitted() {
    let desk = desk();
    let complete = "model = \"complete\"\nwidth = \"6 mm\"\ncontact_impedance = \"0.18 ohm m\"";
    desk.write("points.toml", with(&sheet(), complete, "model = \"point\""));
    let (_board, port) = desk.board("skin.toml", &["--store", "skin.dermatome"]);
    let done = desk.run(&["check", "--port", &port, "--skin", "points.toml", "--frames", "3"]).success();
    assert!(done.out.contains("not fitted") && done.out.contains("nothing looks wrong"), "{done:#?}");
}

//! `dermatome check --skin` as a user runs it: a board whose patch is not quite of the skin it is on.

mod program;

use dermatome::{
    model::Model,
    quantize,
    simulate::{
        Noise, Script, SimulatedSkin,
        board::{BoardOptions, SimulatedBoard},
        instrument::{Instrument, ScanTable},
    },
    skin::Skin,
};
use dermatome_shared::{acquire::FrontEnd, frame::Frame};
use program::{Desk, TINY, with};
use std::path::Path;

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

#[test]
fn a_sheet_that_conducts_a_hundred_times_worse_is_named_and_no_contact_is_blamed() {
    let found = findings(&desk(), &with(&sheet(), "5.0 mS", "50 uS"));
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains("the sheet conducts 0.01 times"), "{found:#?}");
}

/// A desk with a patch whose gain lets voltages clip, at the skin file's current.
fn desk_that_clips() -> Desk {
    let desk = Desk::empty();
    desk.write("skin.toml", with(&sheet(), "frequency = ", "gain = 8\nfrequency = "));
    desk.run(&["build", "skin.toml", "-o", "skin.dermatome"]).success();
    desk
}

#[test]
fn a_current_that_clips_is_told_by_check_and_lowered_by_tare_unless_it_is_to_be_kept() {
    let desk = desk_that_clips();
    let found = findings(&desk, &sheet());
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].contains("voltages clip at 1 mA, and not at 0.25 mA"), "{found:#?}");
    let (_board, port) = desk.board("skin.toml", &["--store", "skin.dermatome"]);
    let kept = desk.run(&["tare", "--port", &port, "--amplitude", "keep"]).refused();
    assert!(kept.contains("did not average"), "{kept}");
    let tared = desk.run(&["tare", "--port", &port, "--json", "tare.json"]).success();
    assert!(
        tared.err.contains("1 mA is too much for this skin or its contacts: measuring with 0.25 mA"),
        "{tared:#?}"
    );
    assert_eq!(desk.report("tare.json")["amplitude_a"], 0.25e-3_f32);
}

#[test]
fn a_stream_that_tares_first_lowers_a_current_that_clips() {
    let desk = desk_that_clips();
    let (_board, port) = desk.board("skin.toml", &["--store", "skin.dermatome"]);
    let stream = |desk: &Desk| {
        let done = desk.run(&["stream", "--port", &port, "--frames", "5", "--json", "stream.json"]).success();
        assert_eq!(desk.report("stream.json")["frames_flagged"], serde_json::json!({}));
        done.err
    };
    let first = stream(&desk);
    assert!(first.contains("1 mA is too much for this skin or its contacts"), "{first}");
    // It lasts, and a board that has a reference keeps its current.
    let second = stream(&desk);
    assert!(!second.contains("too much"), "{second}");
}

/// A skin whose leads make the voltages of every other pair differ with drive and sense exchanged, above 20 kHz.
struct Leads(SimulatedSkin);

impl Instrument for Leads {
    fn scan(&mut self, table: &ScanTable, script_time: Option<f64>) -> Frame {
        let mut frame = self.0.scan(table, script_time);
        if table.drive.frequency > 20e3 {
            for (code, step) in frame.codes.iter_mut().zip(&table.steps) {
                code.0 = if step.drive_plus < step.sense_plus { code.0 / 3 } else { code.0 };
            }
        }
        frame
    }

    fn front_end(&self) -> Option<FrontEnd> {
        self.0.front_end()
    }
}

#[test]
fn leads_that_take_current_are_told_from_multiplexers_by_a_lower_frequency() {
    let desk = desk();
    let text = sheet();
    let skin = Skin::parse(Path::new("skin.toml"), &text).unwrap().made().unwrap();
    let patch = quantize::patch(&skin, &Model::build(&skin, |_| ()).unwrap()).unwrap();
    let leads = Leads(SimulatedSkin::new(&skin, Script::nobody(), Noise { snr_db: 60.0, seed: 1 }).unwrap());
    let board =
        SimulatedBoard::start(BoardOptions { patch: Some(patch), ..BoardOptions::default() }, leads).unwrap();
    let port = format!("tcp:{}", board.address());
    let done = desk.run(&["check", "--port", &port, "--skin", "skin.toml", "--frames", "5"]);
    let wrong: Vec<_> = done.out.lines().filter(|line| line.starts_with("wrong: ")).collect();
    assert_eq!(wrong.len(), 1, "{done:#?}");
    assert!(
        wrong[0].contains("leads take current") && wrong[0].contains("`drive.frequency` = \"12.5 kHz\""),
        "{wrong:?}"
    );
    let drive = desk.run(&["drive", "--port", &port]).success();
    assert!(drive.out.contains("as the patch says"), "the drive is what it was: {drive:#?}");
}

#[test]
fn noise_is_told_from_multiplexers() {
    let desk = desk();
    let (_board, port) =
        desk.board("skin.toml", &["--store", "skin.dermatome", "--noise-db", "15", "--seed", "3"]);
    for skin in [&[][..], &["--skin", "skin.toml"]] {
        let done = desk.run(&[&["check", "--port", &port][..], skin].concat());
        let wrong: Vec<_> = done.out.lines().filter(|line| line.starts_with("wrong: ")).collect();
        assert!(
            wrong.iter().any(|line| line.starts_with("wrong: noise is large beside the voltages")),
            "{done:#?}"
        );
        assert!(!done.out.contains("multiplexers"), "{done:#?}");
    }
}

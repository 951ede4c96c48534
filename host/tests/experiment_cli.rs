//! `dermatome experiment` as a user runs it: one quick experiment, its figures within bounds, and its errors.
#![cfg(unix)]

mod program;

use assert_cmd::cargo::cargo_bin;
use program::{Desk, Running};
use serde_json::Value;
use std::process::{Command, Stdio};

fn comparison<'a>(report: &'a Value, what: &str) -> &'a Value {
    let all = report["experiments"][0]["comparisons"].as_array().unwrap();
    all.iter()
        .find(|found| found["what"].as_str().unwrap().starts_with(what))
        .unwrap_or_else(|| panic!("{what}"))
}

/// The report of one experiment.
fn report_of(name: &str) -> Value {
    let desk = Desk::empty();
    desk.run(&["experiment", name, "--out", "out"]).success();
    desk.report("out/report.json")
}

/// Says at least, or at most, this much, and is met.
#[track_caller]
fn assert_met(report: &Value, what: &str, limit: &str, value: f64) {
    let comparison = comparison(report, what);
    let wanted = comparison[limit].as_f64().unwrap_or_else(|| panic!("{comparison:#}"));
    assert!((wanted - value).abs() < 1e-9 && comparison["met"] == true, "{comparison:#}");
}

/// The sample's centre of pressure lies closer to the load than the thesis' did, in per cent, and is found.
fn assert_loading(name: &str, sample: &str, thesis: f64) {
    let report = report_of(name);
    for what in ["CoP error, larger mean of x and y", "CoP error, mean distance"] {
        assert_met(&report, &format!("{sample}: {what}"), "at_most", thesis);
    }
    let figures = &report["experiments"][0]["figures"];
    let [all, without] =
        ["readings_under_load", "readings_without_contact"].map(|key| figures[key].as_u64().unwrap());
    assert!(all >= 69 && without * 20 <= all, "{without} of {all} readings are without a contact");
    let found = |what: &str| comparison(&report, &format!("{sample}: {what}"))["found"].as_f64().unwrap();
    // Noise is 0.1 % in a frame.
    assert!(found("what the artefacts of a load alone do to the voltages") > 2.0, "{report:#}");
    let plain = comparison(
        &report,
        &format!("{sample}: without electrode movement in the matrix: CoP error, mean distance"),
    );
    assert!((plain["at_most"].as_f64().unwrap() - thesis).abs() < 1e-9, "{plain:#}");
    assert!(plain["found"].as_f64().unwrap() > 4.0 * found("CoP error, mean distance"), "{plain:#}");
    assert_eq!(plain["met"], sample == "Sample 1", "{plain:#}");
    assert_assessed(&report, sample, thesis);
}

/// Table 6.1 has the sample, with the thesis' position error as its limit, and is met where it must be.
fn assert_assessed(report: &Value, sample: &str, position_error: f64) {
    let table = report["table_6_1"].as_array().unwrap();
    assert_eq!((table.len(), table[0]["sample"].as_str()), (1, Some(sample)), "{table:#?}");
    let [range, hysteresis, position] = [0, 1, 2].map(|index| &table[0]["figures"][index]);
    assert!((position["at_most"].as_f64().unwrap() - position_error / 100.0).abs() < 1e-9, "{position:#}");
    assert!(
        position["met"] == true && range["found"].as_f64().unwrap() > 0.7 * range["thesis"].as_f64().unwrap()
    );
    let summary = &comparison(report, &format!("{sample}: hysteresis of the image"))["found"];
    assert_eq!((&hysteresis["found"], &hysteresis["thesis"]), (summary, &hysteresis["at_most"]));
}

#[test]
fn sample_1_is_loaded_and_its_centre_of_pressure_found_better_than_in_the_thesis() {
    assert_loading("loading-1", "Sample 1", 4.6);
}

#[test]
fn sample_2_is_loaded_and_its_centre_of_pressure_found_better_than_in_the_thesis() {
    assert_loading("loading-2", "Sample 2", 3.2);
}

#[test]
fn sample_3_of_one_layer_is_loaded_and_its_centre_of_pressure_found_better_than_in_the_thesis() {
    assert_loading("loading-3-single", "Sample 3, single", 15.7);
}

#[test]
fn sample_3_of_two_layers_is_loaded_and_its_centre_of_pressure_found_better_than_in_the_thesis() {
    assert_loading("loading-3-dual", "Sample 3, dual", 14.1);
}

#[test]
fn the_large_o_shows_its_hole_and_the_l_its_corner_and_small_os_say_that_they_do_not() {
    let report = report_of("shapes");
    for sample in ["Sample 3, single", "Sample 3, dual"] {
        let hole = |size: &str| format!("{sample}: hole of the 'O' of {size} against its ring");
        assert_met(&report, &hole("110/66 mm"), "at_least", 20.0);
        assert_met(&report, &format!("{sample}: error of that angle"), "at_most", 20.0);
        let found = |what: &str| comparison(&report, &format!("{sample}: {what}"))["found"].as_f64().unwrap();
        assert!((found("angle of the 'L'") - 90.0).abs() < 20.0);
        assert!(found("distance of the corner found") < 4.0, "{report:#}");
        let dips = ["110/66 mm", "90/54 mm", "70/42 mm"].map(|size| comparison(&report, &hole(size)));
        for dip in dips {
            assert_eq!(dip["met"], dip["found"].as_f64().unwrap() >= 20.0, "{dip:#}");
        }
        let [large, middle, small] = dips.map(|dip| dip["found"].as_f64().unwrap());
        assert!(large > middle && middle > small, "{large} {middle} {small}");
    }
    for depth in ["full", "half"] {
        let name = |what: &str| format!("thin fingers, {depth} depth: {what}");
        assert_met(&report, &name("seen as exactly one"), "at_least", 99.0);
        let mean = comparison(&report, &name("position error, mean"))["found"].as_f64().unwrap();
        assert!(mean > 0.0 && mean < 1.5, "{mean}");
    }
}

#[test]
fn five_points_are_found_better_than_in_the_thesis() {
    let report = report_of("points");
    assert_met(&report, "position error, mean", "at_most", 9.3);
    assert_met(&report, "position error, largest", "at_most", 19.0);
    let plain = comparison(&report, "without electrode movement in the matrix");
    assert!(plain["met"] == false && plain["found"].as_f64().unwrap() > 20.0, "{plain:#}");
}

#[test]
fn moving_fingers_keep_their_numbers_and_one_that_was_long_away_gets_a_new_one() {
    let report = report_of("tracking");
    assert_met(&report, "identities wrong", "at_most", 0.0);
    assert_met(&report, "finger frames with a track", "at_least", 98.0);
    let numbers = report["experiments"][0]["figures"]["numbers"].as_array().unwrap();
    let of_fingers: Vec<_> = numbers.iter().map(|ids| ids.as_array().unwrap().len()).collect();
    assert_eq!(of_fingers, [1, 1, 2], "{numbers:?}");
    let all: std::collections::BTreeSet<u64> =
        numbers.iter().flat_map(|ids| ids.as_array().unwrap()).map(|id| id.as_u64().unwrap()).collect();
    assert_eq!(all.len(), 4, "{numbers:?}");
    for closest in ["63 mm", "42 mm"] {
        assert_met(&report, &format!("fingers that approach to {closest}"), "at_most", 0.0);
    }
    let closer = comparison(&report, "fingers that approach to 21 mm");
    assert!(closer["met"].is_null(), "closer than they must be told apart: {closer:#}");
    for approach in report["experiments"][0]["figures"]["approach"].as_array().unwrap() {
        let [closest, kept, two] =
            ["closest_m", "numbers_kept", "two_contacts_percent"].map(|key| approach[key].as_f64().unwrap());
        assert!(two > 40.0 && (closest < 0.04 || kept == 6.0 && two > 90.0), "{approach:#}");
    }
}

#[test]
fn the_thesis_own_simulation_matches_on_its_mesh_and_thin_fingers_in_noise_do_not() {
    let desk = Desk::empty();
    desk.run(&["experiment", "surface", "--out", "out"]).success();
    let report = desk.report("out/report.json");
    let meshes = report["experiments"][0]["figures"].as_array().unwrap();
    let count = |mesh: usize, key: &str| meshes[mesh][key].as_u64().unwrap();
    assert_eq!(
        [0, 1].map(|mesh| [count(mesh, "nodes"), count(mesh, "elements")]),
        [[337, 624], [1201, 2304]]
    );
    assert!((3700..4500).contains(&count(2, "elements")), "{}", count(2, "elements"));
    for way in ["same mesh, no noise", "skin meshed anew, 60 dB"] {
        assert_met(&report, &format!("Fig. 5.2, hemisphere: {way}: images"), "at_least", 5.0);
    }
    let thin = comparison(&report, "Fig. 5.2, hemisphere: skin meshed anew, 50 dB, thin");
    assert!(thin["met"] == false && thin["found"].as_f64().unwrap() < 2.0, "{thin:#}");
    let planar = comparison(&report, "Fig. 5.6, disc: same mesh, no noise");
    assert!(planar["thesis"].is_null() && planar["met"].is_null() && planar["found"] == 5.0, "{planar:#}");
    let page = String::from_utf8(desk.read("out/report.html")).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 3);
    assert!(page.contains("which no image of a real skin is"), "the page says that one mesh stands for both");
}

#[test]
fn figures_of_the_thesis_stand_beside_what_they_were_found_for() {
    let thesis = |report: &Value, what: &str| comparison(report, what)["thesis"].clone();
    assert_eq!(thesis(&report_of("saline-depth"), "hysteresis of the method, image"), Value::Null);
    assert_eq!(thesis(&report_of("saline-volume"), "hysteresis of the method, image"), 1.06);
    let map = report_of("pressure-map");
    assert_eq!(thesis(&map, "Sample 1: ringing, smallest"), Value::Null);
    assert_eq!(thesis(&map, "Sample 2: ringing, smallest"), 1.5);
    assert_eq!(thesis(&map, "Sample 2: ringing, largest"), 7.98);
}

#[test]
fn an_interrupt_leaves_no_folder() {
    let desk = Desk::empty();
    let running = desk.start(&["experiment", "all", "--out", "out"]);
    std::thread::sleep(std::time::Duration::from_millis(700));
    running.interrupt();
    let done = running.finish();
    assert_eq!(done.status.code(), None, "{done:?}");
    assert_eq!(desk.files(), Vec::<String>::new());
}

#[test]
fn the_saline_map_is_within_its_bounds_and_the_same_each_time() {
    let desk = Desk::empty();
    let done = desk.run(&["experiment", "saline-map", "--out", "first"]).success();
    assert_eq!(done.err, "", "no progress where there is no terminal");
    let report = desk.report("first/report.json");
    assert_eq!(report["simulated"], true);
    let found = |what: &str| comparison(&report, what)["found"].as_f64().unwrap();
    assert!(found("position error, mean") <= 1.5, "{report:#}");
    assert!(found("position error, largest") <= 4.0, "{report:#}");
    assert!(found("spread of the region's share") <= 10.0, "{report:#}");
    assert!(found("drift in 120 s") <= 0.3, "{report:#}");
    assert_eq!(comparison(&report, "position error, largest")["thesis"], 4.0);
    let places = report["experiments"][0]["figures"]["places"].as_array().unwrap();
    assert_eq!(places.len(), 15);
    assert!(places.iter().all(|place| place["contacts"] == 1), "{places:?}");
    let page = String::from_utf8(desk.read("first/report.html")).unwrap();
    assert!(
        page.contains("simulation with stated models") && page.contains("<svg") && page.contains("base64,")
    );
    assert!(done.out.contains("\n1 experiment in "), "{}", done.out);
    // An existing folder is used, and another file in it is left alone.
    std::fs::create_dir(desk.path("second")).unwrap();
    desk.write("second/mine.txt", "kept");
    desk.run(&["experiment", "saline-map", "--out", "second"]).success();
    for name in ["report.html", "report.json"] {
        assert!(
            desk.read(&format!("first/{name}")) == desk.read(&format!("second/{name}")),
            "{name} differs"
        );
    }
    assert_eq!(desk.read("second/mine.txt"), b"kept");
}

#[test]
fn the_hemispheres_surface_is_better_than_its_planar_image_and_the_page_shows_both() {
    let desk = Desk::empty();
    desk.run(&["experiment", "hemisphere-flat", "--out", "out"]).success();
    let report = desk.report("out/report.json");
    let ratio = comparison(&report, "single contacts away from the pole: planar over surface");
    assert_eq!((&ratio["at_least"], &ratio["met"]), (&2.0.into(), &true.into()), "{report:#}");
    let errors = &report["experiments"][0]["figures"]["errors"];
    let mean = |model: &str| errors[0]["mean_error_mm"][model].as_f64().unwrap();
    assert!(mean("surface") < 10.0 && mean("planar") > 20.0, "{errors:#}");
    let [away, found] = ["away_from_pole", "contacts"].map(|key| errors[0][key].as_u64().unwrap());
    // Of 50, those that both models show.
    assert!(away > 30 && away < found && found >= 48, "{errors:#}");
    let page = String::from_utf8(desk.read("out/report.html")).unwrap();
    assert_eq!(page.matches("data:image/png;base64,").count(), 2);
    for words in ["2 contacts, surface", "3 contacts, planar", "Fig. 5.11"] {
        assert!(page.contains(words), "{words}");
    }
}

#[test]
fn names_and_folders_that_will_not_do_are_refused_and_leave_nothing() {
    let desk = Desk::empty();
    desk.write("file", "mine");
    let unknown = desk.run(&["experiment", "saline"]);
    assert_eq!(unknown.status.code(), Some(2));
    let unknown = unknown.refused();
    assert!(
        unknown.contains("'saline'") && unknown.contains("allowed: all, divider, saline-depth"),
        "{unknown}"
    );
    let file = desk.run(&["experiment", "saline-depth", "--out", "file"]).refused();
    assert!(file.contains("`file`") && file.contains("not a folder"), "{file}");
    let deep = desk.run(&["experiment", "saline-depth", "--out", "missing/out"]).refused();
    assert!(deep.contains("missing/out"), "{deep}");
    desk.write("skin.toml", program::TINY);
    desk.write("push.csv", "time_s,finger,x_m,y_m,radius_m,force_n\n0,1,0,0,0.01,5\n");
    let force = desk.run(&["simulate", "skin.toml", "--path", "push.csv"]).refused();
    assert!(force.contains("give `--material`"), "{force}");
    assert_eq!(desk.files(), ["file", "push.csv", "skin.toml"]);
    assert_eq!(desk.read("file"), b"mine");
}

/// A few rows on a coarse skin, its contacts found in both.
fn trust(desk: &Desk, seed: &str) -> Value {
    desk.write("skin.toml", program::TINY);
    let rows = ["--rows", "untouched,one,latency", "--found-in", "image,voltages"];
    let few = ["--presses", "4", "--frames", "40", "--snr", "60,50", "--seed", seed, "--json", "trust.json"];
    let done = desk.run(&[&["experiment", "trust", "skin.toml"], &rows[..], &few[..]].concat()).success();
    assert!(done.out.contains("tiny, 100 mm, contacts found in the voltages"), "{}", done.out);
    assert_eq!(done.out.matches("full depth: exactly one contact").count(), 4, "{}", done.out);
    desk.report("trust.json")
}

#[test]
fn trust_sets_what_a_board_says_beside_what_is_asked_and_one_seed_gives_the_same() {
    let desk = Desk::empty();
    let report = trust(&desk, "3");
    assert_eq!((&report["seed"], &report["presses"], &report["frames"]), (&3.into(), &4.into(), &40.into()));
    let skins = report["skins"].as_array().unwrap();
    assert_eq!((&skins[0]["found_in"], &skins[1]["found_in"]), (&"image".into(), &"voltages".into()));
    let mut counted = [0; 3];
    for row in skins.iter().flat_map(|skin| skin["rows"].as_array().unwrap()) {
        assert!(row["not_run"].is_null() && !row["figures"].as_array().unwrap().is_empty(), "{row:#}");
        for figure in row["figures"].as_array().unwrap() {
            let keys: Vec<_> = figure.as_object().unwrap().keys().map(String::as_str).collect();
            assert_eq!(
                keys,
                ["at_least", "at_most", "found", "noise_db", "note", "of", "unit", "verdict", "what"]
            );
            let found = figure["found"].as_f64().unwrap_or(f64::NAN);
            let within = figure["at_most"].as_f64().map(|most| found <= most);
            let within = within.or(figure["at_least"].as_f64().map(|least| found >= least));
            match figure["verdict"].as_str() {
                Some("open") => counted[2] += 1,
                Some(verdict) => {
                    assert_eq!(within, Some(verdict == "met"), "{figure:#}");
                    counted[usize::from(verdict != "met")] += 1;
                }
                None => assert_eq!(within, None, "{figure:#}"),
            }
        }
    }
    assert_eq!(["met", "not_met", "open"].map(|key| report[key].as_u64().unwrap()), counted);
    assert!(counted[0] > 0 && counted[2] > 0, "40 frames show no rate of one an hour: {counted:?}");
    // A finger of 4 mm on this coarse skin of 8 electrodes is seen in the voltages.
    let one = &skins[1]["rows"][1]["figures"][0];
    assert!(
        one["what"] == "full depth: exactly one contact" && one["found"].as_f64().unwrap() >= 75.0,
        "{one:#}"
    );
    assert_eq!(trust(&desk, "3")["skins"], report["skins"]);
    assert_ne!(trust(&desk, "4")["skins"], report["skins"]);
}

#[test]
fn faults_of_wires_make_no_contact_on_an_untouched_skin() {
    let desk = Desk::empty();
    desk.write("skin.toml", program::TINY);
    let options =
        ["--rows", "faults", "--snr", "60", "--presses", "1", "--seed", "5", "--json", "trust.json"];
    desk.run(&[&["experiment", "trust", "skin.toml"], &options[..]].concat()).success();
    let report = desk.report("trust.json");
    let figures = report["skins"][0]["rows"][0]["figures"].as_array().unwrap();
    let untouched: Vec<_> = figures.iter().filter(|figure| figure["at_most"] == 0.0).collect();
    assert_eq!(untouched.len(), 21, "seven faults, each as it comes, as it goes, and from the start");
    for figure in untouched {
        assert!(figure["found"] == 0.0 && figure["of"].as_u64().unwrap() >= 320, "{figure:#}");
    }
}

#[test]
fn check_names_what_is_wrong_with_a_skin_and_blames_no_sound_electrode() {
    let desk = Desk::empty();
    desk.write("skin.toml", program::TINY);
    let options = ["--amplitudes", "100,10", "--seed", "5", "--json", "check.json"];
    desk.run(&[&["experiment", "check", "skin.toml"], &options[..]].concat()).success();
    let report = desk.report("check.json");
    for row in report.as_array().unwrap() {
        assert_eq!(row["blamed_sound"], 0, "{row:#}");
        // A disc is the same however its wires are turned.
        let is_told = !row["wrong"].as_str().unwrap().starts_with("wires ");
        assert_eq!(row["named"], if is_told { row["tried"].clone() } else { 0.into() }, "{row:#}");
    }
    let tried: u64 = report.as_array().unwrap().iter().map(|row| row["tried"].as_u64().unwrap()).sum();
    assert_eq!(tried, 2 * (1 + 4 * 8 + 2 + 5));
}

#[test]
fn presses_are_recorded_to_learn_from() {
    let desk = Desk::empty();
    desk.write("skin.toml", program::TINY);
    let record = ["experiment", "presses", "skin.toml", "--count", "60", "--noise-db", "70", "--seed"];
    desk.run(&[&record[..], &["3", "--json", "presses.json"]].concat()).success();
    let report = desk.report("presses.json");
    assert!(
        report["presses"] == 60 && report["measurements"] == 40 && report["untouched_frames"] == 16,
        "{report}"
    );
    let recorded = desk.read("presses.npz");
    let learn =
        ["learn", "skin.toml", "--presses", "presses.npz", "-o", "learnt.dermatome", "--json", "learn.json"];
    desk.run(&learn).success();
    let report = desk.report("learn.json");
    let [learnt, built] = ["test", "model_test"].map(|test| report[test]["median_mm"].as_f64().unwrap());
    assert!(learnt < built, "{learnt} {built}");
    let replay =
        ["replay", "presses.npz:v_pressed", "--patch", "learnt.dermatome", "--reference", "presses.npz:idle"];
    let replayed = desk.run(&[&replay[..], &["--rate", "5"]].concat()).success();
    assert!(replayed.out.lines().count() >= 60, "{}", replayed.out);
    // The same again, and others with another seed.
    desk.run(&[&record[..], &["3"]].concat()).success();
    assert!(desk.read("presses.npz") == recorded);
    desk.run(&[&record[..], &["4"]].concat()).success();
    assert!(desk.read("presses.npz") != recorded);
}

#[test]
fn presses_go_into_an_archive_only() {
    let desk = Desk::empty();
    desk.write("skin.toml", program::TINY);
    let refused = desk.run(&["experiment", "presses", "skin.toml", "-o", "presses.csv"]).refused();
    assert!(refused.contains("`presses.csv`; its name must end in .npz"), "{refused}");
    assert_eq!(desk.files(), ["skin.toml"]);
}

#[test]
fn a_skin_too_narrow_for_a_finger_is_pressed_in_its_middle() {
    let desk = Desk::empty();
    let narrow = program::TINY
        .replace(
            "kind = \"disc\"\ndiameter = \"100 mm\"",
            "kind = \"rectangle\"\nwidth = \"300 mm\"\nheight = \"12 mm\"",
        )
        .replace("edge_length = \"8 mm\"", "edge_length = \"3 mm\"");
    assert!(narrow.contains("300 mm"));
    desk.write("skin.toml", narrow);
    desk.run(&["experiment", "presses", "skin.toml", "--count", "5"]).success();
}

#[test]
fn rows_and_noises_that_are_not_there_are_refused() {
    let desk = Desk::empty();
    for (arguments, words) in [
        (["--rows", "trees"], "allowed: untouched, one, rim"),
        (["--snr", "60,300"], "allowed are 0 to 200 dB"),
        (["--presses", "0"], "'--presses <N>'"),
        (["--found-in", "tea"], "[possible values: image, voltages]"),
    ] {
        let refused = desk.run(&[&["experiment", "trust"], &arguments[..]].concat());
        assert_eq!(refused.status.code(), Some(2));
        let refused = refused.refused();
        assert!(refused.contains(words), "{refused}");
    }
    let missing = desk.run(&["experiment", "trust", "missing.toml", "--json", "trust.json"]).refused();
    assert!(missing.contains("`missing.toml`"), "{missing}");
    assert_eq!(desk.files(), Vec::<String>::new());
}

#[test]
fn where_there_is_no_room_nothing_is_written() {
    let desk = Desk::empty();
    // No file may grow beyond 8 blocks, as on a disk that is full.
    let script = format!(
        "trap '' XFSZ; ulimit -f 8; exec '{}' experiment saline-depth --out out",
        cargo_bin("dermatome").display()
    );
    let mut command = Command::new("sh");
    command.args(["-c", &script]).current_dir(desk.path("")).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let words = Running::start(&mut command).finish().refused();
    assert!(words.contains("out/report.html"), "{words}");
    assert_eq!(desk.files(), Vec::<String>::new());
}

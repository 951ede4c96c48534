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
    let unknown = desk.run(&["experiment", "saline"]).refused();
    assert!(unknown.contains("no experiment `saline`; allowed: all, divider, saline-depth"), "{unknown}");
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

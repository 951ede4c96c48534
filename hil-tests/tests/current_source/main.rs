//! The current source: its corners against limits, its netlist against the figures that the emulated board and
//! docs/hardware.md use.
//!
//! Runs ngspice. Where it is absent nothing is compared, and the tests say *not run*; `./test` installs it.

mod corners;
mod ngspice;

use corners::{Currents, LIMIT, Margins, admittance, currents, kick, margins};
use ngspice::Figures;
use std::{path::Path, sync::LazyLock};

/// How far a figure may be from the netlist's.
const TOLERANCE: f64 = 0.01;
/// How far a figure of the corners may be from them: steps of frequency and time are coarse.
const CORNER_TOLERANCE: f64 = 0.1;
/// The carrier's frequencies, as the netlist names them.
const FREQUENCIES: [&str; 5] = ["12.5k", "20k", "50k", "100k", "200k"];
/// What a rig file states of the netlist's figures.
const STATED: [&str; 6] = [
    "transconductance",
    "bandwidth",
    "output_resistance",
    "output_capacitance",
    "compliance",
    "open_voltage",
];
/// One of the two current sources.
struct Choice {
    /// Its rig file.
    rig: &'static str,
    /// Its netlist of parts.
    parts: &'static str,
    /// What its netlist prints in the range of 1 mA; `None` without ngspice.
    figures: LazyLock<Option<Figures>>,
    /// The same in the range of 29 uA.
    low: LazyLock<Option<Figures>>,
    margins: LazyLock<Option<Margins>>,
    currents: LazyLock<Option<Currents>>,
}

static GOOD: Choice = Choice {
    rig: "analogue.toml",
    parts: "parts.inc",
    figures: LazyLock::new(|| Figures::of("current_source.cir".as_ref())),
    low: LazyLock::new(|| Figures::of("current_source-low.cir".as_ref())),
    margins: LazyLock::new(|| margins("parts.inc")),
    currents: LazyLock::new(|| currents("parts.inc")),
};
static CHEAP: Choice = Choice {
    rig: "analogue-cheap.toml",
    parts: "parts-cheap.inc",
    figures: LazyLock::new(|| Figures::of("current_source-cheap.cir".as_ref())),
    low: LazyLock::new(|| Figures::of("current_source-cheap-low.cir".as_ref())),
    margins: LazyLock::new(|| margins("parts-cheap.inc")),
    currents: LazyLock::new(|| currents("parts-cheap.inc")),
};

/// A quantity such as "9.6 pF" in SI units.
fn si(text: &str) -> f64 {
    let (number, unit) = text.split_once(' ').unwrap_or_else(|| panic!("`{text}` has no unit"));
    let size = match unit {
        "V" | "deg" | "dB" => 1.0,
        "kohm" | "kHz" => 1e3,
        "mS" | "mA" => 1e-3,
        "uS" | "us" => 1e-6,
        "nC" => 1e-9,
        "pF" | "pA/sqrt(Hz)" => 1e-12,
        _ => panic!("unit of `{text}`"),
    };
    number.parse::<f64>().unwrap_or_else(|_| panic!("number of `{text}`")) * size
}

fn not_run() {
    println!("not run: ngspice is absent");
}

fn assert_near(what: &str, stated: f64, netlist: f64, tolerance: f64) {
    let near = (stated - netlist).abs() <= tolerance;
    assert!(near, "{what}: stated {stated:e}, the netlist gives {netlist:e}");
}

/// A field of a rig file.
fn stated(rig: &str, table: &str, field: &str) -> f64 {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("rigs").join(rig);
    let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    si(file[table][field].as_str().unwrap())
}

fn check_rig_file(choice: &Choice) {
    for (range, figures, current) in
        [("large_range", &choice.figures, 1e-3), ("small_range", &choice.low, 28.73e-6)]
    {
        let Some(figures) = &**figures else { return not_run() };
        for name in STATED {
            let (stated, netlist) = (stated(choice.rig, range, name), figures.get(name));
            let what = format!("{}: `{range}.{name}`", choice.rig);
            assert_near(&what, stated, netlist, TOLERANCE * netlist.abs());
        }
        let full = figures.get("transconductance") * stated(choice.rig, "current_source", "full_drive");
        assert_near("current at full amplitude", current, full, TOLERANCE * current);
    }
}

fn check_fits(choice: &Choice, tolerance: f64, degrees: f64) {
    let Some(figures) = &*choice.figures else { return not_run() };
    for frequency in FREQUENCIES {
        let hertz = frequency.trim_end_matches('k').parse::<f64>().unwrap() * 1e3;
        let susceptance = std::f64::consts::TAU * hertz * figures.get("output_capacitance");
        let conductance = 1.0 / figures.get("output_resistance");
        let impedance = figures.get(&format!("impedance_{frequency}"));
        assert_near("|Z|", 1.0 / conductance.hypot(susceptance), impedance, tolerance * impedance);

        let lag = hertz / figures.get("bandwidth");
        let fitted = figures.get("transconductance") / 1.0_f64.hypot(lag);
        let simulated = figures.get(&format!("transconductance_{frequency}"));
        assert_near("transconductance", fitted, simulated, tolerance * simulated);
        let phase = figures.get(&format!("transconductance_phase_{frequency}"));
        assert_near("its phase", -lag.atan().to_degrees(), phase, degrees);
    }
}

/// Rows of a table in docs/hardware.md, which stands below `<!-- ngspice: NAME -->`.
fn table(name: &str) -> Vec<Vec<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/hardware.md");
    let text = std::fs::read_to_string(path).unwrap();
    let (_, after) = text.split_once(&format!("<!-- ngspice: {name} -->\n")).expect("a marker");
    let rows = after.lines().take_while(|line| line.starts_with('|')).skip(2);
    rows.map(|row| row.trim_matches('|').split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
}

/// The four columns of sources, with the netlists' figures; `None` without ngspice.
fn columns() -> Option<[&'static Figures; 4]> {
    let all = [&GOOD.figures, &GOOD.low, &CHEAP.figures, &CHEAP.low].map(|figures| figures.as_ref());
    let [Some(good), Some(good_low), Some(cheap), Some(cheap_low)] = all else { return None };
    Some([good, good_low, cheap, cheap_low])
}

/// Numbers of a row, in the unit behind its name's comma, against the netlist's.
fn check_row(row: &[String], netlist: &[f64], tolerance: impl Fn(f64) -> f64) {
    let (name, unit) = row[0].rsplit_once(", ").unwrap_or_else(|| panic!("`{}` has no unit", row[0]));
    assert_eq!(row.len() - 1, netlist.len(), "cells of `{name}`");
    for (cell, &netlist) in row[1..].iter().zip(netlist) {
        assert_near(name, si(&format!("{cell} {unit}")), netlist, tolerance(netlist));
    }
}

fn check_frequencies() {
    let Some(figures) = &*GOOD.figures else { return not_run() };
    let rows = table("frequencies");
    assert_eq!(rows.len(), 2, "rows");
    let netlist = |name| FREQUENCIES.map(|frequency| figures.get(&format!("{name}_{frequency}")));
    check_row(&rows[0], &netlist("transconductance"), |value| TOLERANCE * value);
    check_row(&rows[1], &netlist("transconductance_phase"), |_| 0.1);
}

fn check_ranges() {
    let Some(columns) = columns() else { return not_run() };
    let names = [
        "transconductance",
        "bandwidth",
        "output_resistance",
        "output_capacitance",
        "compliance",
        "current_noise",
    ];
    let rows = table("ranges");
    assert_eq!(rows.len(), names.len(), "rows");
    for (row, name) in rows.iter().zip(names) {
        check_row(row, &columns.map(|figures| figures.get(name)), |value| TOLERANCE * value);
    }
}

/// What a choice has in the table of corners.
fn corner_figures(choice: &Choice) -> Option<[f64; 5]> {
    let (margins, currents) = (choice.margins.as_ref()?, choice.currents.as_ref()?);
    Some([margins.phase.0, margins.gain.0, currents.lasting, currents.charge, currents.time])
}

fn check_corners() {
    let [Some(good), Some(cheap)] = [&GOOD, &CHEAP].map(corner_figures) else { return not_run() };
    let rows = table("corners");
    assert_eq!(rows.len(), good.len(), "rows");
    for (row, (good, cheap)) in rows.iter().zip(good.into_iter().zip(cheap)) {
        check_row(row, &[good, cheap], |value| CORNER_TOLERANCE * value);
    }
}

#[test]
fn the_rig_files_hold_what_the_netlists_give() {
    check_rig_file(&GOOD);
    check_rig_file(&CHEAP);
}

#[test]
fn resistance_beside_capacitance_and_a_single_pole_describe_both_sources() {
    check_fits(&GOOD, 0.015, 0.5);
    check_fits(&CHEAP, 0.035, 3.0);
}

#[test]
fn the_tables_in_the_documentation_are_the_netlists() {
    check_frequencies();
    check_ranges();
    check_corners();
}

/// The output resistance is positive at the other end of the tolerances as well.
fn check_highest(choice: &Choice) {
    let [Some(figures), Some(low)] = [&choice.figures, &choice.low].map(|figures| figures.as_ref()) else {
        return not_run();
    };
    assert!(figures.get("output_resistance_highest") > figures.get("output_resistance_marked"));
    assert!(low.get("output_resistance_highest") > low.get("output_resistance_marked"));
}

fn check_stability(choice: &Choice) {
    let Some(margins) = &*choice.margins else { return not_run() };
    println!("{}: {margins:?}", choice.parts);
    assert!(margins.turns < 10.0, "{}: a corner is not stable: {margins:?}", choice.parts);
    assert!(margins.phase.0 > 50.0 && margins.gain.0 > 12.0 && margins.distance.0 > 0.55, "{margins:?}");
}

#[test]
fn the_good_source_is_stable_at_every_corner_with_every_load() {
    check_stability(&GOOD);
}

#[test]
fn the_cheap_source_is_stable_at_every_corner_with_every_load() {
    check_stability(&CHEAP);
}

fn check_conductance(choice: &Choice) {
    let Some(admittance) = admittance(choice.parts) else { return not_run() };
    println!("{}: {admittance:?}", choice.parts);
    assert!(admittance.conductance[0] > 1e-6 && admittance.conductance[1] > 3e-8, "{admittance:?}");
    assert!(admittance.damping > 0.5, "{admittance:?}");
}

#[test]
fn the_output_conductance_is_positive_with_each_resistor_at_either_end() {
    check_conductance(&GOOD);
    check_conductance(&CHEAP);
    check_highest(&GOOD);
    check_highest(&CHEAP);
}

fn check_kick(choice: &Choice) {
    let Some(left) = kick(choice.parts) else { return not_run() };
    println!("{}: {left:e} of a kick is left", choice.parts);
    assert!(left < 0.01, "{}: {left:e} of a kick is left", choice.parts);
}

#[test]
fn a_kick_while_idle_dies_away() {
    check_kick(&GOOD);
    check_kick(&CHEAP);
}

fn check_currents(choice: &Choice) {
    let Some(currents) = &*choice.currents else { return not_run() };
    println!("{}: {currents:?}", choice.parts);
    assert!(currents.lasting < LIMIT, "{}: {currents:?}", choice.parts);
    assert!(
        currents.peak < 20e-3 && currents.charge < 0.3e-9 && currents.time < 0.4e-6,
        "{}: {currents:?}",
        choice.parts
    );
}

#[test]
fn a_switch_that_opens_and_closes_lets_no_more_than_the_limit_through() {
    check_currents(&GOOD);
    check_currents(&CHEAP);
}

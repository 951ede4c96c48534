//! The current source's netlist against the figures that the emulated board and docs/hardware.md use.
//!
//! Runs ngspice. Where it is absent nothing is compared, and the tests say *not run*; `./test` installs it.

use std::{collections::BTreeMap, io::ErrorKind, path::Path, process::Command, sync::LazyLock};

/// How far a figure may be from the netlist's.
const TOLERANCE: f64 = 0.01;
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
    /// Its table in docs/hardware.md.
    table: &'static str,
    /// What its netlist prints; `None` without ngspice.
    figures: LazyLock<Option<Figures>>,
}

static GOOD: Choice = Choice {
    rig: "analogue.toml",
    table: "good",
    figures: LazyLock::new(|| Figures::of("current_source.cir")),
};
static CHEAP: Choice = Choice {
    rig: "analogue-cheap.toml",
    table: "cheap",
    figures: LazyLock::new(|| Figures::of("current_source-cheap.cir")),
};

/// What a netlist prints: value in SI units of each figure.
struct Figures(BTreeMap<String, f64>);

impl Figures {
    /// Runs a netlist; `None` without ngspice.
    fn of(netlist: &str) -> Option<Self> {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("analogue");
        let run = match Command::new("ngspice").args(["-n", "-b", netlist]).current_dir(folder).output() {
            Err(error) if error.kind() == ErrorKind::NotFound => return None,
            run => run.expect("ngspice starts"),
        };
        let printed = String::from_utf8_lossy(&run.stdout);
        assert!(run.status.success(), "{netlist}: {printed}{}", String::from_utf8_lossy(&run.stderr));
        Some(Self(printed.lines().filter_map(figure).collect()))
    }

    fn get(&self, name: &str) -> f64 {
        *self.0.get(name).unwrap_or_else(|| panic!("the netlist does not print `{name}`"))
    }
}

/// Name and value in a line `figure NAME VALUE`.
fn figure(line: &str) -> Option<(String, f64)> {
    let (name, value) = line.strip_prefix("figure ")?.split_once(' ')?;
    Some((name.to_owned(), value.trim().parse().ok()?))
}

/// A quantity such as "9.6 pF" in SI units.
fn si(text: &str) -> f64 {
    let (number, unit) = text.split_once(' ').unwrap_or_else(|| panic!("`{text}` has no unit"));
    let size = match unit {
        "V" | "deg" => 1.0,
        "kohm" | "kHz" => 1e3,
        "mS" => 1e-3,
        "pF" => 1e-12,
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

/// `[current_source]` of a rig file.
fn current_source(rig: &str) -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("rigs").join(rig);
    let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
    file["current_source"].as_table().unwrap().clone()
}

fn check_rig_file(choice: &Choice) {
    let Some(figures) = &*choice.figures else { return not_run() };
    let stated = current_source(choice.rig);
    for name in STATED {
        let (stated, netlist) = (si(stated[name].as_str().unwrap()), figures.get(name));
        assert_near(&format!("{}: `{name}`", choice.rig), stated, netlist, TOLERANCE * netlist.abs());
    }
    let full = figures.get("transconductance") * si(stated["full_drive"].as_str().unwrap());
    assert_near("current at full amplitude", 1e-3, full, TOLERANCE * 1e-3);
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

fn check_table(choice: &Choice) {
    let Some(figures) = &*choice.figures else { return not_run() };
    let rows = table(choice.table);
    assert_eq!(rows.len(), FREQUENCIES.len(), "rows of table {}", choice.table);
    for (row, frequency) in rows.iter().zip(FREQUENCIES) {
        assert_eq!(row[0], format!("{} kHz", frequency.trim_end_matches('k')));
        let columns = [
            ("impedance", None),
            ("impedance_phase", Some(0.1)),
            ("marked_impedance", None),
            ("transconductance", None),
            ("transconductance_phase", Some(0.1)),
        ];
        for (cell, (name, degrees)) in row[1..].iter().zip(columns) {
            let netlist = figures.get(&format!("{name}_{frequency}"));
            let tolerance = degrees.unwrap_or(TOLERANCE * netlist.abs());
            assert_near(&format!("{name} at {frequency}"), si(cell), netlist, tolerance);
        }
    }
}

#[test]
fn the_rig_files_hold_what_the_netlists_give() {
    check_rig_file(&GOOD);
    check_rig_file(&CHEAP);
}

#[test]
fn resistance_beside_capacitance_and_a_single_pole_describe_both_sources() {
    check_fits(&GOOD, 0.01, 0.5);
    check_fits(&CHEAP, 0.035, 2.5);
}

#[test]
fn the_tables_in_the_documentation_are_the_netlists() {
    check_table(&GOOD);
    check_table(&CHEAP);
}

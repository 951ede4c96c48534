//! `dermatome evaluate`: what a skin's board finds and how good its images are, everywhere on it.

use super::{
    JsonReport,
    finding::Finding,
    flags::in_flags,
    interrupt,
    noise::seed,
    outputs::{Kind, Output},
    progress,
};
use anyhow::Context;
use dermatome_experiments::evaluate::{
    Evaluation, Length, Options, Watch, evaluate, evaluate_flattened, picture,
    report::{PairFigures, PairRing, Report, Ring, Spread},
};
use dermatome_model::{model::Model, skin::Skin};
use dermatome_patch::output::write_whole;
use indicatif::ProgressBar;
use serde::Serialize;
use std::{path::PathBuf, time::Instant};

/// Map a skin's figures of merit: single targets everywhere, and pairs.
///
/// Each target is a true forward solution on a mesh of its own, with noise and, if wanted, with errors of
/// the electrodes. Contacts are those that a board finds with the skin's patch, in the voltages or in the image.
#[derive(clap::Args)]
#[command(after_help = "LENGTH is per cent, as in 5%, or has a unit, as in 12mm.

Examples:
  dermatome evaluate models/disc-210mm/skin.toml --png disc.png
  dermatome evaluate models/hemisphere-210mm/skin.toml --flatten
  dermatome evaluate skin.toml --noise none --diameter 5% --contrast 0.1 --found-in image --threshold 0
  dermatome evaluate skin.toml --noise 50 --electrode-error 3% --impedance-error 20 --json evaluate.json")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Signal-to-noise ratio of the measurements, dB: 0 to 200, or none.
    #[arg(long, value_name = "DB", default_value = "60", value_parser = noise, allow_hyphen_values = true)]
    noise: Noise,
    /// Seed of noise and errors.
    #[arg(long, default_value_t = 1, value_parser = seed, allow_negative_numbers = true)]
    seed: u64,
    /// Diameter of a target; per cent of the skin's diameter.
    #[arg(long, value_name = "LENGTH", default_value = "10%", allow_hyphen_values = true)]
    diameter: Length,
    /// Relative conductivity change of a target: -0.99 to 1000, not 0.
    #[arg(long, value_name = "CHANGE", default_value_t = 1.0, value_parser = contrast, allow_hyphen_values = true)]
    contrast: f64,
    /// Distance of neighbouring targets; per cent of the skin's diameter [default: about 250 targets].
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    spacing: Option<Length>,
    /// Shift the true electrodes along the rim by errors of this standard deviation; per cent of their spacing.
    #[arg(long, value_name = "LENGTH", default_value = "0%", allow_hyphen_values = true)]
    electrode_error: Length,
    /// Change the true contact impedances by errors of this standard deviation, per cent: 0 to 200.
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = impedance_error, allow_hyphen_values = true)]
    impedance_error: f64,
    /// What contacts are found in [default: as the skin file says].
    #[arg(long, value_name = "WHAT")]
    found_in: Option<Finding>,
    /// Smallest relative conductivity change that counts as a contact in the image [default: the skin file's].
    #[arg(long, value_name = "CHANGE", value_parser = threshold, allow_hyphen_values = true)]
    threshold: Option<f64>,
    /// Also take the same frames through the model of the skin without z, as `build --flatten` makes it, and show how
    /// contacts differ in position, and in size or strength.
    #[arg(long)]
    flatten: bool,
    /// Draw a map of each figure.
    #[arg(long, value_name = "FILE", value_parser = Kind::Png.parser())]
    png: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// Noise in dB, or none.
#[derive(Clone, Copy, Debug)]
struct Noise(Option<f64>);

fn noise(text: &str) -> Result<Noise, String> {
    if text == "none" {
        return Ok(Noise(None));
    }
    let db = text.parse().ok().filter(|db| (0.0..=200.0).contains(db));
    db.map(|db| Noise(Some(db))).ok_or_else(|| "allowed are 0 to 200 dB, and none".to_owned())
}

fn contrast(text: &str) -> Result<f64, String> {
    let change = text.parse().ok().filter(|change| (-0.99..=1000.0).contains(change) && *change != 0.0);
    change.ok_or_else(|| "allowed are -0.99 to 1000, but not 0 (1 doubles the conductivity)".to_owned())
}

fn threshold(text: &str) -> Result<f64, String> {
    let change = text.parse().ok().filter(|change| (0.0..=1000.0).contains(change));
    change.ok_or_else(|| "allowed are 0 to 1000".to_owned())
}

fn impedance_error(text: &str) -> Result<f64, String> {
    let error = text.parse().ok().filter(|error| (0.0..=200.0).contains(error));
    error.ok_or_else(|| "allowed are 0 to 200 per cent".to_owned())
}

impl Args {
    fn options(&self) -> Options {
        Options {
            spacing: self.spacing,
            diameter: self.diameter,
            contrast: self.contrast,
            snr_db: self.noise.0,
            seed: self.seed,
            electrode_error: self.electrode_error,
            impedance_error: self.impedance_error / 100.0,
            found_in: self.found_in.map(Into::into),
            threshold: self.threshold,
        }
    }
}

/// What `evaluate` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Told<'a> {
    skin: &'a str,
    noise_db: Option<f64>,
    seed: u64,
    contrast: f64,
    impedance_error_percent: f64,
    seconds: f64,
    #[serde(flatten)]
    report: &'a Report,
    flattened: Option<&'a Report>,
}

/// Shows progress, and ends with Ctrl-C.
struct Bar(ProgressBar);

impl Watch for Bar {
    fn begin(&self, what: &'static str, count: usize) {
        self.0.reset();
        self.0.set_length(count as u64);
        self.0.set_message(what);
    }

    fn step(&self) {
        self.0.inc(1);
    }

    fn go_on(&self) -> bool {
        !interrupt::requested()
    }
}

/// What sets the options that the library's errors name.
const FLAGS: [(&str, &str); 8] = [
    ("`diameter`", "--diameter"),
    ("`spacing`", "--spacing"),
    ("`electrode_error`", "--electrode-error"),
    ("`impedance_error`", "--impedance-error"),
    ("`seed`", "--seed"),
    ("`found_in`", "--found-in"),
    ("`threshold`", "--threshold"),
    ("`contrast`", "--contrast"),
];

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    interrupt::install()?;
    let start = Instant::now();
    let skin = Skin::load(&args.skin)?.made()?;
    let in_file = || format!("skin file `{}`", args.skin.display());
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(stage)).with_context(in_file)?;
    spinner.finish_and_clear();
    let bar = Bar(progress::counting());
    let evaluation = evaluate(&skin, &model, &args.options(), &bar)
        .map_err(|error| in_flags(error, &FLAGS))
        .with_context(in_file)?;
    anyhow::ensure!(!evaluation.singles.is_empty(), "stopped before the first target was done");
    let report = Report::new(&evaluation);
    let flattened = args.flatten.then(|| flattened(&skin, args, &bar)).transpose().with_context(in_file)?;
    bar.0.finish_and_clear();
    let told = Told {
        skin: &skin.name,
        noise_db: args.noise.0,
        seed: args.seed,
        contrast: args.contrast,
        impedance_error_percent: args.impedance_error,
        seconds: start.elapsed().as_secs_f64(),
        report: &report,
        flattened: flattened.as_ref(),
    };
    print(&told);
    if let Some(path) = &args.png {
        draw(path, &told, &evaluation)?;
    }
    args.json.write(&told)
}

/// What the model of the flattened skin makes of the same frames.
fn flattened(skin: &Skin, args: &Args, bar: &Bar) -> anyhow::Result<Report> {
    let flat = skin.flattened()?;
    let model = Model::build(&flat, |_| ())?;
    let evaluation = evaluate_flattened(skin, &flat, &model, &args.options(), bar);
    Ok(Report::new(&evaluation.map_err(|error| in_flags(error, &FLAGS))?))
}

fn draw(path: &std::path::Path, told: &Told<'_>, evaluation: &Evaluation) -> anyhow::Result<()> {
    let title = format!("{}: {}", told.skin, conditions(told));
    write_whole(path, &picture(evaluation, title).context("cannot encode the picture")?)?;
    say!("picture: {}", path.display());
    Ok(())
}

/// What was tried, in a line.
fn conditions(told: &Told<'_>) -> String {
    let report = told.report;
    let noise = told.noise_db.map_or("no noise".to_owned(), |db| format!("noise at {db} dB"));
    let mut words = format!(
        "targets of {:.1} mm ({:.0} % of the diameter), contrast {:+}, {noise}",
        report.target_diameter_mm,
        100.0 * report.target_diameter_mm / report.skin_diameter_mm,
        told.contrast
    );
    if report.electrode_error_mm > 0.0 {
        words += &format!(", electrodes off by {:.2} mm", report.electrode_error_mm);
    }
    if told.impedance_error_percent > 0.0 {
        words += &format!(", contact impedances off by {} %", told.impedance_error_percent);
    }
    words
}

fn print(told: &Told<'_>) {
    let report = told.report;
    if !report.complete {
        say!("stopped early: the figures cover what was done");
    }
    say!("{}: {}", told.skin, conditions(told));
    say!(
        "{} targets {:.1} mm apart on a true skin of {} elements, seed {}; contacts found in the {}",
        report.total.targets,
        report.spacing_mm,
        report.true_elements,
        told.seed,
        found_in(report)
    );
    if let Some(why) = &report.no_board {
        say!("no board finds contacts in the voltages: {why}");
    }
    let rings = || report.rings.iter().chain([&report.total]);
    say!("");
    say!("{:35}{:^28}  {:-^43}", "", "contact from target", " thesis ");
    let header = ["mm", "% of diam.", "PE, % of diam", "RES", "RNG"];
    say!("{:>12} {:>7} {:>6} {:>5}{}", "way to rim", "targets", "missed", "false", headings(&header));
    rings().for_each(|ring| say!("{}", contact_row(ring)));
    say!("");
    say!("{:14}{:-^60}", "", " strongest contact ");
    let [strength, deviation] = ["strength", "deviation, mm"].map(|name| headings(&[name]));
    say!("{:>12} {:>6}{strength} {:>10}{deviation} {:>12}", "way to rim", "one", "variation", "within 2");
    rings().for_each(|ring| say!("{}", strongest_row(ring)));
    say!("");
    say!("{:14}{:-^88}", "", " GREIT ");
    let header = ["PE, % of diam", "RES", "SD", "RNG", "AR", "AR/centre's"];
    say!("{:>12}{}", "way to rim", headings(&header));
    rings().for_each(|ring| say!("{}", greit_row(ring)));
    say!("");
    if report.total.detectability.is_some() {
        say!("{:14}{:-^54}", "", " what the voltages of one frame tell at most ");
        let header = ["d'", "smallest change", "place, mm"];
        say!("{:>12} {:>6}{}", "way to rim", "deaf", headings(&header));
        rings().filter_map(detectability_row).for_each(|row| say!("{row}"));
        say!("");
    }
    say!(
        "smallest distance at which two contacts are told apart, mm, in steps of {:.1} mm",
        report.pair_step_mm
    );
    say!("{:>12}  {:^24}  {:^24}", "way to rim", "one behind the other", "side by side");
    let pairs = report.pair_rings.iter().chain([&report.pairs_total]);
    pairs.for_each(|ring| say!("{}", pair_row(ring)));
    say!("");
    if let Some(flattened) = told.flattened {
        print_flattened(report, flattened);
    }
    say!("columns: mean, and the value farthest from 0 (d': the least); PE is positive towards the centre;");
    say!("one: exactly one contact; variation: standard deviation of the strengths, % of their mean;");
    say!(
        "deviation: what the board states of the place; within 2: contacts off by no more than two of it, %;"
    );
    say!("never: not told apart even at the largest distance for which there is room");
    say!("{}", summary(report));
}

/// How contacts were found, in words.
fn found_in(report: &Report) -> &'static str {
    match (report.contacts_found_in, report.contacts_found_by) {
        ("voltages", _) => "voltages, by the board's code after six scans",
        (_, "board") => "board's image, by its code",
        _ => "f64 image",
    }
}

/// The surface's model beside that of the flattened skin.
fn print_flattened(report: &Report, flattened: &Report) {
    say!(
        "the same frames through the model of the flattened skin, its contacts laid onto the skin from above"
    );
    say!("{:12}  {:-^50}  {:-^50}", "", " surface ", " flattened ");
    let halves = [report, flattened].map(|report| {
        let size = if report.contacts_found_in == "voltages" { "strength" } else { "area, % of its" };
        format!(" {:>6} {:>5}  {:^17}  {size:^17}", "missed", "false", "from target, mm")
    });
    say!("{:>12} {}", "way to rim", halves.join(" "));
    let rings = |report: &Report| report.rings.iter().chain([&report.total]).cloned().collect::<Vec<_>>();
    for (surface, flat) in rings(report).iter().zip(&rings(flattened)) {
        let way = way([surface.from_percent, surface.to_percent]);
        say!("{way:>12} {} {}", size_row(surface), size_row(flat));
    }
    say!("");
}

/// Contacts have an area in the image, and in the voltages only a strength.
fn size_row(ring: &Ring) -> String {
    let error = cells(ring.position_error_mm, 2);
    let size = match ring.contact_area_percent {
        None => cells(ring.contact_strength, 2),
        area => cells(area, 0),
    };
    format!(" {:>6} {:>5}{error:^19}{size:^19}", ring.missed, ring.false_contacts)
}

/// Width of a mean and a largest value.
const CELLS: usize = 13;

fn headings(names: &[&str]) -> String {
    names.iter().map(|name| format!("  {name:^CELLS$}")).collect()
}

fn way([from, to]: [f64; 2]) -> String {
    if (from, to) == (0.0, 100.0) { "all".to_owned() } else { format!("{from:.0} - {to:.0} %") }
}

fn cells(spread: Option<Spread>, decimals: usize) -> String {
    match spread {
        Some(Spread { mean, max }) => format!("  {mean:>6.decimals$} {max:>6.decimals$}"),
        None => format!("  {:>6} {:>6}", "-", "-"),
    }
}

fn contact_row(ring: &Ring) -> String {
    let Ring { targets, missed, false_contacts, thesis, .. } = ring;
    let figures = [
        cells(ring.position_error_mm, 2),
        cells(ring.position_error_percent, 2),
        cells(thesis.position_error_percent, 2),
        cells(thesis.resolution, 3),
        cells(thesis.ringing, 3),
    ];
    let way = way([ring.from_percent, ring.to_percent]);
    format!("{way:>12} {targets:>7} {missed:>6} {false_contacts:>5}{}", figures.concat())
}

fn strongest_row(ring: &Ring) -> String {
    let number = |value: Option<f64>, decimals| {
        value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let [strength, deviation] =
        [ring.contact_strength, ring.stated_deviation_mm].map(|spread| cells(spread, 2));
    format!(
        "{:>12} {:>6}{strength} {:>10}{deviation} {:>12}",
        way([ring.from_percent, ring.to_percent]),
        ring.exactly_one,
        number(ring.contact_strength_variation_percent, 1),
        number(ring.within_two_stated_percent, 1)
    )
}

fn greit_row(ring: &Ring) -> String {
    let greit = &ring.greit;
    let figures = [
        cells(greit.position_error_percent, 2),
        cells(greit.resolution, 3),
        cells(greit.shape_deformation, 3),
        cells(greit.ringing, 3),
        cells(greit.amplitude_response, 3),
        cells(greit.amplitude_over_centre, 3),
    ];
    format!("{:>12}{}", way([ring.from_percent, ring.to_percent]), figures.concat())
}

fn detectability_row(ring: &Ring) -> Option<String> {
    let told = ring.detectability.as_ref()?;
    let significance = Spread { mean: told.significance_mean, max: told.significance_least };
    let figures = [
        cells(Some(significance), 1),
        cells(Some(told.smallest_change), 4),
        cells(Some(told.position_deviation_mm), 2),
    ];
    Some(format!("{:>12} {:>6}{}", way([ring.from_percent, ring.to_percent]), told.deaf, figures.concat()))
}

fn pair_row(ring: &PairRing) -> String {
    let figures = |figures: &PairFigures| {
        let never = if figures.never > 0 { format!("{} never", figures.never) } else { String::new() };
        format!("{} {never:>10}", cells(figures.distance_mm, 1))
    };
    let (radial, across) = (figures(&ring.radial), figures(&ring.across));
    format!("{:>12}{radial}{across}", way([ring.from_percent, ring.to_percent])).trim_end().to_owned()
}

/// The most important figures, in a line.
fn summary(report: &Report) -> String {
    let total = &report.total;
    let counts = format!(
        "summary: {} of {} targets missed, {} false contacts",
        total.missed, total.targets, total.false_contacts
    );
    let inner = report.rings.iter().filter(|ring| ring.to_percent <= 80.0);
    let worst = inner.filter_map(|ring| Some(ring.position_error_percent?.max)).fold(0.0, f64::max);
    match total.position_error_percent {
        Some(error) => format!(
            "{counts}; position error {:.2} % of the diameter on average, at most {worst:.2} % within 80 % of the \
             way to the rim",
            error.mean
        ),
        None => counts,
    }
}

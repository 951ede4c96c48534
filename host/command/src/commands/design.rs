//! `dermatome design`: skin file -> a skin file with better places for its electrodes.

use super::{
    JsonReport,
    flags::in_flags,
    noise::snr,
    outputs::{Kind, Output, by_default},
    progress,
    skin_of_design::{pattern, refuse_weights, skin_file},
};
use anyhow::{Context, bail, ensure};
use dermatome_experiments::evaluate::Length;
use dermatome_model::{
    metrics::detectability::{Detectability, LEVEL, Sought, strength_of},
    model::{
        Model,
        design::{Wanted, propose},
    },
    skin::{Description, Shape, Skin, is_name},
};
use dermatome_patch::{
    input,
    output::{check_folder, write_whole},
};
use serde::Serialize;
use std::{
    path::{Path, PathBuf},
    time::Instant,
};

/// Propose places for a skin's electrodes, and a stimulation pattern.
///
/// They lie on the rim and inside. A finger shall stand out from the noise as much as possible where it does so least. What is found is modelled anew,
/// and compared with the skin as it is.
#[derive(clap::Args)]
#[command(after_help = "LENGTH is per cent of the skin's size, as in 5%, or has a unit, as in 12mm.

Examples:
  dermatome design models/hemisphere-210mm/formula.toml --out designed.toml
  dermatome design models/disc-210mm/skin.toml --electrodes 12 --noise 50 --radius 6mm")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// How many electrodes, 6 to 16 [default: as many as the skin has].
    #[arg(long, value_name = "COUNT")]
    electrodes: Option<u8>,
    /// Signal-to-noise ratio of the measurements, dB: 0 to 200.
    #[arg(long, value_name = "DB", default_value_t = 60.0, value_parser = snr, allow_hyphen_values = true)]
    noise: f64,
    /// Radius of the finger, which doubles the conductivity.
    #[arg(long, value_name = "LENGTH", default_value = "4%", allow_hyphen_values = true)]
    radius: Length,
    /// Skin file to write [default: the new name with .toml, in this folder].
    #[arg(long, value_name = "FILE", value_parser = Kind::Skin.parser())]
    out: Option<Output>,
    /// Name of the new skin [default: the skin's name with -designed].
    #[arg(long)]
    name: Option<String>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `design` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    name: String,
    file: PathBuf,
    electrodes: usize,
    electrodes_on_rim: usize,
    pattern: String,
    noise_db: f64,
    finger_radius_mm: f64,
    choices_judged: usize,
    before: Figures,
    after: Figures,
    seconds: f64,
}

/// What a frame tells of the finger over a skin.
#[derive(Serialize)]
struct Figures {
    smallest_significance: f64,
    median_significance: f64,
    worst_place_mm: Option<[f64; 3]>,
    deaf_percent: f64,
    worst_position_deviation_mm: f64,
}

impl Figures {
    fn new(found: &Detectability) -> Self {
        let worst = found.worst();
        Self {
            smallest_significance: worst.map_or(0.0, |place| place.significance),
            median_significance: found.median(),
            worst_place_mm: worst.map(|place| (place.position.coords * 1e3).into()),
            deaf_percent: found.deaf().map_or(0.0, |deaf| 100.0 * deaf.share),
            worst_position_deviation_mm: found.worst_deviation() * 1e3,
        }
    }
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let start = Instant::now();
    let in_file = || format!("skin file `{}`", args.skin.display());
    let skin = Skin::load(&args.skin)?.made()?;
    let text = input::read_text(&args.skin).with_context(in_file)?;
    refuse_weights(&text).with_context(in_file)?;
    let name = args.name(&skin)?;
    let out = args.target(&skin, &name)?;
    let spinner = progress::spinner();
    let model = Model::build(&skin, |stage| spinner.set_message(stage)).with_context(in_file)?;
    let sought = args.sought(model.pixels.larger_side())?;
    let before = Figures::new(&model.detectability(&sought));
    let electrodes = args.electrodes.unwrap_or(skin.electrodes.count);
    let proposal = propose(&skin, &Wanted { electrodes, sought }, |stage| spinner.set_message(stage))
        .map_err(|error| in_flags(error, &[("`electrodes`", "`--electrodes`")]))
        .with_context(in_file)?;
    let text = skin_file(&text, &name, &skin, &proposal).with_context(in_file)?;
    let designed = Skin::parse(&out, &text).and_then(Description::made).context("the proposal is no skin")?;
    let after =
        Model::build(&designed, |stage| spinner.set_message(stage)).context("the proposal has no model")?;
    spinner.finish_and_clear();
    write_whole(&out, text.as_bytes())?;
    let report = Report {
        skin: skin.name,
        name,
        file: out,
        electrodes: proposal.positions.len(),
        electrodes_on_rim: proposal.on_rim,
        pattern: pattern(&proposal),
        noise_db: args.noise,
        finger_radius_mm: sought.radius * 1e3,
        choices_judged: proposal.judged,
        before,
        after: Figures::new(&after.detectability(&sought)),
        seconds: start.elapsed().as_secs_f64(),
    };
    print(&report);
    args.json.write(&report)
}

impl Args {
    fn name(&self, skin: &Skin) -> anyhow::Result<String> {
        let name = self.name.clone().unwrap_or_else(|| format!("{}-designed", skin.name));
        ensure!(
            is_name(&name),
            "`--name` is {name:?}; allowed: 1 to 32 letters, digits, \"-\" or \"_\" (by default it is the skin's with \
             \"-designed\")"
        );
        Ok(name)
    }

    /// The file to write: one that is not there yet, where the files that the skin file names are found.
    fn target(&self, skin: &Skin, name: &str) -> anyhow::Result<PathBuf> {
        let out = by_default("--out", self.out.as_ref(), format!("{name}.toml"), Kind::Skin)?;
        check_folder(&out)?;
        if matches!(skin.shape, Shape::Mesh { .. }) && folder(&out) != folder(&self.skin) {
            bail!(
                "`--out` is `{}`; allowed: a file beside `{}`, whose mesh it names",
                out.display(),
                self.skin.display()
            );
        }
        Ok(out)
    }

    fn sought(&self, size: f64) -> anyhow::Result<Sought> {
        let radius = self.radius.of(size);
        let (least, most) = (size / 100.0, size / 4.0);
        ensure!(
            (least..=most).contains(&radius),
            "`--radius` is {:.2} mm; allowed here: {:.2} mm to {:.2} mm",
            radius * 1e3,
            least * 1e3,
            most * 1e3
        );
        Ok(Sought { radius, strength: strength_of(1.0), snr_db: self.noise })
    }
}

fn folder(file: &Path) -> Option<PathBuf> {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    folder.unwrap_or(Path::new(".")).canonicalize().ok()
}

fn print(report: &Report) {
    let Report { before, after, .. } = report;
    say!(
        "skin          {}: {} electrodes, {} on the rim, pattern \"{}\"; best of {} choices",
        report.name,
        report.electrodes,
        report.electrodes_on_rim,
        report.pattern,
        report.choices_judged
    );
    say!("finger        {:.1} mm radius at full depth, {} dB", report.finger_radius_mm, report.noise_db);
    say!("{:28} {:>8} {:>8}", "", "before", "after");
    let row = |what: &str, figure: fn(&Figures) -> f64, decimals: usize| {
        say!("{what:28} {:>8.decimals$} {:>8.decimals$}", figure(before), figure(after));
    };
    row(&format!("smallest d' ({LEVEL} is detected)"), |figures| figures.smallest_significance, 1);
    row("median d'", |figures| figures.median_significance, 1);
    row("deaf, % of the skin", |figures| figures.deaf_percent, 1);
    row("worst deviation of place, mm", |figures| figures.worst_position_deviation_mm, 2);
    say!("written       {} in {:.0} s", report.file.display(), report.seconds);
    if after.smallest_significance <= before.smallest_significance {
        eprintln!("warning: the skin as it is hears its deafest place no worse");
    }
}

//! `dermatome forward`: voltages of a skin's stimulation table.

use super::{
    JsonReport,
    build::warning_of_driven,
    outputs::{Kind, Output},
};
use anyhow::{Context, bail};
use dermatome_frames::{
    array::{Array, Source, npy},
    interchange::conductivity::{self, Voltages},
};
use dermatome_geometry::mesh::{Lattice, Mesh};
use dermatome_model::{
    model::{driven_error, mesh},
    skin::Skin,
    stimulation::{self, PatternReport},
};
use dermatome_patch::output::{stream_whole, write_whole};
use dermatome_shared::stimulation::Step;
use num_complex::Complex64;
use serde::Serialize;
use std::{
    ffi::OsString,
    path::{Path, PathBuf},
};

/// Compute the voltages of a skin.
///
/// Prints one line for each step, or writes the voltages to a file. They are relative: at a current of
/// 1 A through a sheet of 1 S per square. The report also says which steps of the stimulation table are
/// redundant.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome forward models/disc-210mm/skin.toml
  dermatome forward skin.toml --conductivity pressed.npy --out voltages.npy --json forward.json")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Relative conductivity of each element of the mesh, 1 for the untouched sheet; complex for an
    /// admittivity. Without it the skin is untouched.
    #[arg(long, value_name = "FILE")]
    conductivity: Option<OsString>,
    /// Write the voltages to this file, .npy or .csv, and do not print them.
    #[arg(long, value_name = "FILE", value_parser = Kind::Voltages.parser())]
    out: Option<Output>,
    #[command(flatten)]
    json: JsonReport,
}

/// What `forward` tells; keys are documented in docs/cli.md.
#[derive(Serialize)]
struct Report {
    skin: String,
    nodes: usize,
    elements: usize,
    conductivity: Option<String>,
    complex: bool,
    volts_per_unit: f64,
    voltages: Vec<f64>,
    voltages_imaginary: Option<Vec<f64>>,
    driven_error_percent: Option<f64>,
    pattern: PatternReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let out = args.out.as_deref().map(Format::of).transpose()?;
    let skin = Skin::load(&args.skin)?.made()?;
    let in_file = || format!("skin file `{}`", args.skin.display());
    let mesh = mesh(&skin, 1.0, Lattice::default()).with_context(in_file)?;
    let source = args.conductivity.as_deref().map(Source::new);
    let admittivity = match &source {
        Some(source) => conductivity::read(source, mesh.elements.len())?,
        None => vec![skin.admittivity(); mesh.elements.len()],
    };
    let voltages = conductivity::voltages(&skin, &mesh, &admittivity).with_context(in_file)?;
    let error = driven_error(&skin, &mesh)?;
    let report = report(&skin, &mesh, source.as_ref(), &voltages, error);
    match (&args.out, out) {
        (Some(path), Some(format)) => format.write(path, &voltages)?,
        _ => print(&skin.steps(), &voltages),
    }
    print_pattern(&report.pattern);
    error.and_then(warning_of_driven).iter().for_each(|warning| eprintln!("warning: {warning}"));
    args.json.write(&report)
}

fn report(
    skin: &Skin,
    mesh: &Mesh,
    source: Option<&Source>,
    voltages: &Voltages,
    driven_error: Option<f64>,
) -> Report {
    let part = |part: fn(&Complex64) -> f64| voltages.values.iter().map(part).collect();
    Report {
        skin: skin.name.clone(),
        nodes: mesh.nodes.len(),
        elements: mesh.elements.len(),
        conductivity: source.map(ToString::to_string),
        complex: voltages.complex,
        volts_per_unit: skin.drive.amplitude / skin.material.sheet_conductivity,
        voltages: part(|value| value.re),
        voltages_imaginary: voltages.complex.then(|| part(|value| value.im)),
        driven_error_percent: driven_error.map(|error| error * 100.0),
        pattern: stimulation::report(&skin.steps(), skin.electrodes.count),
    }
}

/// How a file holds voltages.
#[derive(Clone, Copy)]
enum Format {
    Npy,
    Csv,
}

impl Format {
    fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("npy") => Ok(Self::Npy),
            Some("csv") => Ok(Self::Csv),
            _ => bail!("`--out` is `{}`; its name must end in .npy or .csv", path.display()),
        }
    }

    fn write(self, path: &Path, voltages: &Voltages) -> anyhow::Result<()> {
        let Voltages { values, complex } = voltages;
        match self {
            Self::Csv => {
                let rows = values.iter().map(|value| cell(*value, *complex) + "\n");
                let text: String = std::iter::once("voltage\n".to_owned()).chain(rows).collect();
                Ok(write_whole(path, text.as_bytes())?)
            }
            Self::Npy => {
                let list = if *complex {
                    Array::list(values.len(), |step| values[step])
                } else {
                    Array::list(values.len(), |step| values[step].re)
                };
                Ok(stream_whole(path, |out| npy::write(out, &list))?)
            }
        }
    }
}

/// A number as Python writes it, with all its digits.
fn cell(value: Complex64, complex: bool) -> String {
    if complex { format!("{:e}{:+e}j", value.re, value.im) } else { format!("{:e}", value.re) }
}

/// Electrodes from 1, as people count them.
fn print(steps: &[Step], voltages: &Voltages) {
    say!("{:>6} {:>9} {:>9}  {}", "step", "drive", "sense", "voltage at 1 A and 1 S");
    for (index, (step, value)) in steps.iter().zip(&voltages.values).enumerate() {
        let [dp, dm, sp, sm] = step.to_bytes().map(|electrode| u16::from(electrode) + 1);
        let quadrature = if voltages.complex { format!(" {:+.9e}j", value.im) } else { String::new() };
        say!("{index:>6} {dm:>3} -> {dp:<3} {sp:>3} - {sm:<3}  {:+.9e}{quadrature}", value.re);
    }
}

fn print_pattern(pattern: &PatternReport) {
    let PatternReport { steps, distinct, rank, largest_rank, .. } = pattern;
    say!(
        "pattern       {steps} steps, {distinct} different measurements, rank {rank} of at most {largest_rank}"
    );
    let idle = |electrodes: &[u8]| {
        let numbers: Vec<_> =
            electrodes.iter().map(|&electrode| (u16::from(electrode) + 1).to_string()).collect();
        numbers.join(", ")
    };
    if !pattern.never_driven.is_empty() {
        say!("never driven  electrodes {}", idle(&pattern.never_driven));
    }
    if !pattern.never_sensed.is_empty() {
        say!("never sensed  electrodes {}", idle(&pattern.never_sensed));
    }
}

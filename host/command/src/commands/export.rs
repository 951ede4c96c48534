//! `dermatome export`: a skin's model as files for NumPy, MATLAB, EIDORS and Gmsh.

use super::{JsonReport, outputs::Folder, progress};
use anyhow::Context;
use dermatome_frames::interchange::{
    contents::Contents,
    export::{CONTENTS, Export, GMSH, MATLAB, PLY, STIMULATION, is_exported, prepare_folder},
};
use dermatome_model::skin::Skin;
use std::path::PathBuf;

/// Write a skin's whole model as NumPy and MATLAB files, and its mesh for Gmsh.
///
/// Nodes, elements, electrodes, system matrix, voltages, Jacobian, prior, reconstruction matrix and
/// more, each as NAME.npy and all of them in skin.mat; the mesh as skin.msh, with its electrodes as
/// physical groups, as skin.ply and as skin.stl (mm); the stimulation table as stimulation.csv; and export.json, which
/// lists the arrays with shapes and units. Everything counts from 0.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  dermatome export models/disc-210mm/skin.toml --out disc
  python3 -c \"import numpy; print(numpy.load('disc/voltages.npy'))\"
  octave --eval \"load disc/skin.mat; trisurf(elements + 1, nodes(:,1), nodes(:,2), nodes(:,3))\"")]
pub(super) struct Args {
    /// Skin file.
    #[arg(value_name = "SKIN")]
    skin: PathBuf,
    /// Folder to write to; it is made if it is not there.
    #[arg(long, value_name = "DIR", value_parser = Folder::parser(is_exported, Some(CONTENTS)))]
    out: Folder,
    #[command(flatten)]
    json: JsonReport,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let skin = Skin::load(&args.skin)?.made()?;
    prepare_folder(&args.out)?;
    let spinner = progress::spinner();
    let export = Export::new(&skin, |stage| spinner.set_message(stage))
        .with_context(|| format!("skin file `{}`", args.skin.display()))?;
    spinner.set_message("writing");
    export.write(&args.out)?;
    spinner.finish_and_clear();
    let contents = export.contents();
    print(args, &contents);
    args.json.write(&contents)
}

fn print(args: &Args, contents: &Contents) {
    say!("skin          {}", contents.skin);
    say!("mesh          {} elements, {} nodes", contents.elements, contents.nodes);
    say!("electrodes    {}, {} model", contents.electrodes, contents.electrode_model);
    say!("measurements  {} from {} steps", contents.measurements, contents.steps);
    say!("pixels        {}", contents.pixels);
    say!("voltages      times {:.6e} are volts", contents.volts_per_unit);
    let too_large = contents.arrays.iter().filter(|(_, entry)| !entry.in_mat);
    for (name, _) in too_large {
        eprintln!("warning: {name} takes more than 2 GiB and is not in {MATLAB}; it is in {name}.npy");
    }
    say!(
        "written       {} arrays as .npy, {MATLAB}, {GMSH}, {PLY}, {STIMULATION} and {CONTENTS} to {}",
        contents.arrays.len(),
        args.out.display()
    );
}

//! `dermatome man`: manual pages.

use super::{command, outputs::Folder};
use anyhow::Context;
use clap::Command;
use clap_mangen::Man;
use dermatome_patch::output::OutputFolder;

/// Write the manual pages, one for each command.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  mkdir -p ~/.local/share/man/man1 && dermatome man --out ~/.local/share/man/man1
  man dermatome-build")]
pub(super) struct Args {
    /// Folder to write to; it is made if it is not there.
    #[arg(long, value_name = "DIR", value_parser = Folder::parser(is_page, Some(FIRST)))]
    out: Folder,
}

/// The page of the program itself.
const FIRST: &str = "dermatome.1";

fn is_page(name: &str) -> bool {
    name == FIRST || name.starts_with("dermatome-") && name.ends_with(".1")
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let folder = OutputFolder::prepare(&args.out)?;
    let mut program = command().disable_help_subcommand(true);
    program.build();
    let mut pages = Vec::new();
    add_pages(&program, &mut pages).context("cannot express the manual")?;
    let files: Vec<_> = pages.iter().map(|(name, page)| (name.as_str(), page.as_slice())).collect();
    folder.write_all(&files)?;
    say!("{} manual pages written to {}", files.len(), args.out.display());
    Ok(())
}

/// The page of a command and those of the commands in it.
fn add_pages(command: &Command, pages: &mut Vec<(String, Vec<u8>)>) -> std::io::Result<()> {
    let man = Man::new(command.clone());
    let mut page = Vec::new();
    man.render(&mut page)?;
    pages.push((man.get_filename(), page));
    command.get_subcommands().try_for_each(|inner| add_pages(inner, pages))
}

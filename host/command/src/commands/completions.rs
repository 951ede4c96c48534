//! `dermatome completions`: what a shell completes.

use super::{command, print_line};
use clap_complete::{Shell, generate};

/// Print what makes a shell complete commands and options.
#[derive(clap::Args)]
#[command(after_help = "The shell reads it from a file when it starts.

Examples:
  dermatome completions bash > ~/.local/share/bash-completion/completions/dermatome
  dermatome completions zsh > ~/.zfunc/_dermatome    (with fpath+=~/.zfunc before compinit in ~/.zshrc)
  dermatome completions fish > ~/.config/fish/completions/dermatome.fish
  dermatome completions powershell >> $PROFILE")]
pub(super) struct Args {
    /// The shell.
    #[arg(value_name = "SHELL")]
    shell: Shell,
}

pub(super) fn run(args: &Args) -> anyhow::Result<()> {
    let mut script = Vec::new();
    generate(args.shell, &mut command(), "dermatome", &mut script);
    print_line(String::from_utf8(script)?.trim_end());
    Ok(())
}

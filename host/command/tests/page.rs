//! docs/cli.md: its list of commands is what the commands say of themselves.

use clap::Command;
use std::{fmt::Write, fs, path::Path};

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/cli.md");
const BEGIN: &str = "<!-- generated: commands -->\n";
const END: &str = "<!-- end -->";
/// Columns of the help.
const WIDTH: usize = 100;

/// The help of every command, under a heading each.
fn commands() -> String {
    let mut program = dermatome_command::command().term_width(WIDTH);
    program.build();
    let mut text = String::new();
    commands_of(&mut program, "dermatome", &mut text);
    text + "\n"
}

/// Those of a command, each with its own behind it.
fn commands_of(parent: &mut Command, name: &str, text: &mut String) {
    for command in parent.get_subcommands_mut().filter(|command| command.get_name() != "help") {
        let name = format!("{name} {}", command.get_name());
        let help = command.render_long_help().to_string();
        let lines: Vec<_> = help.lines().map(str::trim_end).collect();
        writeln!(text, "\n### {name}\n\n```text\n{}\n```", lines.join("\n").trim_end()).unwrap();
        commands_of(command, &name, text);
    }
}

#[test]
fn the_page_lists_the_commands_as_they_are() {
    let page = fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("the page says where the list begins");
    let (_, after) = rest.split_once(END).expect("the page says where the list ends");
    let right = format!("{before}{BEGIN}{}{END}{after}", commands());
    if std::env::var_os("UPDATE_PAGES").is_some() {
        fs::write(Path::new(PAGE), &right).unwrap();
        return;
    }
    assert!(
        page == right,
        "docs/cli.md is not what the commands say; UPDATE_PAGES=1 cargo test -p dermatome-command writes it"
    );
}

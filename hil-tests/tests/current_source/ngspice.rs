//! Runs ngspice and reads its figures.

use std::{collections::BTreeMap, io::ErrorKind, path::Path, process::Command};

/// What a deck prints: value in SI units of each figure.
pub(crate) struct Figures(BTreeMap<String, f64>);

impl Figures {
    /// Runs a deck, seen from the folder of the netlists; `None` without ngspice.
    pub(crate) fn of(deck: &Path) -> Option<Self> {
        let run = match Command::new("ngspice").args(["-n", "-b"]).arg(deck).current_dir(folder()).output() {
            Err(error) if error.kind() == ErrorKind::NotFound => return None,
            run => run.expect("ngspice starts"),
        };
        let printed = String::from_utf8_lossy(&run.stdout);
        let errors = String::from_utf8_lossy(&run.stderr);
        assert!(run.status.success(), "{}: {printed}{errors}", deck.display());
        Some(Self(printed.lines().filter_map(figure).collect()))
    }

    /// Writes a deck to a file of this name, and runs it.
    pub(crate) fn of_text(name: &str, deck: &str) -> Option<Self> {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::write(&file, deck).unwrap();
        Self::of(&file)
    }

    /// One figure.
    pub(crate) fn get(&self, name: &str) -> f64 {
        *self.0.get(name).unwrap_or_else(|| panic!("the deck does not print `{name}`"))
    }
}

/// Folder of the netlists.
pub(crate) fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("analogue")
}

/// Name and value in a line `figure NAME VALUE`.
fn figure(line: &str) -> Option<(String, f64)> {
    let (name, value) = line.strip_prefix("figure ")?.split_once(' ')?;
    Some((name.to_owned(), value.trim().parse().ok()?))
}

//! Workshop: a copy of the project in which mutants are built, under `target/mutants`. The user's own files stay as
//! they are, and what a run that was broken off left behind is mended by the next.

use dermatome_hil::mutants::Mutant;
use std::{
    collections::BTreeSet,
    error::Error,
    ffi::OsString,
    fs, io,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

/// The project.
const PROJECT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
/// What the firmware is built of: its own package, the shared one, and the workspace that the latter's fields are from.
const PARTS: [&str; 3] = ["Cargo.toml", "firmware", "shared"];
/// Folders of results, which are not copied.
const RESULTS: &str = "target";
const BOARD: &str = "nucleo-g474re";

/// A copy of the project, with a build of its own.
pub(super) struct Workshop {
    copy: PathBuf,
}

impl Workshop {
    /// A copy as the project is now. What is alike keeps its time, so that cargo builds only what differs.
    pub(super) fn open() -> Result<Self, Box<dyn Error>> {
        let copy = Path::new(PROJECT).join(RESULTS).join("mutants");
        fs::create_dir_all(&copy).map_err(|error| format!("cannot make `{}`: {error}", copy.display()))?;
        for part in PARTS {
            let (from, to) = (Path::new(PROJECT).join(part), copy.join(part));
            mirror(&from, &to).map_err(|error| format!("cannot copy `{}`: {error}", from.display()))?;
        }
        Ok(Self { copy })
    }

    /// Builds the firmware as it is here. The inner error is the compiler's, or that of the ELF's check.
    pub(super) fn build(&self) -> io::Result<Result<(), String>> {
        let done = Command::new(self.copy.join("firmware/build")).arg(BOARD).stdin(Stdio::null()).output()?;
        if done.status.success() {
            return Ok(Ok(()));
        }
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        let is_error = |line: &&str| line.starts_with("error") || line.starts_with("check-elf");
        let first = said.lines().find(is_error).or(said.lines().last());
        Ok(Err(first.unwrap_or("it says nothing").to_owned()))
    }

    /// Builds the firmware with a mutant in it, and puts the file back.
    pub(super) fn build_with(&self, mutant: &Mutant) -> Result<Result<(), String>, Box<dyn Error>> {
        let path = self.copy.join(&mutant.file);
        let original =
            fs::read(&path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
        mutant.apply(&self.copy)?;
        let built = self.build();
        fs::write(&path, original).map_err(|error| format!("cannot write `{}`: {error}", path.display()))?;
        Ok(built?)
    }

    /// The firmware that was built last.
    pub(super) fn elf(&self) -> PathBuf {
        self.copy.join("firmware/target").join(BOARD).join("dermatome-firmware")
    }
}

/// Makes a file or folder like another one.
fn mirror(from: &Path, to: &Path) -> io::Result<()> {
    if from.is_file() {
        return mirror_file(from, to);
    }
    fs::create_dir_all(to)?;
    let wanted = names(from)?;
    for gone in names(to)?.difference(&wanted) {
        remove(&to.join(gone))?;
    }
    wanted.iter().try_for_each(|name| mirror(&from.join(name), &to.join(name)))
}

fn mirror_file(from: &Path, to: &Path) -> io::Result<()> {
    if fs::read(to).is_ok_and(|there| fs::read(from).is_ok_and(|here| here == there)) {
        return Ok(());
    }
    fs::copy(from, to).map(drop)
}

fn names(folder: &Path) -> io::Result<BTreeSet<OsString>> {
    let names: io::Result<BTreeSet<_>> = fs::read_dir(folder)?.map(|entry| Ok(entry?.file_name())).collect();
    Ok(names?.into_iter().filter(|name| name != RESULTS).collect())
}

fn remove(path: &Path) -> io::Result<()> {
    if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) }
}

//! Mutants: faults that a person could have put into the firmware, and that silicon would punish.
//!
//! The table `mutants.toml` names each one: the file, the text to find there and what takes its place, why a real chip
//! would not put up with it, and the cases that notice. The command `dermatome-hil mutants` builds and runs them.

use crate::cases::Case;
use serde::Deserialize;
use std::{
    collections::BTreeSet,
    fs, io,
    path::{Path, PathBuf},
};

/// The table, as it is built into the program.
const TABLE: &str = include_str!("../mutants.toml");

/// One fault.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mutant {
    /// What it is called.
    pub name: String,
    /// File, seen from the project's folder.
    pub file: PathBuf,
    /// Text that stands there exactly once.
    pub find: String,
    /// What takes its place.
    pub replace: String,
    /// What silicon does about it.
    pub why: String,
    /// Words in the names of the cases that notice.
    pub cases: Vec<String>,
    /// Why no case notices.
    pub survives: Option<String>,
}

/// Why there are no mutants.
#[derive(Debug, thiserror::Error)]
pub enum MutantError {
    /// The table is none.
    #[error("mutants.toml: {0}")]
    Table(#[from] toml::de::Error),
    /// Two have the same name.
    #[error("mutants.toml: two mutants have the `name` \"{0}\"")]
    Name(String),
    /// A mutant's words are in no case's name.
    #[error("mutants.toml, \"{name}\": `cases` has \"{words}\", which no case is called")]
    Case {
        /// The mutant.
        name: String,
        /// Its words.
        words: String,
    },
    /// A mutant's file cannot be read or written.
    #[error("mutants.toml, \"{name}\": `file` is {}: {reason}", file.display())]
    File {
        /// The mutant.
        name: String,
        /// The file.
        file: PathBuf,
        /// What the system says.
        reason: io::Error,
    },
    /// A mutant's text is not where it was, or not only there.
    #[error(
        "mutants.toml, \"{name}\": {} has the text of `find` {times} times, once is allowed: {find:?}",
        file.display()
    )]
    Find {
        /// The mutant.
        name: String,
        /// The file.
        file: PathBuf,
        /// What was looked for.
        find: String,
        /// How often it is there.
        times: usize,
    },
}

/// The table's mutants.
pub fn all() -> Result<Vec<Mutant>, MutantError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Table {
        mutant: Vec<Mutant>,
    }
    let Table { mutant: mutants } = toml::from_str(TABLE)?;
    let mut names = BTreeSet::new();
    match mutants.iter().find(|mutant| !names.insert(&mutant.name)) {
        Some(twice) => Err(MutantError::Name(twice.name.clone())),
        None => Ok(mutants),
    }
}

impl Mutant {
    /// The mutated file's text, for the project in this folder.
    pub fn mutated(&self, project: &Path) -> Result<String, MutantError> {
        let text = fs::read_to_string(project.join(&self.file)).map_err(|reason| self.file_error(reason))?;
        let times = text.matches(&self.find).count();
        if times != 1 {
            let (name, file, find) = (self.name.clone(), self.file.clone(), self.find.clone());
            return Err(MutantError::Find { name, file, find, times });
        }
        Ok(text.replacen(&self.find, &self.replace, 1))
    }

    /// Puts it into the project in this folder.
    pub fn apply(&self, project: &Path) -> Result<(), MutantError> {
        let text = self.mutated(project)?;
        fs::write(project.join(&self.file), text).map_err(|reason| self.file_error(reason))
    }

    /// Whether a case is one of those that should notice.
    #[must_use]
    pub fn expects(&self, case: &Case) -> bool {
        self.cases.iter().any(|words| case.name.contains(words))
    }

    /// Its words are in names of these cases.
    pub fn check_cases(&self, cases: &[Case]) -> Result<(), MutantError> {
        let unknown = |words: &&String| !cases.iter().any(|case| case.name.contains(words.as_str()));
        match self.cases.iter().find(unknown) {
            None => Ok(()),
            Some(words) => Err(MutantError::Case { name: self.name.clone(), words: words.clone() }),
        }
    }

    fn file_error(&self, reason: io::Error) -> MutantError {
        MutantError::File { name: self.name.clone(), file: self.file.clone(), reason }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases;

    const PROJECT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

    fn first(edit: impl FnOnce(&mut Mutant)) -> Mutant {
        let mut mutant = all().unwrap().remove(0);
        edit(&mut mutant);
        mutant
    }

    #[test]
    fn every_mutant_applies_to_todays_sources() {
        for mutant in all().unwrap() {
            let mutated = mutant.mutated(Path::new(PROJECT)).unwrap_or_else(|error| panic!("{error}"));
            let original = fs::read_to_string(Path::new(PROJECT).join(&mutant.file)).unwrap();
            assert_ne!(mutated, original, "{}", mutant.name);
        }
    }

    #[test]
    fn every_mutant_says_why_and_which_cases_notice() {
        let (mutants, cases) = (all().unwrap(), cases::all());
        assert!(mutants.len() >= 30, "{}", mutants.len());
        for mutant in mutants {
            mutant.check_cases(&cases).unwrap_or_else(|error| panic!("{error}"));
            let noticed = mutant.cases.is_empty() != mutant.survives.is_none();
            assert!(!mutant.why.is_empty() && noticed, "{}", mutant.name);
        }
    }

    #[test]
    fn a_text_that_is_gone_or_there_twice_is_named_with_its_file() {
        for (find, times) in [("no such text", "0 times"), ("fn ", "times, once is allowed")] {
            let mutant = first(|mutant| mutant.find = find.to_owned());
            let error = mutant.mutated(Path::new(PROJECT)).unwrap_err().to_string();
            for part in [&mutant.name, &mutant.file.display().to_string(), times] {
                assert!(error.contains(part), "no `{part}` in {error}");
            }
        }
    }

    #[test]
    fn a_case_that_nobody_knows_is_named() {
        let mutant = first(|mutant| mutant.cases = vec!["dancing".to_owned()]);
        let error = mutant.check_cases(&cases::all()).unwrap_err().to_string();
        assert!(error.contains(&mutant.name) && error.contains("dancing"), "{error}");
    }
}

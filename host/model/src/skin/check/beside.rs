//! Files that a skin file names: beside it or in a folder there, and nowhere else.
//!
//! A skin file may come from a stranger: reading it must open no file of somebody else's.

use super::Checker;
use crate::skin::{
    SkinError,
    table::{self, Columns},
};
use serde::de::DeserializeOwned;
use std::path::{Component, Path, PathBuf};

impl Checker<'_> {
    /// Where a file is that `field` names.
    pub(super) fn beside(&self, field: &'static str, file: &Path) -> Result<PathBuf, SkinError> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let path = folder.join(file);
        if stays_inside(file) && !leads_out(folder, &path) {
            return Ok(path);
        }
        let allowed = "a file beside the skin file or in a folder there, by its path from there";
        self.refuse(field, format!("{:?}", file.display().to_string()), allowed)
    }

    /// Rows of a CSV file that a skin file names.
    pub(super) fn table<T: DeserializeOwned>(
        &self,
        file: &Path,
        table: &TableField<'_>,
    ) -> Result<Vec<T>, SkinError> {
        let TableField { field, else_allowed, columns, most } = *table;
        match table::read(&self.beside(field, file)?, columns, most) {
            Ok(rows) => Ok(rows.into_iter().map(|(_, row)| row).collect()),
            Err(error) => {
                let allowed = format!("{else_allowed}, or a CSV file with the columns {}", columns.words());
                self.refuse(field, format!("{:?}: {error}", file.display().to_string()), &allowed)
            }
        }
    }
}

/// A field that may name a CSV file.
pub(super) struct TableField<'a> {
    pub(super) field: &'static str,
    /// What else it may hold.
    pub(super) else_allowed: &'a str,
    pub(super) columns: Columns<'a>,
    /// Rows at most.
    pub(super) most: usize,
}

/// Whether a path is relative and never climbs above where it starts.
fn stays_inside(file: &Path) -> bool {
    let mut depth = 0_usize;
    file.components().all(|component| match component {
        Component::Normal(_) => {
            depth += 1;
            true
        }
        Component::CurDir => true,
        Component::ParentDir if depth > 0 => {
            depth -= 1;
            true
        }
        _ => false,
    })
}

/// Whether links lead from `path` to a place outside `folder`. What is not there leads nowhere.
fn leads_out(folder: &Path, path: &Path) -> bool {
    matches!((folder.canonicalize(), path.canonicalize()), (Ok(folder), Ok(path)) if !path.starts_with(&folder))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_from_the_skin_file_down_are_taken_and_others_are_not() {
        for inside in ["a.csv", "./a.csv", "tables/a.csv", "tables/../a.csv"] {
            assert!(stays_inside(Path::new(inside)), "{inside}");
        }
        for outside in ["/etc/shadow", "../a.csv", "tables/../../a.csv", ".."] {
            assert!(!stays_inside(Path::new(outside)), "{outside}");
        }
    }
}

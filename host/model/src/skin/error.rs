//! Why a skin file cannot be used.

use std::{
    io,
    path::{Path, PathBuf},
};

/// Why a skin file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SkinError {
    /// The file cannot be read.
    #[error("cannot read skin file `{}`: {reason}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: io::Error,
    },
    /// A folder.
    #[error("`{}` is a folder; allowed: a skin file{}", path.display(), of_folder(path))]
    Folder {
        /// The folder.
        path: PathBuf,
    },
    /// The file is not TOML, or lacks a field, or has one too many.
    #[error("skin file `{}`: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// What the TOML reader says, with line and column.
        message: String,
    },
    /// A field has a value that is not allowed.
    #[error("skin file `{}`: `{field}` is {value}; allowed: {allowed}", path.display())]
    Value {
        /// The file.
        path: PathBuf,
        /// The field, with its table.
        field: &'static str,
        /// What it holds.
        value: String,
        /// What it may hold.
        allowed: String,
    },
}

/// The skin file of a folder, if it has one where the shipped skins have theirs.
fn of_folder(folder: &Path) -> String {
    let file = folder.join("skin.toml");
    if file.is_file() { format!(", as `{}`", file.display()) } else { String::new() }
}

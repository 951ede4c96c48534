//! Writing files whole or not at all.

use std::{
    io::{self, Write},
    path::{Path, PathBuf},
};

/// A file that could not be written; nothing was left behind.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{}`: {reason}", path.display())]
pub struct WriteError {
    path: PathBuf,
    reason: io::Error,
}

/// Writes `bytes` to a temporary file beside `path`, then renames it, so that `path` holds either
/// all of them or what it held before.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let write = || {
        let mut file = temporary_file(folder)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(path).map_err(|error| error.error)
    };
    write().map(drop).map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// A temporary file with the permissions of an ordinary new file, which the umask narrows.
fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_folder_is_named_and_nothing_is_left_behind() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("missing/out.bin");
        let error = write_whole(&path, b"x").unwrap_err().to_string();
        assert!(error.contains("missing/out.bin"), "{error}");
        write_whole(&folder.path().join("a"), b"1").unwrap();
        write_whole(&folder.path().join("a"), b"22").unwrap();
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"22");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}

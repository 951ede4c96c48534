//! Writing files whole or not at all.

use std::{
    fs::OpenOptions,
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

/// Bytes that are written at once.
const BUFFER_BYTES: usize = 1 << 16;

/// A file that could not be written; nothing was left behind.
#[derive(Debug, thiserror::Error)]
#[error("cannot write `{}`: {reason}", path.display())]
pub struct WriteError {
    path: PathBuf,
    reason: io::Error,
}

/// Writes `bytes` to `path`, so that a file there holds either all of them or what it held before.
///
/// What is no ordinary file is never replaced: a link is followed, and a device or a pipe is written
/// in place.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    stream_whole(path, |out| out.write_all(bytes))
}

/// The same for bytes that are made as they are written: `write` gets a buffered stream.
pub fn stream_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), WriteError> {
    let written = match Target::of(path) {
        Target::File(path) => replace(&path, write),
        Target::InPlace => {
            OpenOptions::new().write(true).open(path).and_then(|mut file| buffered(&mut file, write))
        }
        Target::StandardOutput => buffered(&mut io::stdout().lock(), write),
    };
    written.map_err(|reason| WriteError { path: path.to_owned(), reason })?;
    log::debug!("wrote `{}`", path.display());
    Ok(())
}

/// Writes files that belong together, so that all of them are written or none is: ordinary files are replaced once
/// their bytes are safe on the disk and what is none has been written in place.
pub fn write_together(files: &[(&Path, &[u8])]) -> Result<(), WriteError> {
    let mut safe = Vec::new();
    for (path, bytes) in files {
        let failed = |reason| WriteError { path: path.to_path_buf(), reason };
        match Target::of(path) {
            Target::File(target) => safe.push((safe_file(&target, bytes).map_err(failed)?, target)),
            Target::InPlace | Target::StandardOutput => write_whole(path, bytes)?,
        }
    }
    persist(safe)
}

/// Checks that a file could be written to `path`, before the work whose result it is to hold.
pub fn check_folder(path: &Path) -> Result<(), WriteError> {
    let tried = match Target::of(path) {
        Target::File(target) => temporary_file(folder_of(&target)).map(drop),
        Target::InPlace if path.is_dir() => {
            Err(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder"))
        }
        Target::InPlace | Target::StandardOutput => Ok(()),
    };
    tried.map_err(|reason| WriteError { path: path.to_owned(), reason })
}

/// A folder for files that belong together: either all of them are written or none is.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Checks that the folder can be made and written to, before the work whose results it is to hold. One that is
    /// not there is made only when there is something to write, so that an interrupt leaves none.
    pub fn prepare(path: &Path) -> Result<Self, WriteError> {
        let open = Made::at(path).and_then(|_made| temporary_file(path).map(drop));
        open.map_err(|reason| WriteError { path: path.to_owned(), reason })?;
        Ok(Self { path: path.to_owned() })
    }

    /// Writes files by name; what is there under these names is replaced once all are safe on the disk.
    pub fn write_all(self, files: &[(&str, &[u8])]) -> Result<(), WriteError> {
        let mut made =
            Made::at(&self.path).map_err(|reason| WriteError { path: self.path.clone(), reason })?;
        let mut safe = Vec::new();
        for (name, bytes) in files {
            let path = self.path.join(name);
            let written = safe_file(&path, bytes);
            safe.push((written.map_err(|reason| WriteError { path: path.clone(), reason })?, path));
        }
        if let Some((_, path)) = safe.iter().find(|(_, path)| path.is_dir()) {
            let reason = io::Error::new(io::ErrorKind::IsADirectory, "it is a folder");
            return Err(WriteError { path: path.clone(), reason });
        }
        made.is_new = false;
        persist(safe)
    }
}

/// A folder that goes away again if it was made here and nothing stays in it.
struct Made<'a> {
    path: &'a Path,
    is_new: bool,
}

impl<'a> Made<'a> {
    fn at(path: &'a Path) -> io::Result<Self> {
        let is_new = !path.exists();
        if is_new {
            std::fs::create_dir(path)?;
        } else if !path.is_dir() {
            return Err(io::Error::new(io::ErrorKind::NotADirectory, "it is there, and is not a folder"));
        }
        Ok(Self { path, is_new })
    }
}

impl Drop for Made<'_> {
    fn drop(&mut self) {
        if self.is_new {
            // Fails only if somebody put something into it meanwhile.
            let _ = std::fs::remove_dir(self.path);
        }
    }
}

/// What a path leads to.
enum Target {
    /// An ordinary file, or nothing yet.
    File(PathBuf),
    /// A device, a pipe, a socket; or a folder, which opening refuses.
    InPlace,
    /// The stream itself: where it leads to a file, a second opening would overwrite what was printed.
    StandardOutput,
}

impl Target {
    fn of(path: &Path) -> Self {
        if cfg!(unix) && path == Path::new("/dev/stdout") {
            return Self::StandardOutput;
        }
        match path.metadata() {
            Ok(metadata) if !metadata.is_file() => Self::InPlace,
            Ok(_) => Self::File(path.canonicalize().unwrap_or_else(|_| path.to_owned())),
            Err(_) => Self::File(path.to_owned()),
        }
    }
}

fn buffered(file: &mut impl Write, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::with_capacity(BUFFER_BYTES, file);
    write(&mut out)?;
    out.flush()
}

/// A temporary file beside `path` with these bytes, which are on the disk.
fn safe_file(path: &Path, bytes: &[u8]) -> io::Result<tempfile::NamedTempFile> {
    let mut file = temporary_file(folder_of(path))?;
    buffered(&mut file, |out| out.write_all(bytes))?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// Puts files where they belong.
fn persist(safe: Vec<(tempfile::NamedTempFile, PathBuf)>) -> Result<(), WriteError> {
    for (file, path) in safe {
        file.persist(&path).map_err(|error| WriteError { path, reason: error.error })?;
    }
    Ok(())
}

/// Writes to a temporary file beside `path`, then renames it.
fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut file = temporary_file(folder_of(path))?;
    buffered(&mut file, write)?;
    file.as_file().sync_all()?;
    file.persist(path).map(drop).map_err(|error| error.error)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A temporary file with the permissions of an ordinary new file, which the umask narrows.
fn temporary_file(folder: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder).map_err(|error| without_path(&error))
}

/// The system's words alone: `tempfile` adds the temporary file's own name, which tells nobody anything.
fn without_path(error: &io::Error) -> io::Error {
    let words = error.to_string();
    let words = words.split_once(" at path ").map_or(&*words, |(words, _)| words);
    io::Error::new(error.kind(), words)
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
        assert!(!error.contains("at path"), "{error}");
        write_whole(&folder.path().join("a"), b"1").unwrap();
        write_whole(&folder.path().join("a"), b"22").unwrap();
        assert_eq!(std::fs::read(folder.path().join("a")).unwrap(), b"22");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_stream_that_breaks_off_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        write_whole(&path, b"old").unwrap();
        let broken = stream_whole(&path, |out| {
            out.write_all(&[b'n'; 200_000])?;
            Err(io::Error::other("no more"))
        });
        assert!(broken.unwrap_err().to_string().ends_with("a`: no more"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_written_in_place_and_stays_a_device() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        // A link, so that a mistake replaces the link and not the machine's /dev/null.
        let [null, full] = ["null", "full"].map(|name| folder.path().join(name));
        symlink("/dev/null", &null).unwrap();
        write_whole(&null, b"gone").unwrap();
        assert!(std::fs::metadata(&null).unwrap().file_type().is_char_device());
        if Path::new("/dev/full").exists() {
            symlink("/dev/full", &full).unwrap();
            let error = write_whole(&full, b"x").unwrap_err().to_string();
            assert!(error.contains("full`: No space left"), "{error}");
            assert!(std::fs::metadata(&full).unwrap().file_type().is_char_device());
        }
    }

    #[cfg(unix)]
    #[test]
    fn where_one_of_several_files_cannot_be_written_the_others_keep_what_they_held() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        std::fs::write(&a, b"old").unwrap();
        let missing = folder.path().join("missing/c");
        for bad in [Path::new("/dev/full"), &missing] {
            let error = write_together(&[(&a, b"new"), (&b, b"new"), (bad, b"x")]).unwrap_err();
            assert!(error.to_string().contains(&*bad.to_string_lossy()), "{error}");
            assert_eq!(std::fs::read(&a).unwrap(), b"old");
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        }
        write_together(&[(&a, b"new"), (&b, b"x")]).unwrap();
        assert_eq!([&a, &b].map(|path| std::fs::read(path).unwrap()), [b"new".to_vec(), b"x".to_vec()]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_to_a_file_stays_a_link() {
        let folder = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|name| folder.path().join(name));
        std::fs::write(&file, b"old").unwrap();
        std::os::unix::fs::symlink("file", &link).unwrap();
        write_whole(&link, b"new").unwrap();
        assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(std::fs::read(&file).unwrap(), b"new");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    }

    #[test]
    fn files_that_belong_together_are_written_all_or_none() {
        let desk = tempfile::tempdir().unwrap();
        let path = desk.path().join("out");
        let write = |files: &[(&str, &[u8])]| OutputFolder::prepare(&path).unwrap().write_all(files);
        drop(OutputFolder::prepare(&path).unwrap());
        assert!(!path.exists(), "nothing was written");
        write(&[("a", b"1"), ("b", b"2")]).unwrap();
        std::fs::create_dir(path.join("c")).unwrap();
        let error = write(&[("a", b"3"), ("c", b"4")]).unwrap_err().to_string();
        assert!(error.contains("it is a folder"), "{error}");
        assert_eq!(std::fs::read(path.join("a")).unwrap(), b"1");
        assert_eq!(std::fs::read_dir(&path).unwrap().count(), 3);
        write(&[("a", b"5")]).unwrap();
        assert_eq!(std::fs::read(path.join("a")).unwrap(), b"5");
        let error = OutputFolder::prepare(&path.join("a")).unwrap_err().to_string();
        assert!(error.contains("not a folder"), "{error}");
        assert!(OutputFolder::prepare(&path.join("x/y")).is_err());
    }

    #[test]
    fn a_folder_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let error = write_whole(folder.path(), b"x").unwrap_err().to_string();
        assert!(error.contains("directory") || error.contains("denied"), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}

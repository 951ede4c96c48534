//! Reading files of bounded size: a path may lead to something that never ends.

use std::{
    fs::File,
    io::{self, ErrorKind, Read},
    path::Path,
};

/// Most bytes of a file that people write: a skin file, a material, a table.
pub const MAX_TEXT_BYTES: u64 = 64 << 20;
/// Most bytes of a patch, several times those of the longest that a board takes.
pub const MAX_PATCH_BYTES: u64 = 1 << 20;

/// The bytes of a file that holds at most `most`.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let words = format!("it holds more than {most} bytes, the most that such a file may");
        return Err(io::Error::new(ErrorKind::FileTooLarge, words));
    }
    log::debug!("read `{}`: {} bytes", path.display(), bytes.len());
    Ok(bytes)
}

/// The text of a file that people write.
pub fn read_text(path: &Path) -> io::Result<String> {
    let bytes = read(path, MAX_TEXT_BYTES)?;
    String::from_utf8(bytes).map_err(|_| io::Error::new(ErrorKind::InvalidData, "it is no text in UTF-8"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_up_to_its_limit_and_refused_beyond_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, [7; 100]).unwrap();
        assert_eq!(read(&path, 100).unwrap(), [7; 100]);
        let error = read(&path, 99).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        assert!(error.to_string().contains("more than 99 bytes"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn what_never_ends_is_refused() {
        let error = read_text(Path::new("/dev/zero")).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::FileTooLarge);
    }
}

//! NumPy's archives: a `.zip` of `.npy` files.

use super::{
    Array, ArrayError, MAX_BYTES,
    error::{Listing, MAX_LISTED},
    npy::{self, HEADER_WINDOW},
};
use std::{
    fmt,
    io::{self, Cursor, Read},
};
use zip::{ZipArchive, ZipWriter, write::SimpleFileOptions};

/// What the name of an array's file ends in.
const SUFFIX: &str = ".npy";

type Archive<'a> = ZipArchive<Cursor<&'a [u8]>>;

/// Reads the array `key`, or the only one.
pub(super) fn parse(bytes: &[u8], key: Option<&str>) -> Result<Array<'static>, ArrayError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(archive_problem)?;
    let key = choose(&mut archive, key)?;
    let member = read_member(&mut archive, &key, MAX_BYTES + 1)?;
    if member.len() as u64 > MAX_BYTES {
        return Err(ArrayError::TooLarge);
    }
    Ok(npy::parse(&member)?)
}

/// Makes an archive of arrays by name, as `numpy.savez_compressed` does.
pub fn archive(arrays: &[(&str, Array<'_>)]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, array) in arrays {
        archive.start_file(format!("{name}{SUFFIX}"), SimpleFileOptions::default())?;
        npy::write(&mut archive, array)?;
    }
    Ok(archive.finish()?.into_inner())
}

fn choose(archive: &mut Archive<'_>, key: Option<&str>) -> Result<String, ArrayError> {
    let mut names: Vec<String> =
        archive.file_names().filter_map(|file| file.strip_suffix(SUFFIX)).map(str::to_owned).collect();
    names.sort();
    match (key, names.as_slice()) {
        (_, []) => Err(ArrayError::NoArrays),
        (Some(key), _) if names.iter().any(|name| name == key) => Ok(key.to_owned()),
        (Some(key), _) => Err(ArrayError::NoKey { key: key.to_owned(), arrays: list(archive, names) }),
        (None, [only]) => Ok(only.clone()),
        (None, _) => Err(ArrayError::SeveralArrays { arrays: list(archive, names) }),
    }
}

fn list(archive: &mut Archive<'_>, names: Vec<String>) -> Listing {
    let describe = |(place, name): (usize, String)| {
        if place >= MAX_LISTED {
            return name;
        }
        let start = read_member(archive, &name, HEADER_WINDOW as u64).ok();
        let shape = start.and_then(|start| npy::describe(&start).ok());
        format!("`{name}` {}", shape.as_deref().unwrap_or("(unreadable)"))
    };
    Listing(names.into_iter().enumerate().map(describe).collect())
}

/// At most `limit` bytes of an array's file.
fn read_member(archive: &mut Archive<'_>, name: &str, limit: u64) -> Result<Vec<u8>, ArrayError> {
    let member = archive.by_name(&format!("{name}{SUFFIX}")).map_err(archive_problem)?;
    let mut bytes = Vec::new();
    member.take(limit).read_to_end(&mut bytes).map_err(archive_problem)?;
    Ok(bytes)
}

fn archive_problem(error: impl fmt::Display) -> ArrayError {
    ArrayError::Archive(error.to_string())
}

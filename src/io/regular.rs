//! Opening files to read them. Only regular ones: a pipe that a scene names would be waited for until someone writes
//! into it, and a device may have no end.

use super::budget::Budget;
use super::error::{FileError, Problem};
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

/// The most that is read of a text that people write: a script, preferences, a table.
pub(crate) const TEXT_BYTES: u64 = 1 << 26;

/// Opens a file to read it, if it is one.
pub(crate) fn open_regular(path: &Path) -> Result<File, FileError> {
    let reading = |error: std::io::Error| FileError::reading(path, &error);
    // Asked before it is opened: opening a pipe already waits.
    let kind = fs::metadata(path).map_err(reading)?.file_type();
    if kind.is_dir() {
        return Err(FileError::new(path, Problem::IsAFolder));
    }
    if !kind.is_file() {
        return Err(FileError::new(path, Problem::NotAFile));
    }
    File::open(path).map_err(reading)
}

/// Opens a file that shall be read, no larger than the limit, and not empty.
pub(super) fn open_to_read(path: &Path, limit: u64) -> Result<BufReader<File>, FileError> {
    let file = open_regular(path)?;
    let metadata = file.metadata();
    let size = metadata
        .map_err(|error| FileError::reading(path, &error))?
        .len();
    if size > limit {
        return Err(FileError::new(path, Problem::TooLarge { size, limit }));
    }
    if size == 0 {
        return Err(FileError::new(path, Problem::Empty));
    }
    let mut reader = BufReader::with_capacity(1 << 16, file);
    let start = reader.fill_buf();
    let start = start.map_err(|error| FileError::reading(path, &error))?;
    let problem = packed(start).map(Problem::Packed);
    match problem.or_else(|| stands_for(start).map(Problem::StandsForAFile)) {
        Some(problem) => Err(FileError::new(path, problem)),
        None => Ok(reader),
    }
}

/// What a file is that often lies where another was to be downloaded to.
fn stands_for(start: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 3] = [
        (b"<!doctype html", "a web page"),
        (b"<html", "a web page"),
        (b"version https://git-lfs", "a pointer of Git LFS"),
    ];
    let begins = |bytes: &[u8]| {
        let start = start.get(..bytes.len());
        start.is_some_and(|start| start.eq_ignore_ascii_case(bytes))
    };
    let kind = KINDS.iter().find(|(bytes, _)| begins(bytes));
    kind.map(|&(_, name)| name)
}

/// The format of a packed file, by how it begins: what is in it may have any.
fn packed(start: &[u8]) -> Option<&'static str> {
    const FORMATS: [(&[u8], &str); 7] = [
        (b"\x1f\x8b\x08", "gzip"),
        (b"PK\x03\x04", "zip"),
        (b"7z\xbc\xaf\x27\x1c", "7z"),
        (b"Rar!\x1a\x07", "rar"),
        (b"\xfd7zXZ\0", "xz"),
        (b"\x28\xb5\x2f\xfd", "zstd"),
        (b"BZh", "bzip2"),
    ];
    let format = FORMATS.iter().find(|(bytes, _)| start.starts_with(bytes));
    format.map(|&(_, name)| name)
}

/// The content of a file, no larger than the limit, and claimed before it is read.
pub(super) fn read_bytes(path: &Path, limit: u64, memory: &Budget) -> Result<Vec<u8>, FileError> {
    read_bytes_unless(path, limit, memory, |_| None)
}

/// The same, unless how the file begins says already that it is of no use.
pub(super) fn read_bytes_unless(
    path: &Path,
    limit: u64,
    memory: &Budget,
    is_no: impl FnOnce(&[u8]) -> Option<Problem>,
) -> Result<Vec<u8>, FileError> {
    let reading = |error: std::io::Error| FileError::reading(path, &error);
    let mut reader = open_to_read(path, limit)?;
    if let Some(problem) = is_no(reader.fill_buf().map_err(reading)?) {
        return Err(FileError::new(path, problem));
    }
    let size = reader.get_ref().metadata().map_err(reading)?.len();
    memory
        .claim(size)
        .map_err(|problem| FileError::new(path, problem))?;
    let mut bytes = Vec::new();
    // No more where it is still growing.
    let mut reader = reader.take(size);
    reader.read_to_end(&mut bytes).map_err(reading)?;
    Ok(bytes)
}

/// The text of a small file that people write, of no more bytes than the limit.
pub(crate) fn read_text(path: &Path, limit: u64) -> Result<String, FileError> {
    let file = open_regular(path)?;
    let mut bytes = Vec::new();
    file.take(limit.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| FileError::reading(path, &error))?;
    let size = bytes.len() as u64;
    if size > limit {
        return Err(FileError::new(path, Problem::TooLarge { size, limit }));
    }
    String::from_utf8(bytes)
        .map_err(|_| FileError::new(path, Problem::Malformed("is not UTF-8 text".into())))
}

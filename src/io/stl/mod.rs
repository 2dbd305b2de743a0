//! STL, ASCII and binary: facets without structure, as printers, scanners and CAD write them.
//!
//! The reader is our own. The crate `stl_io` (0.11) takes every file that begins with `solid` for text, which half of
//! the programs write in front of binary data too; it refuses a whole file for one number that is none; it knows one
//! solid a file and no colours; and its lines may be as long as memory. None of that could be mended from outside.

mod ascii;
mod binary;
mod facets;

use super::Limits;
use super::error::{FileError, Problem};
use super::model::Model;
use facets::Facets;
use std::io::{BufRead, BufReader, Read, Seek};
use std::path::Path;

/// The text before the number of facets, and that number.
const HEAD: u64 = 84;
/// Three corners and a normal of three floats, and two bytes.
const FACET: u64 = 50;

/// Reads an STL: one object for each solid, called like it, or like the file where it has no name. Facets are flat and
/// face where their corners turn counter-clockwise; corners at one place become one vertex.
pub(crate) fn read_stl(file: &Path, limits: &Limits) -> Result<Model, FileError> {
    let reading = |error: std::io::Error| FileError::reading(file, &error);
    let mut reader = super::open_to_read(file, limits.file_bytes)?;
    let size = reader.get_ref().metadata().map_err(reading)?.len();
    let start = reader.fill_buf().map_err(reading)?;
    if size > HEAD && start.iter().all(|&byte| byte == 0) {
        let text = "holds zeros and no facets; get a complete copy";
        return Err(FileError::new(file, Problem::Malformed(text.into())));
    }
    let mut facets = Facets::of(file, limits);
    if is_text(&mut reader, size).map_err(reading)? {
        ascii::read_ascii(&mut facets, limits)?;
    } else if size >= HEAD {
        binary::read_binary(&mut facets, reader, size)?;
    } else {
        return Err(FileError::new(file, neither()));
    }
    facets.into_model()
}

fn neither() -> Problem {
    Problem::Malformed("is neither an ASCII nor a binary STL".into())
}

/// A file is binary where its size is what it says, whatever it begins with; else text where it looks like one.
fn is_text<R: Read + Seek>(reader: &mut BufReader<R>, size: u64) -> std::io::Result<bool> {
    let start = reader.fill_buf()?;
    let count = start.get(80..).and_then(|bytes| bytes.first_chunk());
    if count.is_some_and(|&count| HEAD + FACET * u64::from(u32::from_le_bytes(count)) == size) {
        return Ok(false);
    }
    // No coordinates are without a zero byte or one that no text has, for so long.
    let start = &start[..start.len().min(1024)];
    let is_of_text = |&byte: &u8| byte >= 0x20 || byte.is_ascii_whitespace();
    let is_wide = matches!(start, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]);
    Ok(start.iter().all(is_of_text) || is_wide)
}

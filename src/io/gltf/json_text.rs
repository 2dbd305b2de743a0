//! The text of a glTF file before it is JSON: what it is where it is none, and what can be told of it all the same.

use super::super::error::{FileError, Place, Problem};
use super::super::text::{is_utf_16, no_text, text as decoded_text, utf_16};
use super::not_finite;
use serde_json::Value;
use std::borrow::Cow;
use std::path::Path;

/// Why a file is neither a container nor JSON, by how it begins.
pub(super) fn neither(start: &[u8]) -> Option<Problem> {
    let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start);
    match text.trim_ascii_start() {
        [] | [b'{', ..] => None,
        _ if start.starts_with(b"glTF") => None,
        _ if is_utf_16(start) => Some(utf_16("glTF")),
        _ if start.iter().all(|&byte| byte == 0) => no_text(start),
        _ => {
            let text = "is no glTF: it begins neither with `glTF`, as binary files do, nor with `{`, as text does";
            Some(Problem::Malformed(text.into()))
        }
    }
}

/// A document that is no JSON but for what can be told: letters of an old encoding, numbers that are none.
pub(super) fn mended(text: &[u8], mut note: impl FnMut(&str, &'static str)) -> Option<Value> {
    let decoded = decoded_text(text);
    let is_latin = matches!(decoded, Cow::Owned(_));
    let plain = is_latin
        .then(|| serde_json::from_str(&decoded).ok())
        .flatten();
    let root = plain.or_else(|| {
        let finite = not_finite::without_them(decoded.as_bytes())?;
        let root = serde_json::from_slice(&finite).ok()?;
        let what = "NaN, Infinity or numbers as large, which JSON does not have";
        note(what, "read as none");
        Some(root)
    })?;
    if is_latin {
        note("text that is no UTF-8", "its letters are read as Latin-1");
    }
    Some(root)
}

/// Why the text is no JSON, and where.
pub(super) fn parse_error(file: &Path, text: &[u8], error: &serde_json::Error) -> FileError {
    if is_utf_16(text) {
        return FileError::new(file, utf_16("glTF"));
    }
    if error.is_eof() {
        let problem = Problem::Truncated("the JSON is incomplete".into());
        return FileError::new(file, problem);
    }
    let place = Place::LineColumn(error.line(), error.column());
    let text = error.to_string();
    let text = text.split(" at line").next().unwrap_or_default().to_owned();
    FileError::at(file, place, Problem::Malformed(text))
}

/// What the JSON of a file becomes in memory: for each object in it the largest that there is, and its texts. Data that
/// is written as text has no braces.
pub(super) fn json_bytes(text: &[u8]) -> u64 {
    const LARGEST: u64 = 1000;
    let objects = text.iter().filter(|&&byte| byte == b'{').count();
    LARGEST * objects as u64 + text.len() as u64
}

//! The head of an OpenEXR file, and what its library says of such files.

use super::super::error::{FileError, Problem};
use super::super::open_to_read;
use super::read::one_line;
use crate::io::Limits;
use exr::error::Error;
use exr::meta::attribute::Text;
use exr::meta::{MetaData, magic_number};
use std::io::BufRead;
use std::path::Path;

/// What the library says where a file ends too early, of whatever part.
const ENDED: &str = "reference to missing bytes";

/// The head of a file, of which nothing else is read. One that is no OpenEXR has that problem.
pub(crate) fn exr_head(
    path: &Path,
    limits: &Limits,
    is_none: impl FnOnce() -> Problem,
) -> Result<MetaData, FileError> {
    let mut reader = open_to_read(path, limits.file_bytes)?;
    let start = reader.fill_buf();
    let start = start.map_err(|error| FileError::reading(path, &error))?;
    if !start.starts_with(&magic_number::BYTES) {
        return Err(FileError::new(path, is_none()));
    }
    let read = MetaData::read_from_buffered(reader, false);
    read.map_err(|error| FileError::new(path, exr_problem(error)))
}

/// A text as the format keeps it: as UTF-8, which Blender and other programs write and read in names and attributes.
pub(crate) fn to_exr(text: &str) -> Text {
    Text::from_slice_unchecked(text.as_bytes())
}

/// A text of a file. What is no UTF-8 is taken as Latin-1.
pub(crate) fn from_exr(text: &Text) -> String {
    super::super::text::text(text.as_slice()).into_owned()
}

/// What is wrong with an OpenEXR file that cannot be read.
pub(crate) fn exr_problem(error: Error) -> Problem {
    match error {
        Error::Invalid(text) if text == ENDED => {
            Problem::Truncated("the picture is incomplete".into())
        }
        Error::Io(error) => Problem::Unreadable(one_line(&error.to_string())),
        other => Problem::Malformed(format!(
            "is not a picture that can be decoded: {}",
            one_line(&other.to_string())
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;

    #[test]
    fn what_ends_too_early_what_is_damaged_and_what_the_disk_refuses_are_told_apart() {
        let ended = Error::from(io::Error::from(io::ErrorKind::UnexpectedEof));
        assert!(matches!(exr_problem(ended), Problem::Truncated(_)));
        let denied = Error::from(io::Error::other("device error"));
        let Problem::Unreadable(text) = exr_problem(denied) else {
            panic!("not of the disk");
        };
        assert_eq!(text, "device error");
        for error in [
            Error::Invalid("a bad\nblock".into()),
            Error::NotSupported("a bad\nblock".into()),
        ] {
            let text = exr_problem(error).to_string();
            assert!(text.contains("a bad block"), "{text}");
        }
    }
}

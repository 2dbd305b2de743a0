//! Rendered pictures as files that say how they came about.

use super::super::error::FileError;
use super::{PictureFormat, write_picture_with_notes};
use crate::film::{Picture, Status, develop};
use crate::scene::{Output, RenderSettings, SETTINGS};
use std::path::Path;

/// A name and a text.
pub type Note = (&'static str, String);

/// Writes a picture with notes: linear light where the format holds it, before bloom, exposure and
/// view transform, else what a screen shows.
pub fn write_rendered(
    file: &Path,
    picture: &Picture,
    output: &Output,
    notes: &[Note],
) -> Result<(), FileError> {
    let pixels = if PictureFormat::of(file)?.is_linear() {
        picture
            .pixels
            .iter()
            .map(|pixel| pixel.to_array())
            .collect()
    } else {
        develop(picture, output)
    };
    write_picture_with_notes(file, picture.width, picture.height, &pixels, notes)
}

/// What a file says about itself: enough to render the same picture again. The same render says the
/// same, so there is no time in it.
pub fn picture_notes(camera: &str, settings: &RenderSettings, status: &Status) -> Vec<Note> {
    let words: Vec<String> = SETTINGS
        .iter()
        .map(|setting| format!("{}={}", setting.path, setting.value_text(settings)))
        .collect();
    let mut notes = vec![
        (
            "Software",
            format!("Glassbox {}", env!("CARGO_PKG_VERSION")),
        ),
        ("Camera", camera.replace('\0', " ")),
        ("Settings", words.join(" ")),
        ("Samples", format!("{}", status.samples)),
    ];
    if let Some(error) = status.error() {
        let bound = if error.is_bound { "at most " } else { "" };
        notes.push(("Error", format!("{bound}{:.3e}", error.relative())));
    }
    notes
}

//! How a picture is shown: in a file that screens show, and as a part of a picture keeps it.

use super::Failure;
use super::set::Assignment;
use crate::film::{Picture, develop};
use crate::io::{FileError, PictureFormat, write_picture};
use crate::scene::{RenderSettings, SETTINGS};
use std::path::Path;

/// Writes a picture: linear light where the format holds it, else what a screen shows.
pub(super) fn write_shown(
    file: &Path,
    picture: &Picture,
    settings: &RenderSettings,
) -> Result<(), FileError> {
    let pixels = if PictureFormat::of(file)?.is_linear() {
        picture
            .pixels
            .iter()
            .map(|pixel| pixel.to_array())
            .collect()
    } else {
        develop(picture, &settings.output)
    };
    write_picture(file, picture.width, picture.height, &pixels)
}

/// How a picture is shown, as a part keeps it: every setting of `output`, `key=value`.
pub(super) fn output_text(settings: &RenderSettings) -> String {
    let words: Vec<String> = SETTINGS
        .iter()
        .filter(|setting| setting.path.starts_with("output."))
        .map(|setting| format!("{}={}", setting.path, setting.value_text(settings)))
        .collect();
    words.join(" ")
}

/// Takes over what [`output_text`] wrote.
pub(super) fn read_output(text: &str, settings: &mut RenderSettings) -> Result<(), Failure> {
    for word in text.split_whitespace() {
        let assignment: Assignment = word.parse().map_err(Failure::Usage)?;
        assignment.apply(settings)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::ViewTransform;

    #[test]
    fn what_a_part_keeps_of_the_output_gives_the_same_output() {
        let mut settings = RenderSettings::default();
        settings.output.exposure = -1.25;
        settings.output.view_transform = ViewTransform::AgX;
        settings.output.bloom.intensity = 0.5;
        let mut read = RenderSettings::default();
        read_output(&output_text(&settings), &mut read).unwrap();
        assert_eq!(read, settings);
    }
}

//! How a picture is shown, as a part of a picture keeps it.

use super::Failure;
use super::set::Assignment;
use crate::scene::{RenderSettings, SETTINGS};

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

//! How a picture is shown, as a part of a picture keeps it.

use super::set::Assignment;
use crate::io::{FileError, Problem};
use crate::scene::{Output, RenderSettings, SETTINGS, range_problems};
use std::path::Path;

/// How a picture is shown, as a part keeps it: every setting of `output`, `key=value`.
pub(super) fn output_text(settings: &RenderSettings) -> String {
    let words: Vec<String> = SETTINGS
        .iter()
        .filter(|setting| setting.path.starts_with("output."))
        .map(|setting| format!("{}={}", setting.path, setting.value_text(settings)))
        .collect();
    words.join(" ")
}

/// How a file's picture is shown: takes over what [`output_text`] wrote into it. A file may come from anywhere, so its
/// values are checked as the command line's are.
pub(super) fn read_output(file: &Path, output: &str) -> Result<Output, FileError> {
    let damaged = |why: String| {
        let text = format!("says an `output` that cannot be read ({why}); render it again");
        FileError::new(file, Problem::Malformed(text))
    };
    let mut settings = RenderSettings::default();
    for word in output.split_whitespace() {
        if !word.starts_with("output.") {
            return Err(damaged(format!("`{word}`")));
        }
        let assignment: Assignment = word.parse().map_err(damaged)?;
        let applied = assignment.apply(&mut settings);
        applied.map_err(|failure| damaged(failure.to_string()))?;
    }
    match range_problems(&settings).into_iter().next() {
        Some(problem) => Err(damaged(problem.to_string())),
        None => Ok(settings.output),
    }
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
        let read = read_output(Path::new("a.exr"), &output_text(&settings)).unwrap();
        assert_eq!(read, settings.output);
    }

    #[test]
    fn a_forged_part_cannot_be_shown_with_what_no_setting_may_be() {
        for output in [
            "output.exposure=NaN",
            "output.exposure=1e38",
            "output.bloom.intensity=inf",
            "output.exposure",
            "output.none=1",
            "size=4x4",
        ] {
            let error = read_output(Path::new("a.exr"), output).unwrap_err();
            let text = error.to_string();
            assert!(
                text.starts_with("a.exr: ") && text.contains("output"),
                "{text}"
            );
        }
    }
}

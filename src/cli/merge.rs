//! `glassbox merge`: parts of a picture to a picture.

use super::Failure;
use super::output::{say, tell};
use super::render::write_shown;
use super::set::Assignment;
use crate::io::{self, Limits, PictureFormat, check_writable, read_part, write_part};
use crate::scene::{RenderSettings, SETTINGS};
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub(super) struct Merge {
    /// Parts that `glassbox render --samples A..B` wrote
    #[arg(required = true, value_name = "PART.exr")]
    pub parts: Vec<PathBuf>,
    /// Picture file; an .exr is a part again, with the samples of all
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Print nothing but errors
    #[arg(long)]
    pub quiet: bool,
}

pub(super) fn run(args: Merge) -> Result<(), Failure> {
    let format = PictureFormat::of(&args.output)?;
    check_writable(&args.output)?;
    let mut merge = io::Merge::default();
    for file in &args.parts {
        merge.add(file, read_part(file, &Limits::default())?)?;
    }
    let part = merge.finish()?;
    if format == PictureFormat::Exr {
        write_part(&args.output, &part)?;
    } else {
        let mut settings = RenderSettings::default();
        for word in part.output.split_whitespace() {
            let assignment: Assignment = word.parse().map_err(Failure::Usage)?;
            assignment.apply(&mut settings)?;
        }
        write_shown(&args.output, &part.film.picture(), &settings)?;
    }
    if args.quiet {
        return Ok(());
    }
    for pair in part.samples.windows(2) {
        if let [before, after] = pair {
            let (start, end) = (before.end, after.start);
            tell(
                "note",
                format_args!("samples {start}..{end} are in none of the parts"),
            );
        }
    }
    let ranges: Vec<String> = part
        .samples
        .iter()
        .map(|range| format!("{}..{}", range.start, range.end))
        .collect();
    let (size, file) = (part.film.size(), args.output.display());
    say(format_args!(
        "{file}: {}x{}, samples {}",
        size.x,
        size.y,
        ranges.join(" and ")
    ))
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
        for word in output_text(&settings).split_whitespace() {
            word.parse::<Assignment>()
                .unwrap()
                .apply(&mut read)
                .unwrap();
        }
        assert_eq!(read, settings);
    }
}

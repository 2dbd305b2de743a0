//! `--view`, `--range` and `--legend`: what of a film is written.

use super::Failure;
use crate::film::views::{Shown, Source, Sources, View, burn_legend, show};
use crate::film::{FirstHits, Rendered};
use crate::io::{PictureFormat, write_picture};
use crate::scene::Output;
use clap::Args;
use std::path::Path;
use std::str::FromStr;

/// What is shown.
#[derive(Args, Default)]
pub(super) struct ViewArgs {
    /// What to show: shaded, albedo, normal, depth, object, nodes, triangles, samples, error,
    /// bloom-threshold or bloom-layer. Nodes and triangles are what each pixel's central ray meets,
    /// traced alone
    #[arg(long, value_name = "NAME", default_value_t)]
    pub view: View,
    /// Values at the ends of a heatmap's palette (default: from 0, or for depth the 1st percentile,
    /// to the 99th)
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub range: Option<ValueRange>,
    /// Write the palette with its range into a heatmap's lower left corner
    #[arg(long)]
    pub legend: bool,
}

/// Two numbers, the smaller one first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ValueRange([f32; 2]);

impl FromStr for ValueRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (low, high) = text.split_once("..")?;
            let range: [f32; 2] = [low.trim().parse().ok()?, high.trim().parse().ok()?];
            let fits = range[0] < range[1] && range.iter().all(|end| end.is_finite());
            fits.then_some(Self(range))
        };
        parse().ok_or_else(|| "two numbers, the smaller one first, for example 0..100".to_owned())
    }
}

impl ViewArgs {
    /// Refuses what does not go together.
    pub fn check(&self, output: &Path) -> Result<(), Failure> {
        let view = self.view;
        if (self.legend || self.range.is_some()) && !view.is_heatmap() {
            let heatmaps: Vec<&str> = View::ALL
                .into_iter()
                .filter(|view| view.is_heatmap())
                .map(View::name)
                .collect();
            return Err(Failure::Usage(format!(
                "--legend and --range are for heatmaps ({}), `{view}` is none",
                heatmaps.join(", ")
            )));
        }
        let format = PictureFormat::of(output).map_err(Failure::of_output)?;
        if view != View::Shaded && format.is_linear() {
            return Err(Failure::Usage(format!(
                "{}: the view `{view}` is made for screens: write a .png or .jpg",
                output.display()
            )));
        }
        Ok(())
    }

    /// Whether the view is made from camera rays alone: nothing needs to be rendered for it.
    pub fn is_of_first_hits(&self) -> bool {
        self.view.source() == Source::FirstHits
    }

    /// Writes a view of what was rendered.
    pub fn write_rendered(
        &self,
        file: &Path,
        rendered: &Rendered,
        output: &Output,
    ) -> Result<(), Failure> {
        let film = &rendered.film;
        let (mut samples, mut errors) = (Vec::new(), Vec::new());
        match self.view.source() {
            Source::Samples => samples = film.counts(),
            Source::Errors => errors = film.relative_errors(),
            Source::Picture | Source::FirstHits => {}
        }
        let sources = Sources {
            picture: Some(&rendered.picture),
            samples: Some((film.size(), &samples)),
            errors: Some((film.size(), &errors)),
            ..Sources::default()
        };
        self.write(file, &sources, output)
    }

    /// Writes a view of what the camera meets first.
    pub fn write_first_hits(
        &self,
        file: &Path,
        hits: &FirstHits,
        output: &Output,
    ) -> Result<(), Failure> {
        let sources = Sources {
            first_hits: Some(hits),
            ..Sources::default()
        };
        self.write(file, &sources, output)
    }

    fn write(&self, file: &Path, sources: &Sources, output: &Output) -> Result<(), Failure> {
        let range = self.range.map(|ValueRange(range)| range);
        let mut shown: Shown = show(self.view, sources, output, range)
            .map_err(|error| Failure::Usage(error.to_string()))?;
        if self.legend {
            burn_legend(&mut shown);
        }
        write_picture(file, shown.width, shown.height, &shown.pixels)?;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_two_finite_numbers_the_smaller_one_first() {
        assert_eq!("0..100".parse(), Ok(ValueRange([0.0, 100.0])));
        assert_eq!("-1.5 .. 2e3".parse(), Ok(ValueRange([-1.5, 2000.0])));
        for text in [
            "", "5", "5..", "..5", "5..5", "6..5", "0..inf", "NaN..1", "a..b",
        ] {
            assert!(text.parse::<ValueRange>().is_err(), "{text}");
        }
    }

    #[test]
    fn a_legend_without_a_heatmap_and_a_view_in_linear_light_are_refused() {
        let args = |view, legend| ViewArgs {
            view,
            range: None,
            legend,
        };
        let check = |args: ViewArgs, file| args.check(Path::new(file)).map_err(|e| e.to_string());
        assert_eq!(check(args(View::Depth, true), "a.png"), Ok(()));
        assert_eq!(check(args(View::Shaded, false), "a.exr"), Ok(()));
        let error = check(args(View::Normal, true), "a.png").unwrap_err();
        assert!(
            error.contains("triangles") && error.contains("`normal`"),
            "{error}"
        );
        let error = check(args(View::Normal, false), "a.exr").unwrap_err();
        assert!(error.contains("a.exr") && error.contains(".png"), "{error}");
    }
}

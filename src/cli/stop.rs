//! `--error`, `--time`, `--adaptive` and `--samples`: how much of a picture is rendered.

use super::Failure;
use crate::scene::{RenderSettings, Sampling, range_problems};
use clap::{ArgAction, Args};
use std::ops::Range;
use std::str::FromStr;

/// When a rendering ends; whichever comes first.
#[derive(Args, Default)]
pub(super) struct StopArgs {
    /// Stop when the estimated relative error of the picture is this small: 0.01 is one percent
    #[arg(long, value_name = "E", allow_negative_numbers = true)]
    pub error: Option<f32>,
    /// Stop after this many seconds of tracing, but not before each pixel has a sample
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub time: Option<f32>,
    /// With --error or --time: whether samples go where the error is (default: as the scene says; on
    /// in a new one)
    #[arg(long, value_name = "on|off", action = ArgAction::Set, value_parser = parse_switch)]
    pub adaptive: Option<bool>,
    /// Render only samples A to B-1 of each pixel, to an .exr that `glassbox merge` adds to others
    #[arg(
        long,
        value_name = "A..B",
        conflicts_with_all = ["spp", "error", "time", "adaptive"]
    )]
    pub samples: Option<SampleRange>,
}

/// The most samples of a pixel with --error and --time, where --spp does not say: the length of the
/// sequence of sample points.
const MOST: u32 = 1 << 16;
/// As many as --spp takes.
const LAST: u64 = 1 << 20;

fn parse_switch(text: &str) -> Result<bool, String> {
    match text {
        "on" | "true" => Ok(true),
        "off" | "false" => Ok(false),
        _ => Err("it is on or off".into()),
    }
}

/// Sample indices from the first to before the second.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct SampleRange(pub Range<u64>);

impl FromStr for SampleRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parse = || {
            let (start, end) = text.split_once("..")?;
            Some(start.trim().parse::<u64>().ok()?..end.trim().parse::<u64>().ok()?)
        };
        let range = parse().ok_or("two whole numbers, for example 0..64")?;
        if range.is_empty() {
            return Err(format!(
                "it holds no sample: the second number must be above the first, for example {}..{}",
                range.end.min(range.start),
                range
                    .end
                    .max(range.start)
                    .saturating_add(u64::from(range.start == range.end)),
            ));
        }
        if range.end > LAST {
            return Err(format!("samples end at {LAST}"));
        }
        Ok(Self(range))
    }
}

impl StopArgs {
    /// Refuses numbers that nothing can end at.
    pub fn check(&self) -> Result<(), Failure> {
        for (flag, value, unit) in [
            ("error", self.error, "0.01 is one percent"),
            ("time", self.time, "in seconds"),
        ] {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(Failure::Usage(format!(
                    "--{flag} is {value}, and must be above 0 ({unit})"
                )));
            }
        }
        let mut settings = RenderSettings::default();
        self.apply(&mut settings, true);
        match range_problems(&settings).into_iter().next() {
            Some(problem) => Err(Failure::Usage(problem.to_string())),
            None => Ok(()),
        }
    }

    /// Writes the flags into a scene's settings; `spp` tells whether --spp was given.
    pub fn apply(&self, settings: &mut RenderSettings, spp: bool) {
        let Sampling {
            adaptive,
            error,
            time,
        } = &mut settings.sampling;
        *error = self.error.unwrap_or(*error);
        *time = self.time.unwrap_or(*time);
        *adaptive = self.adaptive.unwrap_or(*adaptive);
        if !spp && (self.error.is_some() || self.time.is_some()) {
            settings.spp = MOST;
        }
        if self.samples.is_some() {
            // A part has all of its samples, whatever the scene would have ended at.
            *error = 0.0;
            *time = 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_samples_is_two_whole_numbers_the_second_above_the_first() {
        assert_eq!("0..64".parse(), Ok(SampleRange(0..64)));
        assert_eq!("7 .. 8".parse(), Ok(SampleRange(7..8)));
        for text in [
            "",
            "5",
            "5..",
            "..5",
            "-1..4",
            "a..b",
            "1.5..3",
            "0..1048577",
        ] {
            assert!(text.parse::<SampleRange>().is_err(), "{text}");
        }
        let error = "64..16".parse::<SampleRange>().unwrap_err();
        assert!(
            error.contains("no sample") && error.contains("16..64"),
            "{error}"
        );
        let error = "5..5".parse::<SampleRange>().unwrap_err();
        assert!(error.contains("5..6"), "{error}");
    }

    #[test]
    fn nothing_ends_at_zero_below_or_at_no_number() {
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let error = StopArgs {
                error: Some(bad),
                ..StopArgs::default()
            }
            .check()
            .unwrap_err()
            .to_string();
            assert!(
                error.contains("--error") && error.contains("above 0"),
                "{error}"
            );
            assert!(
                StopArgs {
                    time: Some(bad),
                    ..StopArgs::default()
                }
                .check()
                .is_err()
            );
        }
        assert!(
            StopArgs {
                error: Some(0.01),
                time: Some(2.0),
                ..StopArgs::default()
            }
            .check()
            .is_ok()
        );
    }

    #[test]
    fn what_no_scene_could_say_is_the_command_lines_fault() {
        for (error, time, says) in [
            (Some(2000.0), None, "sampling.error is 2000"),
            (None, Some(1e8), "sampling.time is"),
        ] {
            let args = StopArgs {
                error,
                time,
                ..StopArgs::default()
            };
            let failure = args.check().unwrap_err();
            assert!(matches!(failure, Failure::Usage(_)), "{failure}");
            assert!(failure.to_string().contains(says), "{failure}");
        }
    }

    #[test]
    fn spp_is_the_most_with_an_error_and_the_sequences_length_without_it() {
        let apply = |args: StopArgs, spp| {
            let mut settings = RenderSettings::default();
            args.apply(&mut settings, spp);
            settings
        };
        let plain = RenderSettings::default();
        assert_eq!(apply(StopArgs::default(), false), plain);
        let error = || StopArgs {
            error: Some(0.5),
            adaptive: Some(false),
            ..StopArgs::default()
        };
        assert_eq!(apply(error(), true).spp, plain.spp);
        let settings = apply(error(), false);
        assert_eq!((settings.spp, settings.sampling.error), (MOST, 0.5));
        assert!(!settings.sampling.adaptive);
    }
}

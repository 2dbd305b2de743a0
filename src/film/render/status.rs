//! What a render says about itself.

use crate::film::errors::error::ErrorEstimate;
use crate::scene::Sampling;
use crate::trace::RayCounts;

/// What a render is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Tracing.
    Running,
    /// Waiting to be resumed.
    Paused,
    /// It will not go on.
    Ended(Ending),
}

/// Why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It has all the samples that were asked for.
    Samples,
    /// The estimated error fell to the one asked for.
    Error,
    /// The time was up.
    Time,
    /// It was cancelled.
    Cancelled,
}

/// A render's numbers at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    /// What it is doing.
    pub state: State,
    /// Samples of a pixel so far, on average.
    pub samples: f64,
    /// Samples of each pixel after which it ends at the latest.
    pub samples_wanted: f64,
    /// Rays that the film's samples took so far.
    pub rays: RayCounts,
    /// What there was of both when its clock began anew with an edit.
    pub before: Before,
    /// How long it has been tracing, pauses not counted; since an edit that cost rays, where there was one.
    pub seconds: f64,
    /// The estimated error after every pass so far.
    pub trend: Vec<TrendPoint>,
    /// Until the first of its rules ends it; `None` where nothing is known yet.
    pub seconds_left: Option<f64>,
    /// How coarse the picture is: at least every n-th pixel of every n-th row has a sample, n a power
    /// of two; 1 is the full resolution. `None` before the first picture.
    pub divider: Option<u32>,
}

/// What a render had when an edit set its clock to zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Before {
    /// Rays of all kinds.
    pub rays: u64,
    /// Samples of a pixel, on average, that the edit left.
    pub samples: f64,
}

/// The estimated error after one pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrendPoint {
    /// Samples of a pixel, on average.
    pub samples: f64,
    /// Seconds of tracing.
    pub seconds: f64,
    /// How far from the converged picture.
    pub error: ErrorEstimate,
}

impl Status {
    /// Millions of rays a second, all threads together.
    pub fn mrays_per_s(&self) -> f64 {
        if self.seconds > 0.0 {
            self.rays.total().saturating_sub(self.before.rays) as f64 / self.seconds * 1e-6
        } else {
            0.0
        }
    }

    /// The estimate after the last pass.
    pub fn error(&self) -> Option<ErrorEstimate> {
        self.trend.last().map(|point| point.error)
    }

    /// The exponent s of the relative error's decline, error ~ seconds^-s, over the last passes;
    /// plain random sampling has 0.5. `None` before the passes took two doublings of time, or where nothing declines.
    pub fn decline(&self) -> Option<f64> {
        let last = self.trend.last()?;
        // Two doublings: fewer are too noisy, and older ones say little of what comes.
        let before = self
            .trend
            .iter()
            .rev()
            .find(|p| 4.0 * p.seconds <= last.seconds)?;
        let time = (last.seconds / before.seconds).ln();
        let error = (before.error.relative() / last.error.relative()).ln();
        let slope = error / time;
        (time > 0.0 && slope.is_finite() && slope > 0.0).then_some(slope)
    }
}

/// How long something takes, with two units at most: `42 s`, `3 min 20 s`, `3 h 31 min`, `2 d 4 h`.
pub fn duration_text(seconds: f64) -> String {
    // What takes longer is as good as endless.
    let whole = seconds.clamp(0.0, 1e10).round() as u64;
    let two = |large: u64, name: &str, small: u64, small_name: &str| match small {
        0 => format!("{large} {name}"),
        small => format!("{large} {name} {small} {small_name}"),
    };
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => two(whole / 60, "min", whole % 60, "s"),
        3600..86_400 => two(whole / 3600, "h", whole % 3600 / 60, "min"),
        _ => two(whole / 86_400, "d", whole % 86_400 / 3600, "h"),
    }
}

/// Seconds until the first of the rules will have ended the render, if it goes on as it did.
pub(super) fn seconds_left(status: &Status, rules: &Sampling) -> Option<f64> {
    if matches!(status.state, State::Ended(_)) {
        return Some(0.0);
    }
    // The first tiles say little: threads begin one after the other, and the sky comes first.
    let is_begun = status.seconds >= 2.0 || status.samples >= 0.01 * status.samples_wanted;
    let taken = status.samples - status.before.samples;
    let by_samples = (is_begun && taken > 0.0)
        .then(|| status.seconds / taken * (status.samples_wanted - status.samples));
    let by_time = (rules.time > 0.0).then(|| f64::from(rules.time) - status.seconds);
    let by_error = status
        .trend
        .last()
        .zip(status.decline())
        .and_then(|(last, slope)| {
            let factor = last.error.relative() / f64::from(rules.error);
            let end = last.seconds * factor.powf(1.0 / slope);
            (rules.error > 0.0).then_some(end - status.seconds)
        });
    [by_samples, by_time, by_error]
        .into_iter()
        .flatten()
        .filter(|seconds| seconds.is_finite())
        .map(|seconds| seconds.max(0.0))
        .reduce(f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status() -> Status {
        let point = |seconds: f64| TrendPoint {
            samples: 10.0 * seconds,
            seconds,
            error: ErrorEstimate {
                rmse: 1.0,
                // An error of 0.1 · seconds^-0.75.
                relative_mse: 0.01 * seconds.powf(-1.5),
                is_bound: false,
            },
        };
        Status {
            state: State::Running,
            samples: 80.0,
            samples_wanted: 1000.0,
            rays: RayCounts {
                camera: 16_000_000,
                ..RayCounts::default()
            },
            before: Before::default(),
            seconds: 8.0,
            divider: Some(1),
            trend: [1.0, 2.0, 4.0, 8.0].map(point).to_vec(),
            seconds_left: None,
        }
    }

    #[test]
    fn durations_are_said_in_the_units_that_fit() {
        for (seconds, text) in [
            (2.4, "2 s"),
            (59.6, "1 min"),
            (200.0, "3 min 20 s"),
            (12_661.0, "3 h 31 min"),
            (187_200.0, "2 d 4 h"),
            (f64::NAN, "0 s"),
        ] {
            assert_eq!(duration_text(seconds), text);
        }
    }

    #[test]
    fn a_decline_is_told_once_the_passes_took_two_doublings_of_time() {
        let mut status = status();
        // The picture was late, and the passes after it took hardly any time: t^-10 and more says nothing.
        for point in &mut status.trend {
            point.seconds += 8.0;
        }
        assert_eq!(status.decline(), None);
        status.trend[0].seconds = 4.0;
        assert!(status.decline().is_some());
        status.trend.clear();
        assert_eq!(status.decline(), None);
    }

    #[test]
    fn the_first_rule_to_end_it_says_how_long_it_takes() {
        let status = status();
        assert_eq!(status.mrays_per_s(), 2.0);
        let decline = status.decline().unwrap();
        assert!((decline - 0.75).abs() < 1e-9, "{decline}");
        let left = |error, time| {
            let rules = Sampling {
                error,
                time,
                ..Sampling::default()
            };
            seconds_left(&status, &rules).unwrap()
        };
        assert!((left(0.0, 0.0) - 92.0).abs() < 1e-9);
        assert_eq!(left(0.0, 20.0), 12.0);
        // 0.1 · s^-0.75 = 0.0125 at s = 16.
        assert!(
            (left(0.0125, 20.0) - 8.0).abs() < 1e-4,
            "{}",
            left(0.0125, 20.0)
        );
        assert_eq!(left(0.5, 20.0), 0.0);
    }

    #[test]
    fn what_was_there_before_the_clock_began_anew_is_in_no_rate() {
        let status = Status {
            before: Before {
                rays: 8_000_000,
                samples: 70.0,
            },
            trend: Vec::new(),
            ..status()
        };
        assert_eq!(status.mrays_per_s(), 1.0);
        // 10 samples in 8 s.
        let left = seconds_left(&status, &Sampling::default()).unwrap();
        assert!((left - 736.0).abs() < 1e-9, "{left}");
    }

    #[test]
    fn how_long_it_takes_is_not_guessed_from_the_first_tiles() {
        let left = |samples, seconds| {
            let status = Status {
                samples,
                seconds,
                trend: Vec::new(),
                ..status()
            };
            seconds_left(&status, &Sampling::default())
        };
        assert_eq!(left(0.1, 0.4), None);
        assert_eq!(left(10.0, 0.4), Some(0.4 * 99.0));
        assert_eq!(left(1.0, 2.0), Some(2.0 * 999.0));
        assert_eq!(left(0.0, 9.0), None);
    }
}

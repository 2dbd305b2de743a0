use super::output::tell;
use crate::film::{Status, duration_text};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};

/// A bar on a terminal; nothing in a pipe, but for steps that are told there; nothing where quiet was asked for.
pub(super) struct Progress {
    bar: Option<ProgressBar>,
    /// What is done, and the step that was told last, where steps are told.
    told: Option<(String, Mutex<String>)>,
}

impl Progress {
    pub fn new(quiet: bool, what: &str) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self {
                bar: None,
                told: None,
            };
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {prefix}")
        {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Self {
            bar: Some(bar),
            told: None,
        }
    }

    /// The same of what takes minutes: where there is no bar it tells each step, a line each.
    pub fn of_steps(quiet: bool, what: &str) -> Self {
        let mut progress = Self::new(quiet, what);
        let tells = progress.bar.is_none() && !quiet;
        progress.told = tells.then(|| (what.to_owned(), Mutex::default()));
        progress
    }

    /// Shows how much of how much is done.
    pub fn show(&self, done: u64, all: u64) {
        if let Some(bar) = &self.bar {
            bar.set_length(all);
            bar.set_position(done);
        }
    }

    /// Shows how much of how much is done of something else than before.
    pub fn show_step(&self, what: &str, done: u64, all: u64) {
        if let Some(bar) = &self.bar {
            bar.set_message(what.to_owned());
        }
        if let Some((of, last)) = &self.told {
            let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
            if *last != what {
                tell(of, what);
                *last = what.to_owned();
            }
        }
        self.show(done, all);
    }

    /// Shows samples, rays a second, error and time left of a rendering.
    pub fn show_status(&self, status: &Status) {
        if let Some(bar) = &self.bar {
            let left = status.seconds_left.unwrap_or(f64::INFINITY);
            let part = status.seconds / (status.seconds + left);
            bar.set_length(PARTS);
            bar.set_position((part * PARTS as f64) as u64);
            bar.set_prefix(status_text(status));
        }
    }
}

/// Steps of a bar that shows a share of time.
const PARTS: u64 = 1000;

fn status_text(status: &Status) -> String {
    let mut text = format!(
        "{:.0} spp, {:.2} Mrays/s",
        status.samples,
        status.mrays_per_s()
    );
    if let Some(error) = status.error() {
        text += &format!(", error {error}");
    }
    if let Some(left) = status.seconds_left {
        text += &format!(", {} left", duration_text(left));
    }
    text
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Before, ErrorEstimate, State, TrendPoint};
    use crate::trace::RayCounts;

    #[test]
    fn a_rendering_shows_samples_speed_error_and_what_is_left() {
        let error = ErrorEstimate {
            rmse: 0.1,
            relative_mse: 1e-4,
            is_bound: false,
        };
        let mut status = Status {
            state: State::Running,
            samples: 32.0,
            samples_wanted: 64.0,
            rays: RayCounts {
                camera: 8_000_000,
                ..RayCounts::default()
            },
            before: Before::default(),
            seconds: 2.0,
            trend: vec![TrendPoint {
                samples: 32.0,
                seconds: 2.0,
                error,
            }],
            seconds_left: Some(2.0),
            divider: Some(1),
        };
        assert_eq!(
            status_text(&status),
            "32 spp, 4.00 Mrays/s, error 1.00 %, 2 s left"
        );
        status.trend.clear();
        status.seconds_left = None;
        assert_eq!(status_text(&status), "32 spp, 4.00 Mrays/s");
    }
}

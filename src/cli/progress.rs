use crate::film::{Status, duration_text};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;

/// A bar on a terminal; nothing in a pipe, or where quiet was asked for.
pub(super) struct Progress(Option<ProgressBar>);

impl Progress {
    pub fn new(quiet: bool, what: &str) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new(1);
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {prefix}")
        {
            bar.set_style(style);
        }
        bar.set_message(what.to_owned());
        Self(Some(bar))
    }

    /// Shows how much of how much is done.
    pub fn show(&self, done: u64, all: u64) {
        if let Some(bar) = &self.0 {
            bar.set_length(all);
            bar.set_position(done);
        }
    }

    /// Shows how much of how much is done of something else than before.
    pub fn show_step(&self, what: &str, done: u64, all: u64) {
        if let Some(bar) = &self.0 {
            bar.set_message(what.to_owned());
        }
        self.show(done, all);
    }

    /// Shows samples, rays a second, error and time left of a rendering.
    pub fn show_status(&self, status: &Status) {
        if let Some(bar) = &self.0 {
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
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{ErrorEstimate, State, TrendPoint};
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

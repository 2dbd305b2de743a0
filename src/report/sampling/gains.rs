//! What the sequence, adaptive sampling and the film's estimate are worth, over all scenes.

use super::super::fit::reaches;
use super::super::table::digits;
use super::GOAL;
use super::curve::{Point, Way};

/// What the sequence and adaptive sampling gain, over all scenes.
#[derive(Default)]
pub(super) struct Gains {
    /// ln of the Sobol points' error over that of independent numbers, at the most samples.
    against_independent: Vec<f64>,
    /// ln of the Sobol points' error over that of jitter.
    against_jitter: Vec<f64>,
    /// ln of the Sobol points' seconds to 1 % over those of independent numbers.
    time: Vec<f64>,
    /// ln of rays that adaptive sampling takes, over those of the same samples for every pixel at the same true error.
    adaptive: Vec<f64>,
    /// The film's estimates over true errors.
    estimates: Vec<f64>,
}

impl Gains {
    pub fn add(&mut self, curves: &[Vec<Point>; Way::ALL.len()]) {
        let [independent, jittered, sobol, adaptive] = curves;
        let last = |curve: &[Point]| curve.last().map_or(f64::NAN, Point::relative);
        self.against_independent
            .push((last(sobol) / last(independent)).ln());
        self.against_jitter
            .push((last(sobol) / last(jittered)).ln());
        let seconds = |curve: &[Point]| {
            let points: Vec<(f64, f64)> = curve.iter().map(|p| (p.seconds, p.relative())).collect();
            reaches(&points, GOAL).map_or(f64::NAN, |(at, _)| at)
        };
        self.time.push((seconds(sobol) / seconds(independent)).ln());
        let rays: Vec<(f64, f64)> = sobol.iter().map(|p| (p.rays, p.relative())).collect();
        if let Some(point) = adaptive.last()
            && let Some((uniform, _)) = reaches(&rays, point.relative())
        {
            self.adaptive.push((point.rays / uniform).ln());
        }
        let estimated = sobol.iter().chain(adaptive);
        self.estimates
            .extend(estimated.filter_map(|p| Some(p.estimate? / p.relative())));
    }

    pub fn findings(&self) -> Vec<String> {
        let mean = |logs: &[f64]| {
            let known: Vec<f64> = logs.iter().copied().filter(|log| log.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            digits(mean.exp(), 2)
        };
        let least = self.estimates.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.estimates.iter().copied().fold(0.0, f64::max);
        vec![
            format!(
                "With the same number of samples the error with Owen-scrambled Sobol points is {} times that with independent \
                 random numbers and {} times that with stratified jitter; they reach an error of 1 % in {} times the random \
                 numbers' time (geometric means over the scenes).",
                mean(&self.against_independent),
                mean(&self.against_jitter),
                mean(&self.time),
            ),
            format!(
                "To reach the same true error, adaptive sampling needs {} times the rays of uniform sampling (geometric mean \
                 over the scenes).",
                mean(&self.adaptive),
            ),
            format!(
                "With Sobol points the film's own estimate of the error was {} to {} times the true error.",
                digits(least, 2),
                digits(most, 2),
            ),
        ]
    }
}

//! What the sequence, adaptive sampling and the film's estimate are worth, over all scenes.

use super::super::fit::reaches;
use super::super::table::digits;
use super::GOAL;
use super::curve::{Point, Way};

/// What the sequence and adaptive sampling gain, over all scenes.
#[derive(Default)]
pub(super) struct Gains {
    /// ln of our error over that of independent numbers, at the most samples.
    against_independent: Vec<f64>,
    /// ln of our error over that of jitter.
    against_jitter: Vec<f64>,
    /// ln of the seconds to 1 % of ours over those of independent numbers.
    time: Vec<f64>,
    /// ln of rays that adaptive sampling takes, over those of the same samples for every pixel at the same true error.
    adaptive: Vec<f64>,
    /// The film's estimates over true errors.
    estimates: Vec<f64>,
}

impl Gains {
    pub fn add(&mut self, curves: &[Vec<Point>; Way::ALL.len()]) {
        let [independent, jittered, ours, adaptive] = curves;
        let last = |curve: &[Point]| curve.last().map_or(f64::NAN, Point::relative);
        self.against_independent
            .push((last(ours) / last(independent)).ln());
        self.against_jitter.push((last(ours) / last(jittered)).ln());
        let seconds = |curve: &[Point]| {
            let points: Vec<(f64, f64)> = curve.iter().map(|p| (p.seconds, p.relative())).collect();
            reaches(&points, GOAL).map_or(f64::NAN, |(at, _)| at)
        };
        self.time.push((seconds(ours) / seconds(independent)).ln());
        let rays: Vec<(f64, f64)> = ours.iter().map(|p| (p.rays, p.relative())).collect();
        if let Some(point) = adaptive.last()
            && let Some((uniform, _)) = reaches(&rays, point.relative())
        {
            self.adaptive.push((point.rays / uniform).ln());
        }
        let estimated = ours.iter().chain(adaptive);
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
                "With as many samples our sequence leaves {} of the error of independent random numbers and {} of that of \
                 stratified jitter (means over the scenes), and reaches an error of 1 % in {} of the random numbers' time.",
                mean(&self.against_independent),
                mean(&self.against_jitter),
                mean(&self.time),
            ),
            format!(
                "For the same true error adaptive sampling takes {} times the rays of the same samples for every pixel.",
                mean(&self.adaptive),
            ),
            format!(
                "The film's own estimate was {} to {} times the true error.",
                digits(least, 2),
                digits(most, 2),
            ),
        ]
    }
}

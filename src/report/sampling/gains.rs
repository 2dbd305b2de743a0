//! What the sequence, adaptive sampling and the film's estimate are worth, over all scenes.

use super::super::fit::{How, Reached, reaches};
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
    time: Vec<Ratio>,
    /// ln of rays that adaptive sampling takes, over those of the same samples for every pixel at the same true error.
    adaptive: Vec<Ratio>,
    /// The film's estimates over true errors.
    estimates: Vec<f64>,
}

/// Of where two curves reach the same error.
struct Ratio {
    ln: f64,
    is_extrapolated: bool,
}

impl Ratio {
    /// `None` where nobody knows: where one of them is never there, or was from its first point on.
    fn between(a: Option<Reached>, b: Option<Reached>) -> Option<Self> {
        let (a, b) = a.zip(b)?;
        let hows = [a.how, b.how];
        let ratio = Self {
            ln: (a.at / b.at).ln(),
            is_extrapolated: hows.contains(&How::Extrapolated),
        };
        (!hows.contains(&How::Bound) && ratio.ln.is_finite()).then_some(ratio)
    }
}

fn logs(ratios: &[Ratio]) -> Vec<f64> {
    ratios.iter().map(|ratio| ratio.ln).collect()
}

/// Says of how many scenes a fitted line was gone along.
fn extrapolated(ratios: &[Ratio]) -> String {
    let beyond = ratios.iter().filter(|ratio| ratio.is_extrapolated);
    match (beyond.count(), ratios.len()) {
        (0, _) => String::new(),
        (beyond, all) => {
            format!(", in {beyond} of {all} scenes along fitted lines beyond what was measured")
        }
    }
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
            reaches(&points, GOAL)
        };
        self.time
            .extend(Ratio::between(seconds(sobol), seconds(independent)));
        let rays: Vec<(f64, f64)> = sobol.iter().map(|p| (p.rays, p.relative())).collect();
        if let Some(point) = adaptive.last() {
            let (at, how) = (point.rays, How::Measured);
            let uniform = reaches(&rays, point.relative());
            self.adaptive
                .extend(Ratio::between(Some(Reached { at, how }), uniform));
        }
        let estimated = sobol.iter().chain(adaptive);
        self.estimates
            .extend(estimated.filter_map(|p| Some(p.estimate? / p.relative())));
    }

    pub fn findings(&self) -> Vec<String> {
        // Nothing is known of scenes without noise.
        let mean = |logs: &[f64]| {
            let known: Vec<f64> = logs.iter().copied().filter(|log| log.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            (!known.is_empty()).then(|| digits(mean.exp(), 2))
        };
        let mut findings = Vec::new();
        if let (Some(independent), Some(jitter)) =
            (mean(&self.against_independent), mean(&self.against_jitter))
        {
            let time = mean(&logs(&self.time)).map(|time| {
                format!(
                    "; they reach an error of 1 % in {time} times the random numbers' time{}",
                    extrapolated(&self.time)
                )
            });
            findings.push(format!(
                "With the same number of samples the error with Owen-scrambled Sobol points is {independent} times that with \
                 independent random numbers and {jitter} times that with stratified jitter{} (geometric means over the \
                 scenes).",
                time.unwrap_or_default(),
            ));
        }
        if let Some(rays) = mean(&logs(&self.adaptive)) {
            findings.push(format!(
                "To reach the same true error, adaptive sampling needs {rays} times the rays of uniform sampling{} (geometric \
                 mean over the scenes).",
                extrapolated(&self.adaptive)
            ));
        }
        let known = self
            .estimates
            .iter()
            .copied()
            .filter(|part| part.is_finite());
        let [least, most] = [f64::min, f64::max].map(|end| known.clone().reduce(end));
        if let (Some(least), Some(most)) = (least, most) {
            findings.push(format!(
                "With Sobol points the film's own estimate of the error was {} to {} times the true error.",
                digits(least, 2),
                digits(most, 2),
            ));
        }
        findings
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_scenes_without_noise_nothing_is_found() {
        let flat = Point {
            samples: 16.0,
            seconds: 1.0,
            rays: 1e6,
            rmse: 0.0,
            relative_mse: 0.0,
            estimate: Some(0.0),
            decline: None,
        };
        let mut gains = Gains::default();
        gains.add(&[vec![flat], vec![flat], vec![flat], vec![]]);
        assert_eq!(gains.findings(), [""; 0]);
        let noisy = |relative_mse: f64| Point {
            relative_mse,
            estimate: Some(0.5 * relative_mse.sqrt()),
            ..flat
        };
        gains.add(&[
            vec![noisy(0.04)],
            vec![noisy(0.04)],
            vec![noisy(0.01)],
            vec![],
        ]);
        let findings = gains.findings();
        assert_eq!(findings.len(), 2, "{findings:?}");
        assert!(findings[0].contains("is 0.50 times"), "{findings:?}");
        assert!(findings[1].contains("0.50 to 0.50"), "{findings:?}");
    }

    #[test]
    fn where_a_curve_begins_below_the_error_no_gain_is_told_and_beyond_the_last_point_it_is_said() {
        let curve = |errors: &[f64]| -> Vec<Point> {
            let numbers = errors.iter().zip([1.0, 2.0, 4.0, 8.0]);
            let point = |(error, at): (&f64, f64)| Point {
                samples: 16.0 * at,
                seconds: at,
                rays: 1e6 * at,
                rmse: *error,
                relative_mse: error * error,
                estimate: None,
                decline: None,
            };
            numbers.map(point).collect()
        };
        let found = |curves: [&[f64]; 4]| {
            let mut gains = Gains::default();
            gains.add(&curves.map(curve));
            gains.findings()
        };
        let slow = [0.16, 0.08, 0.04, 0.02];
        let there = [0.04, 0.02, 0.01, 0.005];
        let beyond = ", in 1 of 1 scenes along fitted lines beyond what was measured";
        let findings = found([&slow, &slow, &there, &[0.02]]);
        assert!(
            findings[0].contains(&format!("in 0.25 times the random numbers' time{beyond}")),
            "{findings:?}"
        );
        assert!(
            findings[1].contains("needs 0.50 times the rays of uniform sampling (geo"),
            "{findings:?}"
        );
        let findings = found([&there, &there, &there, &[0.001]]);
        assert!(
            findings[0].contains("in 1.0 times the random numbers' time ("),
            "{findings:?}"
        );
        assert!(findings[1].contains(beyond), "{findings:?}");
        let findings = found([&there, &there, &[0.009, 0.0045], &[0.02]]);
        assert_eq!(findings.len(), 1, "{findings:?}");
        assert!(!findings[0].contains("1 %"), "{findings:?}");
    }
}

//! Straight lines through logarithms: error = c · x^slope.

/// Slope and ln c of the least-squares line through (ln x, ln y). `None` with less than two different, positive x.
pub(super) fn power_law(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(x, y)| *x > 0.0 && *y > 0.0 && x.is_finite() && y.is_finite())
        .map(|(x, y)| (x.ln(), y.ln()))
        .collect();
    let count = logs.len() as f64;
    let mean = |f: fn(&(f64, f64)) -> f64| logs.iter().map(f).sum::<f64>() / count;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let spread: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
    if logs.len() < 2 || spread == 0.0 {
        return None;
    }
    let slope = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    Some((slope, y - slope * x))
}

/// Where a curve reaches a goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reached {
    pub at: f64,
    pub how: How,
}

/// How that is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum How {
    /// Between two measured points.
    Measured,
    /// The first point is there: so far at most.
    Bound,
    /// Beyond the last point, along the fitted line.
    Extrapolated,
}

impl How {
    /// As tables call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Bound => "at most",
            Self::Extrapolated => "extrapolated",
        }
    }
}

/// Where a falling curve of (x, error) reaches `goal`. `None` where it never does.
pub(super) fn reaches(points: &[(f64, f64)], goal: f64) -> Option<Reached> {
    let first = points.first()?;
    if first.1 <= goal {
        let (at, how) = (first.0, How::Bound);
        return Some(Reached { at, how });
    }
    for pair in points.windows(2) {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        if y0 > goal && y1 <= goal && y1 > 0.0 {
            let part = (y0 / goal).ln() / (y0 / y1).ln();
            let at = (x0.ln() + part * (x1 / x0).ln()).exp();
            let how = How::Measured;
            return Some(Reached { at, how });
        }
    }
    let (slope, offset) = power_law(points)?;
    (slope < 0.0).then(|| Reached {
        at: ((goal.ln() - offset) / slope).exp(),
        how: How::Extrapolated,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_is_found_again_and_reached_where_it_says() {
        let points: Vec<(f64, f64)> = [1.0, 2.0, 4.0, 8.0]
            .map(|x: f64| (x, 0.1 * x.powf(-0.75)))
            .to_vec();
        let (slope, offset) = power_law(&points).unwrap();
        assert!((slope + 0.75).abs() < 1e-12 && (offset - 0.1_f64.ln()).abs() < 1e-12);
        for (goal, at, how) in [
            (0.0125, 16.0, How::Extrapolated),
            (0.05, 2.0_f64.powf(4.0 / 3.0), How::Measured),
            (0.1, 1.0, How::Bound),
            (0.2, 1.0, How::Bound),
        ] {
            let reached = reaches(&points, goal).unwrap();
            assert!((reached.at - at).abs() < 1e-9, "{reached:?}");
            assert_eq!(reached.how, how, "{goal}");
        }
        // A curve that begins below its goal was there before it rose above it.
        let noisy = [(1.0, 0.04), (2.0, 0.06), (4.0, 0.03)];
        let how = How::Bound;
        assert_eq!(reaches(&noisy, 0.05), Some(Reached { at: 1.0, how }));
        assert_eq!(reaches(&[(1.0, 0.1), (2.0, 0.2)], 0.05), None);
        assert_eq!(power_law(&[(1.0, 1.0)]), None);
    }
}

//! Where an axis has its ticks, and what stands beside them.

use super::Axis;
use crate::report::table::digits;
use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};
use std::ops::Range;

/// An axis with its range: places on it are values, or their decimal logarithms.
#[derive(Clone)]
pub(super) struct Scale {
    pub low: f64,
    pub high: f64,
    pub ticks: Vec<f64>,
    logarithmic: bool,
}

impl Scale {
    /// Holds all these values with a margin.
    pub fn over(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let logarithmic = axis.logarithmic;
        let places = values
            .filter(|v| v.is_finite() && (!logarithmic || *v > 0.0))
            .map(|v| if logarithmic { v.log10() } else { v });
        let (mut low, mut high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        if low > high {
            (low, high) = (0.0, 1.0);
        }
        if !logarithmic {
            low = low.min(0.0);
        }
        let margin = 0.08
            * (high - low).max(if logarithmic {
                0.3
            } else {
                high.abs() * 0.1 + 1e-12
            });
        if logarithmic || low < 0.0 {
            low -= margin;
        }
        high += margin;
        let ticks = if logarithmic {
            decades(low, high)
        } else {
            steps(low, high)
        };
        Self {
            low,
            high,
            ticks,
            logarithmic,
        }
    }

    /// Where a value is; `None` where the axis does not have it.
    pub fn place(&self, value: f64) -> Option<f64> {
        let place = if self.logarithmic {
            value.log10()
        } else {
            value
        };
        place.is_finite().then_some(place)
    }

    /// What stands at a tick.
    pub fn text(&self, place: f64) -> String {
        let value = if self.logarithmic {
            10f64.powf(place)
        } else {
            place
        };
        let text = digits(value, 3);
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, ""));
        let mantissa = if mantissa.contains('.') {
            mantissa.trim_end_matches('0').trim_end_matches('.')
        } else {
            mantissa
        };
        match exponent {
            "" => mantissa.to_owned(),
            _ => format!("{mantissa}e{exponent}"),
        }
    }
}

impl Ranged for Scale {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, place: &f64, (first, last): (i32, i32)) -> i32 {
        let part = (place - self.low) / (self.high - self.low);
        first + (part * f64::from(last - first)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, _: Hint) -> Vec<f64> {
        self.ticks.clone()
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

impl ValueFormatter<f64> for Scale {
    fn format(place: &f64) -> String {
        digits(*place, 3)
    }
}

/// 1 and, where there is room, 2 and 5 of each decade.
fn decades(low: f64, high: f64) -> Vec<f64> {
    let between: &[f64] = match high - low {
        width if width < 2.5 => &[1.0, 2.0, 5.0],
        _ => &[1.0],
    };
    let step = if high - low > 8.0 { 2 } else { 1 };
    (low.floor() as i32..=high.ceil() as i32)
        .filter(|decade| decade % step == 0)
        .flat_map(|decade| between.iter().map(move |m| f64::from(decade) + m.log10()))
        .filter(|place| (low..=high).contains(place))
        .collect()
}

/// Four to nine round steps.
fn steps(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 6.0;
    let decade = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .map(|m| m * decade)
        .into_iter()
        .find(|step| *step >= rough)
        .unwrap_or(10.0 * decade);
    let first = (low / step).ceil() as i64;
    (first..)
        .map(|i| i as f64 * step)
        .take_while(|place| *place <= high)
        .take(20)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_lie_on_the_axis_and_read_as_they_should() {
        let scale = Scale::over(&Axis::logarithmic("x"), [0.0, 1e-7, 3e-4].into_iter());
        let texts: Vec<String> = scale.ticks.iter().map(|&t| scale.text(t)).collect();
        assert_eq!(texts, ["1e-7", "1e-6", "1e-5", "1e-4"]);
        let scale = Scale::over(&Axis::logarithmic("x"), [1.0, 16.0].into_iter());
        let texts: Vec<String> = scale.ticks.iter().map(|&t| scale.text(t)).collect();
        assert_eq!(texts, ["1", "2", "5", "10"]);
        let scale = Scale::over(&Axis::linear("x"), [3.0, 11.0].into_iter());
        let texts: Vec<String> = scale.ticks.iter().map(|&t| scale.text(t)).collect();
        assert_eq!(texts, ["0", "2", "4", "6", "8", "10"]);
        for values in [vec![], vec![5.0], vec![0.0], vec![f64::NAN]] {
            for axis in [Axis::linear("x"), Axis::logarithmic("x")] {
                let scale = Scale::over(&axis, values.iter().copied());
                assert!(scale.low < scale.high, "{values:?}");
            }
        }
    }
}

use super::viridis;

/// Which colours mean which values: what the legend says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    /// The value at the palette's one end; smaller ones are shown as it.
    pub low: f32,
    /// The value at the other end, above `low`; larger ones are shown as it.
    pub high: f32,
    /// What is measured, in lower-case letters.
    pub unit: &'static str,
    /// The bright end of the palette is that of the low values.
    pub low_is_bright: bool,
}

/// What is drawn where a value is not known: no colour of the palette, and not a miss's black.
pub const UNKNOWN: [f32; 3] = [0.76, 0.09, 0.20];

/// Where an automatic range begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Beginning {
    /// At zero: half as bright is half as much.
    Zero,
    /// Where the values do.
    Lowest,
}

/// The part of the values that may lie beyond either end of an automatic range: a few pixels that
/// stand out would otherwise take all the contrast from the rest.
const BEYOND: f64 = 0.01;

impl Scale {
    /// The colour of a value, sRGB; an infinite one (a miss) is black, NaN is [`UNKNOWN`].
    pub fn color(&self, value: f32) -> [f32; 3] {
        if value.is_nan() {
            return UNKNOWN;
        }
        if value.is_infinite() {
            return [0.0; 3];
        }
        let place = (value - self.low) / (self.high - self.low);
        viridis(if self.low_is_bright {
            1.0 - place
        } else {
            place
        })
    }
}

/// From zero or the 1st percentile of the finite values to the 99th; one unit wide where that would
/// be empty.
pub(super) fn auto_range(values: &[f32], beginning: Beginning) -> [f32; 2] {
    let mut finite: Vec<f32> = values.iter().copied().filter(|v| v.is_finite()).collect();
    if finite.is_empty() {
        return [0.0, 1.0];
    }
    let last = finite.len() - 1;
    let beyond = (BEYOND * last as f64) as usize;
    let (_, high, _) = finite.select_nth_unstable_by(last - beyond, f32::total_cmp);
    let high = *high;
    let low = match beginning {
        Beginning::Zero => 0.0,
        Beginning::Lowest => *finite.select_nth_unstable_by(beyond, f32::total_cmp).1,
    };
    [low, if high > low { high } else { low + 1.0 }]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_automatic_range_leaves_out_one_value_in_a_hundred_at_either_end_and_all_misses() {
        let mut values: Vec<f32> = (0..=1000).rev().map(|i| i as f32).collect();
        values.extend([f32::INFINITY, f32::NAN, f32::NEG_INFINITY]);
        assert_eq!(auto_range(&values, Beginning::Lowest), [10.0, 990.0]);
        assert_eq!(auto_range(&values, Beginning::Zero), [0.0, 990.0]);
    }

    #[test]
    fn a_range_is_never_empty() {
        for values in [&[][..], &[f32::NAN], &[0.0; 4]] {
            assert_eq!(auto_range(values, Beginning::Zero), [0.0, 1.0]);
        }
        assert_eq!(auto_range(&[7.0; 9], Beginning::Lowest), [7.0, 8.0]);
        assert_eq!(auto_range(&[7.0; 9], Beginning::Zero), [0.0, 7.0]);
    }

    #[test]
    fn values_beyond_the_ends_are_shown_as_the_ends_misses_as_black_and_what_is_unknown_apart() {
        let mut scale = Scale {
            low: 2.0,
            high: 4.0,
            unit: "m",
            low_is_bright: false,
        };
        assert_eq!(scale.color(2.0), viridis(0.0));
        assert_eq!(scale.color(3.0), viridis(0.5));
        assert_eq!(scale.color(9.0), viridis(1.0));
        assert_eq!(scale.color(f32::INFINITY), [0.0; 3]);
        assert_eq!(scale.color(f32::NAN), UNKNOWN);
        for i in 0..=100 {
            let palette = viridis(i as f32 / 100.0);
            let distance: f32 = (0..3).map(|c| (palette[c] - UNKNOWN[c]).powi(2)).sum();
            assert!(distance > 0.1, "{palette:?} looks like what is not known");
        }
        scale.low_is_bright = true;
        assert_eq!(scale.color(2.0), viridis(1.0));
        assert_eq!(scale.color(-1.0), viridis(1.0));
        assert_eq!(scale.color(4.0), viridis(0.0));
    }
}

//! How far a picture is from the converged one, estimated from how its means moved.
//!
//! A pixel's first N samples are two halves with means A and B that are equally far from the limit,
//! E[(A-L)²] = E[(B-L)²]. Its mean M = (A+B)/2 moved by D = (B-A)/2 when the second half arrived, and
//! E[D²] = e²(N/2) - e²(N) where e² is the expected squared error: what was won by doubling. (From
//! E[(M-L)·D] = (E[(B-L)²] - E[(A-L)²])/4 = 0.) If doubling multiplies e² by r, then
//! e²(N) = r/(1-r) · E[D²]. Independent samples have r = 1/2; a low-discrepancy sequence has less, by
//! the smoothness of what is sampled. Since r varies little from picture to picture and the ratio of two
//! D² varies much by chance, r is mostly what pictures usually have ([`Decline`]).
//!
//! With that, the estimate of the picture's error is 0.8 to 1.5 times the true one, from 16 samples on, but
//! for three things that no move shows:
//!
//! - What no sample has found: a bright spot that one sample in a thousand meets is missing at 16 samples.
//!   What such spots may hide at most is known ([`unmet`](super::unmet)): where no pixel moved at all, that
//!   bound is told, and said to be one. (Where some did, it would be many times the error of ordinary pictures.)
//! - An edge that runs exactly along a row (or column) of pixels and covers the same part p of each, where
//!   it is so strong that this row makes most of the picture's error. N stratified samples have one stratum
//!   that the edge cuts, at the same fraction f of it in every pixel, f = frac(pN): e²(N) = J²·f(1-f)/N²
//!   with J the step across the edge. With x = frac(pN/2) that is |1-2x| times E[D²], any part of it from
//!   nothing to all, depending on where the edge lies below the pixel's size; r/(1-r) stands for all of
//!   them. So the estimate has no upper bound there (the row's error may vanish at one doubling and be back
//!   at the next), and is too small only as far as few pixels have met the edge. `tests/film/calibration.rs`
//!   has such a scene, a lamp 470 times as bright as the ceiling around it, and says what was measured.
//! - Light that falls into a single pixel: a point lamp 1 mm above a floor, of which a pixel shows 8 mm. That pixel
//!   has four fifths of the picture's error, so what is told beside what is true is one number of chance beside
//!   another: of 80 pictures with 16 samples nine in ten told 0.55 to 5.5 times the true error, with 64 samples 0.3
//!   to 7. No divisor helps: told by the pixel's exact value, which only the formula of such a floor knows, it would be
//!   0.04 to 16 times (simulated). Over many pictures the root mean square of what is told is 2.2, 1.9 and 1.5 times
//!   that of the error at 16, 64 and 256 samples; too high, since a pixel that moved far beside dark ones is taken for
//!   one that a rare sample met (`likely_value` in `film/errors/means.rs`). Divided by its own mean it would be 0.8 to 1.7
//!   times, and then a dark pixel that one sample in a thousand made a hundred times too bright would tell an error of
//!   no more than one. At 1 cm each picture tells 1.0 to 1.8 times. `report/stability/errors.rs` measures both.

use super::unmet::Reach;
use std::fmt;

/// Added to a pixel's squared value before its squared error is divided by it, so that black pixels
/// count too: a tenth of full white, squared (Rousselle, Knaus and Zwicker 2011 use the same).
pub const RELATIVE_FLOOR: f64 = 0.01;

/// Samples of each pixel from which on the estimate is calibrated.
pub const LEAST_SAMPLES: u32 = 16;

/// How far a picture is from the converged one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorEstimate {
    /// Root of the mean squared error over all pixels and channels, in the picture's own unit.
    pub rmse: f64,
    /// Mean over all pixels of squared error / (value² + [`RELATIVE_FLOOR`]), where the squared error
    /// and the value are averaged over the channels.
    pub relative_mse: f64,
    /// Whether that is what features may hide, at most, that no sample has met: the samples themselves
    /// say less, or nothing.
    pub is_bound: bool,
}

impl ErrorEstimate {
    /// Root of [`Self::relative_mse`]: 0.01 is an error of one percent.
    pub fn relative(&self) -> f64 {
        self.relative_mse.sqrt()
    }
}

/// In percent, for people: `1.37 %`, or `at most 0.42 %`, rounded up, where it is a bound.
impl fmt::Display for ErrorEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = 100.0 * self.relative();
        if self.is_bound {
            write!(f, "at most {:.2} %", (100.0 * percent).ceil() / 100.0)
        } else {
            write!(f, "{percent:.2} %")
        }
    }
}

/// How far the means of some pixels moved at the last three doublings of their samples, the last
/// one first. All of them have the same number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::film) struct Moves {
    /// Sums over the pixels of the squared distance.
    pub absolute: [f64; 3],
    /// The same, each divided by the pixel's squared value + [`RELATIVE_FLOOR`].
    pub relative: [f64; 3],
    /// Samples of each pixel.
    pub count: u32,
    /// How many pixels.
    pub pixels: u32,
    /// Sums over the pixels of how much they err by light that no sample has met.
    pub reach: Reach,
}

/// What a squared error is multiplied by when the samples double: one number for a whole picture, since
/// of a tile alone it is mostly chance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::film) struct Decline {
    /// Of the squared error.
    pub absolute: f64,
    /// Of the relative squared error.
    pub relative: f64,
}

/// What the moves of some pixels say about their error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::film) struct Expected {
    /// Sum over the pixels of the expected squared error.
    pub absolute: f64,
    /// The same, each divided by the pixel's squared value + [`RELATIVE_FLOOR`].
    pub relative: f64,
}

/// What independent samples have for r; no sequence has more, and what is measured beyond is chance.
const INDEPENDENT: f64 = 0.5;
/// The least r that is believed: a smooth light has 0.16 (its error falls like N^-1.3).
const LEAST: f64 = 0.125;
/// What r is before anything is measured. Edges have 2^-1.5 = 0.35, edges behind a lens, in motion or
/// in a penumbra up to 0.5. Over the built-in scenes, four seeds and 16 to 64 samples (64 × 64 pixels,
/// against the mean of the other seeds' 256 samples) this puts the middle of the estimated error at
/// 1.1 times the true one.
const USUAL: f64 = 0.43;
/// The exponent of the measured r in the geometric mean of both. A few pixels make most of a picture's
/// error, so the measured r is noisy: with 1, many more estimates are too small than with 0.2.
const MEASURED: f64 = 0.2;
/// As a multiple of the measured r, the largest that is believed: one so low is not chance.
const BEYOND_MEASURED: f64 = 1.6;
/// The sequence's length; after it another begins, independent of the first.
const SEQUENCE: u32 = 1 << 16;

impl Decline {
    /// From what all pixels of a picture moved.
    pub fn of<'a>(groups: impl IntoIterator<Item = &'a Moves>) -> Self {
        let mut sums = [[0.0; 2]; 2];
        for moves in groups {
            // Over two doublings: a net's points fill squares at every other power of two only, so
            // that r goes up and down from one to the next.
            if moves.is_known() && moves.count >= 8 && moves.absolute[2].is_finite() {
                for (sum, moves) in sums.iter_mut().zip([moves.absolute, moves.relative]) {
                    sum[0] += moves[0];
                    sum[1] += moves[2];
                }
            }
        }
        let [absolute, relative] = sums.map(|[last, before]| {
            let measured = if before > 0.0 {
                (last / before).sqrt().clamp(LEAST, INDEPENDENT)
            } else {
                USUAL
            };
            let mean = measured.powf(MEASURED) * USUAL.powf(1.0 - MEASURED);
            mean.min(BEYOND_MEASURED * measured)
        });
        Self { absolute, relative }
    }
}

impl Moves {
    /// Whether these pixels have two samples or more, and how far they moved is known.
    fn is_known(&self) -> bool {
        self.count >= 2 && self.absolute[0].is_finite()
    }

    /// The error of these pixels as they are now, in a picture whose errors decline so. `None` where
    /// it is not known.
    pub fn expected(&self, decline: &Decline) -> Option<Expected> {
        if !self.is_known() {
            return None;
        }
        let last = 1_u32 << self.count.ilog2();
        // What has come since the last doubling is taken for independent of what was there.
        let since = f64::from(last) / f64::from(self.count);
        let of = |moved: f64, ratio: f64| {
            let ratio = if last > SEQUENCE { INDEPENDENT } else { ratio };
            ratio / (1.0 - ratio) * moved * since
        };
        Some(Expected {
            absolute: of(self.absolute[0], decline.absolute),
            relative: of(self.relative[0], decline.relative),
        })
    }

    /// The means over the pixels of how much they err by unmet light, for so many samples of each.
    pub fn reach_with(&self, count: u32) -> Reach {
        let samples = f64::from(self.pixels.max(1)) * f64::from(count.max(1));
        Reach {
            absolute: self.reach.absolute / samples,
            relative: self.reach.relative / samples,
        }
    }
}

impl ErrorEstimate {
    /// Of pixels that lie in several groups, where unmet light may leave `hidden` times what they err by
    /// it; `None` where of one of them it is not known.
    pub(in crate::film) fn of(groups: &[Moves], hidden: f64) -> Option<Self> {
        let decline = Decline::of(groups);
        let (mut absolute, mut relative, mut pixels) = (0.0, 0.0, 0);
        let mut worst = Reach::default();
        for moves in groups.iter().filter(|moves| moves.pixels > 0) {
            let expected = moves.expected(&decline)?;
            absolute += expected.absolute;
            relative += expected.relative;
            pixels += moves.pixels;
            let reach = moves.reach_with(moves.count);
            worst.absolute = worst.absolute.max(reach.absolute);
            worst.relative = worst.relative.max(reach.relative);
        }
        let pixels = f64::from(pixels.max(1));
        let measured = relative / pixels;
        // A pixel that lacks all of its light errs by one.
        let unmet = (hidden * worst.relative / pixels).min(1.0);
        Some(Self {
            rmse: (absolute.max(hidden * worst.absolute) / pixels).sqrt(),
            relative_mse: measured.max(unmet),
            is_bound: unmet > measured,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moves(squares: [f64; 3], count: u32) -> Moves {
        Moves {
            absolute: squares,
            relative: squares.map(|square| 4.0 * square),
            count,
            pixels: 10,
            ..Moves::default()
        }
    }

    /// The expected squared error of a picture that is this group alone.
    fn alone(squares: [f64; 3], count: u32) -> Expected {
        let moves = moves(squares, count);
        moves.expected(&Decline::of([&moves])).unwrap()
    }

    #[test]
    fn independent_samples_err_about_as_much_as_their_mean_moved() {
        // Halves with squared error 1/n each: the mean of 2n moved by 1/(2n), and errs by 1/(2n).
        let estimate = alone([1.0, 2.0, 4.0], 64);
        assert!(
            (0.8..1.0).contains(&estimate.absolute.sqrt()),
            "{estimate:?}"
        );
        assert!((estimate.relative - 4.0 * estimate.absolute).abs() < 1e-12);
        // Beyond the sequence's length another one begins, whatever the moves before.
        assert_eq!(alone([1.0, 9.0, 81.0], 1 << 17).absolute, 1.0);
    }

    #[test]
    fn for_every_decline_of_a_sequence_the_error_is_within_a_factor_of_one_and_a_half() {
        // From N^-1.3 to N^-0.5: with squared errors 1, r, r², … the moves are their differences.
        for slope in [0.5, 0.6, 0.75, 1.0, 1.3] {
            let r = 2.0_f64.powf(-2.0 * slope);
            let moved = [1, 2, 3].map(|i| r.powi(-i) - r.powi(1 - i));
            let factor = alone(moved, 64).absolute.sqrt();
            assert!((0.8..1.5).contains(&factor), "N^-{slope}: {factor:.2}");
        }
    }

    #[test]
    fn what_falls_faster_errs_less_than_it_moved_and_what_stands_no_more() {
        let fast = alone([1.0, 4.0, 16.0], 64).absolute;
        assert!(fast < 0.7 && fast > 1.0 / 3.0, "{fast}");
        assert!(alone([1.0, 1.0, 1.0], 64).absolute <= 1.0);
    }

    #[test]
    fn the_decline_is_that_of_the_whole_picture() {
        let quiet = moves([1e-9, 4e-9, 9e-9], 16);
        let loud = moves([1.0, 3.0, 9.0], 64);
        let decline = Decline::of([&quiet, &loud]);
        let by_loud = Decline::of([&loud]);
        assert!((decline.absolute - by_loud.absolute).abs() < 1e-6);
        assert!(quiet.expected(&decline).unwrap().absolute < 1e-9);
    }

    #[test]
    fn nothing_that_moved_errs_by_nothing_and_one_sample_says_nothing() {
        assert_eq!(alone([0.0; 3], 64).absolute, 0.0);
        assert!(alone([1.0, 0.0, 0.0], 8).absolute.is_finite());
        assert_eq!(ErrorEstimate::of(&[moves([0.0; 3], 1)], 0.0), None);
        let known = moves([1.0, 2.0, 4.0], 16);
        assert!(ErrorEstimate::of(&[known], 0.0).is_some());
        let merged = moves([f64::INFINITY; 3], 16);
        assert_eq!(ErrorEstimate::of(&[known, merged], 0.0), None);
        assert!(Decline::of([&known, &merged]).absolute.is_finite());
    }

    #[test]
    fn samples_after_the_last_doubling_count_as_independent_ones() {
        let at = |count| alone([1.0, 2.0, 4.0], count).absolute;
        assert!((at(64) / at(80) - 1.25).abs() < 1e-12);
    }
}

//! How far a picture is from the converged one, estimated from how its means moved.
//!
//! A pixel's first N samples are two halves with means A and B that are equally far from the limit,
//! E[(A-L)²] = E[(B-L)²]. Its mean M = (A+B)/2 moved by D = (B-A)/2 when the second half arrived, and
//! E[D²] = e²(N/2) - e²(N) where e² is the expected squared error: what was won by doubling. (From
//! E[(M-L)·D] = (E[(B-L)²] - E[(A-L)²])/4 = 0.) If doubling multiplies e² by r, then
//! e²(N) = r/(1-r) · E[D²], and r is the ratio of two successive D². Independent samples have
//! r = 1/2; a low-discrepancy sequence has less, by the smoothness of what is sampled.

use super::tiles::FilmPixel;

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
}

impl ErrorEstimate {
    /// Root of [`Self::relative_mse`]: 0.01 is an error of one percent.
    pub fn relative(&self) -> f64 {
        self.relative_mse.sqrt()
    }
}

/// How far the means of some pixels moved at the last three doublings of their samples, the last
/// one first. All of them have the same number of samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moves {
    /// Sums over the pixels of the squared distance.
    pub absolute: [f64; 3],
    /// The same, each divided by the pixel's squared value + [`RELATIVE_FLOOR`].
    pub relative: [f64; 3],
    /// Samples of each pixel.
    pub count: u32,
    /// How many pixels.
    pub pixels: u32,
}

impl Moves {
    pub fn of<'a>(pixels: impl Iterator<Item = &'a FilmPixel>) -> Self {
        let mut moves = Self::default();
        for pixel in pixels {
            let mean = f64::from(pixel.sum.mean(pixel.count).element_sum()) / 3.0;
            let weight = 1.0 / (mean * mean + RELATIVE_FLOOR);
            for (i, moved) in pixel.moved.into_iter().enumerate() {
                moves.absolute[i] += f64::from(moved);
                moves.relative[i] += f64::from(moved) * weight;
            }
            moves.count = pixel.count;
            moves.pixels += 1;
        }
        moves
    }
}

/// What the moves of some pixels say about their error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Expected {
    /// Sum over the pixels of the expected squared error.
    pub absolute: f64,
    /// The same, each divided by the pixel's squared value + [`RELATIVE_FLOOR`].
    pub relative: f64,
    /// What the relative one is multiplied by when the samples double.
    pub ratio: f64,
}

/// What independent samples have for r; no sequence has more, and what is measured beyond is chance.
const INDEPENDENT: f64 = 0.5;
/// How much of r is measured; the rest is [`INDEPENDENT`], on the safe side. Few pixels make most of a
/// picture's error, so a measured r is noisy, and e² reacts strongly to it. With a half the estimated
/// root of e² is 0.8 to 1.75, in the middle 1.15 times the true one over the built-in scenes.
const MEASURED: f64 = 0.5;
/// The sequence's length; after it another begins, independent of the first.
const SEQUENCE: u32 = 1 << 16;

impl Moves {
    /// The error of these pixels as they are now. `None` with less than two samples of each.
    pub fn expected(&self) -> Option<Expected> {
        if self.count < 2 {
            return None;
        }
        // What has come since the last doubling is taken for independent of what was there.
        let since = f64::from(1 << self.count.ilog2()) / f64::from(self.count);
        let doublings = self.count.ilog2();
        let [absolute, relative] = [self.absolute, self.relative].map(|moves| {
            let ratio = ratio(moves, doublings);
            (ratio / (1.0 - ratio) * moves[0] * since, ratio)
        });
        Some(Expected {
            absolute: absolute.0,
            relative: relative.0,
            ratio: relative.1,
        })
    }
}

/// r, from the moves at the last of so many doublings.
fn ratio(moves: [f64; 3], doublings: u32) -> f64 {
    if 1 << doublings > SEQUENCE {
        return INDEPENDENT;
    }
    // Over two doublings where there are three moves: a net's points fill squares at every other
    // power of two only, so that r goes up and down from one to the next.
    let measured = match doublings {
        0 | 1 => INDEPENDENT,
        2 => moves[0] / moves[1],
        _ => (moves[0] / moves[2]).sqrt(),
    };
    // Not a number where nothing moved; `min` then takes the other.
    INDEPENDENT + MEASURED * (measured.min(INDEPENDENT) - INDEPENDENT)
}

impl ErrorEstimate {
    /// Of pixels that lie in several groups; `None` where one of them has less than two samples.
    pub(super) fn of(groups: impl Iterator<Item = Moves>) -> Option<Self> {
        let (mut absolute, mut relative, mut pixels) = (0.0, 0.0, 0);
        for moves in groups.filter(|moves| moves.pixels > 0) {
            let expected = moves.expected()?;
            absolute += expected.absolute;
            relative += expected.relative;
            pixels += moves.pixels;
        }
        let pixels = f64::from(pixels.max(1));
        Some(Self {
            rmse: (absolute / pixels).sqrt(),
            relative_mse: relative / pixels,
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
        }
    }

    #[test]
    fn independent_samples_err_as_much_as_their_mean_moved() {
        // Halves with squared error 1/n each: the mean of 2n moved by 1/(2n), and errs by 1/(2n).
        let estimate = moves([1.0, 2.0, 4.0], 64).expected().unwrap();
        assert!((estimate.absolute - 1.0).abs() < 1e-12 && (estimate.relative - 4.0).abs() < 1e-12);
        assert_eq!(estimate.ratio, 0.5);
        // Beyond the sequence's length another one begins, whatever the moves before.
        let beyond = moves([1.0, 9.0, 81.0], 1 << 17).expected().unwrap();
        assert_eq!((beyond.absolute, beyond.ratio), (1.0, 0.5));
    }

    #[test]
    fn what_falls_faster_errs_less_than_it_moved_and_what_stands_no_more() {
        let fast = moves([1.0, 4.0, 16.0], 64).expected().unwrap();
        assert!(
            fast.absolute < 0.7 && fast.absolute > 1.0 / 3.0,
            "{}",
            fast.absolute
        );
        let standing = moves([1.0, 1.0, 1.0], 64).expected().unwrap();
        assert_eq!(standing.absolute, 1.0);
    }

    #[test]
    fn nothing_that_moved_errs_by_nothing_and_one_sample_says_nothing() {
        assert_eq!(moves([0.0; 3], 64).expected().unwrap().absolute, 0.0);
        assert!(
            moves([1.0, 0.0, 0.0], 8)
                .expected()
                .unwrap()
                .absolute
                .is_finite()
        );
        assert_eq!(moves([0.0; 3], 1).expected(), None);
        assert_eq!(ErrorEstimate::of([moves([0.0; 3], 1)].into_iter()), None);
    }

    #[test]
    fn samples_after_the_last_doubling_count_as_independent_ones() {
        let at = |count| moves([1.0, 2.0, 4.0], count).expected().unwrap().absolute;
        assert!((at(64) / at(80) - 1.25).abs() < 1e-12);
    }
}

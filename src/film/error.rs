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

impl ErrorEstimate {
    /// Of pixels that lie in several groups.
    pub(super) fn of(groups: impl Iterator<Item = Moves>) -> Option<Self> {
        let mut sum = Self::default();
        let mut pixels = 0;
        for moves in groups {
            if moves.count < 2 && moves.pixels > 0 {
                return None;
            }
            sum.rmse += moves.absolute[0];
            sum.relative_mse += moves.relative[0];
            pixels += moves.pixels;
        }
        let pixels = f64::from(pixels.max(1));
        Some(Self {
            rmse: (sum.rmse / pixels).sqrt(),
            relative_mse: sum.relative_mse / pixels,
        })
    }
}

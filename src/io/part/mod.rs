//! Parts of a picture: some of the samples of each pixel, as exact sums, so that parts that were
//! rendered by several processes or machines add up to the picture that one would have rendered, bit
//! for bit.
//!
//! A part is an OpenEXR file. Its channels R, G and B are the linear mean, so every program can show
//! it; `sum.R.0` to `sum.B.3` are the words of [`Sum::to_words`]; its attribute `glassbox` says, line
//! by line, what it is a part of:
//!
//! ```text
//! part 2
//! digest 0123456789abcdef0123456789abcdef
//! samples 0..64 128..192
//! sampling uniform
//! output output.exposure=0.0 output.view_transform=Srgb
//! checksum 0123456789abcdef
//! ```
//!
//! The checksum is that of the lines before it and of the sums: a sum that one wrong bit made a thousand times larger is a
//! sum like any other.

mod checksum;
mod header;
mod merge;
mod read;
mod write;

pub use merge::{Merge, MergeError};
pub use read::read_part;
pub use write::write_part;

use crate::film::{Film, Sum};
use std::ops::Range;

/// Part of a picture's samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Of what they are samples: a [`Digest`](crate::trace::Digest), as text.
    pub digest: String,
    /// Indices of the samples that each pixel has: in order, apart from each other, none empty.
    pub samples: Vec<Range<u64>>,
    /// Whether each pixel has all of these samples, and not only some where there was little error.
    pub uniform: bool,
    /// How the picture is shown, as `key=value` words of the render settings.
    pub output: String,
    /// The sums.
    pub film: Film,
}

/// Samples that a sum surely holds.
const MOST_SAMPLES: u64 = 1 << 22;

/// Bytes of a part, uncompressed: each pixel's mean and sums.
pub fn part_bytes(width: u64, height: u64) -> u64 {
    const PIXEL: u64 = 4 * (3 + 3 * 4);
    width.saturating_mul(height).saturating_mul(PIXEL)
}

fn channel_name(component: usize, word: usize) -> String {
    format!("sum.{}.{word}", ["R", "G", "B"][component])
}

/// The sums of a film, row by row.
fn sums(film: &Film) -> impl Iterator<Item = Sum> + '_ {
    let size = film.size();
    (0..size.y).flat_map(move |y| (0..size.x).map(move |x| film.sum(x, y)))
}

#[cfg(test)]
pub(crate) mod tests;

//! Exact sums of samples, pixel by pixel, in a tile's columns.
//!
//! [`sum`] has one pixel's, in the 128 bits of [`fixed_point`]; [`sum_columns`] those of many pixels at once, bit for bit;
//! [`tiles`] how a picture is cut, and where a pixel lies in its tile's memory.

pub(super) mod fixed_point;
mod sum;
pub(super) mod sum_columns;
pub(super) mod tiles;

pub use sum::Sum;
pub use tiles::TILE;

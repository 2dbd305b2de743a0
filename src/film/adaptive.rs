//! Which tiles get more samples.

use super::error::Moves;
use super::tile_state::Pixels;
use std::ops::Range;

/// Half of the pixels of a tile.
#[derive(Clone, Copy, Debug)]
#[expect(dead_code, reason = "read by the choice that follows")]
pub(super) struct Cell {
    pub tile: u32,
    pub half: usize,
    /// What its own pixels say, which decides on those of the other half.
    pub own: Moves,
    /// What the other half's say, which decides on these.
    pub other: Moves,
    /// Rays that a sample takes.
    pub rays: f64,
}

/// More samples for some pixels of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Task {
    pub tile: u32,
    pub pixels: Pixels,
    pub range: Range<u64>,
}

/// The cells whose samples are doubled next, up to `most` a pixel.
pub(super) fn choose(_cells: &[Cell], _most: u64, _goal: f64) -> Vec<Task> {
    Vec::new()
}

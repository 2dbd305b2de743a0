//! What a film has of a tile.

use super::Sum;
use super::past_moves::PastMoves;
use super::sum_columns::{CHANNELS, SumColumns, TileColors};
use super::tile_state::Pixels;
use super::tiles::{TILE_PIXELS, Tile, half_of, place_in_tile};
use glam::Vec3;

/// The pixels of a tile: what arrived, and how many samples it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FilmTile {
    /// None where nothing arrived.
    pub sums: SumColumns,
    pub past: PastMoves,
    /// Samples of each pixel of each half.
    pub counts: [u32; 2],
}

impl FilmTile {
    /// Pixels with these sums, of so many samples each.
    pub fn of_sums(sums: impl IntoIterator<Item = (usize, Sum)>, count: u32) -> Self {
        let mut tile = Self {
            counts: [count; 2],
            ..Self::default()
        };
        tile.sums.reset(TILE_PIXELS);
        tile.past.forget(Pixels::All);
        for (place, sum) in sums {
            tile.sums.set(place, &sum);
        }
        tile
    }

    pub fn sum(&self, place: usize) -> Sum {
        if self.sums.is_empty() {
            Sum::default()
        } else {
            self.sums.get(place)
        }
    }

    pub fn count(&self, place: usize) -> u32 {
        self.counts[half_of(place)]
    }

    /// The means of all its pixels; black where nothing arrived.
    pub fn means(&self) -> TileColors {
        if self.sums.is_empty() {
            [0.0; CHANNELS * TILE_PIXELS]
        } else {
            self.sums.all().means(self.counts)
        }
    }

    /// Adds the samples of another one.
    pub fn merge(&mut self, other: &Self) {
        for half in 0..2 {
            let pixels = Pixels::Half(half);
            match (self.counts[half], other.counts[half]) {
                (_, 0) => {}
                (0, _) => self.past.copy(pixels, &other.past),
                _ => self.past.forget(pixels),
            }
            self.counts[half] += other.counts[half];
        }
        if self.sums.is_empty() {
            self.sums = other.sums.clone();
        } else if !other.sums.is_empty() {
            self.sums.merge(0, other.sums.all());
        }
    }
}

/// Draws a tile with these means into rows of a picture, `width` pixels each, of which the first is the tile's first.
pub(super) fn draw(means: &TileColors, tile: Tile, rows: &mut [Vec3], width: usize) {
    let Tile { origin, extent } = tile;
    for (y, row) in (0..extent.y).zip(rows.chunks_mut(width)) {
        let row = &mut row[origin.x as usize..][..extent.x as usize];
        for (x, pixel) in (0..extent.x).zip(row) {
            let at = CHANNELS * place_in_tile(x, y);
            *pixel = Vec3::new(means[at], means[at + 1], means[at + 2]);
        }
    }
}

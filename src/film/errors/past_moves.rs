//! How far the means of a tile's pixels moved.

use crate::film::sums::sum_columns::{CHANNELS, TileColors};
use crate::film::sums::tiles::{Pixels, TILE_PIXELS};

/// How far each pixel's mean moved when its samples doubled, the last three times, the last one first: squared, averaged over
/// the channels. Infinite where samples did not arrive by doublings from the first one on (and not NaN, so that equal films
/// are equal).
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::film) struct PastMoves(
    /// None before the first doubling: all moved by 0.
    Option<Box<Columns>>,
);

type Columns = [[f32; TILE_PIXELS]; 3];

/// What a pixel takes.
pub(in crate::film) const PAST_BYTES: usize = size_of::<[f32; 3]>();

impl PastMoves {
    pub fn columns(&self) -> &Columns {
        static NONE: Columns = [[0.0; TILE_PIXELS]; 3];
        self.0.as_deref().unwrap_or(&NONE)
    }

    /// Whether nothing has moved yet.
    pub fn are_none(&self) -> bool {
        self.0.is_none()
    }

    fn columns_mut(&mut self) -> &mut Columns {
        self.0
            .get_or_insert_with(|| Box::new([[0.0; TILE_PIXELS]; 3]))
    }

    /// The samples of these pixels have doubled, and their means moved so far, squared.
    pub fn push(&mut self, pixels: Pixels, squares: &[f32; TILE_PIXELS]) {
        let [last, before, first] = self.columns_mut();
        for places in pixels.runs() {
            first[places.clone()].copy_from_slice(&before[places.clone()]);
            before[places.clone()].copy_from_slice(&last[places.clone()]);
            last[places.clone()].copy_from_slice(&squares[places]);
        }
    }

    /// At their last doubling they moved so far, as is known now.
    pub fn correct(&mut self, pixels: Pixels, squares: &[f32; TILE_PIXELS]) {
        let [last, ..] = self.columns_mut();
        for places in pixels.runs() {
            if last[places.start].is_finite() {
                last[places.clone()].copy_from_slice(&squares[places]);
            }
        }
    }

    /// The same, and before that as much more or less: no more is known of it.
    pub fn rescale(&mut self, squares: &[f32; TILE_PIXELS]) {
        let Some(columns) = &mut self.0 else {
            return;
        };
        let [last, before, first] = &mut **columns;
        for (place, square) in squares.iter().enumerate() {
            if last[place].is_finite() && last[place] > 0.0 {
                let scale = square / last[place];
                before[place] *= scale;
                first[place] *= scale;
            }
            if last[place].is_finite() {
                last[place] = *square;
            }
        }
    }

    /// They moved as far as others did.
    pub fn copy(&mut self, pixels: Pixels, others: &Self) {
        if self == others {
            return;
        }
        for (column, other) in self.columns_mut().iter_mut().zip(others.columns()) {
            for places in pixels.runs() {
                column[places.clone()].copy_from_slice(&other[places]);
            }
        }
    }

    /// Of these pixels it is not known.
    pub fn forget(&mut self, pixels: Pixels) {
        for column in self.columns_mut() {
            for places in pixels.runs() {
                column[places].fill(f32::INFINITY);
            }
        }
    }
}

/// The squares of how far each pixel moved, averaged over the channels.
pub(in crate::film) fn squares(moved: &TileColors) -> [f32; TILE_PIXELS] {
    let mut squares = [0.0; TILE_PIXELS];
    for (square, moved) in squares.iter_mut().zip(moved.chunks_exact(CHANNELS)) {
        *square = moved.iter().map(|moved| moved * moved).sum::<f32>() / CHANNELS as f32;
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_three_are_kept_of_each_half_and_what_is_not_known_stays_so() {
        let mut past = PastMoves::default();
        for square in [1.0, 2.0, 3.0, 4.0] {
            past.push(Pixels::Half(1), &[square; TILE_PIXELS]);
        }
        let of = |past: &PastMoves, place: usize| past.columns().map(|column| column[place]);
        assert_eq!(of(&past, 8), [4.0, 3.0, 2.0]);
        assert_eq!(of(&past, 7), [0.0; 3]);
        past.rescale(&[2.0; TILE_PIXELS]);
        assert_eq!(of(&past, 8), [2.0, 1.5, 1.0]);
        assert_eq!(of(&past, 7), [2.0, 0.0, 0.0]);
        past.forget(Pixels::Half(0));
        past.rescale(&[8.0; TILE_PIXELS]);
        past.correct(Pixels::All, &[9.0; TILE_PIXELS]);
        assert_eq!(of(&past, 7), [f32::INFINITY; 3]);
        assert_eq!(of(&past, 8), [8.0, 6.0, 4.0]);
    }

    #[test]
    fn a_square_is_the_mean_over_the_channels() {
        let mut moved = [0.0; CHANNELS * TILE_PIXELS];
        moved[3..6].copy_from_slice(&[1.0, -2.0, 2.0]);
        assert_eq!(squares(&moved)[..3], [0.0, 3.0, 0.0]);
    }
}

//! How far the means of a tile's pixels moved, absolute and beside what they are.

use super::error::{Moves, RELATIVE_FLOOR};
use super::past_moves::PastMoves;
use super::unmet::{Reach, ReachColumns};
use crate::film::sums::sum_columns::{CHANNELS, TileColors};
use crate::film::sums::tiles::{
    BLOCK, BLOCK_PIXELS, HALF_PIXELS, Pixels, TILE, TILE_PIXELS, Tile, pixel_in_tile,
};
use crate::instruction_sets::vectorized;
use glam::{UVec2, Vec3};

/// How far pixels have moved whose samples were all of this colour: not at all.
pub(in crate::film) fn unmoved(color: Vec3, count: u32, pixels: u64) -> Moves {
    let reach = Reach::of(mean_of(&color.to_array()));
    Moves {
        count,
        pixels: pixels as u32,
        reach: Reach {
            absolute: pixels as f64 * reach.absolute,
            relative: pixels as f64 * reach.relative,
        },
        ..Moves::default()
    }
}

/// Over the channels of a pixel.
#[inline(always)]
fn mean_of(color: &[f32]) -> f64 {
    f64::from(color[0] + color[1] + color[2]) / CHANNELS as f64
}

/// What is known of a tile's pixels, in columns.
pub(in crate::film) struct Means<'a> {
    past: &'a PastMoves,
    counts: [u32; 2],
    extent: UVec2,
    /// What each pixel's squared error is multiplied by for the relative one: 1 / (likely value² + [`RELATIVE_FLOOR`]).
    weights: [f64; TILE_PIXELS],
    /// How much each errs by light that no sample has met.
    reach: ReachColumns,
}

impl<'a> Means<'a> {
    /// Of the pixels of a tile, of which `extent` lies in the picture, with these means of so many samples, those of each half.
    pub fn of(colors: &TileColors, past: &'a PastMoves, counts: [u32; 2], extent: UVec2) -> Self {
        let mut means = [0.0; TILE_PIXELS];
        for (mean, color) in means.iter_mut().zip(colors.chunks_exact(CHANNELS)) {
            *mean = mean_of(color);
        }
        let mut reach = ReachColumns::of(&means);
        let mut around = [f64::NAN; AROUND * AROUND];
        let mut moved = [0.0; TILE_PIXELS];
        let [last, ..] = past.columns();
        let has = |place: usize| pixel_in_tile(place).cmplt(extent).all();
        for place in (0..TILE_PIXELS).filter(|place| has(*place)) {
            let at = row_by_row(place);
            around[place_around(at)] = means[place];
            moved[at] = f64::from(last[place]);
        }
        let mut by_rows = [0.0; TILE_PIXELS];
        relative_weights(&around, &moved, &mut by_rows);
        let mut weights = [1.0; TILE_PIXELS];
        for (place, weight) in weights.iter_mut().enumerate() {
            if has(place) {
                *weight = by_rows[row_by_row(place)];
            } else {
                // What no samples have has not moved.
                reach.absolute[place] = 0.0;
                reach.relative[place] = 0.0;
            }
        }
        Self {
            past,
            counts,
            extent,
            weights,
            reach,
        }
    }

    /// How far the pixels of one half have moved.
    pub fn moves(&self, half: usize) -> Moves {
        let blocks = (0..TILE_PIXELS / BLOCK_PIXELS).map(|block| self.moves_in_block(half, block));
        blocks.fold(Moves::default(), |mut all, block| {
            let [absolute, relative] = [&mut all.absolute, &mut all.relative];
            for (sum, more) in absolute.iter_mut().zip(block.absolute) {
                *sum += more;
            }
            for (sum, more) in relative.iter_mut().zip(block.relative) {
                *sum += more;
            }
            all.reach.absolute += block.reach.absolute;
            all.reach.relative += block.reach.relative;
            all.pixels += block.pixels;
            all.count = block.count;
            all
        })
    }

    /// How far those of one block have.
    pub fn moves_in_block(&self, half: usize, block: usize) -> Moves {
        let first = block * BLOCK_PIXELS + half * HALF_PIXELS;
        let places = first..first + HALF_PIXELS;
        let sum = |numbers: &[f64]| numbers.iter().sum::<f64>();
        let weights = &self.weights[places.clone()];
        let columns = self.past.columns().each_ref();
        let moved = columns.map(|column| {
            let moved: [f32; HALF_PIXELS] = std::array::from_fn(|i| column[first + i]);
            moved.map(f64::from)
        });
        let corner = pixel_in_tile(block * BLOCK_PIXELS);
        let inside = Tile {
            origin: UVec2::ZERO,
            extent: self.extent.saturating_sub(corner).min(UVec2::splat(BLOCK)),
        };
        Moves {
            absolute: moved.map(|moved| sum(&moved)),
            relative: moved.map(|moved| {
                let weighted: [f64; HALF_PIXELS] = std::array::from_fn(|i| moved[i] * weights[i]);
                sum(&weighted)
            }),
            count: self.counts[half],
            pixels: inside.count(Pixels::Half(half)) as u32,
            reach: Reach {
                absolute: sum(&self.reach.absolute[places.clone()]),
                relative: sum(&self.reach.relative[places]),
            },
        }
    }
}

/// Where the pixel at a place of a tile's memory stands among its pixels row by row.
#[inline(always)]
fn row_by_row(place: usize) -> usize {
    let pixel = pixel_in_tile(place);
    (pixel.y * TILE + pixel.x) as usize
}

/// Edge of a tile with a margin of two pixels, in which nothing is known.
const AROUND: usize = TILE as usize + 2 * MARGIN;
const MARGIN: usize = 2;

/// Where a pixel of a tile, counted row by row, lies in the tile with its margin.
#[inline(always)]
const fn place_around(at: usize) -> usize {
    let (x, y) = (at % TILE as usize, at / TILE as usize);
    (y + MARGIN) * AROUND + x + MARGIN
}

vectorized! {
    /// The [`Means::weights`] row by row, of pixels with these means, not a number outside of the picture, whose last moves
    /// squared are `moved`.
    fn relative_weights(
        around: &[f64; AROUND * AROUND],
        moved: &[f64; TILE_PIXELS],
        weights: &mut [f64; TILE_PIXELS],
    ) {
        for y in 0..TILE as usize {
            let row = y * TILE as usize;
            for x in 0..TILE as usize {
                let at = row + x;
                let value = likely_value(around, place_around(row) + x, moved[at].sqrt());
                weights[at] = 1.0 / (value * value + RELATIVE_FLOOR);
            }
        }
    }
}

/// What a pixel's value is likely to be, by which its squared error is divided. Where one rare,
/// bright sample has moved a dark pixel far, its mean is far above its value, and dividing by the
/// mean would hide nearly all of the error. So a pixel counts as the mean of itself and of those two
/// opposite ones near it that are most alike: along an edge, not across it. (Neighbours across a
/// corner and the next but one of the row and the column: they are of the same half as it, and what a
/// half says must not depend on the other.) But it counts as no further from its own mean than that has
/// moved: a small highlight stands out and is there.
#[inline(always)]
fn likely_value(around: &[f64; AROUND * AROUND], at: usize, moved: f64) -> f64 {
    const PAIRS: [usize; 4] = [2, 2 * AROUND, AROUND + 1, AROUND - 1];
    let own = around[at];
    let (mut least, mut a, mut b) = (f64::INFINITY, own, own);
    for offset in PAIRS {
        let (one, other) = (around[at + offset], around[at - offset]);
        let apart = (one - other).abs();
        // Never where one of them lies outside.
        let is_less = apart < least;
        least = if is_less { apart } else { least };
        a = if is_less { one } else { a };
        b = if is_less { other } else { b };
    }
    let mean = (own + a + b) / 3.0;
    let (low, high) = (own - moved, own + moved);
    let mean = if mean < low { low } else { mean };
    let mean = if mean > high { high } else { mean };
    if least < f64::INFINITY && moved < f64::INFINITY {
        mean
    } else {
        own
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::sums::tiles::place_in_tile;

    #[test]
    fn one_bright_sample_in_a_dark_place_does_not_hide_its_own_error() {
        // 16 × 16 pixels of value 0.1; one of them has met a light of 160 once in 16 samples.
        let place = |x: u32, y: u32| place_in_tile(x, y);
        let lit = place(4, 6);
        let mut means = [0.1_f32; CHANNELS * TILE_PIXELS];
        let mean = |means: &mut TileColors, place: usize, value: f32| {
            means[CHANNELS * place..][..CHANNELS].fill(value);
        };
        // In both halves together, of which all but these pixels have not moved.
        let relative = |means: &TileColors, moved: &[(usize, f32)], size: u32| {
            let mut squares = [0.0; TILE_PIXELS];
            for (place, square) in moved {
                squares[*place] = *square;
            }
            let mut past = PastMoves::default();
            past.push(Pixels::All, &squares);
            let means = Means::of(means, &past, [16; 2], UVec2::splat(size));
            means.moves(0).relative[0] + means.moves(1).relative[0]
        };
        mean(&mut means, lit, 10.1);
        // Its mean is 10.1, which has moved by 10.
        let value: f64 = (0.1 + 0.1 + 10.1) / 3.0;
        let told = relative(&means, &[(lit, 100.0)], 16);
        assert!(
            (told / (100.0 / value.powi(2)) - 1.0).abs() < 0.01,
            "{told}"
        );
        // Where the halves agree it is a bright pixel.
        let told = relative(&means, &[(lit, 0.01)], 16);
        assert!((told / (0.01 / 100.0) - 1.0).abs() < 0.1, "{told}");
        // Of a row of pixels that all meet the light now and then, each may, whatever lies beside the row.
        for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
            let value = match y {
                0..6 => 0.1,
                6 => 3.0,
                _ => 33.0,
            };
            mean(&mut means, place(x, y), value);
        }
        mean(&mut means, place(6, 6), 6.0);
        let told = relative(&means, &[(place(6, 6), 9.0)], 16);
        assert!((told / (9.0 / 16.0) - 1.0).abs() < 0.01, "{told}");
        // Alone in the picture it has no neighbours.
        mean(&mut means, place(0, 0), 13.0);
        let told = relative(&means, &[(place(0, 0), 0.01)], 1);
        assert!((told / (0.01 / 169.0) - 1.0).abs() < 0.01, "{told}");
    }
}

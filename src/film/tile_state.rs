//! What a tile holds while it is rendered: its pixels, what has arrived of its next pass, and what
//! is known of its error.

use super::error::{Means, Moves};
use super::tiles::{FilmPixel, NOT_KNOWN, NearError, Tile};
use super::{Sum, TILE};
use std::ops::Range;

pub(super) const TILE_PIXELS: usize = (TILE * TILE) as usize;

/// Which of a tile's pixels: those with x + y even, odd, or both. Adaptive sampling gives one half
/// the samples that the other half asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Pixels {
    All,
    Half(usize),
}

impl Pixels {
    pub fn has_half(self, half: usize) -> bool {
        self == Self::All || self == Self::Half(half)
    }

    /// Whether the pixel at `place` of the tile's memory is one of them.
    pub fn has(self, place: usize) -> bool {
        self.has_half(half_of(place))
    }
}

/// The half that the pixel at `place` of the tile's memory belongs to.
pub(super) fn half_of(place: usize) -> usize {
    (place / TILE as usize + place) % 2
}

/// A piece of a pass over one tile: some of the samples of some of its pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Chunk {
    pub tile: u32,
    pub pixels: Pixels,
    /// Sample indices of this piece.
    pub range: Range<u64>,
    /// How many samples a pixel gets in this pass, all pieces together.
    pub of: u64,
}

impl Chunk {
    /// Whether it is the whole pass.
    pub fn is_whole(&self) -> bool {
        self.range.end - self.range.start == self.of
    }

    /// Its indices, cut at the powers of two: after each the mean is compared with the one before.
    /// A piece of a pass is one segment; so are samples that do not begin with the first.
    pub fn segments(&self) -> impl Iterator<Item = Range<u64>> + use<> {
        let Range { start, end } = self.range;
        let cut = start == 0 && self.is_whole();
        let mut from = start;
        std::iter::from_fn(move || {
            let to = if cut { end.min((2 * from).max(1)) } else { end };
            let segment = from..to;
            from = to;
            (!segment.is_empty()).then_some(segment)
        })
    }
}

/// A tile of the film while it is rendered.
pub(super) struct TileState {
    pub tile: Tile,
    /// `TILE_PIXELS`, or none before the first pass: a render begins without waiting for memory.
    pub pixels: Box<[FilmPixel]>,
    /// Of each pixel the sum of what lamps close by add too much; none where no sample met one.
    near: Box<[Sum]>,
    pending: Option<Box<Pending>>,
    /// How far the means moved, for each half of the pixels.
    pub moves: [Moves; 2],
    /// Rays that its samples took, and how many samples that were.
    pub rays: u64,
    pub samples: u64,
    /// Counts how often its pixels have changed.
    pub version: u32,
}

/// The pieces of a pass that have arrived; they enter the pixels when it is complete.
struct Pending {
    sums: Vec<Sum>,
    /// The same of what lamps close by add too much; none where no sample met one.
    near: Vec<Sum>,
    /// Samples a pixel of each half still waits for; 0 where no pass has begun.
    missing: [u64; 2],
}

impl TileState {
    pub fn new(tile: Tile) -> Self {
        Self {
            tile,
            pixels: Box::default(),
            near: Box::default(),
            pending: None,
            moves: [Moves::default(); 2],
            rays: 0,
            samples: 0,
            version: 0,
        }
    }

    /// Takes the sums of a chunk, `TILE_PIXELS` for each of its segments, and as many of what lamps close by
    /// add too much, or none. True where they complete the pass and so have entered the pixels.
    pub fn absorb(&mut self, chunk: &Chunk, sums: &[Sum], near: &[Sum], rays: u64) -> bool {
        let length = chunk.range.end - chunk.range.start;
        self.rays += rays;
        self.samples += length
            * self
                .tile
                .pixels()
                .filter(|(_, at)| chunk.pixels.has(*at))
                .count() as u64;
        if chunk.is_whole() {
            let mut near = near.chunks_exact(TILE_PIXELS);
            for (segment, sums) in chunk.segments().zip(sums.chunks_exact(TILE_PIXELS)) {
                let near = near.next().unwrap_or_default();
                self.commit(chunk.pixels, sums, near, segment.end - segment.start);
            }
            self.note_moves(chunk.pixels);
            return true;
        }
        let mut pending = self.pending.take().unwrap_or_else(|| {
            Box::new(Pending {
                sums: vec![Sum::default(); TILE_PIXELS],
                near: Vec::new(),
                missing: [0; 2],
            })
        });
        for (at, sum) in pending.sums.iter_mut().enumerate() {
            if chunk.pixels.has(at) {
                sum.merge(&sums[at]);
            }
        }
        if !near.is_empty() {
            pending.near.resize(TILE_PIXELS, Sum::default());
        }
        for (at, (sum, near)) in pending.near.iter_mut().zip(near).enumerate() {
            if chunk.pixels.has(at) {
                sum.merge(near);
            }
        }
        for half in 0..2 {
            if chunk.pixels.has_half(half) {
                let missing = &mut pending.missing[half];
                *missing = if *missing == 0 { chunk.of } else { *missing } - length;
            }
        }
        let first = usize::from(!chunk.pixels.has_half(0));
        let complete = pending.missing[first] == 0;
        if complete {
            self.commit(chunk.pixels, &pending.sums, &pending.near, chunk.of);
            self.note_moves(chunk.pixels);
            let Pending { sums, near, .. } = &mut *pending;
            for sums in [sums, near] {
                for (at, sum) in sums.iter_mut().enumerate() {
                    if chunk.pixels.has(at) {
                        *sum = Sum::default();
                    }
                }
            }
        }
        if !complete || pending.missing != [0; 2] {
            self.pending = Some(pending);
        }
        complete
    }

    /// Adds `count` samples to every pixel, whose sums are given.
    fn commit(&mut self, pixels: Pixels, sums: &[Sum], near: &[Sum], count: u64) {
        if self.pixels.is_empty() {
            self.pixels = vec![FilmPixel::default(); TILE_PIXELS].into();
        }
        let doubles = |pixel: &FilmPixel| u64::from(pixel.count) == count;
        for (_, at) in self.tile.pixels().filter(|(_, at)| pixels.has(*at)) {
            let pixel = &mut self.pixels[at];
            if doubles(pixel) {
                let moved = pixel.sum.half_difference(&sums[at], pixel.count);
                let squared = moved.iter().map(|m| m * m).sum::<f64>() / 3.0;
                pixel.moved = [squared as f32, pixel.moved[0], pixel.moved[1]];
            } else if pixel.count == 0 && count > 1 {
                pixel.moved = NOT_KNOWN;
            }
            pixel.sum.merge(&sums[at]);
            pixel.count += count as u32;
        }
        if !near.is_empty() && self.near.is_empty() {
            self.near = vec![Sum::default(); TILE_PIXELS].into();
        }
        for (at, (sum, near)) in self.near.iter_mut().zip(near).enumerate() {
            if pixels.has(at) {
                sum.merge(near);
            }
        }
    }

    /// The pixels have changed: says how far they moved.
    fn note_moves(&mut self, pixels: Pixels) {
        let near = self.near_errors();
        let means = Means::of(&self.pixels, &near, self.tile.extent);
        for half in 0..2 {
            if pixels.has_half(half) {
                let places = self.tile.pixels().map(|(_, at)| at);
                self.moves[half] = means.moves(places.filter(|at| half_of(*at) == half));
            }
        }
        self.version = self.version.wrapping_add(1);
    }

    /// What lamps close by leave each pixel off by; empty where none is close.
    pub fn near_errors(&self) -> Vec<NearError> {
        let pixels = self.near.iter().zip(&self.pixels);
        pixels
            .map(|(sum, pixel)| NearError::of(sum, pixel.count))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{UVec2, Vec3};

    fn tile() -> TileState {
        TileState::new(Tile {
            origin: UVec2::new(16, 32),
            extent: UVec2::new(16, 5),
        })
    }

    fn chunk(range: Range<u64>, of: u64, pixels: Pixels) -> Chunk {
        Chunk {
            tile: 0,
            pixels,
            range,
            of,
        }
    }

    fn sums(values: Range<u64>) -> Vec<Sum> {
        (0..TILE_PIXELS)
            .map(|at| {
                let mut sum = Sum::default();
                for value in values.clone() {
                    sum.add(Vec3::splat((value * 1000 + at as u64) as f32));
                }
                sum
            })
            .collect()
    }

    #[test]
    fn a_chunk_from_the_first_sample_on_is_cut_at_the_powers_of_two() {
        let segments = |range, of| chunk(range, of, Pixels::All).segments().collect::<Vec<_>>();
        assert_eq!(segments(0..11, 11), [0..1, 1..2, 2..4, 4..8, 8..11]);
        assert_eq!(segments(4..8, 4).as_slice(), std::slice::from_ref(&(4..8)));
        assert_eq!(segments(0..8, 16).as_slice(), std::slice::from_ref(&(0..8)));
        assert_eq!(segments(3..3, 0), []);
    }

    #[test]
    fn the_pieces_of_a_pass_enter_the_pixels_together_in_any_order() {
        let mut whole = tile();
        let mut first: Vec<Sum> = Vec::new();
        for segment in chunk(0..4, 4, Pixels::All).segments() {
            first.extend(sums(segment));
        }
        assert!(whole.absorb(&chunk(0..4, 4, Pixels::All), &first, &[], 10));
        let mut pieces = tile();
        assert!(pieces.absorb(&chunk(0..4, 4, Pixels::All), &first, &[], 10));
        assert!(whole.absorb(&chunk(4..8, 4, Pixels::All), &sums(4..8), &[], 10));
        for (range, half, complete) in [
            (6..8, 1, false),
            (6..8, 0, false),
            (4..6, 0, true),
            (4..6, 1, true),
        ] {
            let before = pieces.pixels.clone();
            let done = pieces.absorb(
                &chunk(range.clone(), 4, Pixels::Half(half)),
                &sums(range),
                &[],
                0,
            );
            assert_eq!(done, complete);
            assert_eq!(pieces.pixels == before, !complete);
        }
        assert!(pieces.pending.is_none());
        assert_eq!(whole.pixels, pieces.pixels);
        assert_eq!(whole.moves, pieces.moves);
        assert_eq!(whole.samples, 8 * 80);
        assert_eq!(whole.pixels[0].count, 8);
        assert_eq!(whole.pixels[5 * 16].count, 0, "outside the picture");
    }

    #[test]
    fn how_far_a_mean_moved_is_kept_for_the_last_three_doublings() {
        let mut tile = tile();
        let mut all: Vec<Sum> = Vec::new();
        for segment in chunk(0..8, 8, Pixels::All).segments() {
            all.extend(sums(segment));
        }
        tile.absorb(&chunk(0..8, 8, Pixels::All), &all, &[], 0);
        // Means of 0..1, 0..2, 0..4, 0..8 in thousands: 0, 0.5, 1.5, 3.5.
        assert_eq!(tile.pixels[0].moved, [4e6, 1e6, 0.25e6]);
    }
}

//! What a tile holds while it is rendered: its pixels, what has arrived of its next pass, and what
//! is known of its error.

use super::error::{Means, Moves};
use super::sample_chunk::Subject;
use super::tile_planes::TilePlanes;
use super::tiles::{FilmPixel, NOT_KNOWN, Tile};
use super::{Sum, TILE};
use crate::trace::PlaneSet;
use crate::trace::planes::OWN;
use glam::{UVec2, Vec3};
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
    /// Of which planes.
    pub planes: PlaneSet,
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
    /// What the pixels are the sum of, where planes stay apart.
    planes: Option<Box<TilePlanes>>,
    /// The edit by whose tints they are.
    edit: u32,
    /// [`Subject::arrangement`] of its planes.
    arrangement: u32,
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
    /// `TILE_PIXELS` for each plane.
    sums: Vec<Sum>,
    /// Samples a pixel of each half still waits for; 0 where no pass has begun.
    missing: [u64; 2],
}

impl TileState {
    pub fn new(tile: Tile) -> Self {
        Self {
            tile,
            pixels: Box::default(),
            planes: None,
            edit: 0,
            arrangement: 0,
            pending: None,
            moves: [Moves::default(); 2],
            rays: 0,
            samples: 0,
            version: 0,
        }
    }

    /// Takes the sums of a chunk, `TILE_PIXELS` for each plane of each of its segments. True where they complete the pass
    /// and so have entered the pixels.
    pub fn absorb(&mut self, subject: &Subject, chunk: &Chunk, sums: &[Sum], rays: u64) -> bool {
        let each = subject.planes() * TILE_PIXELS;
        let length = chunk.range.end - chunk.range.start;
        self.rays += rays;
        self.samples += length
            * self
                .tile
                .pixels()
                .filter(|(_, at)| chunk.pixels.has(*at))
                .count() as u64;
        if chunk.is_whole() {
            for (segment, sums) in chunk.segments().zip(sums.chunks_exact(each)) {
                self.commit(subject, chunk, sums, segment.end - segment.start);
            }
            self.note_moves(chunk.pixels);
            return true;
        }
        let mut pending = self.pending.take().unwrap_or_else(|| {
            Box::new(Pending {
                sums: vec![Sum::default(); each],
                missing: [0; 2],
            })
        });
        for (at, sum) in pending.sums.iter_mut().enumerate() {
            if chunk.pixels.has(at % TILE_PIXELS) {
                sum.merge(&sums[at]);
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
            self.commit(subject, chunk, &pending.sums, chunk.of);
            self.note_moves(chunk.pixels);
            for (at, sum) in pending.sums.iter_mut().enumerate() {
                if chunk.pixels.has(at % TILE_PIXELS) {
                    *sum = Sum::default();
                }
            }
        }
        if !complete || pending.missing != [0; 2] {
            self.pending = Some(pending);
        }
        complete
    }

    /// Adds `count` samples to every pixel of the chunk, whose sums are given.
    fn commit(&mut self, subject: &Subject, chunk: &Chunk, sums: &[Sum], count: u64) {
        if subject.stays_apart {
            self.commit_apart(subject, chunk, sums, count);
            return;
        }
        if self.pixels.is_empty() {
            self.pixels = first_pixels(self.tile, chunk.pixels, count, |at| sums[at]);
            return;
        }
        let pixels = chunk.pixels;
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
    }

    /// The same where light is kept apart.
    fn commit_apart(&mut self, subject: &Subject, chunk: &Chunk, sums: &[Sum], count: u64) {
        self.retint(subject);
        let planes = self
            .planes
            .get_or_insert_with(|| Box::new(TilePlanes::new(subject.planes())));
        planes.add(chunk.pixels, chunk.planes, sums, count as u32);
        let is_more = chunk.planes.has(OWN);
        if self.pixels.is_empty() {
            // Samples are counted by what shines by itself: without it there are none yet.
            if is_more {
                let sum = |at| planes.fold(at, &subject.light.tints).0;
                self.pixels = first_pixels(self.tile, chunk.pixels, count, sum);
            }
            return;
        }
        for (_, at) in (self.tile.pixels()).filter(|(_, at)| chunk.pixels.has(*at)) {
            let pixel = &mut self.pixels[at];
            let (sum, moved) = planes.fold(at, &subject.light.tints);
            if !is_more {
                pixel.moved[0] = if pixel.moved[0].is_finite() {
                    moved
                } else {
                    pixel.moved[0]
                };
            } else if u64::from(pixel.count) == count {
                pixel.moved = [moved, pixel.moved[0], pixel.moved[1]];
            } else if pixel.count == 0 && count > 1 {
                pixel.moved = NOT_KNOWN;
            }
            pixel.sum = sum;
            pixel.count += if is_more { count as u32 } else { 0 };
        }
    }

    /// The pixels are what they are with the subject's tints.
    pub fn retint(&mut self, subject: &Subject) {
        // While an edit arrives here its tints are those of other planes.
        if self.edit == subject.edit || self.arrangement != subject.arrangement {
            return;
        }
        self.edit = subject.edit;
        if let Some(planes) = &self.planes {
            planes.retint(&mut self.pixels, &subject.light.tints);
            for half in 0..2 {
                if self.moves[half].pixels > 0 {
                    self.note_moves(Pixels::Half(half));
                }
            }
        }
    }

    /// The planes of an edited scene, its `arrangement`, are those of these numbers before. What has arrived of a pass is of
    /// no plane that there is.
    pub fn rearrange(&mut self, from: &[Option<usize>], arrangement: u32) {
        self.pending = None;
        self.arrangement = arrangement;
        if let Some(planes) = &mut self.planes {
            planes.rearrange(from);
        }
    }

    /// Samples that each pixel of a half has; `None` where it has no pixel.
    pub fn count(&self, half: usize) -> Option<u32> {
        let UVec2 { x, y } = self.tile.extent;
        let first = match half {
            0 => 0,
            _ if x > 1 => 1,
            _ if y > 1 => TILE as usize,
            _ => return None,
        };
        Some(self.pixels.get(first).map_or(0, |pixel| pixel.count))
    }

    /// The mean of a pixel's samples in one plane, without its tint; black where planes do not stay apart.
    pub fn plane_mean(&self, plane: usize, at: usize) -> Vec3 {
        let planes = self.planes.as_ref();
        planes.map_or(Vec3::ZERO, |planes| planes.mean(plane, at))
    }

    /// Whether it has all the light that a subject has, in the same planes.
    pub fn has_planes_of(&self, subject: &Subject) -> bool {
        let has_all = |planes: &TilePlanes| !planes.lacks_light();
        self.arrangement == subject.arrangement && self.planes.as_deref().is_some_and(has_all)
    }

    /// Whether something that shines is missing in its pixels.
    pub fn lacks_light(&self) -> bool {
        self.planes
            .as_ref()
            .is_some_and(|planes| planes.lacks_light())
    }

    /// Planes of a half that have fewer samples than it: those with the fewest, how many they have, and how many it has.
    pub fn behind(&self, half: usize) -> Option<(PlaneSet, u32, u32)> {
        self.planes.as_ref()?.behind(half)
    }

    /// The pixels have changed: says how far they moved.
    fn note_moves(&mut self, pixels: Pixels) {
        let means = Means::of(&self.pixels, self.tile.extent);
        for half in 0..2 {
            if pixels.has_half(half) {
                let places = self.tile.pixels().map(|(_, at)| at);
                self.moves[half] = means.moves(places.filter(|at| half_of(*at) == half));
            }
        }
        self.version = self.version.wrapping_add(1);
    }
}

/// The pixels of a tile whose first samples these are. They are written without being read: new memory comes page by page,
/// and a page that is read before it is written comes twice.
fn first_pixels(
    tile: Tile,
    pixels: Pixels,
    count: u64,
    sum: impl Fn(usize) -> Sum,
) -> Box<[FilmPixel]> {
    let pixel = |at: usize| {
        let place = UVec2::new(at as u32 % TILE, at as u32 / TILE);
        if !pixels.has(at) || place.cmpge(tile.extent).any() {
            return FilmPixel::default();
        }
        FilmPixel {
            sum: sum(at),
            count: count as u32,
            moved: if count > 1 { NOT_KNOWN } else { [0.0; 3] },
        }
    };
    (0..TILE_PIXELS).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::super::test_scene;
    use super::*;
    use crate::trace::World;
    use std::sync::Arc;

    fn tile() -> TileState {
        let tile = Tile {
            origin: UVec2::new(16, 32),
            extent: UVec2::new(16, 5),
        };
        TileState::new(tile)
    }

    fn chunk(range: Range<u64>, of: u64, pixels: Pixels) -> Chunk {
        Chunk {
            tile: 0,
            pixels,
            planes: PlaneSet::ALL,
            range,
            of,
        }
    }

    fn subject() -> Subject {
        let settings = test_scene::settings(UVec2::new(64, 64), 8);
        let world = World {
            lights: Arc::default(),
            ..test_scene::world()
        };
        Subject::new(world, test_scene::camera(), settings, false)
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
        assert!(whole.absorb(&subject(), &chunk(0..4, 4, Pixels::All), &first, 10));
        let mut pieces = tile();
        assert!(pieces.absorb(&subject(), &chunk(0..4, 4, Pixels::All), &first, 10));
        assert!(whole.absorb(&subject(), &chunk(4..8, 4, Pixels::All), &sums(4..8), 10));
        for (range, half, complete) in [
            (6..8, 1, false),
            (6..8, 0, false),
            (4..6, 0, true),
            (4..6, 1, true),
        ] {
            let before = pieces.pixels.clone();
            let done = pieces.absorb(
                &subject(),
                &chunk(range.clone(), 4, Pixels::Half(half)),
                &sums(range),
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
        tile.absorb(&subject(), &chunk(0..8, 8, Pixels::All), &all, 0);
        // Means of 0..1, 0..2, 0..4, 0..8 in thousands: 0, 0.5, 1.5, 3.5.
        assert_eq!(tile.pixels[0].moved, [4e6, 1e6, 0.25e6]);
    }
}

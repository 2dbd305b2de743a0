//! What a tile holds while it is rendered: its pixels, what has arrived of its next pass, and what
//! is known of its error.

use super::tile_planes::TilePlanes;
use super::tiled_film::FilmTile;
use crate::film::errors::error::Moves;
use crate::film::errors::means::{Means, unmoved};
use crate::film::subject::Subject;
use crate::film::sums::sum_columns::{SumColumns, Sums, TileColors};
use crate::film::sums::tiles::{Pixels, TILE_PIXELS, Tile};
use crate::trace::{MaterialSet, PlaneSet};
use glam::Vec3;
use std::ops::Range;

/// A piece of a pass over one tile: some of the samples of some of its pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::film) struct Chunk {
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
pub(in crate::film) struct TileState {
    pub tile: Tile,
    /// None before the first pass: a render begins without waiting for memory.
    planes: TilePlanes,
    /// The edit whose tints they have.
    edit: u32,
    /// [`Subject::arrangement`] of its planes.
    arrangement: u32,
    pending: Option<Box<Pending>>,
    /// How far the means moved, for each half of the pixels.
    moves: [Moves; 2],
    /// Their tints are others since then.
    moves_are_old: bool,
    /// Rays that its samples took, and how many samples that were.
    pub rays: u64,
    pub samples: u64,
    /// The materials that they met.
    met: MaterialSet,
    /// Counts how often its pixels have changed.
    pub version: u32,
}

/// The pieces of a pass that have arrived; they enter the pixels when it is complete.
struct Pending {
    /// `TILE_PIXELS` for each plane.
    sums: SumColumns,
    /// Samples a pixel of each half still waits for; 0 where no pass has begun.
    missing: [u64; 2],
}

impl TileState {
    pub fn new(tile: Tile) -> Self {
        Self {
            tile,
            planes: TilePlanes::default(),
            edit: 0,
            arrangement: 0,
            pending: None,
            moves: [Moves::default(); 2],
            moves_are_old: false,
            rays: 0,
            samples: 0,
            met: MaterialSet::NONE,
            version: 0,
        }
    }

    /// Takes the sums of a chunk, `TILE_PIXELS` for each of its planes, of each of its segments. True where they complete the
    /// pass and so have entered the pixels.
    pub fn absorb(&mut self, subject: &Subject, chunk: &Chunk, sums: Sums, rays: u64) -> bool {
        let each = chunk.planes.rows(subject.planes()) * TILE_PIXELS;
        let length = chunk.range.end - chunk.range.start;
        self.rays += rays;
        self.samples += length * self.tile.count(chunk.pixels);
        if chunk.is_whole() {
            for (number, segment) in chunk.segments().enumerate() {
                let sums = sums.part(number * each..(number + 1) * each);
                self.commit(
                    subject,
                    chunk,
                    chunk.planes,
                    sums,
                    segment.end - segment.start,
                );
            }
            self.note_moves(chunk.pixels);
            return true;
        }
        let mut pending = self.pending.take().unwrap_or_else(|| {
            let mut sums = SumColumns::default();
            sums.reset(subject.planes() * TILE_PIXELS);
            Box::new(Pending {
                sums,
                missing: [0; 2],
            })
        });
        // Those of other pixels are sums of nothing.
        for (row, plane) in chunk.planes.of(subject.planes()).enumerate() {
            let sums = sums.part(row * TILE_PIXELS..(row + 1) * TILE_PIXELS);
            pending.sums.merge(plane * TILE_PIXELS, sums);
        }
        for half in chunk.pixels.halves() {
            let missing = &mut pending.missing[half];
            *missing = if *missing == 0 { chunk.of } else { *missing } - length;
        }
        let complete = (chunk.pixels.halves()).all(|half| pending.missing[half] == 0);
        if complete {
            self.commit(subject, chunk, PlaneSet::ALL, pending.sums.all(), chunk.of);
            self.note_moves(chunk.pixels);
            for plane in 0..subject.planes() {
                for run in chunk.pixels.runs() {
                    let first = plane * TILE_PIXELS;
                    pending.sums.clear(first + run.start..first + run.end);
                }
            }
        }
        if !complete || pending.missing != [0; 2] {
            self.pending = Some(pending);
        }
        complete
    }

    /// Takes the samples of a chunk that is a whole pass, and so completes it: all are of this colour and see no light.
    pub fn absorb_even(
        &mut self,
        subject: &Subject,
        chunk: &Chunk,
        color: Vec3,
        rays: u64,
    ) -> bool {
        let length = |range: Range<u64>| (range.end - range.start) as u32;
        let first = chunk.segments().next().map_or(0, length);
        let count = length(chunk.range.clone());
        self.rays += rays;
        self.samples += u64::from(count) * self.tile.count(chunk.pixels);
        self.begin(subject);
        (self.planes).add_even(chunk.pixels, chunk.planes, color, (first, count));
        self.note_moves(chunk.pixels);
        true
    }

    /// Has the planes and the tints of a subject.
    fn begin(&mut self, subject: &Subject) {
        self.retint(subject);
        if self.planes.is_empty() {
            self.planes = TilePlanes::of(subject);
        }
    }

    /// Adds `count` samples to every pixel of the chunk. The sums are of these planes.
    fn commit(&mut self, subject: &Subject, chunk: &Chunk, of: PlaneSet, sums: Sums, count: u64) {
        self.begin(subject);
        let sums = (of, sums);
        (self.planes).add(chunk.pixels, chunk.planes, sums, count as u32, chunk.of);
    }

    /// The pixels are what they are with the subject's tints.
    pub fn retint(&mut self, subject: &Subject) {
        // While an edit arrives here its tints are those of other planes.
        if self.edit == subject.edit || self.arrangement != subject.arrangement {
            return;
        }
        self.edit = subject.edit;
        if !self.planes.is_empty() {
            self.planes.retint(&subject.light.tints);
            self.moves_are_old = true;
            self.version = self.version.wrapping_add(1);
        }
    }

    /// The planes of an edited scene, its `arrangement`, are those of these numbers before. What has arrived of a pass is of
    /// no plane that there is.
    pub fn rearrange(&mut self, from: &[Option<usize>], arrangement: u32) {
        self.pending = None;
        self.arrangement = arrangement;
        if !self.planes.is_empty() {
            self.planes.rearrange(from);
        }
    }

    /// Samples on their way into it met these materials.
    pub fn meet(&mut self, met: MaterialSet) {
        self.met = self.met.union(met);
    }

    /// Whether some sample may have met one of these materials.
    pub fn may_show(&self, materials: MaterialSet) -> bool {
        self.met.may_share(materials)
    }

    /// Has no sample any more; how many they were.
    pub fn empty(&mut self) -> u64 {
        let samples = |half: usize| {
            u64::from(self.planes.counts()[half]) * self.tile.count(Pixels::Half(half))
        };
        let samples = samples(0) + samples(1);
        self.planes.empty();
        self.pending = None;
        self.moves = [Moves::default(); 2];
        self.moves_are_old = true;
        self.met = MaterialSet::NONE;
        samples
    }

    /// Samples that each pixel of a half has; `None` where it has no pixel.
    pub fn count(&self, half: usize) -> Option<u32> {
        let has_pixels = self.tile.count(Pixels::Half(half)) > 0;
        has_pixels.then(|| self.planes.counts()[half])
    }

    /// Whether some pixel has samples.
    pub fn has_samples(&self) -> bool {
        self.planes.counts() != [0; 2]
    }

    /// The means of the pixels' samples so far.
    pub fn means(&mut self) -> TileColors {
        self.planes.means()
    }

    /// What a film has of it.
    pub fn film_tile(&mut self) -> FilmTile {
        self.planes.film_tile()
    }

    /// The same without a copy: nothing of it is left.
    pub fn take_film_tile(&mut self) -> FilmTile {
        std::mem::take(&mut self.planes).into_film_tile()
    }

    /// The mean of a pixel's samples in one plane, without its tint; black where there is no such plane.
    pub fn plane_mean(&self, plane: usize, place: usize) -> Vec3 {
        self.planes.mean(plane, place)
    }

    /// Whether it has all the light that a subject has, in the same planes.
    pub fn has_planes_of(&self, subject: &Subject) -> bool {
        self.arrangement == subject.arrangement
            && subject.stays_apart
            && !self.planes.is_empty()
            && !self.lacks_light()
    }

    /// Whether something that shines is missing in its pixels, or all of it.
    pub fn lacks_light(&self) -> bool {
        self.planes.lacks_light()
    }

    /// Planes of a half that have fewer samples than it: those with the fewest, how many they have, and how many it has.
    pub fn behind(&self, half: usize) -> Option<(PlaneSet, u32, u32)> {
        self.planes.behind(half)
    }

    /// How far the means moved, for each half of the pixels.
    pub fn moves(&mut self) -> [Moves; 2] {
        if std::mem::take(&mut self.moves_are_old) {
            self.update_moves(Pixels::All);
        }
        self.moves
    }

    /// The pixels have changed: says how far they moved.
    fn note_moves(&mut self, pixels: Pixels) {
        self.update_moves(pixels);
        self.version = self.version.wrapping_add(1);
    }

    fn update_moves(&mut self, pixels: Pixels) {
        let counts = self.planes.counts();
        for half in pixels.halves().filter(|half| counts[*half] < 2) {
            // Of a single sample nothing is known.
            self.moves[half] = Moves {
                count: counts[half],
                pixels: self.tile.count(Pixels::Half(half)) as u32,
                ..Moves::default()
            };
        }
        if let Some(means) = self.planes.even_means() {
            for half in pixels.halves().filter(|half| counts[*half] >= 2) {
                let pixels = self.tile.count(Pixels::Half(half));
                self.moves[half] = unmoved(means[half], counts[half], pixels);
            }
        } else if pixels.halves().any(|half| counts[half] >= 2) {
            let colors = self.planes.means();
            let means = Means::of(&colors, self.planes.past(), counts, self.tile.extent);
            for half in pixels.halves().filter(|half| counts[*half] >= 2) {
                self.moves[half] = means.moves(half);
            }
        }
    }
}

#[cfg(test)]
mod tests;

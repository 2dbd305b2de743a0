//! What camera rays hit, kept while lights and materials are edited: those are in no camera ray's way.
//!
//! Kept from the first edit on, since a render that nobody edits has no use for it, and of each pixel's first samples only:
//! who drags a light sees no more of them.

use super::lock;
use super::tile_state::Pixels;
use super::tiles::{TILE_PIXELS, TileGrid};
use crate::bvh::Hit;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// What all of a picture's hits may take together, in bytes.
const MOST_BYTES: u64 = 1 << 28;
/// What those of one sample of a tile take.
const TILE_BYTES: u64 = (TILE_PIXELS * size_of::<Option<Hit>>()) as u64;

/// Hits of a picture's camera rays, tile by tile.
pub(super) struct KeptHits {
    tiles: Vec<Mutex<TileHits>>,
    /// Samples of each pixel for which there is room.
    samples: u64,
    bytes: AtomicU64,
}

/// Those of a tile.
#[derive(Default)]
struct TileHits {
    /// Of each of its samples, of each place of its memory.
    hits: Vec<Option<Hit>>,
    /// Of each of its samples, whether they are there of each half of its pixels.
    known: Vec<[bool; 2]>,
}

/// Places of a chunk, by their numbers in its list, of one sample: a piece of a batch.
pub(super) type Run = (u64, Range<usize>);

impl KeptHits {
    pub fn new(grid: &TileGrid) -> Self {
        let samples = MOST_BYTES / (u64::from(grid.count()) * TILE_BYTES).max(1);
        Self {
            tiles: grid.tiles().map(|_| Mutex::default()).collect(),
            samples,
            bytes: AtomicU64::new(0),
        }
    }

    /// What they take now, in bytes.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Appends the hits of a batch's runs of these places of a tile. False, and nothing appended, where some are not known.
    pub fn read(
        &self,
        tile: u32,
        pixels: Pixels,
        places: &[usize],
        runs: &[Run],
        hits: &mut Vec<Option<Hit>>,
    ) -> bool {
        let tile = lock(&self.tiles[tile as usize]);
        let is_known = |index: u64| {
            let known = tile.known.get(index as usize);
            known.is_some_and(|known| pixels.halves().all(|half| known[half]))
        };
        if !runs.iter().all(|(index, _)| is_known(*index)) {
            return false;
        }
        for (index, run) in runs {
            let of_sample = &tile.hits[*index as usize * TILE_PIXELS..][..TILE_PIXELS];
            if places.len() == TILE_PIXELS {
                hits.extend_from_slice(&of_sample[run.clone()]);
            } else {
                hits.extend(places[run.clone()].iter().map(|place| of_sample[*place]));
            }
        }
        true
    }

    /// Keeps the hits of a batch's runs, as far as there is room.
    pub fn write(&self, tile: u32, places: &[usize], runs: &[Run], mut hits: &[Option<Hit>]) {
        let mut tile = lock(&self.tiles[tile as usize]);
        for (index, run) in runs {
            let (own, others) = hits.split_at(run.len());
            hits = others;
            if *index >= self.samples {
                continue;
            }
            let samples = *index as usize + 1;
            if tile.known.len() < samples {
                let more = (samples - tile.known.len()) as u64 * TILE_BYTES;
                self.bytes.fetch_add(more, Ordering::Relaxed);
                tile.known.resize(samples, [false; 2]);
                tile.hits.resize(samples * TILE_PIXELS, None);
            }
            let of_sample = &mut tile.hits[*index as usize * TILE_PIXELS..][..TILE_PIXELS];
            for (place, hit) in places[run.clone()].iter().zip(own) {
                of_sample[*place] = *hit;
            }
        }
    }

    /// All hits of these samples of these pixels have been written.
    pub fn complete(&self, tile: u32, pixels: Pixels, samples: Range<u64>) {
        let mut tile = lock(&self.tiles[tile as usize]);
        for index in samples.start..samples.end.min(self.samples) {
            if let Some(known) = tile.known.get_mut(index as usize) {
                pixels.halves().for_each(|half| known[half] = true);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::UVec2;

    fn hit(triangle: u32) -> Option<Hit> {
        Some(Hit {
            t: 1.0,
            instance: 0,
            triangle,
            u: 0.2,
            v: 0.3,
        })
    }

    #[test]
    fn what_was_written_of_all_pixels_of_a_half_is_read_again_and_no_other() {
        let kept = KeptHits::new(&TileGrid::new(UVec2::new(20, 16)));
        let all: Vec<usize> = (0..TILE_PIXELS).collect();
        let half: Vec<usize> = Pixels::Half(1).runs().flatten().collect();
        let hits: Vec<_> = (0..TILE_PIXELS as u32).map(hit).collect();
        let mut found = Vec::new();
        let mut read = |pixels, places: &[usize], run: Run| {
            found.clear();
            let is_known = kept.read(0, pixels, places, &[run], &mut found);
            (is_known, found.clone())
        };
        assert_eq!(read(Pixels::All, &all, (0, 0..4)), (false, Vec::new()));
        // In two batches, of which the first alone is not enough.
        let runs = [(2, 0..half.len()), (3, 0..9)];
        let of_half: Vec<_> = half.iter().map(|place| hits[*place]).collect();
        kept.write(0, &half, &runs, &[&of_half[..], &of_half[..9]].concat());
        kept.complete(0, Pixels::Half(1), 2..3);
        assert_eq!(kept.bytes(), 4 * TILE_BYTES);
        assert!(!read(Pixels::All, &all, (2, 0..4)).0, "the other half");
        assert!(!read(Pixels::Half(1), &half, (3, 0..4)).0, "not complete");
        let (is_known, found) = read(Pixels::Half(1), &half, (2, 3..11));
        assert!(is_known);
        assert_eq!(found, of_half[3..11]);
        kept.write(0, &all, &[(2, 0..TILE_PIXELS)], &hits);
        kept.complete(0, Pixels::All, 2..3);
        let (is_known, found) = read(Pixels::All, &all, (2, 17..200));
        assert!(is_known);
        assert_eq!(found, hits[17..200]);
    }

    #[test]
    fn of_a_picture_too_large_for_them_nothing_is_kept() {
        let kept = KeptHits::new(&TileGrid::new(UVec2::new(4096, 4096)));
        let places = [0];
        for index in 0..2 {
            kept.write(7, &places, &[(index, 0..1)], &[hit(5)]);
            kept.complete(7, Pixels::All, index..index + 1);
        }
        assert_eq!(kept.bytes(), 0);
        assert!(!kept.read(7, Pixels::All, &places, &[(0, 0..1)], &mut Vec::new()));
    }
}

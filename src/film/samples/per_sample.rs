//! What is kept of a picture's samples from edit to edit, tile by tile.
//!
//! Of each pixel's first samples only, as far as there is room: who drags a light sees no more of them.

use crate::film::lock;
use crate::film::sums::tiles::{TILE_PIXELS, TileGrid};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// What a [`PerSample`] may take, in bytes. A render has four.
const MOST_BYTES: u64 = 1 << 27;

/// Something of each sample; its default where nothing is known.
pub(super) struct PerSample<T> {
    /// Of each tile and each of its samples, one for each place of its memory.
    tiles: Vec<Mutex<Vec<T>>>,
    /// Samples of each pixel for which there is room.
    samples: u64,
    bytes: AtomicU64,
}

/// Where the samples of a batch belong: to places of a tile, and to each of those the same ones of its samples.
pub(in crate::film) struct BatchPlaces<'a> {
    pub tile: u32,
    pub places: &'a [usize],
    pub indices: Range<u64>,
    /// The samples of a place follow one another; else a sample of each place.
    pub by_place: bool,
}

impl BatchPlaces<'_> {
    /// How many samples they are.
    pub fn count(&self) -> usize {
        self.places.len() * (self.indices.end - self.indices.start) as usize
    }

    /// Hears place and index of each sample, in order.
    pub fn each(&self, mut hear: impl FnMut(usize, u64)) {
        if self.by_place {
            for &place in self.places {
                self.indices.clone().for_each(|index| hear(place, index));
            }
        } else {
            for index in self.indices.clone() {
                self.places.iter().for_each(|&place| hear(place, index));
            }
        }
    }
}

/// Where a sample is kept.
fn kept_at(place: usize, index: u64) -> usize {
    index as usize * TILE_PIXELS + place
}

impl<T: Copy + Default> PerSample<T> {
    /// What those of one sample of a tile take.
    const TILE_BYTES: u64 = (TILE_PIXELS * size_of::<T>()) as u64;

    pub fn new(grid: &TileGrid) -> Self {
        let samples = MOST_BYTES / (u64::from(grid.count()) * Self::TILE_BYTES).max(1);
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

    /// Tells what is known of each sample of a batch, in order.
    pub fn read(&self, of: &BatchPlaces, mut tell: impl FnMut(T)) {
        let tile = lock(&self.tiles[of.tile as usize]);
        of.each(|place, index| {
            let known = tile.get(kept_at(place, index));
            tell(known.copied().unwrap_or_default());
        });
    }

    /// Keeps what is known now of each sample of a batch, as far as there is room.
    pub fn write(&self, of: &BatchPlaces, mut values: impl Iterator<Item = T>) {
        if of.indices.start >= self.samples {
            return;
        }
        let mut tile = lock(&self.tiles[of.tile as usize]);
        let end = of.indices.end.min(self.samples) as usize * TILE_PIXELS;
        if tile.len() < end {
            let more = ((end - tile.len()) / TILE_PIXELS) as u64 * Self::TILE_BYTES;
            self.bytes.fetch_add(more, Ordering::Relaxed);
            tile.resize(end, T::default());
        }
        of.each(|place, index| {
            let value = values.next();
            if let Some((kept, value)) = tile.get_mut(kept_at(place, index)).zip(value) {
                *kept = value;
            }
        });
    }

    /// Changes all that is known. On the current rayon pool.
    pub fn change(&self, change: impl Fn(&mut T) + Sync)
    where
        T: Send,
    {
        if self.bytes() > 0 {
            let tiles = self.tiles.par_iter();
            tiles.for_each(|tile| lock(tile).iter_mut().for_each(&change));
        }
    }

    /// Forgets everything.
    pub fn clear(&self) {
        if self.bytes() == 0 {
            return;
        }
        for tile in &self.tiles {
            *lock(tile) = Vec::new();
        }
        self.bytes.store(0, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::sums::tiles::Pixels;
    use glam::UVec2;

    fn in_first_tile(places: &[usize], indices: Range<u64>) -> BatchPlaces<'_> {
        BatchPlaces {
            tile: 0,
            places,
            indices,
            by_place: true,
        }
    }

    #[test]
    fn what_was_written_of_some_pixels_is_read_again_and_nothing_of_others_until_it_is_forgotten() {
        let kept = PerSample::<Option<u32>>::new(&TileGrid::new(UVec2::new(20, 16)));
        let all: Vec<usize> = (0..TILE_PIXELS).collect();
        let half: Vec<usize> = Pixels::Half(1).runs().flatten().collect();
        let values: Vec<_> = (0..2 * TILE_PIXELS as u32).map(Some).collect();
        let read = |places: &[usize], indices: Range<u64>| {
            let mut found = Vec::new();
            kept.read(&in_first_tile(places, indices), |value| found.push(value));
            found
        };
        assert_eq!(read(&all[..4], 0..1), [None; 4]);
        // Two of each pixel, which follow one another.
        let of_half = |place: &usize| [values[*place], values[place + TILE_PIXELS / 2]];
        let two_each: Vec<_> = half[..9].iter().flat_map(of_half).collect();
        kept.write(&in_first_tile(&half[..9], 2..4), two_each.iter().copied());
        assert_eq!(kept.bytes(), 4 * PerSample::<Option<u32>>::TILE_BYTES);
        assert_eq!(read(&half[3..9], 2..4), two_each[6..]);
        let second = half[7..11].iter().take(2).map(|place| of_half(place)[1]);
        let second: Vec<_> = second.chain([None, None]).collect();
        assert_eq!(read(&half[7..11], 3..4), second);
        let known = read(&all, 2..3);
        assert_eq!(known.iter().flatten().count(), 9);
        kept.write(&in_first_tile(&all, 2..3), values.iter().copied());
        assert_eq!(read(&all[17..200], 2..3), values[17..200]);
        kept.clear();
        assert_eq!((read(&all[..3], 2..3), kept.bytes()), (vec![None; 3], 0));
    }

    #[test]
    fn of_a_picture_too_large_for_it_nothing_is_kept() {
        let kept = PerSample::<Option<[u64; 3]>>::new(&TileGrid::new(UVec2::new(4096, 4096)));
        kept.write(&in_first_tile(&[0], 0..2), [Some([5; 3]); 2].into_iter());
        let mut found = Vec::new();
        kept.read(&in_first_tile(&[0], 0..1), |value| found.push(value));
        assert_eq!((kept.bytes(), found), (0, vec![None]));
    }
}

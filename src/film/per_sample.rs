//! What is kept of a picture's samples from edit to edit, tile by tile.
//!
//! Of each pixel's first samples only, as far as there is room: who drags a light sees no more of them.

use super::lock;
use super::tiles::{TILE_PIXELS, TileGrid};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// What all of a picture's samples may take together, in bytes.
const MOST_BYTES: u64 = 1 << 27;

/// Something of each sample; its default where nothing is known.
pub(super) struct PerSample<T> {
    /// Of each tile and each of its samples, one for each place of its memory.
    tiles: Vec<Mutex<Vec<T>>>,
    /// Samples of each pixel for which there is room.
    samples: u64,
    bytes: AtomicU64,
}

/// Places of a chunk, by their numbers in its list, of one sample: a piece of a batch.
pub(super) type Run = (u64, Range<usize>);

/// Where the samples of a batch belong: a tile, places in it, and the runs through those.
#[derive(Clone, Copy)]
pub(super) struct BatchPlaces<'a> {
    pub tile: u32,
    pub places: &'a [usize],
    pub runs: &'a [Run],
}

impl BatchPlaces<'_> {
    /// How many samples they are.
    pub fn count(&self) -> usize {
        self.runs.iter().map(|(_, run)| run.len()).sum()
    }
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
    pub fn read(&self, of: BatchPlaces, mut tell: impl FnMut(T)) {
        let tile = lock(&self.tiles[of.tile as usize]);
        for (index, run) in of.runs {
            let first = *index as usize * TILE_PIXELS;
            let all = tile.get(first..first + TILE_PIXELS);
            for place in &of.places[run.clone()] {
                tell(all.map_or_else(T::default, |all| all[*place]));
            }
        }
    }

    /// Keeps what is known now of each sample of a batch, as far as there is room.
    pub fn write(&self, of: BatchPlaces, mut values: impl Iterator<Item = T>) {
        let mut tile = lock(&self.tiles[of.tile as usize]);
        for (index, run) in of.runs {
            let own = values.by_ref().take(run.len());
            if *index >= self.samples {
                own.for_each(drop);
                continue;
            }
            let first = *index as usize * TILE_PIXELS;
            let end = first + TILE_PIXELS;
            if tile.len() < end {
                let more = ((end - tile.len()) / TILE_PIXELS) as u64 * Self::TILE_BYTES;
                self.bytes.fetch_add(more, Ordering::Relaxed);
                tile.resize(end, T::default());
            }
            for (place, value) in of.places[run.clone()].iter().zip(own) {
                tile[first + *place] = value;
            }
        }
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
    use super::super::tile_state::Pixels;
    use super::*;
    use glam::UVec2;

    fn in_first_tile<'a>(places: &'a [usize], runs: &'a [Run]) -> BatchPlaces<'a> {
        BatchPlaces {
            tile: 0,
            places,
            runs,
        }
    }

    #[test]
    fn what_was_written_of_some_pixels_is_read_again_and_nothing_of_others_until_it_is_forgotten() {
        let kept = PerSample::<Option<u32>>::new(&TileGrid::new(UVec2::new(20, 16)));
        let all: Vec<usize> = (0..TILE_PIXELS).collect();
        let half: Vec<usize> = Pixels::Half(1).runs().flatten().collect();
        let values: Vec<_> = (0..TILE_PIXELS as u32).map(Some).collect();
        let read = |places: &[usize], run: Run| {
            let mut found = Vec::new();
            kept.read(in_first_tile(places, &[run]), |value| found.push(value));
            found
        };
        assert_eq!(read(&all, (0, 0..4)), [None; 4]);
        let of_half: Vec<_> = half.iter().map(|place| values[*place]).collect();
        let runs = [(2, 0..half.len()), (3, 0..9)];
        let values_of_runs = of_half.iter().chain(&of_half[..9]);
        kept.write(in_first_tile(&half, &runs), values_of_runs.copied());
        assert_eq!(kept.bytes(), 4 * PerSample::<Option<u32>>::TILE_BYTES);
        assert_eq!(read(&half, (2, 3..11)), of_half[3..11]);
        assert_eq!(
            read(&half, (3, 7..11)),
            [of_half[7], of_half[8], None, None]
        );
        let known = read(&all, (2, 0..TILE_PIXELS));
        assert_eq!(known.iter().flatten().count(), half.len());
        let whole = [(2, 0..TILE_PIXELS)];
        kept.write(in_first_tile(&all, &whole), values.iter().copied());
        assert_eq!(read(&all, (2, 17..200)), values[17..200]);
        kept.clear();
        assert_eq!((read(&all, (2, 0..3)), kept.bytes()), (vec![None; 3], 0));
    }

    #[test]
    fn of_a_picture_too_large_for_it_nothing_is_kept() {
        let kept = PerSample::<Option<[u64; 3]>>::new(&TileGrid::new(UVec2::new(4096, 4096)));
        let runs = [(0, 0..1), (1, 0..1)];
        kept.write(in_first_tile(&[0], &runs), [Some([5; 3]); 2].into_iter());
        let mut found = Vec::new();
        kept.read(in_first_tile(&[0], &runs[..1]), |value| found.push(value));
        assert_eq!((kept.bytes(), found), (0, vec![None]));
    }
}

//! Chunks that wait, those nearest the focus first.

use crate::film::planes::tile_state::Chunk;
use crate::film::sums::tiles::{TILE_PIXELS, TileGrid};
use glam::Vec2;
use std::cmp::Reverse;

/// Chunks that wait for a thread.
#[derive(Default)]
pub(super) struct Queue {
    /// Farthest first, so that the nearest is popped.
    chunks: Vec<Chunk>,
    focus: Vec2,
    sorted: bool,
}

impl Queue {
    /// Pixels that should come first are near `focus`, in pixels.
    pub fn set_focus(&mut self, focus: Vec2) {
        if self.focus != focus {
            self.focus = focus;
            self.sorted = false;
        }
    }

    pub fn focus(&self) -> Vec2 {
        self.focus
    }

    /// Adds a chunk.
    pub fn push(&mut self, chunk: Chunk) {
        self.chunks.push(chunk);
        self.sorted = false;
    }

    /// The chunks to do next are added to `some`: more than one where they are no more than so many samples together.
    pub fn pop(&mut self, grid: &TileGrid, samples: u64, some: &mut Vec<Chunk>) {
        if !self.sorted {
            let focus = self.focus;
            self.chunks.sort_by_cached_key(|chunk| {
                let distance = grid.tile(chunk.tile).center().distance_squared(focus);
                // Not negative, so its bits are ordered as it is.
                Reverse((distance.to_bits(), chunk.tile, chunk.range.start))
            });
            self.sorted = true;
        }
        let mut left = samples;
        while let Some(chunk) = self.chunks.last() {
            let takes = (chunk.range.end - chunk.range.start) * TILE_PIXELS as u64;
            if takes > left && !some.is_empty() {
                break;
            }
            left = left.saturating_sub(takes);
            some.extend(self.chunks.pop());
        }
    }

    /// Nothing waits any more.
    pub fn clear(&mut self) {
        self.chunks.clear();
    }

    pub fn len(&self) -> usize {
        self.chunks.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::sums::tiles::Pixels;
    use crate::trace::PlaneSet;
    use glam::UVec2;

    /// Four tiles, of which each waits for one sample of each pixel.
    fn queue() -> (TileGrid, Queue) {
        let mut queue = Queue::default();
        for tile in 0..4 {
            queue.push(Chunk {
                tile,
                pixels: Pixels::All,
                planes: PlaneSet::ALL,
                range: 0..1,
                of: 1,
            });
        }
        (TileGrid::new(UVec2::new(64, 16)), queue)
    }

    /// The tiles that come next.
    fn next(queue: &mut Queue, grid: &TileGrid, samples: u64) -> Vec<u32> {
        let mut some = Vec::new();
        queue.pop(grid, samples, &mut some);
        some.iter().map(|chunk| chunk.tile).collect()
    }

    #[test]
    fn tiles_come_nearest_the_focus_first_and_a_new_focus_reorders_what_waits() {
        let (grid, mut queue) = queue();
        queue.set_focus(Vec2::new(30.0, 8.0));
        assert_eq!(next(&mut queue, &grid, 1), [1]);
        assert_eq!(next(&mut queue, &grid, 1), [2]);
        queue.set_focus(Vec2::new(64.0, 0.0));
        assert_eq!(next(&mut queue, &grid, 1), [3]);
        assert_eq!(next(&mut queue, &grid, 1), [0]);
        assert_eq!(queue.len(), 0);
    }

    #[test]
    fn small_chunks_come_together_and_a_large_one_alone() {
        let (grid, mut queue) = queue();
        let samples = TILE_PIXELS as u64;
        assert_eq!(next(&mut queue, &grid, 3 * samples), [0, 1, 2]);
        assert_eq!(next(&mut queue, &grid, 3 * samples), [3]);
        assert!(next(&mut queue, &grid, 3 * samples).is_empty());
        let (_, mut queue) = self::queue();
        assert_eq!(next(&mut queue, &grid, samples - 1), [0]);
        assert_eq!(next(&mut queue, &grid, 2 * samples - 1), [1]);
    }
}

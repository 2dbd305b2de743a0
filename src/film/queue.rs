//! Chunks that wait, those nearest the focus first.

use super::tile_state::Chunk;
use super::tiles::TileGrid;
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

    /// The chunk to do next.
    pub fn pop(&mut self, grid: &TileGrid) -> Option<Chunk> {
        if !self.sorted {
            let focus = self.focus;
            self.chunks.sort_by_cached_key(|chunk| {
                let distance = grid.tile(chunk.tile).center().distance_squared(focus);
                // Not negative, so its bits are ordered as it is.
                Reverse((distance.to_bits(), chunk.tile, chunk.range.start))
            });
            self.sorted = true;
        }
        self.chunks.pop()
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
    use super::super::tile_state::Pixels;
    use super::*;
    use crate::trace::PlaneSet;
    use glam::UVec2;

    #[test]
    fn tiles_come_nearest_the_focus_first_and_a_new_focus_reorders_what_waits() {
        let grid = TileGrid::new(UVec2::new(64, 16));
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
        queue.set_focus(Vec2::new(30.0, 8.0));
        let mut next = || queue.pop(&grid).map(|chunk| chunk.tile);
        assert_eq!(next(), Some(1));
        assert_eq!(next(), Some(2));
        queue.set_focus(Vec2::new(64.0, 0.0));
        let rest: Vec<_> =
            std::iter::from_fn(|| queue.pop(&grid).map(|chunk| chunk.tile)).collect();
        assert_eq!(rest, [3, 0]);
        assert_eq!(queue.len(), 0);
    }
}

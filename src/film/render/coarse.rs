//! How a render begins that someone looks at, and goes on after an edit that takes a while: with coarse pictures, each finer
//! than the one before.

use super::engine::Engine;
use super::preview::{Preview, first_divider, lattice, lattice_squares, time_samples};
use super::status::Ending;
use crate::film::samples::sample_chunk::with_scratch;
use crate::film::sums::tiles::TileGrid;
use crate::film::{TILE, lock};
use crate::trace::{PlaneSet, SampleId};
use bevy::math::URect;
use glam::UVec2;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Engine {
    /// The coarse pictures, as far as they come before the one of full resolution.
    pub fn start_coarse(&self) -> Option<Ending> {
        let area = self.area;
        let (preview, seconds) = self.begin_preview();
        let unlit = Unlit::of(self);
        let mut divider = first_divider(area.extent, unlit.part() * seconds);
        // Its samples are not kept: a lattice of every second pixel would take a quarter of the time that they all do.
        while divider > 2 {
            preview.begin(divider);
            let shows = unlit.around(divider);
            let mut squares = lattice_squares(area.extent, divider);
            while !squares.is_empty() {
                // Those that were not done when a pause came, or the turn of another render, are tried again; what
                // they had is kept.
                squares = self.on_threads(|turn| {
                    let squares = squares.into_par_iter().with_max_len(1);
                    let left = squares.filter(|square| {
                        turn.is_over() || !self.preview_square(&preview, *square, divider, &shows)
                    });
                    left.collect()
                });
                if let Some(ending) = self.interrupted() {
                    return Some(ending);
                }
                if self.edit_waits.load(Ordering::Relaxed) {
                    // What comes next is another picture.
                    return None;
                }
            }
            self.set_divider(divider);
            divider /= 2;
        }
        None
    }

    /// A preview that is seen from now on, and the seconds that a sample takes on all threads together.
    fn begin_preview(&self) -> (Arc<Preview>, f64) {
        loop {
            let number = self.number();
            let subject = self.subject();
            let focus = lock(&self.queue).focus();
            let preview = Arc::new(Preview::new(self.area));
            let seconds = self.on_threads(|_| {
                let stopped = || self.must_stop();
                let timed = time_samples(&subject, &preview, focus, &self.batch, &stopped);
                timed / rayon::current_num_threads() as f64
            });
            let mut seen = lock(&self.preview);
            // Tints may have changed before it was there for all to see.
            if self.number() == number {
                *seen = Some(preview.clone());
                return (preview, seconds);
            }
        }
    }

    /// Evaluates what is not known yet of a square of the lattice, where it shows. False where it had to stop.
    fn preview_square(
        &self,
        preview: &Preview,
        square: UVec2,
        divider: u32,
        shows: &[bool],
    ) -> bool {
        let pixels: Vec<_> = lattice(self.area, square, TILE, divider)
            .filter(|pixel| shows[self.grid.tile_of(*pixel)] && preview.get(*pixel).is_none())
            .collect();
        let subject = self.subject();
        let mut rest = &pixels[..];
        while !rest.is_empty() {
            if self.must_stop() {
                return false;
            }
            let (some, others) = rest.split_at(self.batch.get().min(rest.len()));
            rest = others;
            let is_done = with_scratch(|scratch| {
                let ids = some.iter().map(|&pixel| SampleId { pixel, index: 0 });
                let stopped = || self.must_stop();
                let taken = scratch.evaluate(&subject, PlaneSet::ALL, ids, &self.batch, &stopped);
                if taken.is_some() {
                    preview.take(some, scratch.folded());
                }
                taken.is_some()
            });
            if !is_done {
                return false;
            }
        }
        true
    }

    /// There is one from the first samples on until every pixel has one.
    pub fn preview(&self) -> Option<Arc<Preview>> {
        lock(&self.preview).clone()
    }
}

/// The tiles that have no picture of their own yet, or lack light: all of them at first, and after an edit of a material those
/// where it was seen.
struct Unlit {
    grid: TileGrid,
    /// Of each tile.
    is_unlit: Vec<bool>,
    rendered: usize,
}

impl Unlit {
    fn of(engine: &Engine) -> Self {
        let mut is_unlit = vec![false; engine.tiles.len()];
        for tile in engine.rendered.iter().map(|tile| *tile as usize) {
            is_unlit[tile] = lock(&engine.tiles[tile]).lacks_light();
        }
        Self {
            grid: engine.grid,
            is_unlit,
            rendered: engine.rendered.len(),
        }
    }

    /// Which part of those that are rendered.
    fn part(&self) -> f64 {
        let count = self.is_unlit.iter().filter(|is_unlit| **is_unlit).count();
        count as f64 / self.rendered.max(1) as f64
    }

    /// Of each tile whether pixels in it of a lattice of this divider show there, or in one of those: what lies between
    /// two of the lattice's pixels shows both.
    fn around(&self, divider: u32) -> Vec<bool> {
        let reach = UVec2::splat(divider);
        let mut shows = vec![false; self.is_unlit.len()];
        for (tile, _) in self.grid.tiles().zip(&self.is_unlit).filter(|(_, is)| **is) {
            let around = URect {
                min: tile.origin.saturating_sub(reach),
                max: tile.origin + tile.extent + reach,
            };
            for row in self.grid.rows_within(around) {
                shows[row.start as usize..row.end as usize].fill(true);
            }
        }
        shows
    }
}

#[cfg(test)]
mod tests {
    use super::super::engine::Mode;
    use super::*;
    use crate::film::subject::Subject;
    use crate::film::test_scene::{camera, lit, repainted, settings};
    use crate::trace::Gains;
    use glam::Vec3;

    #[test]
    fn a_coarse_picture_after_an_edit_is_of_the_tiles_that_lack_light_and_of_their_neighbours() {
        let mode = Mode {
            watched: true,
            samples: 0..1,
            region: None,
        };
        let size = UVec2::new(200, 120);
        let world = lit();
        let subject = Subject::new(world.clone(), camera(), settings(size, 1), true);
        let engine = Engine::new(subject, mode, None);
        assert_eq!(Unlit::of(&engine).part(), 1.0);
        engine.run(&|_| {});
        assert_eq!(Unlit::of(&engine).part(), 0.0);
        assert!(engine.edit(repainted(&world, 1, Vec3::X), &Gains::default()));
        engine.take_edit();
        let unlit = Unlit::of(&engine);
        let part = unlit.part();
        assert!(part > 0.0 && part < 0.7, "{part}");
        let preview = Preview::new(engine.area);
        preview.begin(4);
        let shows = unlit.around(4);
        for square in lattice_squares(size, 4) {
            assert!(engine.preview_square(&preview, square, 4, &shows));
        }
        let mut left_out = 0;
        for pixel in lattice(engine.area, UVec2::ZERO, u32::MAX, 4) {
            let lacks = |at: UVec2| unlit.is_unlit[engine.grid.tile_of(at.min(size - 1))];
            let near = [pixel.saturating_sub(UVec2::splat(4)), pixel, pixel + 4].map(lacks);
            let is_known = preview.get(pixel).is_some();
            assert!(is_known || near == [false; 3], "{pixel}");
            left_out += u32::from(!is_known);
        }
        assert!(left_out > 100, "{left_out}");
    }
}

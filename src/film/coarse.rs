//! How a render begins that someone looks at: with coarse pictures, each finer than the one before.

use super::engine::Engine;
use super::preview::{Preview, first_divider, lattice, lattice_squares, time_samples};
use super::sample_chunk::with_scratch;
use super::tile_state::TILE_PIXELS;
use super::tiles::Tile;
use super::{Ending, TILE, lock};
use crate::trace::SampleId;
use glam::{UVec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

impl Engine {
    /// The coarse pictures, as far as they come before the one of full resolution.
    pub fn start_coarse(&self) -> Option<Ending> {
        let area = self.area;
        let focus = lock(&self.queue).focus();
        let preview = Arc::new(Preview::new(area));
        let ((seconds, rays), threads) = self.on_threads(|| {
            let timed = time_samples(&self.subject, &preview, focus, &self.batch);
            (timed, rayon::current_num_threads())
        });
        let coarsest = first_divider(area.extent, seconds / threads as f64);
        self.note_rays(rays);
        *lock(&self.preview) = Some(preview.clone());
        let mut divider = coarsest;
        while divider > 1 {
            preview.begin(divider);
            let mut squares = lattice_squares(area.extent, divider);
            while !squares.is_empty() {
                // Those that were not done when a pause came are tried again; what they had is kept.
                squares = self.on_threads(|| {
                    let squares = squares.into_par_iter().with_max_len(1);
                    let left =
                        squares.filter(|square| !self.preview_square(&preview, *square, divider));
                    left.collect()
                });
                if let Some(ending) = self.interrupted() {
                    return Some(ending);
                }
            }
            self.set_divider(divider);
            divider /= 2;
        }
        None
    }

    /// Evaluates what is not known yet of a square of the lattice. False where it had to stop.
    fn preview_square(&self, preview: &Preview, square: UVec2, divider: u32) -> bool {
        let pixels: Vec<_> = lattice(self.area, square, TILE, divider)
            .filter(|pixel| preview.get(*pixel).is_none())
            .collect();
        let mut rest = &pixels[..];
        while !rest.is_empty() {
            if self.must_stop() {
                return false;
            }
            let (some, others) = rest.split_at(self.batch.get().min(rest.len()));
            rest = others;
            let rays = with_scratch(|scratch| {
                let ids = some.iter().map(|&pixel| SampleId { pixel, index: 0 });
                let rays = scratch.evaluate(&self.subject, ids, &self.batch);
                preview.take(some, scratch.values());
                if scratch.is_near_lamps() {
                    preview.meet_near_lamps();
                }
                rays
            });
            self.note_rays(rays);
        }
        true
    }

    /// There is one from the first samples on until every pixel has one.
    pub fn preview(&self) -> Option<Arc<Preview>> {
        lock(&self.preview).clone()
    }

    /// First samples of the tile's pixels that the preview has.
    pub fn known(&self, tile: Tile) -> Vec<Option<Vec3>> {
        let sampling = &self.subject.settings.sampling;
        if sampling.adaptive && sampling.error > 0.0 {
            // Where samples go depends on what they cost, and must not depend on how far a preview came.
            return Vec::new();
        }
        let Some(preview) = self.preview().filter(|preview| preview.is_enough()) else {
            return Vec::new();
        };
        let mut known = vec![None; TILE_PIXELS];
        for (pixel, at) in tile.pixels() {
            known[at] = preview.get(pixel);
        }
        known
    }
}

//! How a render begins that someone looks at, and goes on after an edit that takes a while: with coarse pictures, each finer
//! than the one before.

use super::engine::Engine;
use super::preview::{Preview, first_divider, lattice, lattice_squares, time_samples};
use super::sample_chunk::with_scratch;
use super::{Ending, TILE, lock};
use crate::trace::{PlaneSet, SampleId};
use glam::UVec2;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::Ordering;

impl Engine {
    /// The coarse pictures, as far as they come before the one of full resolution.
    pub fn start_coarse(&self) -> Option<Ending> {
        let area = self.area;
        let subject = self.subject();
        let focus = lock(&self.queue).focus();
        let preview = Arc::new(Preview::new(area));
        let (seconds, threads) = self.on_threads(|_| {
            let stopped = || self.must_stop();
            let timed = time_samples(&subject, &preview, focus, &self.batch, &stopped);
            (timed, rayon::current_num_threads())
        });
        let coarsest = first_divider(area.extent, seconds / threads as f64);
        *lock(&self.preview) = Some(preview.clone());
        let mut divider = coarsest;
        // Its samples are not kept: a lattice of every second pixel would take a quarter of the time that they all do.
        while divider > 2 {
            preview.begin(divider);
            let mut squares = lattice_squares(area.extent, divider);
            while !squares.is_empty() {
                // Those that were not done when a pause came, or the turn of another render, are tried again; what
                // they had is kept.
                squares = self.on_threads(|turn| {
                    let squares = squares.into_par_iter().with_max_len(1);
                    let left = squares.filter(|square| {
                        turn.is_over() || !self.preview_square(&preview, *square, divider)
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

    /// Evaluates what is not known yet of a square of the lattice. False where it had to stop.
    fn preview_square(&self, preview: &Preview, square: UVec2, divider: u32) -> bool {
        let pixels: Vec<_> = lattice(self.area, square, TILE, divider)
            .filter(|pixel| preview.get(*pixel).is_none())
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

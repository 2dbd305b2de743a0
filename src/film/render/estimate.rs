//! How far a render is from the converged picture, as its tiles tell.

use super::engine::Engine;
use crate::film::errors::error::{ErrorEstimate, Moves};
use rayon::prelude::*;

impl Engine {
    /// How far the film is from the converged one; `None` before there is anything to compare.
    pub fn error(&self) -> Option<ErrorEstimate> {
        self.error_of(&self.moves())
    }

    /// The same, from how far the halves of its tiles moved.
    pub(super) fn error_of(&self, moves: &[Moves]) -> Option<ErrorEstimate> {
        if self.mode.samples.start > 0 || self.samples() < 2.0 {
            return None;
        }
        let measured = ErrorEstimate::of(moves, 0.0)?;
        if measured.relative_mse > 0.0 {
            return Some(measured);
        }
        // Samples that all agree say no more than what none of them has met.
        ErrorEstimate::of(moves, self.unmet.hidden(&self.subject(), 1))
    }

    /// The squared error that unmet features may leave in a pixel, per reach of a sample, if they lie in all
    /// alike; 0 where samples differ anywhere, and so say more themselves.
    pub fn hidden_in_a_pixel(&self) -> f64 {
        self.hidden_with(self.error())
    }

    /// The same, where the picture has this error.
    pub(super) fn hidden_with(&self, error: Option<ErrorEstimate>) -> f64 {
        match error {
            Some(error) if error.is_bound => {
                self.unmet.hidden(&self.subject(), 1) / self.pixels().max(1.0)
            }
            _ => 0.0,
        }
    }

    /// Works out on all threads how far the tiles moved that have other tints.
    pub(in crate::film) fn update_moves(&self) {
        let subject = self.subject();
        let tiles = (0..self.tiles.len()).into_par_iter();
        self.on_threads(|_| tiles.for_each(|tile| _ = self.tile_of(&subject, tile).moves()));
    }

    /// Of each half of each tile.
    pub(in crate::film) fn moves(&self) -> Vec<Moves> {
        let subject = self.subject();
        (0..self.tiles.len())
            .flat_map(|tile| self.tile_of(&subject, tile).moves())
            .collect()
    }
}

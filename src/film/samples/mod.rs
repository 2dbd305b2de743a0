//! Samples evaluated, tile by tile, and what is kept of them.
//!
//! [`sample_chunk`] evaluates a chunk of them, batch by batch. [`kept`] has what is known of them from edit to edit, in the memory
//! of [`per_sample`]; [`voids`] are tiles of which all is known without a ray. [`first_hits`] and [`depth`] are pictures of
//! what camera rays meet, for views and files.

mod depth;
mod first_hits;
pub(super) mod kept;
mod per_sample;
pub(super) mod sample_chunk;
pub(super) mod voids;

pub use depth::depths;
pub use first_hits::FirstHits;

//! Questions to an aggregate, answered by the walk of [`wide`](super::kernel::wide).
//!
//! [`queries`], [`multi_hit`] and [`transmit`] are the questions. [`levels`] are the ways in which an aggregate is arranged, [`leaves`]
//! what its leaves hold. [`tree_ray`] is a ray as walks ask for it, [`batch`] many made ready at once, [`packets`] many that walk
//! together. [`crossing`] are triangles that report one crossing.

mod batch;
mod crossing;
mod leaves;
pub(super) mod levels;
mod multi_hit;
mod packets;
pub(super) mod queries;
mod transmit;
mod tree_ray;

pub use multi_hit::MultiHit;
pub use transmit::Transmittances;

//! How far a picture is from the converged one, read from its sums.
//!
//! [`past_moves`] and [`means`] tell how far the means of a tile's pixels moved, [`error`] what follows for the picture, [`unmet`]
//! what may hide where no sample has met it.

pub(super) mod error;
pub(super) mod means;
pub(super) mod past_moves;
pub(super) mod unmet;

pub use error::{ErrorEstimate, RELATIVE_FLOOR};

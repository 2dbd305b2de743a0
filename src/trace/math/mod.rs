//! Arithmetic in columns: what several stages and lights compute with, and knows nothing of them.
//!
//! [`vectors`] are columns of vectors, [`polynomials`] functions that vectorise, [`piecewise`] chooses by densities that are
//! linear between nodes, [`disc`] on discs.

pub(super) mod disc;
pub(super) mod piecewise;
pub(super) mod polynomials;
pub(super) mod vectors;

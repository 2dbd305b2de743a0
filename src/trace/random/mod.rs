//! The random numbers of samples: each follows from pixel, index, seed and purpose alone.
//!
//! [`sampler`] gives them one by one, [`numbers`] those of a batch in columns, both from the sequence of [`sobol`].

pub(super) mod numbers;
pub(super) mod sampler;
mod sobol;

pub use sampler::{Purpose, SampleId, Sampler};

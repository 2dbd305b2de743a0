//! From a linear picture to a screen's.
//!
//! [`bloom`] lets what is bright glow, by the blur of [`gaussian`]; [`view_transform`] and [`agx`] bring what is left into a screen's
//! range, [`eight_bits`] into its bytes, many times a second.

mod agx;
mod bloom;
mod eight_bits;
mod gaussian;
mod view_transform;

pub use agx::agx;
pub use bloom::{bloom_layer, bloom_threshold, with_bloom};
pub use eight_bits::develop_rgba8;
pub use gaussian::{MAX_SIGMA, blurred, kernel};
pub use view_transform::{develop, view_transform};

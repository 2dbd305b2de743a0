//! Pixels over time: samples become a picture, a picture becomes a screen's.
//!
//! A [`Film`] keeps, for every pixel, the exact sum of its samples ([`Sum`]) and their number. Sums
//! are exact, so they do not depend on the order in which samples arrive: the same picture for any
//! number of threads, any order of tiles, any pause, any merge.
//!
//! Nothing here traces a ray but [`render`](render()), which hands tiles of samples to
//! [`trace::radiance`](crate::trace::radiance()).

mod agx;
mod bloom;
mod gaussian;
mod picture;
mod render;
mod sum;
mod tiles;
mod view_transform;

pub use agx::agx;
pub use bloom::{BloomError, bloom_layer, bloom_threshold, check_bloom, with_bloom};
pub use gaussian::{MAX_SIGMA, blurred, kernel};
pub use picture::Picture;
pub use render::{Rendered, render};
pub use sum::Sum;
pub use tiles::{Film, TILE};
pub use view_transform::{develop, view_transform};

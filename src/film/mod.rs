//! Pixels over time: samples become a picture, a picture becomes a screen's.
//!
//! ```text
//! sums ── errors ── planes ── samples ── render      develop, views
//! ```
//! `sums` are exact, pixel by pixel; `errors` are read from how their means move; `planes` keep a tile's light apart;
//! `samples` evaluates them, chunk by chunk; `render` does so pass by pass. Each uses those left of it. `develop` and
//! [`views`] make a screen's picture of what is there. All are given a `subject`: a world, seen in some way.
//!
//! A [`Film`] keeps, for every pixel, the exact sum of its samples ([`Sum`]) and their number. Sums
//! are exact, so they do not depend on the order in which samples arrive: the same picture for any
//! number of threads, any order of tiles, any pause, any merge.
//!
//! A render adds samples pass by pass: each pass doubles them, so that what has been rendered is a
//! picture at any time, and so that each pass tells by how much the picture still moves, from which
//! [`ErrorEstimate`] follows. A pass goes tile by tile. [`render()`] does it at once, [`Progressive`]
//! on a thread of its own.
//!
//! A file adds up whole samples. A view sums light by light, each without its tint ([`Planes`](crate::trace::Planes)), so
//! that [`Progressive::edit`] has another tint for nothing and traces a light that moved alone. Its picture is the file's but
//! for the rounding of f32.
//!
//! Nothing here traces a ray but those two, which hand batches of samples to
//! [`trace::radiance`](crate::trace::radiance()), [`FirstHits::trace`] and [`depths()`]. Bloom,
//! exposure, view transforms and [`views`] read what was traced.

mod develop;
mod errors;
mod light_mix;
mod picture;
mod planes;
mod render;
mod samples;
mod subject;
mod sums;
#[cfg(test)]
mod test_scene;
pub mod views;

pub use develop::{
    MAX_SIGMA, agx, bloom_layer, bloom_threshold, blurred, develop, develop_rgba8, kernel,
    view_transform, with_bloom,
};
pub use errors::{ErrorEstimate, RELATIVE_FLOOR};
pub use light_mix::{FilmMemory, LightMix};
pub use picture::Picture;
pub use planes::{Film, PixelError};
pub use render::{
    Before, Ending, LightPicture, LightPictures, Progressive, Rendered, Snapshot, State, Status,
    TrendPoint, duration_text, render, render_lights, render_samples, render_while,
};
pub use samples::{FirstHits, depths};
pub use sums::{Sum, TILE};

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a mutex guards, even where another thread has panicked: a bug there is reported there.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

//! Pixels over time: samples become a picture, a picture becomes a screen's.
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

mod adaptive;
mod agx;
mod bloom;
mod coarse;
mod control;
mod depth;
mod edit;
mod eight_bits;
mod engine;
mod error;
mod estimate;
mod first_hits;
mod fixed_point;
mod gaussian;
mod kept;
mod light_mix;
mod light_pictures;
mod means;
mod passes;
mod past_moves;
mod per_pixel;
mod per_sample;
mod picture;
mod plane_sums;
mod pool;
mod preview;
mod progressive;
mod queue;
mod render;
mod sample_chunk;
mod snapshot;
mod status;
mod subject;
mod sum;
mod sum_columns;
#[cfg(test)]
mod test_scene;
mod tile_planes;
mod tile_state;
mod tiled_film;
mod tiles;
mod unmet;
mod view_transform;
pub mod views;
mod voids;
mod work;

pub use agx::agx;
pub use bloom::{bloom_layer, bloom_threshold, with_bloom};
pub use depth::depths;
pub use eight_bits::develop_rgba8;
pub use error::{ErrorEstimate, RELATIVE_FLOOR};
pub use first_hits::FirstHits;
pub use gaussian::{MAX_SIGMA, blurred, kernel};
pub use light_mix::{FilmMemory, LightMix};
pub use light_pictures::{LightPicture, LightPictures, render_lights};
pub use per_pixel::PixelError;
pub use picture::Picture;
pub use progressive::Progressive;
pub use render::{Rendered, render, render_samples, render_while};
pub use snapshot::Snapshot;
pub use status::{Before, Ending, State, Status, TrendPoint, duration_text};
pub use sum::Sum;
pub use tiled_film::Film;
pub use tiles::TILE;
pub use view_transform::{develop, view_transform};

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a mutex guards, even where another thread has panicked: a bug there is reported there.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

//! A render: passes of samples over all tiles, until a rule, a cancel or an edit stops it.
//!
//! [`engine`] has what it reads and what it has, [`status`] what it says of itself. [`passes`] and [`adaptive`] choose the next
//! samples, [`estimate`] tells when they are enough, [`queue`] orders their chunks, [`work`] does them on all threads,
//! [`control`] stops and pauses it.
//! [`at_once`] and [`light_pictures`] render to the end. [`progressive`] is for those who look on, on the threads of [`pool`]:
//! [`coarse`] and [`preview`] come first, [`snapshot`] is the picture so far, [`edit`] keeps what of it stays true.

mod adaptive;
mod at_once;
mod coarse;
mod control;
mod edit;
mod engine;
mod estimate;
mod light_pictures;
mod passes;
mod pool;
mod preview;
mod progressive;
mod queue;
mod snapshot;
mod status;
mod work;

pub use at_once::{Rendered, render, render_samples, render_while};
pub use light_pictures::{LightPicture, LightPictures, render_lights};
pub use progressive::Progressive;
pub use snapshot::Snapshot;
pub use status::{Before, Ending, State, Status, TrendPoint, duration_text};

//! The stages of a batch of samples: functions from columns to columns, in the order of [`radiance`].
//!
//! [`camera_rays`] makes rays, [`nearest`] finds what they hit, [`vertices`] what it is made of. [`direct`] goes from light to light:
//! [`questions`] are what vertices ask, [`light_columns`] the points they are given, [`replies`] what they reflect of them,
//! [`shadow_rays`] what is on its way there. [`scatter`] makes the next [`paths`]. [`known`] is what needs no ray, from
//! [`second_hits`] and [`visibility`]. [`recorder`] watches, [`ray_counts`] counts.

pub(super) mod camera_rays;
mod direct;
mod known;
mod light_columns;
mod nearest;
pub(super) mod paths;
mod questions;
pub(super) mod radiance;
mod ray_counts;
pub(super) mod recorder;
mod replies;
pub(super) mod scatter;
mod second_hits;
pub(super) mod shadow_rays;
pub(super) mod vertices;
mod visibility;

pub use known::Known;
pub use radiance::{Workspace, radiance, radiance_in_planes};
pub use ray_counts::RayCounts;
pub use second_hits::SecondHit;
pub use visibility::{Visibility, other_points};

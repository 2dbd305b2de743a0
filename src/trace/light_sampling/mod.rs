//! Points of lights, chosen for the surface that sees them, and lights as rays meet them.
//!
//! [`lamp`] is a light of any kind. [`segment_warp`], [`parallelogram_warp`] (in the axes of [`parallelogram_frame`]) and [`dome`]
//! choose places by what they give a surface ([`receiver`]); [`light_frames`] keeps what is known of each light for that.
//! [`faint`] leaves some of many lights to chance, [`visible_lights`] finds those that rays meet; [`planes`] keeps their light
//! apart, [`gains`] multiplies it.

mod dome;
pub(super) mod faint;
mod gains;
pub(super) mod lamp;
pub(super) mod light_frames;
pub(super) mod parallelogram_frame;
pub(super) mod parallelogram_warp;
pub mod planes;
pub(super) mod receiver;
pub(super) mod segment_warp;
pub(super) mod visible_lights;

pub use dome::{DOME, Dome};
pub use faint::FEW as FEW_LIGHTS;
pub use gains::Gains;
pub use lamp::{Lamp, LightKind};
pub use parallelogram_frame::ParallelogramFrame;
pub use parallelogram_warp::Places;
pub use planes::{PlaneSet, Planes, Untinted};
pub use receiver::Receivers;
pub use segment_warp::{SegmentFrame, SegmentPlaces};

//! What is asked of a scene besides the value of samples.
//!
//! Before a picture: [`in_view`], where anything may be seen; [`emitters`], what may shine unmet; [`crossings`], whether rays pass
//! many surfaces. Of single rays: [`first_hit`], what the camera meets; [`probe`], samples evaluated again; a
//! [`recording`] of them becomes a [`ray_tree`].

mod crossings;
mod emitters;
mod first_hit;
mod in_view;
mod probe;
mod ray_tree;
mod recording;

pub use crossings::Crossings;
pub use emitters::emitters;
pub use first_hit::{FirstHit, central_hits, central_ray, first_hits, first_surface};
pub use in_view::in_view;
pub use probe::{MOST_RAYS, ProbeError, Samples, probe, probe_while};
pub use ray_tree::{
    Crossing, LightSample, ProbedSample, RayCost, RayEnd, RayHit, RayKind, RayTree, TracedRay,
};

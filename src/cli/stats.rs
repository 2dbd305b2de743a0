//! `--stats`: what a rendering took, as one JSON object.

use crate::trace::{RayCounts, World};
use serde::Serialize;

/// What a rendering took. With several cameras rays and times are those of all pictures together.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Stats {
    /// The scene as the command line named it.
    pub scene: String,
    /// Of all objects: a mesh that two objects share counts twice.
    pub triangles: u64,
    /// Objects that are traced.
    pub instances: u64,
    pub width: u32,
    pub height: u32,
    /// Samples of each pixel.
    pub spp: u32,
    /// The largest estimated relative error of the pictures; none with one sample.
    pub relative_error: Option<f64>,
    /// Whether that is an upper bound, of what features may hide that no sample has met.
    pub relative_error_is_bound: bool,
    pub threads: usize,
    pub builder: &'static str,
    /// Milliseconds of tree building: every mesh and the tree over them, added up.
    pub build_ms: f64,
    /// Milliseconds of rendering, wall clock.
    pub render_ms: f64,
    pub rays: RayCounts,
    /// Million rays of every kind a second.
    pub mrays_per_s: f64,
}

/// Triangles of all objects.
pub(super) fn triangles(world: &World) -> u64 {
    world
        .objects
        .iter()
        .map(|object| object.mesh.tree.triangles().len() as u64)
        .sum()
}

/// Million rays a second.
pub(super) fn mrays_per_second(rays: u64, seconds: f64) -> f64 {
    if seconds > 0.0 {
        rays as f64 / seconds / 1e6
    } else {
        0.0
    }
}

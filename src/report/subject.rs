//! What is measured: a scene as the tracer has it.

use crate::inspect::corners;
use crate::scene::RenderSettings;
use crate::trace::{Camera, World};
use glam::Vec3;
use std::sync::Arc;

/// A scene, from one camera.
#[derive(Clone)]
pub struct Subject {
    /// What it is called.
    pub name: String,
    /// What rays read.
    pub world: Arc<World>,
    /// Where they come from.
    pub camera: Camera,
    /// How they are traced.
    pub settings: RenderSettings,
}

impl Subject {
    /// Its name as a part of a file's name.
    pub(super) fn file(&self) -> String {
        let fit = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
        self.name.chars().map(fit).collect()
    }

    /// Corners of all its triangles that are traced, in world space, as they stand at time 0.
    pub(super) fn triangles(&self) -> Vec<[Vec3; 3]> {
        corners(&self.world)
    }
}

//! This room's triangle test by itself, for whoever walks another tree with it.

use glam::Vec3;

use crate::bvh::{
    Ray,
    mesh_tree::ObjectRay,
    safe_ray::SafeRay,
    triangle::{Crossing, LeafTriangle, Shear, cross},
};

/// A ray that is ready for [`SingleTriangle::cross`].
pub(crate) struct ReadyRay {
    ray: ObjectRay,
    shear: Shear,
}

impl ReadyRay {
    /// `None` where the ray misses whatever there is. Its direction is of ordinary length: `t` is not rescaled.
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        let ray = SafeRay::new(ray)?.world;
        let shear = Shear::new(ray.origin, ray.direction);
        Some(Self { ray, shear })
    }
}

/// A triangle as a leaf holds it.
pub(crate) struct SingleTriangle(LeafTriangle);

impl SingleTriangle {
    pub(crate) fn new(corners: [Vec3; 3]) -> Self {
        Self(LeafTriangle::new(corners, 0))
    }

    /// `t` and the weights of corners 1 and 2, where the line of the ray crosses the triangle before `limit`.
    #[inline(always)]
    pub(crate) fn cross(&self, ready: &ReadyRay, limit: f32) -> Option<(f32, f32, f32)> {
        let crossing = cross(&ready.shear, &ready.ray.slab, &self.0, limit);
        crossing.map(|Crossing { t, u, v }| (t, u, v))
    }
}

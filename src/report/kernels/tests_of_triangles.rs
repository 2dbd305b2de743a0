//! Triangle tests that can be put into any traversal.

use crate::bvh::Ray;
use crate::bvh::hard_cases::single::{ReadyRay, SingleTriangle};
use glam::Vec3;
use obvhs::ray::Ray as ObvhsRay;
use obvhs::rt_triangle::RtTriangle;

/// A triangle that is ready to be tested.
pub(super) trait TriangleTest {
    /// A ray that is ready for it.
    type Ready;

    /// Made once.
    fn new(corners: [Vec3; 3]) -> Self;

    /// Made for each ray; `None` where it can hit nothing.
    fn ready(ray: &Ray) -> Option<Self::Ready>;

    /// `t` of a hit with 0 < t < limit, or infinity. `walked` is the same ray as obvhs has it.
    fn cross(&self, ready: &Self::Ready, walked: &ObvhsRay, limit: f32) -> f32;

    /// Weights of corners 1 and 2 of the hit that [`Self::cross`] found.
    fn weights(&self, ready: &Self::Ready, walked: &ObvhsRay) -> [f32; 2];
}

/// Glassbox' own.
pub(super) struct Watertight(SingleTriangle);

impl TriangleTest for Watertight {
    type Ready = ReadyRay;

    fn new(corners: [Vec3; 3]) -> Self {
        Self(SingleTriangle::new(corners))
    }

    fn ready(ray: &Ray) -> Option<Self::Ready> {
        ReadyRay::new(ray)
    }

    #[inline(always)]
    fn cross(&self, ready: &Self::Ready, _: &ObvhsRay, limit: f32) -> f32 {
        match self.0.cross(ready, limit) {
            Some((t, ..)) if t > 0.0 && t < limit => t,
            _ => f32::INFINITY,
        }
    }

    fn weights(&self, ready: &Self::Ready, _: &ObvhsRay) -> [f32; 2] {
        let (_, u, v) = self.0.cross(ready, f32::INFINITY).unwrap_or_default();
        [u, v]
    }
}

/// The one that obvhs brings.
pub(super) struct ObvhsTest(RtTriangle);

impl TriangleTest for ObvhsTest {
    type Ready = ();

    fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self(RtTriangle::new(a.into(), b.into(), c.into()))
    }

    fn ready(_: &Ray) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn cross(&self, (): &(), walked: &ObvhsRay, _: f32) -> f32 {
        self.0.intersect(walked)
    }

    fn weights(&self, (): &(), walked: &ObvhsRay) -> [f32; 2] {
        // It weighs corner 2 second, along its edges v0 - v1 and v2 - v0.
        self.0.compute_barycentric(walked).to_array()
    }
}

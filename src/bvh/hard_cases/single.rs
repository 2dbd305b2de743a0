//! This room's triangle test by itself, one ray and one triangle, for whoever walks another tree with it or none. It is
//! written once more, without lanes: what the walk finds with any number of them has to be the same, bit for bit.

use glam::{Vec3, Vec3A, Vec3Swizzles};

use super::super::kernel::object_ray::ObjectRay;
use super::super::kernel::safe_ray::SafeRay;
use super::super::kernel::triangle::{Crossing, Shear, accept};
use crate::bvh::Ray;

/// A ray that is ready for [`SingleTriangle::cross`].
pub(crate) struct ReadyRay {
    ray: ObjectRay,
    shear: Shear,
}

impl ReadyRay {
    /// `None` where the ray misses whatever there is. Its direction is of ordinary length: `t` is not rescaled.
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        Some(Self::of(SafeRay::new(ray)?.world))
    }

    /// A ray in object space.
    pub(crate) fn of(ray: ObjectRay) -> Self {
        let shear = Shear::new(ray.origin, ray.direction);
        Self { ray, shear }
    }

    /// The ray itself.
    #[cfg(test)]
    pub(crate) fn ray(&self) -> &ObjectRay {
        &self.ray
    }

    /// Its frame.
    pub(crate) fn shear(&self) -> &Shear {
        &self.shear
    }
}

/// A triangle, its coordinates axis by axis.
pub(crate) struct SingleTriangle([Vec3; 3]);

impl SingleTriangle {
    pub(crate) fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self([0, 1, 2].map(|axis| Vec3::new(a[axis], b[axis], c[axis])))
    }

    fn corners(&self) -> [Vec3; 3] {
        let [x, y, z] = self.0;
        [
            Vec3::new(x.x, y.x, z.x),
            Vec3::new(x.y, y.y, z.y),
            Vec3::new(x.z, y.z, z.z),
        ]
    }

    /// Where the ray crosses the triangle, `0 < t <= limit`: `t` and the weights of corners 1 and 2.
    #[inline(always)]
    pub(crate) fn cross(&self, ready: &ReadyRay, limit: f32) -> Option<(f32, f32, f32)> {
        let ReadyRay { ray, shear } = ready;
        // A lane is a corner.
        let [x, y, z] = (shear.axes).map(|axis| Vec3A::from(self.0[axis as usize]));
        let [right, up, depth] = shear.from.map(Vec3A::splat);
        let depth = depth - z;
        let right = right - x - depth * shear.slope[0];
        let up = up - y - depth * shear.slope[1];
        // An edge function a lane: corner 2 x 1, 0 x 2, 1 x 0.
        let edges = right.zxy() * up.yzx() - up.zxy() * right.yzx();
        if edges.cmplt(Vec3A::ZERO).any() && edges.cmpgt(Vec3A::ZERO).any() {
            return None;
        }
        let edges = edges.to_array();
        let det = edges[0] + edges[1] + edges[2];
        // Also false for a NaN.
        if !(det != 0.0 && det.is_finite()) {
            return None;
        }
        let crossing = accept(ray, self.corners(), edges, limit, false);
        crossing.map(|Crossing { t, u, v }| (t, u, v))
    }
}

//! A ray that is safe to trace: finite, in range, without a negative zero.

use glam::Vec3;

use super::{
    mesh_tree::ObjectRay,
    ray::{Hit, Ray},
    slab::SMALLEST_DIRECTION,
    triangles::REACH,
};

/// A world ray whose direction was multiplied by a power of two if it was too short or too long to compute with; so
/// its `t` is the ray's divided by `scale`.
pub(crate) struct SafeRay {
    pub(crate) world: ObjectRay,
    /// Where it ends, in its own `t`.
    pub(crate) end: f32,
    /// When it is shot.
    pub(crate) time: f32,
    scale: f32,
    t_max: f32,
}

/// Directions this long, or as much longer than 1, stay in range through every instance's transform.
const ORDINARY: f32 = SMALLEST_DIRECTION * (1u64 << 30) as f32;

impl SafeRay {
    /// `None` is a miss: something is not finite, the origin is beyond [`REACH`], the direction is zero, the ray ends
    /// before it starts, or its time is not in [0, 1].
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        // -0.0 becomes +0.0, so that both mean the same.
        let (origin, mut direction) = (ray.origin + 0.0, ray.direction + 0.0);
        let size = direction.abs().max_element();
        let mut scale = 1.0;
        if !(ORDINARY..=1.0 / ORDINARY).contains(&size) {
            (direction, scale) = rescale(direction)?;
        }
        let sane = origin.is_finite()
            && direction.is_finite()
            && origin.abs().max_element() <= REACH
            && ray.t_max > 0.0
            && (0.0..=1.0).contains(&ray.time);
        sane.then(|| Self {
            world: ObjectRay::new(origin, direction),
            end: ray.t_max / scale,
            time: ray.time,
            scale,
            t_max: ray.t_max,
        })
    }

    /// Whether a hit at this ray's `t` lies on the caller's ray.
    #[inline(always)]
    pub(crate) fn reaches(&self, t: f32) -> bool {
        let t = t * self.scale;
        t > 0.0 && t < self.t_max
    }

    /// A hit as the caller measures it.
    #[inline(always)]
    pub(crate) fn scaled(&self, hit: Hit) -> Hit {
        Hit {
            t: hit.t * self.scale,
            ..hit
        }
    }

    /// A caller's hit as this ray measures it.
    #[inline(always)]
    pub(crate) fn unscaled(&self, hit: Hit) -> Hit {
        Hit {
            t: hit.t / self.scale,
            ..hit
        }
    }
}

/// A very short or long direction, times a power of two.
#[cold]
fn rescale(direction: Vec3) -> Option<(Vec3, f32)> {
    if !direction.is_finite() || direction == Vec3::ZERO {
        return None;
    }
    let scale = if direction.abs().max_element() < 1.0 {
        (1u128 << 100) as f32
    } else {
        1.0 / (1u128 << 100) as f32
    };
    Some((direction * scale, scale))
}

//! A ray that is safe to trace: finite, in range, without a negative zero.

use glam::Vec3A;

use super::object_ray::ObjectRay;
use super::ray::{Hit, Ray, TriangleId};
use super::slab::SMALLEST_DIRECTION;
use crate::bvh::triangles::REACH;

/// A world ray whose direction was multiplied by a power of two if it was too short or too long to compute with; so
/// its `t` is the ray's divided by `scale`.
pub(crate) struct SafeRay {
    pub(crate) world: ObjectRay,
    /// Hits before this `t`, its own, are not asked for: boxes that end before are passed by.
    pub(crate) start: f32,
    /// Where it ends, in its own `t`.
    pub(crate) end: f32,
    /// When it is shot.
    pub(crate) time: f32,
    /// The triangle that it starts on.
    pub(crate) starts_on: TriangleId,
    /// How the caller measures it.
    pub(crate) measure: Measure,
}

/// How the caller measures a ray.
#[derive(Clone, Copy)]
pub(crate) struct Measure {
    /// The caller's `t` in one of the [`SafeRay`]'s: a power of two.
    scale: f32,
    /// Where the ray ends, in the caller's `t`.
    t_max: f32,
}

impl Measure {
    /// Of a ray that is safe as it is.
    #[inline(always)]
    pub(crate) fn unscaled(t_max: f32) -> Self {
        Self::new(1.0, t_max)
    }

    /// Of a ray in which one of its own `t` is so many of the caller's, and that ends at the caller's `t_max`.
    #[inline(always)]
    pub(crate) fn new(scale: f32, t_max: f32) -> Self {
        Self { scale, t_max }
    }

    /// The caller's `t` in one of the [`SafeRay`]'s.
    pub(crate) fn scale(&self) -> f32 {
        self.scale
    }

    /// Whether a hit at the [`SafeRay`]'s `t` lies on the caller's ray.
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
}

/// Directions this long, or as much longer than 1, stay in range through every instance's transform.
pub(super) const ORDINARY: f32 = SMALLEST_DIRECTION * (1u64 << 30) as f32;

impl SafeRay {
    /// `None` is a miss: something is not finite, the origin is beyond [`REACH`], the direction is zero, the ray ends
    /// before it starts, or its time is not in [0, 1].
    #[inline(always)]
    pub(crate) fn new(ray: &Ray) -> Option<Self> {
        // -0.0 becomes +0.0, so that both mean the same.
        let origin = Vec3A::from(ray.origin) + 0.0;
        let mut direction = Vec3A::from(ray.direction) + 0.0;
        let size = direction.abs();
        let mut longest = size.max_element();
        let (mut scale, mut end) = (1.0, ray.t_max);
        // Packed comparisons, which a NaN fails; the largest of several numbers may hide one.
        let ordinary = size.cmple(Vec3A::splat(1.0 / ORDINARY)).all();
        if !(ordinary & (longest >= ORDINARY)) {
            scale = ordinary_scale(direction)?;
            direction *= scale;
            longest *= scale;
            end /= scale;
        }
        let near = origin.abs().cmple(Vec3A::splat(REACH)).all();
        let sane = near & (ray.t_max > 0.0) & (ray.time >= 0.0) & (ray.time <= 1.0);
        sane.then(|| Self {
            world: ObjectRay::new(origin, direction, longest),
            start: 0.0,
            end,
            time: ray.time,
            starts_on: ray.starts_on,
            measure: Measure {
                scale,
                t_max: ray.t_max,
            },
        })
    }

    /// The rest of the ray from a hit of the caller's on, and that hit as this ray measures it.
    ///
    /// A hit's `t` lies within its triangle's box, and that in all boxes above it ([`super::slab`]): what ends before
    /// `start` holds no hit behind it, to the last bit.
    #[inline(always)]
    pub(crate) fn from_hit(ray: &Ray, hit: &Hit) -> Option<(Self, Hit)> {
        let mut safe = Self::new(ray)?;
        safe.start = hit.t / safe.measure.scale;
        let hit = Hit {
            t: safe.start,
            ..*hit
        };
        Some((safe, hit))
    }
}

/// The power of two that brings a very short or long direction into range.
#[cold]
fn ordinary_scale(direction: Vec3A) -> Option<f32> {
    if !direction.is_finite() || direction == Vec3A::ZERO {
        return None;
    }
    let short = direction.abs().max_element() < 1.0;
    let large = (1u128 << 100) as f32;
    Some(if short { large } else { 1.0 / large })
}

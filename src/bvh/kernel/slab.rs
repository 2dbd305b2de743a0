//! The ray against boxes: a slab test that never loses a triangle.
//!
//! # What is promised
//! For a ray with origin `o` and a box `[min, max]` the test returns `entry` and `exit` such that
//! 1. **monotone**: a larger box never enters later nor exits earlier, to the last bit, because `-`, `*`, `min`, `max`
//!    are monotone under rounding. So a node that contains a triangle's box is never pruned before that triangle.
//! 2. **conservative**: where the triangle test ([`super::triangle`]) sees the ray cross a triangle, the ray also
//!    passes the triangle's own box. So asking for both loses no hit.
//!
//! # Where the pads come from
//! Let u = 2⁻²⁴ be half an ulp, v a triangle's corners, M = max |v - o|∞. The triangle test shears the corners into the
//! ray's frame: `x' = (x - ox) - S (z - oz)`, |S| <= 1, with one rounding a subtraction, S rounded once and its product
//! once. To first order the error of x' is at most 2u|x - ox| + 4u|z - oz| <= 6uM. Its edge functions never have the
//! wrong sign (see there), so a crossing is one of the triangle that these slightly moved corners make: the exact ray
//! passes some point of the true triangle at a distance of at most 6uM along each axis. The slab test itself has
//! three relative roundings (difference, reciprocal, product), another 3uM. M <= |v|∞ + |o|∞, so 9u (|v|∞ + |o|∞)
//! covers both. Half of that depends on the triangle alone and half on the ray alone:
//! * [`triangle_box`] widens a triangle's box by `12u |v|∞`, once, when the tree is built;
//! * [`SlabRay`] moves the origin by `12u |o|∞` towards either side, once a ray. In a box it costs nothing.
//!
//! The 3u between 9 and 12 cover the roundings of the pads themselves and the terms of second order. Nothing is finer
//! than this slack in the first place: it is a few units in the last place of the coordinates.
//!
//! This goes further than the relative widening of the exit distance of Ize, "Robust BVH Ray Traversal" (JCGT 2(2),
//! 2013), which covers the slab test's own rounding but not that of a triangle with a corner far away and a crossing
//! nearby.
//!
//! # No infinity, no NaN
//! A component of the direction smaller than 2⁻³² of the largest is raised to that. This moves no crossing by more than
//! 2⁻³²M, which is nothing beside the pads, and makes 0 · ∞ impossible.

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Slack of triangle boxes and of ray origins, relative to their largest coordinate: 12 half ulps (see the module).
pub(crate) const PAD: f32 = 6.0 * f32::EPSILON;

/// Directions are accepted when their largest component lies between this and its reciprocal.
pub(crate) const SMALLEST_DIRECTION: f32 = 1.0 / (1u128 << 90) as f32;

/// A triangle's box, widened by the slack that makes the slab test conservative. Everything that bounds triangles
/// starts from it.
#[inline(always)]
pub(crate) fn triangle_box([a, b, c]: [Vec3A; 3]) -> Aabb {
    let min = a.min(b).min(c);
    let max = a.max(b).max(c);
    let pad = Vec3A::splat(min.abs().max(max.abs()).max_element() * PAD);
    Aabb::new(min - pad, max + pad)
}

/// What the slab test needs of a ray, computed once.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SlabRay {
    /// Origin moved up: what lower faces are measured from.
    pub(crate) above: Vec3A,
    /// Origin moved down: what upper faces are measured from.
    pub(crate) below: Vec3A,
    /// One over the direction; finite.
    pub(crate) inverse: Vec3A,
}

impl SlabRay {
    /// `pad` is the absolute slack around the origin. `origin` and `direction` are finite; `longest`, the size of the
    /// direction's largest component, lies between [`SMALLEST_DIRECTION`] and its reciprocal.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A, longest: f32, pad: f32) -> Self {
        let least = Vec3A::splat(longest * (1.0 / (1u64 << 32) as f32));
        let direction = direction.abs().max(least).copysign(direction);
        let slab = Self {
            above: origin,
            below: origin,
            inverse: direction.recip(),
        };
        slab.with_pad(origin, pad)
    }

    /// The same ray from `origin`, its own, with another slack.
    #[inline(always)]
    pub(crate) fn with_pad(self, origin: Vec3A, pad: f32) -> Self {
        let pad = Vec3A::splat(pad);
        Self {
            above: origin + pad,
            below: origin - pad,
            ..self
        }
    }

    /// Where the line enters and leaves the box. It misses when `entry > exit`; both may be negative.
    #[inline(always)]
    pub(crate) fn span(&self, bounds: &Aabb) -> (f32, f32) {
        let lower = (bounds.min - self.above) * self.inverse;
        let upper = (bounds.max - self.below) * self.inverse;
        (
            lower.min(upper).max_element(),
            lower.max(upper).min_element(),
        )
    }

    /// The slack that the object-space test of a ray from `origin` needs.
    #[inline(always)]
    pub(crate) fn pad_of(origin: Vec3A) -> f32 {
        origin.abs().max_element() * PAD
    }
}

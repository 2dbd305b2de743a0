//! A ray, and what it hits.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A half-open piece of a line: the points `origin + t · direction` with `0 < t < t_max`.
// In this order, so that a packet reads eight numbers at once.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Ray {
    /// Where it starts, in world space. A coordinate that is not finite, or beyond [`crate::bvh::REACH`], makes the ray a miss.
    pub origin: Vec3,
    /// Where it goes. Any length but zero: `t` is measured in this length. Zero or not finite makes the ray a miss.
    pub direction: Vec3,
    /// Hits lie in `0 < t < t_max`; may be infinite. NaN makes the ray a miss.
    pub t_max: f32,
    /// When it is shot, in [0, 1]: moving instances stand where they are then.
    pub time: f32,
    /// The triangle that it starts on, or [`TriangleId::NONE`]. A line crosses a plane once, so it does not meet that one
    /// again, and is not tested against it: half of the crossings that a ray from a surface has to decide are with the
    /// surface itself, a rounding away.
    pub starts_on: TriangleId,
}

/// The name of a triangle of an [`crate::bvh::Aggregate`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct TriangleId {
    /// Index into [`crate::bvh::Aggregate::instances`].
    pub instance: u32,
    /// Index into the mesh's [`crate::bvh::Triangles::indices`].
    pub triangle: u32,
}

impl TriangleId {
    /// None.
    pub const NONE: Self = Self {
        instance: u32::MAX,
        triangle: u32::MAX,
    };
}

impl Ray {
    /// A ray without an end, at time 0, that starts on no triangle.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            t_max: f32::INFINITY,
            time: 0.0,
            starts_on: TriangleId::NONE,
        }
    }

    /// The point at `t`.
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + self.direction * t
    }
}

/// Where a ray met a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in lengths of the ray's direction, `0 < t < t_max`.
    pub t: f32,
    /// Index into [`crate::bvh::Aggregate::instances`].
    pub instance: u32,
    /// Index into the mesh's [`crate::bvh::Triangles::indices`].
    pub triangle: u32,
    /// Barycentric weight of the triangle's corner 1, in [0, 1].
    pub u: f32,
    /// Barycentric weight of the triangle's corner 2, in [0, 1]; corner 0 has `1 - u - v`.
    pub v: f32,
}

impl Hit {
    /// The triangle.
    #[inline(always)]
    pub fn id(&self) -> TriangleId {
        TriangleId {
            instance: self.instance,
            triangle: self.triangle,
        }
    }

    /// Ties in `t` go to the smaller (instance, triangle): the same hit wins in any order of testing.
    #[inline(always)]
    pub(crate) fn beats(&self, other: &Hit) -> bool {
        self.t < other.t
            || (self.t == other.t
                && (self.instance, self.triangle) < (other.instance, other.triangle))
    }
}

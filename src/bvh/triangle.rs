//! The ray against one triangle: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (JCGT 2(1), 2013).
//!
//! The corners are moved into a frame in which the ray starts at the origin and runs along z. There the triangle is hit
//! when the three edge functions do not differ in sign.
//!
//! # Why nothing leaks
//! An edge function is the difference of two rounded products. Rounding is monotone, so the difference never has the
//! wrong sign; it can only be zero where the truth is not. Zero counts as inside. Two triangles that share an edge move
//! its corners to the same places and compute, for that edge, exactly opposite numbers. So the moved triangles cover
//! what the true ones cover, without a gap. (A fused multiply-add would break this: its products round differently on
//! either side.)
//!
//! # Rules
//! * Both sides are hit. An edge or a corner belongs to every triangle that touches it.
//! * A triangle without area as the ray sees it (`det == 0`) is missed: so a ray in a triangle's plane misses it.
//! * The ray must also pass the triangle's own box ([`super::slab`]), and `t` is clamped to the piece of the ray within
//!   it. The first throws out the far, tiny triangles whose edge functions all round to zero or one ulp. The second
//!   repairs `t` of a grazing hit. Both together make every hit independent of the tree: the boxes above a triangle
//!   contain its own, so none of them is entered after that `t`.

use glam::{Vec3, Vec3A};

use super::slab::{SlabRay, triangle_box};

/// The ray's frame: which axis is z, and the shear that turns the direction into it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: Vec3A,
    axes: [usize; 3],
    x: f32,
    y: f32,
    z: f32,
}

impl Shear {
    /// The frame of a ray. `direction` is finite and not zero.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        let size = direction.abs();
        let z = if size.x > size.y {
            if size.x > size.z { 0 } else { 2 }
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Self {
            origin: origin.into(),
            axes: [x, y, z],
            x: direction[x] / direction[z],
            y: direction[y] / direction[z],
            z: 1.0 / direction[z],
        }
    }
}

/// A crossing: `t`, and the barycentric weights of corners 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    pub(crate) t: f32,
    pub(crate) u: f32,
    pub(crate) v: f32,
}

/// Where the line of the ray crosses the triangle. `t` may be negative or beyond the ray's end.
#[inline(always)]
pub(crate) fn cross(shear: &Shear, slab: &SlabRay, corners: [Vec3A; 3]) -> Option<Crossing> {
    let [x, y, z] = shear.axes;
    let [a, b, c] = corners.map(|corner| (corner - shear.origin).to_array());
    let (ax, ay) = (a[x] - shear.x * a[z], a[y] - shear.y * a[z]);
    let (bx, by) = (b[x] - shear.x * b[z], b[y] - shear.y * b[z]);
    let (cx, cy) = (c[x] - shear.x * c[z], c[y] - shear.y * c[z]);
    let u = cx * by - cy * bx;
    let v = ax * cy - ay * cx;
    let w = bx * ay - by * ax;
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return None;
    }
    let det = u + v + w;
    if det == 0.0 {
        return None;
    }
    let (entry, exit) = slab.span(&triangle_box(corners));
    // Also false where overflow made `t` not a number.
    let t = (u * a[z] + v * b[z] + w * c[z]) / det * shear.z;
    if !(entry <= exit && t.is_finite()) {
        return None;
    }
    let inverse = 1.0 / det;
    Some(Crossing {
        t: t.max(entry).min(exit),
        u: v * inverse,
        v: w * inverse,
    })
}

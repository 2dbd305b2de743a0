//! A mesh placed in the world, and the rays that follow it into its own space.
//!
//! # The ray's way into object space, and what it costs
//! With `world = L · object + T` a ray becomes `o' = L⁻¹ (o - T)`, `d' = L⁻¹ d`. The direction is not renormalised, so
//! `t` means the same in both spaces. The inverse is computed in f64 and rounded once; the rest is f32. Subtracting T
//! first makes the error relative to the distance from the instance, not to the size of the coordinates. The identity
//! takes the ray as it is, bit for bit.
//!
//! # Why a box in the world never hides a hit in the object
//! u = 2⁻²⁴, norms are the maximum norm, κ = ‖|L||L⁻¹|‖, K = ‖L‖‖L⁻¹‖ >= κ. Per component o' is off by at most
//! 6u |L⁻¹||o - T| and d' by 5u |L⁻¹||d|. A hit at `t` means that the point `x' = o' + t d'` lies within
//! 17u (B + |o'|) of the padded box of its triangle, B the largest coordinate in it ([`crate::bvh::kernel::slab`]: pads and
//! roundings). The world's ray is at `o + t d` then, and that differs from `L x' + T` by at most
//! 6uκ (|o - T| + t|d|), where t|d| <= 1.3 |o - T| + 1.2 R, R the largest coordinate of L times the box, because
//! 6uκ <= 1/8 (larger ones are refused). Together, with |o'| <= 1.001 ‖L⁻¹‖ |o - T|:
//!
//! `|o + t d - (point of the box, carried into the world)| <= (14κ + 20K) u |o - T| + 7uκ R + 20u ‖L‖ B`
//!
//! The world's own slab test adds 4u (|o| + |world box|). With |o - T| <= |o| + |T| this splits into a part that only
//! the instance knows, added to its world box, and a factor times |o|, by which the world ray's origin is padded (the
//! largest factor of all instances: [`Instance::ray_pad`]). So the boxes above a hit are always passed, and entered no
//! later than at the hit's `t`: one level, two levels and brute force find the same hits to the last bit.

use std::sync::Arc;

use glam::{Affine3A, DMat3, DVec3, Mat3A, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use thiserror::Error;

use super::mesh_tree::MeshTree;
use crate::bvh::kernel::object_ray::ObjectRay;
use crate::bvh::kernel::slab::{PAD, SMALLEST_DIRECTION};
use crate::bvh::kernel::wide::{Lanes, PacketRays, by_axis, largest_size};
use crate::bvh::triangles::REACH;

/// Half an ulp of 1, the u of the derivation above.
const U: f64 = f32::EPSILON as f64 / 2.0;
/// Largest κ with 6uκ <= 1/8.
const MOST_SKEW: f64 = 1.0 / (8.0 * 6.0 * U);
/// Largest norm of the transform and of its inverse, so that rays of ordinary length stay in range.
const MOST_SCALE: f64 = (1u64 << 30) as f64;

/// Why a transform cannot be traced through.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum SingularTransform {
    /// A number in it is NaN, infinite, or its translation is beyond [`REACH`].
    #[error("the transform holds a number that is not finite or is larger than 1e12")]
    NotFinite,
    /// It flattens space: the determinant is zero.
    #[error(
        "the transform is singular (determinant 0): a scale of 0 on some axis? use a small one instead"
    )]
    Flat,
    /// It, or its inverse, magnifies by more than 2^30.
    #[error("the transform scales by {scale:e}: outside 1e-9 to 1e9")]
    Scale {
        /// The magnification, below 1 when it is the inverse that magnifies.
        scale: f64,
    },
    /// So skewed that an inverse in f32 means nothing.
    #[error(
        "the transform is so skewed (condition {condition:e}) that f32 cannot invert it: at most {MOST_SKEW:e}"
    )]
    Skewed {
        /// ‖|L||L⁻¹|‖ in the maximum norm; 1 for any scaling, at most 3 for scaling and rotation.
        condition: f64,
    },
}

/// A mesh placed in the world by an affine transform; mirrored and sheared ones included.
// In this order: what a ray reads that enters it is in its first two cache lines.
#[derive(Clone)]
#[repr(C, align(64))]
pub struct Instance {
    entry: Entry,
    /// The mesh. Instances share it.
    pub mesh: Arc<MeshTree>,
    world_from_object: Affine3A,
    normal_from_object: Mat3A,
    condition: f64,
    norm: f64,
    inverse_norm: f64,
    edge_reach: f32,
    mirrored: bool,
}

/// The way into an instance.
#[derive(Clone, Copy)]
#[repr(C)]
struct Entry {
    object_from_world: Mat3A,
    translation: Vec3A,
    velocity: Vec3A,
    is_identity: bool,
}

impl Instance {
    /// Places a mesh. The transform is refused when it has no usable inverse.
    pub fn new(
        mesh: Arc<MeshTree>,
        world_from_object: &Affine3A,
    ) -> Result<Self, SingularTransform> {
        let translation = world_from_object.translation;
        if !world_from_object.is_finite() || translation.abs().max_element() > REACH {
            return Err(SingularTransform::NotFinite);
        }
        let linear = columns(&world_from_object.matrix3);
        let determinant = linear.determinant();
        if determinant == 0.0 {
            return Err(SingularTransform::Flat);
        }
        let inverse = linear.inverse();
        if !inverse.is_finite() {
            return Err(SingularTransform::Flat);
        }
        let (norm, inverse_norm) = (norm(linear.abs()), norm(inverse.abs()));
        let condition = self::norm(linear.abs() * inverse.abs());
        if condition > MOST_SKEW {
            return Err(SingularTransform::Skewed { condition });
        }
        if norm > MOST_SCALE {
            return Err(SingularTransform::Scale { scale: norm });
        }
        if inverse_norm > MOST_SCALE {
            return Err(SingularTransform::Scale {
                scale: 1.0 / inverse_norm,
            });
        }
        Ok(Self {
            mesh,
            world_from_object: *world_from_object,
            entry: Entry {
                object_from_world: inverse.as_mat3().into(),
                translation,
                velocity: Vec3A::ZERO,
                is_identity: *world_from_object == Affine3A::IDENTITY,
            },
            normal_from_object: inverse.transpose().as_mat3().into(),
            mirrored: determinant < 0.0,
            condition,
            norm,
            inverse_norm,
            edge_reach: edge_reach(linear, norm, inverse_norm) as f32,
        })
    }

    /// The same, moving: at time `t` in [0, 1] it stands `velocity · t` farther. Rays carry their time.
    pub fn moving(mut self, velocity: Vec3) -> Result<Self, SingularTransform> {
        if !velocity.is_finite() || velocity.abs().max_element() > REACH {
            return Err(SingularTransform::NotFinite);
        }
        self.entry.velocity = velocity.into();
        self.entry.is_identity &= velocity == Vec3::ZERO;
        Ok(self)
    }

    /// World-space way from time 0 to time 1.
    pub fn velocity(&self) -> Vec3 {
        self.entry.velocity.into()
    }

    /// The transform at time 0, from object to world space.
    pub fn world_from_object(&self) -> &Affine3A {
        &self.world_from_object
    }

    /// Whether the transform turns left hands into right ones, and so the triangles' winding.
    pub fn mirrored(&self) -> bool {
        self.mirrored
    }

    /// Whether rays pass unchanged.
    pub(crate) fn is_identity(&self) -> bool {
        self.entry.is_identity
    }

    /// κ of the module docs.
    pub(crate) fn condition(&self) -> f32 {
        self.condition as f32
    }

    /// What a distance in the world is at most in the mesh, beside an edge. Where the transform also changes angles, by
    /// how much it may narrow them is in it.
    pub(super) fn edge_reach(&self) -> f32 {
        self.edge_reach
    }

    /// Where the instance stands at a time: the translation that rays of that time see.
    pub(in crate::bvh) fn stands_at(&self, time: f32) -> Vec3A {
        self.entry.translation + self.entry.velocity * time
    }

    /// The linear part of the transform.
    pub(in crate::bvh) fn exact_linear(&self) -> DMat3 {
        columns(&self.world_from_object.matrix3)
    }

    /// Whether a point of the world lies on the side of a triangle's plane from which its corners run counterclockwise
    /// (as the mesh gives them, and its normal points), at a time; `None` where it lies in it. In f64, so that it is
    /// true of a ray's origin however grazing the ray.
    pub fn is_above(&self, triangle: u32, point: Vec3, time: f32) -> Option<bool> {
        let linear = self.exact_linear();
        let stands = self.stands_at(time).as_dvec3();
        let [a, b, c] = (self.mesh.triangles().corners(triangle)).map(|p| linear * p.as_dvec3());
        let height = (b - a).cross(c - a).dot(point.as_dvec3() - stands - a);
        (height != 0.0).then_some((height > 0.0) != self.mirrored)
    }

    /// A point of the mesh, in the world, at time 0.
    #[inline]
    pub fn to_world_point(&self, point: Vec3) -> Vec3 {
        if self.entry.is_identity {
            point
        } else {
            self.world_from_object.transform_point3(point)
        }
    }

    /// A vector of the mesh (an edge), in the world.
    #[inline]
    pub fn to_world_vector(&self, vector: Vec3) -> Vec3 {
        if self.entry.is_identity {
            vector
        } else {
            self.world_from_object.transform_vector3(vector)
        }
    }

    /// A normal of the mesh, in the world, by the inverse transpose. Not normalised, except that the identity leaves it
    /// as it is. It stays on the side of the surface that it was on.
    #[inline]
    pub fn to_world_normal(&self, normal: Vec3) -> Vec3 {
        if self.entry.is_identity {
            normal
        } else {
            self.normal_from_object * normal
        }
    }

    /// What turns normals into the world, by columns: the inverse transpose of the linear part.
    pub(super) fn normal_columns(&self) -> [Vec3; 3] {
        [0, 1, 2].map(|i| self.normal_from_object.col(i).into())
    }

    /// The box around the instance in the world, or `None` when its mesh has no triangle that is traced. It is wide
    /// enough for the rounding of every ray that enters (see the module).
    ///
    /// Where axes do not stay axes it is that of how far the mesh itself reaches along them: a turned box
    /// sticks out far beyond what is in it (that of a ball to three times the ball's area).
    pub fn world_bounds(&self) -> Option<Aabb> {
        let whole = self.mesh.bounds()?;
        if self.keeps_axes() {
            return Some(self.to_world_box(&whole));
        }
        let rows = self.exact_linear().transpose();
        let rows = [rows.x_axis, rows.y_axis, rows.z_axis];
        let ends = rows.map(|row| self.mesh.reach_along(row));
        let low = DVec3::from(ends.map(|[_, behind]| -behind));
        let high = DVec3::from(ends.map(|[ahead, _]| ahead));
        Some(self.placed(low, high, &whole))
    }

    /// Whether a box stays a box in the world, nearly: whoever turns a model from z up to y up has sines of π that are not 0.
    fn keeps_axes(&self) -> bool {
        let matrix = &self.world_from_object.matrix3;
        [matrix.x_axis, matrix.y_axis, matrix.z_axis]
            .map(Vec3A::abs)
            .iter()
            .all(|column| column.element_sum() <= 1.001 * column.max_element())
    }

    /// The world box of a padded box in object space, conservative for hits inside it.
    pub(crate) fn to_world_box(&self, bounds: &Aabb) -> Aabb {
        if self.entry.is_identity {
            return *bounds;
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let linear = self.exact_linear();
        let middle = linear * ((min + max) * 0.5);
        let half = linear.abs() * ((max - min) * 0.5);
        self.placed(middle - half, middle + half, bounds)
    }

    /// The world box of what reaches from `low` to `high` where the instance's linear part has turned it, and lies in
    /// the padded box `within` before: swept over its way, and wide enough for rounding.
    fn placed(&self, low: DVec3, high: DVec3, within: &Aabb) -> Aabb {
        let largest = f64::from(within.min.abs().max(within.max.abs()).max_element());
        let reach = low.abs().max(high.abs()).max_element();
        let (translation, velocity) = (
            self.entry.translation.as_dvec3(),
            self.entry.velocity.as_dvec3(),
        );
        let low = low + translation + velocity.min(DVec3::ZERO);
        let high = high + translation + velocity.max(DVec3::ZERO);
        let world = low.abs().max(high.abs()).max_element();
        // T + velocity · t is rounded twice, which a box that stands still does not see: 2u each.
        let farthest = (translation.abs() + velocity.abs()).max_element();
        let pad =
            (14.0 * self.condition + 20.0 * self.norm * self.inverse_norm + 4.0) * U * farthest
                + 7.0 * U * self.condition * reach
                + 20.0 * U * self.norm * largest
                + 6.0 * U * world;
        let pad = DVec3::splat(pad);
        Aabb::new(round_down(low - pad), round_up(high + pad))
    }

    /// The factor by which |o|∞ pads the origin of a world ray, for the boxes above this instance.
    pub(crate) fn ray_pad(&self) -> f32 {
        if self.entry.is_identity {
            PAD
        } else {
            let factor = 14.0 * self.condition + 20.0 * self.norm * self.inverse_norm + 6.0;
            ((factor * U) as f32).max(PAD)
        }
    }

    /// Has what a ray reads that enters it brought nearer.
    #[inline(always)]
    pub(crate) fn prefetch<L: Lanes>(&self) {
        L::prefetch(&self.entry);
    }

    /// The ray as the mesh sees it, or `None` when its direction is out of range there.
    #[inline(always)]
    pub(crate) fn to_object_ray(&self, world: &ObjectRay, time: f32) -> Option<ObjectRay> {
        if self.entry.is_identity {
            return Some(*world);
        }
        let origin = self.entry.object_from_world * (world.origin - self.stands_at(time));
        let direction = self.entry.object_from_world * world.direction;
        let size = direction.abs().max_element();
        ((SMALLEST_DIRECTION..=1.0 / SMALLEST_DIRECTION).contains(&size)
            && origin.abs().max_element() < f32::MAX)
            .then(|| ObjectRay::new(origin, direction, size))
    }

    /// [`Self::to_object_ray`] of a packet, and which of its rays are in range there.
    #[inline(always)]
    pub(crate) fn to_object_packet<L: Lanes>(
        &self,
        world: &PacketRays<L>,
        time: L,
    ) -> (PacketRays<L>, u32) {
        let stands = by_axis!(|i| {
            let way = L::splat(self.entry.velocity[i]).mul(time);
            L::splat(self.entry.translation[i]).add(way)
        });
        let from = by_axis!(|i| world.origin[i].sub(stands[i]));
        let matrix = &self.entry.object_from_world;
        let origin = by_axis!(|row| turned(matrix, row, &from));
        let direction = by_axis!(|row| turned(matrix, row, &world.direction));
        let size = largest_size(&direction);
        let far = largest_size(&origin);
        let in_range = L::and(
            L::splat(SMALLEST_DIRECTION).le(size),
            size.le(L::splat(1.0 / SMALLEST_DIRECTION)),
        );
        let in_range = L::bits(L::and(in_range, far.lt(L::splat(f32::MAX))));
        (PacketRays::new(origin, direction, size), in_range)
    }
}

/// A row of a matrix times vectors.
#[inline(always)]
fn turned<L: Lanes>(matrix: &Mat3A, row: usize, [x, y, z]: &[L; 3]) -> L {
    let x = L::splat(matrix.x_axis[row]).mul(*x);
    let y = L::splat(matrix.y_axis[row]).mul(*y);
    let z = L::splat(matrix.z_axis[row]).mul(*z);
    x.add(y).add(z)
}

fn columns(matrix: &Mat3A) -> DMat3 {
    DMat3::from_cols(
        matrix.x_axis.as_dvec3(),
        matrix.y_axis.as_dvec3(),
        matrix.z_axis.as_dvec3(),
    )
}

/// See [`Instance::edge_reach`]. A transform that keeps angles has the same factor everywhere; else the norms bound the
/// lengths, by √3 each, and the tangent of an angle changes by no more than the product of both.
fn edge_reach(linear: DMat3, norm: f64, inverse_norm: f64) -> f64 {
    let squared = linear.transpose() * linear;
    let scale = (squared.x_axis.x + squared.y_axis.y + squared.z_axis.z) / 3.0;
    let off = squared - DMat3::from_diagonal(DVec3::splat(scale));
    if self::norm(off.abs()) <= 1e-5 * scale {
        1.0 / scale.sqrt()
    } else {
        3.0_f64.sqrt() * inverse_norm * 3.0 * norm * inverse_norm
    }
}

/// The maximum norm of a matrix with no negative entry: its largest row sum.
fn norm(matrix: DMat3) -> f64 {
    (matrix * DVec3::ONE).max_element()
}

fn round_down(v: DVec3) -> Vec3A {
    Vec3A::from_array(v.to_array().map(|x| {
        let near = x as f32;
        if f64::from(near) > x {
            near.next_down()
        } else {
            near
        }
    }))
}

fn round_up(v: DVec3) -> Vec3A {
    -round_down(-v)
}

//! Where a hit lies in the world, how far the rounding of that may be off, and where a ray starts that leaves it.
//!
//! # The error
//! u = 2⁻²⁴. A point is the sum of three weighted corners, which rounds by at most 7u Σ b|v| (Pharr, Jakob, Humphreys,
//! "Physically Based Rendering", 4th ed., 6.8.5); carried into the world that is multiplied by |L|, and the transform adds
//! 4u (|L||p| + |T|), T where the instance stands at that time, reached by another rounding of its way. A new ray from
//! there is rounded twice more: on its way into object space, by 6u κ |p - T| (see `bvh/geometry/instance.rs`), and where the
//! triangle test sums t from corners relative to the ray's origin, by 8u Σ b|v - p|. All of this is a bound for each
//! coordinate ([`SurfacePoint::error`]), and so for every direction: a point is off **along** its triangle by as much as
//! **across** it. Let e be the sum of its three coordinates, which is no less than its length.
//!
//! # A start beside an edge
//! [`SurfacePoint::leave`] moves the point along the normal out of its error's box. The start is then at most 2.5e above
//! the triangle (|n| · error, what the point was off, and one step of each coordinate) and 1.5e beside the exact point. In
//! a wedge of the angle φ a start `h` above one side at the distance `d` from the edge is before the other side where
//! `d sin φ > h cos φ`. So nothing has to be done at a distance of more than 1.5e + 2.5e cot φ from every edge, for which
//! 4e / sin φ is enough at every angle; the angle is that of the triangle's narrowest wedge ([`MeshTree::wedge_of`]).
//! Edges are measured where the mesh is: distances there are `1/s` times those in the world, s the least factor by which the
//! transform shortens ([`Instance::edge_reach`]).
//!
//! [`MeshTree::wedge_of`]: super::mesh_tree::MeshTree
//!
//! What is nearer ([`SurfacePoint::near_edge`]) is one hit in some ten thousand beside the origin, and one in three in a
//! room that stands 12 km away from it. [`super::leave`] finds a start for those.

use glam::Vec3;

use super::instance::Instance;
use crate::bvh::{Hit, TriangleId};

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World space, from the barycentric weights: closer to the surface than `origin + t · direction`.
    pub position: Vec3,
    /// A ray that starts farther from the surface than this, in each coordinate, does not meet it again.
    pub error: Vec3,
    /// Unit normal of the triangle, by the winding of its corners in object space.
    pub normal: Vec3,
    /// The triangle.
    pub triangle: TriangleId,
    /// Where the point is so close to an edge of its triangle that `error` may reach behind the surface beyond: the hit,
    /// from which [`Aggregate::leave`](super::aggregate::Aggregate::leave) finds the start of a ray.
    pub near_edge: Option<NearEdge>,
}

/// A hit close to an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearEdge {
    /// What was hit.
    pub hit: Hit,
    /// By a ray of this time.
    pub time: f32,
}

impl SurfacePoint {
    /// Where a ray starts that leaves by the side to which `towards` points, so that it does not meet this surface again.
    /// Not for a point near an edge.
    pub(in crate::bvh) fn leave(&self, towards: Vec3) -> Vec3 {
        beyond_error(self.position, self.error, self.normal, towards)
    }
}

/// A point moved along its surface's normal, to the side to which `towards` points, out of the box in which the exact point
/// lies (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 6.8.6). Without a branch.
#[inline(always)]
pub(crate) fn beyond_error(position: Vec3, error: Vec3, normal: Vec3, towards: Vec3) -> Vec3 {
    let side = if towards.dot(normal) < 0.0 { -1.0 } else { 1.0 };
    let offset = side * normal.abs().dot(error) * normal;
    Vec3::new(
        moved_on(position.x, offset.x),
        moved_on(position.y, offset.y),
        moved_on(position.z, offset.z),
    )
}

/// `p + d`, and one float farther.
#[inline(always)]
fn moved_on(p: f32, d: f32) -> f32 {
    let moved = p + d;
    let bits = moved.to_bits();
    let magnitude = bits & 0x7fff_ffff;
    // Away from zero the magnitude grows by one, towards it it shrinks by one; from zero it is one on the side of `d`.
    let grows = (bits ^ d.to_bits()) >> 31 == 0;
    let next = if grows {
        bits.wrapping_add(1)
    } else {
        bits.wrapping_sub(1)
    };
    let next = if magnitude == 0 {
        (d.to_bits() & 0x8000_0000) | 1
    } else {
        next
    };
    // Infinity has no next float towards itself; a sum that is no number stays none.
    let stays = d == 0.0 || d.is_nan() || magnitude > INFINITE || (magnitude == INFINITE && grows);
    f32::from_bits(if stays { bits } else { next })
}

/// The bits of infinity.
const INFINITE: u32 = f32::INFINITY.to_bits();

/// Half an ulp of 1.
const U: f32 = f32::EPSILON / 2.0;

/// So many times the error over the sine of the wedge a point has to be away from an edge (see the module).
const CLEAR_OF_AN_EDGE: f32 = 4.0;

/// How an instance lies in the world: what is the same for all hits on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placement {
    is_identity: bool,
    /// By columns: the linear part of the transform, its sizes, and what turns normals.
    linear: [Vec3; 3],
    sizes: [Vec3; 3],
    turns: [Vec3; 3],
    translation: Vec3,
    velocity: Vec3,
    condition: f32,
    edge_reach: f32,
}

/// A hit in the world, as it is found without a branch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) position: Vec3,
    pub(crate) error: Vec3,
    /// Unit normal of the triangle.
    pub(crate) normal: Vec3,
    /// How far the point has to be from every edge, in the mesh, times what its wedge asks for.
    clear: f32,
    /// Whether that is all there is to know of it. Else only [`Instance::surface_point`] says where it lies.
    pub(crate) is_ordinary: bool,
}

#[inline(always)]
fn times(columns: &[Vec3; 3], v: Vec3) -> Vec3 {
    columns[0] * v.x + columns[1] * v.y + columns[2] * v.z
}

#[inline(always)]
fn largest(v: Vec3) -> f32 {
    let larger = if v.y > v.z { v.y } else { v.z };
    if v.x > larger { v.x } else { larger }
}

#[inline(always)]
fn weighted([a, b, c]: [Vec3; 3], [u, v, w]: [f32; 3]) -> Vec3 {
    Vec3::ZERO + u * a + v * b + w * c
}

impl Placement {
    /// Where the point of a triangle lies that a ray of `time` hit at (u, v); one over the sine of the triangle's narrowest
    /// wedge is `wedge`.
    #[inline(always)]
    pub(crate) fn of_hit(
        &self,
        corners: [Vec3; 3],
        wedge: f32,
        [u, v]: [f32; 2],
        time: f32,
    ) -> Placed {
        let plane = Plane::of(corners);
        let mut placed = self.place(corners, [1.0 - u - v, u, v], time, plane.normal);
        let weight = 1.0 - u - v;
        let least = if weight < u { weight } else { u };
        let least = if least < v { least } else { v };
        // NaN is nothing ordinary.
        let is_clear = least * plane.height > placed.clear * wedge;
        placed.is_ordinary = plane.is_ordinary & is_clear;
        placed
    }

    /// The same where the normal of the triangle is known.
    #[inline(always)]
    fn place(&self, corners: [Vec3; 3], weights: [f32; 3], time: f32, normal: Vec3) -> Placed {
        let [a, b, c] = corners;
        let point = weighted(corners, weights);
        let size = weighted([a.abs(), b.abs(), c.abs()], weights);
        let around = [(a - point).abs(), (b - point).abs(), (c - point).abs()];
        let reach = largest(weighted(around, weights));
        let error = U * (7.0 * size + Vec3::splat(8.0 * reach));
        let mut placed = Placed {
            position: point,
            error,
            normal,
            clear: 0.0,
            is_ordinary: false,
        };
        if !self.is_identity {
            let way = self.velocity * time;
            let translation = self.translation + way;
            placed.position = times(&self.linear, point) + self.translation + way;
            placed.error = times(&self.sizes, error)
                + 4.0 * U * (times(&self.sizes, point.abs()) + translation.abs() + 2.0 * way.abs())
                + Vec3::splat(
                    6.0 * U * self.condition * largest((placed.position - translation).abs()),
                );
            let turned = times(&self.turns, normal);
            let scale = 1.0 / turned.length();
            let has_length = scale > 0.0 && scale < f32::INFINITY;
            placed.normal = if has_length { turned * scale } else { normal };
        }
        placed.clear = CLEAR_OF_AN_EDGE * placed.error.element_sum() * self.edge_reach;
        placed
    }

    /// Whether meshes lie in the world as they are.
    pub(crate) fn is_identity(&self) -> bool {
        self.is_identity
    }

    /// The same, where it is known beforehand whether that is so: nothing has to be decided then for each hit.
    #[inline(always)]
    pub(crate) fn as_identity(&self, is_identity: bool) -> Self {
        Self {
            is_identity,
            ..*self
        }
    }

    /// A normal of the mesh, in the world. Not normalised.
    #[inline(always)]
    pub(crate) fn world_normal(&self, normal: Vec3) -> Vec3 {
        if self.is_identity {
            normal
        } else {
            times(&self.turns, normal)
        }
    }
}

impl Instance {
    /// What is the same for all hits on it.
    pub(crate) fn placement(&self) -> Placement {
        let transform = self.world_from_object();
        let linear = [0, 1, 2].map(|i| Vec3::from(transform.matrix3.col(i)));
        Placement {
            is_identity: self.is_identity(),
            linear,
            sizes: linear.map(Vec3::abs),
            turns: self.normal_columns(),
            translation: transform.translation.into(),
            velocity: self.velocity(),
            condition: self.condition(),
            edge_reach: self.edge_reach(),
        }
    }

    /// The point of a hit on this instance by a ray of `time`.
    ///
    /// # Panics
    /// When `hit` is not a hit on this instance's mesh.
    pub fn surface_point(&self, hit: &Hit, time: f32) -> SurfacePoint {
        let corners = self.mesh.triangles().corners(hit.triangle);
        let placement = self.placement();
        let wedge = self.mesh.wedge_of(hit.triangle);
        let mut placed = placement.of_hit(corners, wedge, [hit.u, hit.v], time);
        let mut near = None;
        if !placed.is_ordinary {
            let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
            let normal = Plane::exact_normal(corners);
            placed = placement.place(corners, weights, time, normal);
            near = near_edge(corners, weights, placed.clear * wedge)
                .then_some(NearEdge { hit: *hit, time });
        }
        SurfacePoint {
            position: placed.position,
            error: placed.error,
            normal: placed.normal,
            triangle: hit.id(),
            near_edge: near,
        }
    }
}

/// Whether the point of a triangle with these weights is not `clear` of an edge.
#[cold]
fn near_edge([a, b, c]: [Vec3; 3], weights: [f32; 3], clear: f32) -> bool {
    let clear = f64::from(clear);
    let [a, b, c] = [a, b, c].map(|corner| corner.as_dvec3());
    let area = (b - a).cross(c - a).length();
    let opposite = [c - b, a - c, b - a];
    let mut edges = weights.into_iter().zip(opposite);
    edges.any(|(weight, edge)| f64::from(weight) * area <= clear * edge.length())
}

/// What the corners of a triangle say about it.
struct Plane {
    /// Unit normal.
    normal: Vec3,
    /// No more than the least of its three heights.
    height: f32,
    /// Whether f32 has digits enough for both.
    is_ordinary: bool,
}

impl Plane {
    /// Of a triangle that is no sliver, and whose edges are neither tiny nor huge: squares of squares of them stay in range.
    #[inline(always)]
    fn of([a, b, c]: [Vec3; 3]) -> Self {
        let (ab, ac) = (b - a, c - a);
        let [longest, other] = [largest(ab.abs()), largest(ac.abs())];
        let longest = if longest > other { longest } else { other };
        let normal = ab.cross(ac);
        let squared = normal.length_squared();
        // Twice the area over the longest edge, of which no coordinate is longer than twice that.
        let area = squared.sqrt();
        let edge_squared = longest * longest;
        Self {
            normal: normal * (1.0 / area),
            height: area / longest * (1.0 / 3.5),
            is_ordinary: (longest > 1e-8)
                & (longest < 1e8)
                & (squared > 1e-12 * edge_squared * edge_squared),
        }
    }

    /// The unit normal of any triangle; corners may be as small or large as f32 holds.
    #[cold]
    fn exact_normal(corners: [Vec3; 3]) -> Vec3 {
        let plane = Self::of(corners);
        if plane.is_ordinary {
            return plane.normal;
        }
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        (b - a).cross(c - a).normalize_or(glam::DVec3::Y).as_vec3()
    }
}

#[cfg(test)]
mod tests;

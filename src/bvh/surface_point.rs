//! Where a hit lies in the world, how far the rounding of that may be off, and where a ray starts that leaves it.
//!
//! # The error
//! u = 2⁻²⁴. A point is the sum of three weighted corners, which rounds by at most 7u Σ b|v| (Pharr, Jakob, Humphreys,
//! "Physically Based Rendering", 4th ed., 6.8.5); carried into the world that is multiplied by |L|, and the transform adds
//! 4u (|L||p| + |T|), T where the instance stands at that time, reached by another rounding of its way. A new ray from
//! there is rounded twice more: on its way into object space, by 6u κ |p - T| (see `bvh/instance.rs`), and where the
//! triangle test sums t from corners relative to the ray's origin, by 8u Σ b|v - p|. All of this is a bound for each
//! coordinate ([`SurfacePoint::error`]), and so for every direction: a point is off **along** its triangle by as much as
//! **across** it. Let e be the sum of its three coordinates, which is no less than its length.
//!
//! # A start beside an edge
//! [`SurfacePoint::leave`] moves the point along the normal out of its error's box. The start is then at most 2.5e above
//! the triangle (|n| · error, what the point was off, and one step of each coordinate) and 1.5e beside the exact point. In
//! a wedge of the angle φ a start `h` above one side at the distance `d` from the edge is before the other side where
//! `d sin φ > h cos φ`. So nothing has to be done at a distance of more than 1.5e + 2.5e cot φ from every edge, for which
//! 4e / sin φ is enough at every angle; the angle is that of the mesh's [`Wedges`]. Edges are measured where
//! the mesh is: distances there are `1/s` times those in the world, s the least factor by which the transform shortens
//! ([`Instance::edge_reach`]).
//!
//! What is nearer ([`SurfacePoint::near_edge`]) is one hit in some ten thousand beside the origin, and one in three in a
//! room that stands 12 km away from it. [`super::leave`] finds a start for those.

use glam::Vec3;

use super::{Hit, Instance, wedges::Wedges};

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World space, from the barycentric weights: closer to the surface than `origin + t · direction`.
    pub position: Vec3,
    /// A ray that starts farther from the surface than this, in each coordinate, does not meet it again.
    pub error: Vec3,
    /// Unit normal of the triangle, by the winding of its corners in object space.
    pub normal: Vec3,
    /// Where the point is so close to an edge of its triangle that `error` may reach behind the surface beyond: the hit,
    /// from which [`Aggregate::leave`](super::Aggregate::leave) finds the start of a ray.
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
    /// Where a ray starts that leaves by the side to which `towards` points, so that it does not meet this surface again:
    /// moved along the normal, out of the box in which the exact point lies (Pharr, Jakob, Humphreys, "Physically Based
    /// Rendering", 4th ed., 6.8.6). Not for a point near an edge.
    pub(super) fn leave(&self, towards: Vec3) -> Vec3 {
        let n = self.normal;
        let side = if towards.dot(n) < 0.0 { -1.0 } else { 1.0 };
        let offset = side * n.abs().dot(self.error) * n;
        let away = |p: f32, d: f32| {
            let moved = p + d;
            if d > 0.0 {
                moved.next_up()
            } else if d < 0.0 {
                moved.next_down()
            } else {
                moved
            }
        };
        Vec3::new(
            away(self.position.x, offset.x),
            away(self.position.y, offset.y),
            away(self.position.z, offset.z),
        )
    }
}

/// Half an ulp of 1.
const U: f32 = f32::EPSILON / 2.0;

/// So many times the error over the sine of the wedge a point has to be away from an edge (see the module).
const CLEAR_OF_AN_EDGE: f32 = 4.0;

impl Instance {
    /// The point of a hit on this instance by a ray of `time`.
    ///
    /// # Panics
    /// When `hit` is not a hit on this instance's mesh.
    pub fn surface_point(&self, hit: &Hit, time: f32) -> SurfacePoint {
        let corners = self.mesh.triangles().corners(hit.triangle);
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let weighted =
            |f: &dyn Fn(Vec3) -> Vec3| -> Vec3 { (0..3).map(|i| weights[i] * f(corners[i])).sum() };
        let point = weighted(&|v| v);
        let size = weighted(&|v| v.abs());
        let reach = weighted(&|v| (v - point).abs()).max_element();
        let error = U * (7.0 * size + Vec3::splat(8.0 * reach));
        let Plane { normal, height } = Plane::of(corners);
        let mut placed = SurfacePoint {
            position: point,
            error,
            normal,
            near_edge: None,
        };
        if !self.is_identity() {
            let transform = self.world_from_object();
            let linear = transform.matrix3.abs();
            let way = self.velocity() * time;
            let translation = Vec3::from(transform.translation) + way;
            placed.position = self.to_world_point(point) + way;
            placed.error = linear * error
                + 4.0 * U * (linear * point.abs() + translation.abs() + 2.0 * way.abs())
                + Vec3::splat(
                    6.0 * U
                        * self.condition()
                        * (placed.position - translation).abs().max_element(),
                );
            placed.normal = self.to_world_normal(normal).normalize_or(normal);
        }
        let wedges = self.mesh.wedges();
        let clear = CLEAR_OF_AN_EDGE * placed.error.element_sum() * self.edge_reach();
        let least = weights[0].min(hit.u).min(hit.v);
        if least * height <= clear * wedges.narrowest()
            && near_edge(corners, weights, clear, hit.triangle, wedges)
        {
            placed.near_edge = Some(NearEdge { hit: *hit, time });
        }
        placed
    }
}

/// Whether the point of a triangle with these weights is not `clear` of an edge, times what its wedge asks for.
#[cold]
fn near_edge(
    [a, b, c]: [Vec3; 3],
    weights: [f32; 3],
    clear: f32,
    triangle: u32,
    wedges: &Wedges,
) -> bool {
    let clear = f64::from(clear * wedges.of_triangle(triangle));
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
}

impl Plane {
    /// Of a triangle that is no line; corners may be as small or large as f32 holds.
    fn of([a, b, c]: [Vec3; 3]) -> Self {
        let (ab, ac) = (b - a, c - a);
        let longest = ab.abs().max(ac.abs()).max_element();
        // The square of the product of tiny or huge edges would leave f32's range.
        let scale = if (1e-8..1e8).contains(&longest) {
            1.0
        } else {
            longest
        };
        let normal = if scale == 1.0 {
            ab.cross(ac)
        } else {
            (ab / scale).cross(ac / scale)
        };
        let squared = normal.length_squared();
        let edge = longest / scale;
        if squared > 1e-12 * (edge * edge) * (edge * edge) && squared.is_finite() {
            // Twice the area over the longest edge, of which no coordinate is longer than twice the scale.
            let area = squared.sqrt();
            return Self {
                normal: normal * (1.0 / area),
                height: area / edge * scale * (1.0 / 3.5),
            };
        }
        // A sliver: f32's product has lost its digits.
        let normal = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
        Self {
            normal: normal.normalize_or(glam::DVec3::Y).as_vec3(),
            height: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{BuildOptions, MeshTree, Triangles};
    use glam::{Affine3A, Quat};
    use std::sync::Arc;

    #[test]
    fn the_normal_of_a_tiny_triangle_or_a_sliver_has_unit_length() {
        for size in [1e-18_f32, 1e-6, 1.0, 1e12] {
            let n = Plane::of([Vec3::ZERO, Vec3::X * size, Vec3::NEG_Z * size]).normal;
            assert!((n - Vec3::Y).length() < 1e-6, "size {size:e}: {n}");
        }
        let n = Plane::of([Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.0, -1e-7)]).normal;
        assert!((n - Vec3::Y).length() < 1e-6, "sliver: {n}");
    }

    #[test]
    fn the_point_lies_within_its_error_of_the_exact_one() {
        let corners = vec![
            Vec3::new(0.1, 0.7, -0.3),
            Vec3::new(1.9, -0.2, 0.4),
            Vec3::new(-0.6, 0.3, 1.1),
        ];
        let triangles = Triangles::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
        let mesh = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
        let transform = Affine3A::from_scale_rotation_translation(
            Vec3::new(2.0, -0.5, 30.0),
            Quat::from_rotation_y(0.7),
            Vec3::new(1000.0, -20.0, 3.0),
        );
        let instance = Instance::new(mesh, &transform).unwrap();
        for i in 0..100 {
            let (u, v) = (i as f32 * 0.004, 0.55 - i as f32 * 0.005);
            let hit = Hit {
                t: 1.0,
                instance: 0,
                triangle: 0,
                u,
                v,
            };
            let point = instance.surface_point(&hit, 0.0);
            let (u, v) = (f64::from(u), f64::from(v));
            let [a, b, c] = [0, 1, 2].map(|i: usize| corners[i].as_dvec3());
            let object = a * (1.0 - u - v) + b * u + c * v;
            let matrix = transform.matrix3;
            let exact = matrix.x_axis.as_dvec3() * object.x
                + matrix.y_axis.as_dvec3() * object.y
                + matrix.z_axis.as_dvec3() * object.z
                + transform.translation.as_dvec3();
            let off = (point.position.as_dvec3() - exact).abs();
            assert!(
                off.cmple(point.error.as_dvec3()).all(),
                "{off} is more than {}",
                point.error
            );
        }
    }
}

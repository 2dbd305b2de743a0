//! Where a hit lies in the world, and how far the rounding of that may be off.

use glam::Vec3;

use super::{Hit, Instance};

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// World space, from the barycentric weights: closer to the surface than `origin + t · direction`.
    pub position: Vec3,
    /// A ray that starts farther from the surface than this, in each coordinate, does not meet it again.
    pub error: Vec3,
    /// Unit normal of the triangle, by the winding of its corners in object space.
    pub normal: Vec3,
}

impl SurfacePoint {
    /// Where a ray along `direction` starts, so that it does not meet this surface again: moved along the normal, to
    /// the side that the ray leaves by, out of the box in which the exact point lies (Pharr, Jakob, Humphreys,
    /// "Physically Based Rendering", 4th ed., 6.8.6).
    pub fn leave(&self, direction: Vec3) -> Vec3 {
        let n = self.normal;
        let side = if direction.dot(n) < 0.0 { -1.0 } else { 1.0 };
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

impl Instance {
    /// The point of a hit on this instance by a ray of `time`.
    ///
    /// # The error
    /// The sum of three weighted corners rounds by at most 7u Σ b|v| (Pharr, Jakob, Humphreys, "Physically Based
    /// Rendering", 4th ed., 6.8.5); carried into the world that is multiplied by |L|, and the transform adds
    /// 4u (|L||p| + |T|), T where the instance stands at that time, reached by another rounding of its way. A new ray from there is rounded twice more: on its way into object space, by 6u κ |p - T|
    /// (see `bvh/instance.rs`), and where the triangle test sums t from corners relative to the ray's origin, by
    /// 8u Σ b|v - p|.
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
        let normal = triangle_normal(corners);
        if self.is_identity() {
            return SurfacePoint {
                position: point,
                error,
                normal,
            };
        }
        let transform = self.world_from_object();
        let linear = transform.matrix3.abs();
        let way = self.velocity() * time;
        let translation = Vec3::from(transform.translation) + way;
        let position = self.to_world_point(point) + way;
        let carried = linear * error
            + 4.0 * U * (linear * point.abs() + translation.abs() + 2.0 * way.abs())
            + Vec3::splat(
                6.0 * U * self.condition() * (position - translation).abs().max_element(),
            );
        SurfacePoint {
            position,
            error: carried,
            normal: self.to_world_normal(normal).normalize_or(normal),
        }
    }
}

/// Unit normal of a triangle that is no line; corners may be as small or large as f32 holds.
fn triangle_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let (ab, ac) = (b - a, c - a);
    // Scaled first: the product of two small edges would leave f32's range.
    let scale = ab.abs().max(ac.abs()).max_element();
    let normal = (ab / scale).cross(ac / scale);
    let squared = normal.length_squared();
    if squared > 1e-12 && squared.is_finite() {
        return normal / squared.sqrt();
    }
    // A sliver: f32's product has lost its digits.
    let normal = (b.as_dvec3() - a.as_dvec3()).cross(c.as_dvec3() - a.as_dvec3());
    normal.normalize_or(glam::DVec3::Y).as_vec3()
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
            let n = triangle_normal([Vec3::ZERO, Vec3::X * size, Vec3::NEG_Z * size]);
            assert!((n - Vec3::Y).length() < 1e-6, "size {size:e}: {n}");
        }
        let n = triangle_normal([Vec3::ZERO, Vec3::X, Vec3::new(0.5, 0.0, -1e-7)]);
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

//! The crossing of a ray and a triangle in f64: differences of f32 are exact there, and what is left of rounding is far
//! below an ulp of f32. As a triangle test, and as what the other tests' errors are measured against.

use super::tests_of_triangles::TriangleTest;
use crate::bvh::Ray;
use glam::{DVec3, Vec3};
use obvhs::ray::Ray as ObvhsRay;

/// t, u, v where the line of the ray meets the triangle's plane; not finite where it lies in it.
pub(super) fn crossing(corners: &[Vec3; 3], origin: DVec3, direction: DVec3) -> [f64; 3] {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3() - origin);
    // Signed volumes of the ray with each edge (Cramer's rule): they sum up to the determinant.
    let [of_a, of_b, of_c] = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.dot(q.cross(p)));
    let sum = of_a + of_b + of_c;
    let (u, v) = (of_b / sum, of_c / sum);
    let normal = (b - a).cross(c - a);
    [normal.dot(a) / normal.dot(direction), u, v]
}

/// A triangle that is tested in f64.
pub(super) struct Exact([Vec3; 3]);

impl Exact {
    #[inline(always)]
    fn solve(&self, ready: &(DVec3, DVec3)) -> Option<[f64; 3]> {
        let [t, u, v] = crossing(&self.0, ready.0, ready.1);
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some([t, u, v])
    }
}

impl TriangleTest for Exact {
    type Ready = (DVec3, DVec3);

    fn new(corners: [Vec3; 3]) -> Self {
        Self(corners)
    }

    fn ready(ray: &Ray) -> Option<Self::Ready> {
        Some((ray.origin.as_dvec3(), ray.direction.as_dvec3()))
    }

    #[inline(always)]
    fn cross(&self, ready: &Self::Ready, _: &ObvhsRay, limit: f32) -> f32 {
        match self.solve(ready) {
            Some([t, ..]) if t > 0.0 && t < f64::from(limit) => t as f32,
            _ => f32::INFINITY,
        }
    }

    fn weights(&self, ready: &Self::Ready, _: &ObvhsRay) -> [f32; 2] {
        let solved = self.solve(ready);
        solved.map_or([0.0; 2], |[_, u, v]| [u as f32, v as f32])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_of_the_triangle_has_the_weights_that_it_was_made_with() {
        let corners = [
            Vec3::new(0.1, 0.7, -0.3),
            Vec3::new(1.9, -0.2, 0.4),
            Vec3::new(-0.6, 0.3, 1.1),
        ];
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        for (u, v) in [(0.2, 0.3), (0.9, 0.05), (-0.5, 0.1)] {
            let point = a * (1.0 - u - v) + b * u + c * v;
            let origin = DVec3::new(3.0, 2.0, -1.0);
            let found = crossing(&corners, origin, (point - origin) / 7.0);
            for (found, expected) in found.into_iter().zip([7.0, u, v]) {
                assert!((found - expected).abs() < 1e-13, "{found} for {expected}");
            }
        }
    }
}

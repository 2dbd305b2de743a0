//! Möller and Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection" (JGT 2(1), 1997), in f32, both sides.

use super::tests_of_triangles::TriangleTest;
use crate::bvh::Ray;
use glam::{Vec3, Vec3A};
use obvhs::ray::Ray as ObvhsRay;

/// A corner and the two edges that leave it.
pub(super) struct MollerTrumbore {
    corner: Vec3A,
    edges: [Vec3A; 2],
}

impl MollerTrumbore {
    /// t, u, v where the line meets the triangle.
    #[inline(always)]
    fn solve(&self, origin: Vec3A, direction: Vec3A) -> Option<[f32; 3]> {
        let [e1, e2] = self.edges;
        let p = direction.cross(e2);
        let inverse = 1.0 / e1.dot(p);
        let s = origin - self.corner;
        let u = s.dot(p) * inverse;
        let q = s.cross(e1);
        let v = direction.dot(q) * inverse;
        // A ray in the plane divides by zero: what then is not a number fails here.
        (u >= 0.0 && v >= 0.0 && u + v <= 1.0).then(|| [e2.dot(q) * inverse, u, v])
    }
}

impl TriangleTest for MollerTrumbore {
    type Ready = ();

    fn new([a, b, c]: [Vec3; 3]) -> Self {
        Self {
            corner: a.into(),
            edges: [(b - a).into(), (c - a).into()],
        }
    }

    fn ready(_: &Ray) -> Option<()> {
        Some(())
    }

    #[inline(always)]
    fn cross(&self, (): &(), walked: &ObvhsRay, limit: f32) -> f32 {
        match self.solve(walked.origin, walked.direction) {
            Some([t, ..]) if t > 0.0 && t < limit => t,
            _ => f32::INFINITY,
        }
    }

    fn weights(&self, (): &(), walked: &ObvhsRay) -> [f32; 2] {
        let solved = self.solve(walked.origin, walked.direction);
        solved.map_or([0.0; 2], |[_, u, v]| [u, v])
    }
}

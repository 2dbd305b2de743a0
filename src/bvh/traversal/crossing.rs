//! Where a ray crosses a surface exactly on an edge or in a corner, several triangles report the same crossing.

use glam::Vec3;

use crate::bvh::{Aggregate, Hit, Ray, Visitor};

impl Aggregate {
    /// The next crossing behind `after`, a hit of the same ray: the ray goes straight on through what it met. Every
    /// layer is met once, however close layers lie, and also where the ray passes through an edge or a corner that
    /// triangles of one mesh share: the same corners in both, with nothing else in between.
    pub fn next_crossing(&self, ray: &Ray, after: &Hit) -> Option<Hit> {
        self.crossing_behind(after, |last| self.closest_hit_after(ray, last))
    }

    /// [`Self::next_crossing`], watched.
    pub fn next_crossing_with<V: Visitor>(
        &self,
        ray: &Ray,
        after: &Hit,
        visitor: &mut V,
    ) -> Option<Hit> {
        self.crossing_behind(after, |last| {
            self.closest_hit_after_with(ray, last, visitor)
        })
    }

    /// The first of the hits behind `after`, one found `behind` the other, that is a crossing of its own.
    #[inline(always)]
    fn crossing_behind(
        &self,
        after: &Hit,
        mut behind: impl FnMut(&Hit) -> Option<Hit>,
    ) -> Option<Hit> {
        let mut last = *after;
        while let Some(hit) = behind(&last) {
            if !self.same_crossing(&last, &hit) {
                return Some(hit);
            }
            last = hit;
        }
        None
    }

    /// Whether a hit lies on an edge of its triangle, or in a corner.
    pub(super) fn is_on_an_edge(&self, hit: &Hit) -> bool {
        self.touched(hit).is_some()
    }

    /// Whether two hits lie on the same edge, or in the same corner, of neighbouring triangles.
    pub(super) fn same_crossing(&self, a: &Hit, b: &Hit) -> bool {
        if a.instance != b.instance {
            return false;
        }
        let (Some(a), Some(b)) = (self.touched(a), self.touched(b)) else {
            return false;
        };
        a.iter().flatten().all(|p| b.contains(&Some(*p)))
            && b.iter().flatten().all(|p| a.contains(&Some(*p)))
    }

    /// The corners of the edge that a hit lies on, or the one corner; `None` inside the triangle.
    fn touched(&self, hit: &Hit) -> Option<[Option<Vec3>; 3]> {
        // A weight whose edge function is zero is exactly zero for corners 1 and 2; that of corner 0 is what is left
        // of 1 after two products with a rounded reciprocal.
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let zero = [
            weights[0].abs() <= 4.0 * f32::EPSILON,
            hit.u == 0.0,
            hit.v == 0.0,
        ];
        if !zero.contains(&true) {
            return None;
        }
        let mesh = &self.instances()[hit.instance as usize].mesh;
        let corners = mesh.triangles().corners(hit.triangle);
        Some(std::array::from_fn(|i| (!zero[i]).then_some(corners[i])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{BuildOptions, Instance, MeshTree, Triangles};
    use glam::Affine3A;
    use std::sync::Arc;

    fn aggregate(positions: Vec<Vec3>, indices: Vec<[u32; 3]>) -> Aggregate {
        let options = BuildOptions::default();
        let triangles = Triangles::new(positions, indices).unwrap();
        let mesh = Arc::new(MeshTree::build(triangles, &options));
        let instance = Instance::new(mesh, &Affine3A::IDENTITY).unwrap();
        Aggregate::build(vec![instance], &options)
    }

    fn crossings(aggregate: &Aggregate, ray: &Ray) -> usize {
        let mut count = 0;
        let mut next = aggregate.closest_hit(ray);
        while let Some(hit) = next {
            count += 1;
            next = aggregate.next_crossing(ray, &hit);
        }
        count
    }

    #[test]
    fn a_ray_through_a_shared_edge_or_corner_crosses_the_surface_once() {
        // A fan of eight triangles around the origin, in both windings, their corners not shared by index.
        let corner = |i: usize| {
            let angle = i as f32 * std::f32::consts::TAU / 8.0;
            Vec3::new(angle.cos(), 0.1 * (i % 2) as f32, angle.sin())
        };
        let mut positions = Vec::new();
        let mut indices = Vec::new();
        for i in 0..8 {
            let first = positions.len() as u32;
            positions.extend([Vec3::ZERO, corner(i), corner((i + 1) % 8)]);
            indices.push(match i % 3 {
                0 => [first, first + 1, first + 2],
                1 => [first + 1, first, first + 2],
                _ => [first + 2, first, first + 1],
            });
        }
        let fan = aggregate(positions, indices);
        assert_eq!(
            crossings(&fan, &Ray::new(Vec3::Y, Vec3::NEG_Y)),
            1,
            "the corner"
        );
        for i in 0..8 {
            for step in 1..64 {
                let target = corner(i) * (step as f32 / 64.0);
                for origin in [
                    Vec3::new(target.x, 1.0, target.z),
                    Vec3::new(0.3, 2.0, -0.1),
                ] {
                    let count = crossings(&fan, &Ray::new(origin, target - origin));
                    assert_eq!(count, 1, "edge {i}, step {step}, from {origin}");
                }
            }
        }
    }

    #[test]
    fn layers_as_close_as_floats_allow_are_crossed_one_by_one() {
        let mut positions = Vec::new();
        let mut indices = Vec::new();
        let mut y = 1.0_f32;
        for layer in 0..64u32 {
            positions.extend([
                Vec3::new(-1.0, y, -1.0),
                Vec3::new(3.0, y, -1.0),
                Vec3::new(-1.0, y, 3.0),
            ]);
            indices.push([3 * layer, 3 * layer + 1, 3 * layer + 2]);
            y = y.next_up();
        }
        let layers = aggregate(positions, indices);
        let down = Ray::new(Vec3::new(0.2, 5.0, 0.3), Vec3::new(0.01, -1.0, 0.02));
        assert_eq!(crossings(&layers, &down), 64);
    }
}

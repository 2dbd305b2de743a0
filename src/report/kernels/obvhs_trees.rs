//! obvhs' own trees and traversals, with any triangle test in their leaves.

use super::tests_of_triangles::TriangleTest;
use super::{Found, Kernel};
use crate::bvh::Ray;
use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle;
use std::time::Duration;

/// Triangles in the order of a tree's leaves, with their numbers.
struct Leaves<T> {
    triangles: Vec<T>,
    numbers: Vec<u32>,
}

impl<T: TriangleTest> Leaves<T> {
    fn new(triangles: &[[Vec3; 3]], order: &[u32]) -> Self {
        let corners = order.iter().map(|&number| triangles[number as usize]);
        Self {
            triangles: corners.map(T::new).collect(),
            numbers: order.to_vec(),
        }
    }
}

/// A ray as obvhs wants it; a component of -0.0 would miss everything in its wide tree.
fn walked(ray: &Ray) -> ObvhsRay {
    let direction = ray.direction + 0.0;
    ObvhsRay::new(ray.origin.into(), direction.into(), 0.0, ray.t_max)
}

fn triangles_of(triangles: &[[Vec3; 3]]) -> Vec<Triangle> {
    let one = |[a, b, c]: &[Vec3; 3]| Triangle {
        v0: (*a).into(),
        v1: (*b).into(),
        v2: (*c).into(),
    };
    triangles.iter().map(one).collect()
}

/// The two-way tree.
pub(super) struct Binary<T> {
    tree: Bvh2,
    leaves: Leaves<T>,
}

impl<T: TriangleTest> Binary<T> {
    pub fn build(triangles: &[[Vec3; 3]]) -> Self {
        let preset = BvhBuildParams::medium_build();
        let tree = build_bvh2_from_tris(&triangles_of(triangles), preset, &mut Duration::default());
        let leaves = Leaves::new(triangles, &tree.primitive_indices);
        Self { tree, leaves }
    }
}

/// The eight-way tree with quantised boxes.
pub(super) struct Wide<T> {
    tree: CwBvh,
    leaves: Leaves<T>,
}

impl<T: TriangleTest> Wide<T> {
    pub fn build(triangles: &[[Vec3; 3]]) -> Self {
        let preset = BvhBuildParams::medium_build();
        let tree =
            build_cwbvh_from_tris(&triangles_of(triangles), preset, &mut Duration::default());
        let leaves = Leaves::new(triangles, &tree.primitive_indices);
        Self { tree, leaves }
    }
}

/// Both trees have the same calls, but no trait for them.
macro_rules! kernel {
    ($tree:ident) => {
        impl<T: TriangleTest> Kernel for $tree<T> {
            fn closest(&self, rays: &[Ray], found: &mut Vec<Option<Found>>) {
                let Leaves { triangles, numbers } = &self.leaves;
                let find = |ray: &Ray| {
                    let (ready, walked) = (T::ready(ray)?, walked(ray));
                    let mut hit = RayHit::none();
                    self.tree.ray_traverse(walked, &mut hit, |now, place| {
                        triangles[place].cross(&ready, now, now.tmax)
                    });
                    if hit.t == f32::INFINITY {
                        return None;
                    }
                    let place = hit.primitive_id as usize;
                    let [u, v] = triangles[place].weights(&ready, &walked);
                    Some(Found {
                        t: hit.t,
                        triangle: numbers[place],
                        u,
                        v,
                    })
                };
                found.clear();
                found.extend(rays.iter().map(find));
            }

            fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
                let triangles = &self.leaves.triangles;
                let is_occluded = |ray: &Ray| {
                    let Some(ready) = T::ready(ray) else {
                        return false;
                    };
                    let missed = self.tree.ray_traverse_miss(walked(ray), |now, place| {
                        triangles[place].cross(&ready, now, now.tmax)
                    });
                    !missed
                };
                occluded.clear();
                occluded.extend(rays.iter().map(is_occluded));
            }
        }
    };
}

kernel!(Binary);
kernel!(Wide);

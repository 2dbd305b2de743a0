//! One mesh and its tree: built once, shared by every instance.

use std::time::{Duration, Instant};

use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};

use super::{
    build_tree,
    options::BuildOptions,
    slab::{SlabRay, triangle_box},
    stats::TreeStats,
    traverse::{STOP, Stack, walk},
    triangle::{Crossing, LeafTriangle, Shear, cross},
    triangles::Triangles,
    visitor::{TreeRef, Visitor},
};

/// A mesh's triangles, the tree over them, and their corners again in the order of the tree's leaves.
#[derive(Clone)]
pub struct MeshTree {
    triangles: Triangles,
    tree: Bvh2,
    leaves: Vec<LeafTriangle>,
    build_time: Duration,
}

impl MeshTree {
    /// Builds the tree. Triangles that cannot be traced are not in it.
    pub fn build(triangles: Triangles, options: &BuildOptions) -> Self {
        let start = Instant::now();
        let numbers: Vec<u32> = (0..triangles.len() as u32)
            .filter(|&triangle| triangles.is_traced(triangle))
            .collect();
        let boxes: Vec<Aabb> = numbers
            .iter()
            .map(|&triangle| triangle_box(triangles.corners(triangle).map(Vec3A::from)))
            .collect();
        let tree = build_tree(&boxes, options);
        let leaves = tree
            .primitive_indices
            .iter()
            .map(|&slot| {
                let number = numbers[slot as usize];
                LeafTriangle::new(triangles.corners(number), number)
            })
            .collect();
        Self {
            triangles,
            tree,
            leaves,
            build_time: start.elapsed(),
        }
    }

    /// The mesh.
    pub fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    /// The tree over those triangles that are traced. Its primitives are positions in a list without the others:
    /// [`Self::triangle_at`] names the triangle. Boxes are widened by a few units in the last place.
    pub fn tree(&self) -> &Bvh2 {
        &self.tree
    }

    /// The number of the triangle at a place in leaf order (`first_index ..` of a leaf).
    pub fn triangle_at(&self, place: usize) -> u32 {
        self.leaves[place].number
    }

    /// How many triangles are traced.
    pub fn traced(&self) -> usize {
        self.leaves.len()
    }

    /// The box around all traced triangles (a few units in the last place wider), or `None` when there is none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.tree.nodes.first().map(|root| *root.aabb())
    }

    /// Memory held, in bytes: mesh, tree and leaves.
    pub fn bytes(&self) -> usize {
        size_of_val(self.triangles.positions())
            + size_of_val(self.triangles.indices())
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.primitive_indices.as_slice())
    }

    /// Statistics of the tree.
    pub fn stats(&self) -> TreeStats {
        TreeStats::of(&self.tree)
    }

    /// How long building took.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// Walks the tree along a ray in object space. `at(triangle number, crossing, limit)` returns the new limit.
    #[inline(always)]
    pub(crate) fn walk<V: Visitor>(
        &self,
        ray: &ObjectRay,
        stack: &mut Stack,
        limit: f32,
        instance: u32,
        visitor: &mut V,
        mut at: impl FnMut(u32, Option<Crossing>, f32, &mut V) -> f32,
    ) -> f32 {
        let mut shear = None;
        walk(
            &self.tree.nodes,
            stack,
            &ray.slab,
            limit,
            TreeRef::Mesh(instance),
            visitor,
            |first, count, mut limit, visitor| {
                let shear = shear.get_or_insert_with(|| Shear::new(ray.origin, ray.direction));
                let first = first as usize;
                for triangle in &self.leaves[first..first + count as usize] {
                    let crossing = cross(shear, &ray.slab, triangle, limit);
                    limit = at(triangle.number, crossing, limit, visitor);
                    if limit == STOP {
                        break;
                    }
                }
                limit
            },
        )
    }

    /// The padded box of a triangle by its place in leaf order, in object space.
    pub(crate) fn box_at(&self, place: usize) -> Aabb {
        triangle_box(self.leaves[place].corners().map(Vec3A::from))
    }

    /// One triangle by its place in leaf order, tested against a ray in object space.
    #[inline(always)]
    pub(crate) fn cross_at(
        &self,
        shear: &Shear,
        ray: &ObjectRay,
        place: u32,
        limit: f32,
    ) -> (u32, Option<Crossing>) {
        let triangle = &self.leaves[place as usize];
        (triangle.number, cross(shear, &ray.slab, triangle, limit))
    }
}

/// A ray in a mesh's own space, with what the slab test needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRay {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    pub(crate) slab: SlabRay,
}

impl ObjectRay {
    /// The direction's largest component must lie within the range that [`SlabRay`] asks for.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            slab: SlabRay::new(origin, direction, SlabRay::pad_of(origin)),
        }
    }
}

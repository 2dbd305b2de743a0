//! One mesh and its tree: built once, shared by every instance.

use std::{
    marker::PhantomData,
    time::{Duration, Instant},
};

use glam::Vec3A;
use obvhs::{aabb::Aabb, bvh2::Bvh2};
use rayon::prelude::*;

use super::{
    build_tree,
    goal::Goal,
    options::BuildOptions,
    ray::Hit,
    slab::{SlabRay, triangle_box},
    stats::TreeStats,
    traverse::{STOP, Stack, walk},
    triangle::{Crossing, LeafTriangle, Shear, cross},
    triangles::Triangles,
    visitor::{TreeRef, Visitor},
    wedges::Wedges,
    wide::{
        self, Eight, Found, Group, InstructionSet, Leaves, PacketLeaves, PacketRays, TriangleBlock,
        View, WideBox, WideRay, WideStats, WideTree, lanes_of,
    },
};

/// Below this many triangles a pass over them takes less time than handing it to other threads.
const PARALLEL_SIZE: usize = 1 << 13;

/// A mesh's triangles, the tree over them, and their corners again in the order of the tree's leaves. And the same in
/// the form in which rays walk it when nobody watches.
#[derive(Clone)]
pub struct MeshTree {
    triangles: Triangles,
    tree: Bvh2,
    pub(crate) leaves: Vec<LeafTriangle>,
    wide: WideTree,
    blocks: Vec<TriangleBlock>,
    wedges: Wedges,
    /// The largest coordinate of a traced triangle, without its sign.
    reach: f32,
    build_time: Duration,
}

impl MeshTree {
    /// Builds the tree. Triangles that cannot be traced are not in it.
    pub fn build(triangles: Triangles, options: &BuildOptions) -> Self {
        let start = Instant::now();
        let numbers: Vec<u32> = (0..triangles.len() as u32)
            .into_par_iter()
            .with_min_len(PARALLEL_SIZE)
            .filter(|&triangle| triangles.is_traced(triangle))
            .collect();
        let ((tree, leaves, wide, blocks), wedges) = rayon::join(
            || tree_over(&triangles, &numbers, options),
            || Wedges::of(&triangles, &numbers),
        );
        let reach = tree.nodes.first().map_or(Vec3A::ZERO, |root| {
            let bounds = root.aabb();
            bounds.min.abs().max(bounds.max.abs())
        });
        Self {
            reach: reach.max_element(),
            wedges,
            triangles,
            tree,
            leaves,
            wide,
            blocks,
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

    /// The largest coordinate of its tree's box, without its sign.
    pub(super) fn reach(&self) -> f32 {
        self.reach
    }

    /// How narrow the wedges are that its triangles make with each other.
    pub(super) fn wedges(&self) -> &Wedges {
        &self.wedges
    }

    /// Memory held, in bytes: mesh, tree and leaves.
    pub fn bytes(&self) -> usize {
        size_of_val(self.triangles.positions())
            + size_of_val(self.triangles.indices())
            + size_of_val(self.leaves.as_slice())
            + size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.primitive_indices.as_slice())
            + self.wide.bytes()
            + size_of_val(self.blocks.as_slice())
            + self.wedges.bytes()
    }

    /// Statistics of the tree.
    pub fn stats(&self) -> TreeStats {
        TreeStats::of(&self.tree)
    }

    /// Statistics of the form that rays walk when nobody watches.
    pub fn wide_stats(&self) -> WideStats {
        let nodes = self.wide.stats();
        WideStats {
            blocks: self.blocks.len(),
            triangles_per_block: self.traced() as f64 / self.blocks.len().max(1) as f64,
            bytes: nodes.bytes + size_of_val(self.blocks.as_slice()),
            ..nodes
        }
    }

    /// The boxes of the form that rays walk when nobody watches, parents before children.
    pub fn wide_boxes(&self) -> Vec<WideBox> {
        let root = self.bounds().unwrap_or_default();
        self.wide.boxes(&root)
    }

    /// How long building took.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// The wide form.
    #[cfg(test)]
    pub(crate) fn wide(&self) -> (&WideTree, &[TriangleBlock]) {
        (&self.wide, &self.blocks)
    }

    /// Entries of a stack that [`Self::walk_wide`] needs.
    pub(crate) fn most_pending(&self) -> usize {
        self.wide.most_pending()
    }

    /// Walks the tree along a ray in object space, from the first `t` of the span to the second, the limit, unwatched:
    /// [`walk`](wide::walk). `at(triangle number, crossing, limit)` returns the new limit, or [`STOP`].
    #[inline(always)]
    pub(crate) fn walk_wide<E: Eight, G: Goal>(
        &self,
        ray: &ObjectRay,
        stack: &mut [u64],
        (start, limit): (f32, f32),
        at: impl FnMut(u32, Crossing, f32) -> f32,
    ) -> f32 {
        let mut leaves = MeshLeaves::<_, G> {
            blocks: &self.blocks,
            reach: self.reach,
            ray,
            shear: None,
            at,
            goal: PhantomData,
        };
        let wide_ray = WideRay::new(&ray.slab, start);
        wide::walk::<E, G>(&self.wide, stack, &wide_ray, limit, &mut leaves)
    }

    /// Walks the tree with a group of a packet's rays in object space.
    #[inline(always)]
    pub(crate) fn walk_packet<S: InstructionSet, G: Goal>(
        &self,
        rays: &PacketRays<S::Packet>,
        group: &Group,
        instance: u32,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        let mut view = View::<S>::new(rays, group);
        let mut leaves = PacketOfMesh::<S, G> {
            mesh: self,
            rays,
            instance,
            goal: PhantomData,
        };
        wide::walk_packet::<S, G>(
            &self.wide,
            stack,
            &mut view,
            group.lanes,
            found,
            &mut leaves,
        );
    }

    /// Walks the tree along a ray in object space, from the first `t` of the span to the second, the limit. `at(triangle
    /// number, crossing, limit)` returns the new one.
    #[inline(always)]
    pub(crate) fn walk<V: Visitor>(
        &self,
        ray: &ObjectRay,
        stack: &mut Stack,
        span: (f32, f32),
        instance: u32,
        visitor: &mut V,
        mut at: impl FnMut(u32, Option<Crossing>, f32, &mut V) -> f32,
    ) -> f32 {
        let mut shear = None;
        walk(
            &self.tree.nodes,
            stack,
            &ray.slab,
            span,
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

    /// A triangle by its place in leaf order.
    pub(crate) fn leaf_triangle(&self, place: u32) -> LeafTriangle {
        self.leaves[place as usize]
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

/// The tree over the triangles of these numbers, their corners in the order of its leaves, and both in the form in which rays
/// walk it when nobody watches.
fn tree_over(
    triangles: &Triangles,
    numbers: &[u32],
    options: &BuildOptions,
) -> (Bvh2, Vec<LeafTriangle>, WideTree, Vec<TriangleBlock>) {
    let boxes: Vec<Aabb> = (numbers.par_iter().with_min_len(PARALLEL_SIZE))
        .map(|&triangle| triangle_box(triangles.corners(triangle).map(Vec3A::from)))
        .collect();
    let tree = build_tree(&boxes, options);
    drop(boxes);
    let leaves: Vec<LeafTriangle> = (tree.primitive_indices.par_iter())
        .with_min_len(PARALLEL_SIZE)
        .map(|&slot| {
            let number = numbers[slot as usize];
            LeafTriangle::new(triangles.corners(number), number)
        })
        .collect();
    let (wide, blocks) = WideTree::new(&tree, TriangleBlock::CAPACITY, |places, blocks| {
        TriangleBlock::append(&leaves[places], blocks);
    });
    (tree, leaves, wide, blocks)
}

/// The blocks of a mesh's wide tree, with a ray.
struct MeshLeaves<'a, At, G> {
    blocks: &'a [TriangleBlock],
    reach: f32,
    ray: &'a ObjectRay,
    /// Made at the first leaf: many rays meet none.
    shear: Option<Shear>,
    at: At,
    goal: PhantomData<G>,
}

impl<E: Eight, At: FnMut(u32, Crossing, f32) -> f32, G: Goal> Leaves<E> for MeshLeaves<'_, At, G> {
    #[inline(always)]
    fn visit(&mut self, block: u32, limit: f32, _: &mut [u64]) -> f32 {
        let ray = self.ray;
        let shear = match &mut self.shear {
            Some(shear) => shear,
            none => none.insert(Shear::new(ray.origin, ray.direction)),
        };
        self.blocks[block as usize].cross::<E, G>(shear, &ray.slab, self.reach, limit, &mut self.at)
    }

    #[inline(always)]
    fn rest(&self, block: u32) -> Option<u32> {
        let continues = self.blocks[block as usize].continues();
        continues.then_some(block + 1)
    }
}

/// A mesh's wide tree, with a group of a packet's rays.
struct PacketOfMesh<'a, S: InstructionSet, G> {
    mesh: &'a MeshTree,
    rays: &'a PacketRays<S::Packet>,
    instance: u32,
    goal: PhantomData<G>,
}

impl<S: InstructionSet, G: Goal> PacketLeaves<S> for PacketOfMesh<'_, S, G> {
    #[inline(always)]
    fn visit(
        &mut self,
        leaf: u32,
        lanes: u32,
        view: &mut View<S>,
        found: &mut Found<S::Packet>,
        _: &mut [u64],
    ) {
        for block in &self.mesh.blocks[leaf as usize..] {
            block.cross_packet::<S, G>(self.rays, view, lanes, self.instance, found);
            if !block.continues() {
                break;
            }
        }
    }

    #[inline(always)]
    fn alone(&mut self, child: u32, lanes: u32, found: &mut Found<S::Packet>, stack: &mut [u64]) {
        let mesh = self.mesh;
        for lane in lanes_of(lanes) {
            let ray = self.rays.ray(lane);
            let mut alone = found.alone(lane);
            let limit = alone.limit;
            let mut leaves = MeshLeaves::<_, G> {
                blocks: &mesh.blocks,
                reach: mesh.reach,
                ray: &ray,
                shear: None,
                at: |triangle, Crossing { t, u, v }, limit| {
                    let hit = Hit {
                        t,
                        instance: self.instance,
                        triangle,
                        u,
                        v,
                    };
                    alone.offer::<G>(hit, limit)
                },
                goal: PhantomData,
            };
            let wide_ray = WideRay::new(&ray.slab, 0.0);
            wide::walk_from::<S::Eight, G>(&mesh.wide, child, stack, &wide_ray, limit, &mut leaves);
            found.rejoin::<G>(alone);
        }
    }
}

/// A ray in a mesh's own space, with what the slab test needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRay {
    pub(crate) origin: Vec3A,
    pub(crate) direction: Vec3A,
    pub(crate) slab: SlabRay,
}

impl ObjectRay {
    /// `longest` is the size of the direction's largest component, and lies within the range that [`SlabRay`] asks for.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A, longest: f32) -> Self {
        Self {
            origin,
            direction,
            slab: SlabRay::new(origin, direction, longest, SlabRay::pad_of(origin)),
        }
    }
}

//! One mesh and its tree: built once, shared by every instance.

use std::{
    sync::OnceLock,
    time::{Duration, Instant},
};

use glam::{DVec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};
use rayon::prelude::*;

use super::support::{Support, reach};
use super::wedges::Wedges;
use crate::bvh::build::options::BuildOptions;
use crate::bvh::build_tree;
use crate::bvh::kernel::slab::triangle_box;
use crate::bvh::kernel::wide::{TriangleBlock, WideBox, WideStats, WideTree};
use crate::bvh::measure::stats::TreeStats;
use crate::bvh::triangles::Triangles;

/// Below this many triangles a pass over them takes less time than handing it to other threads.
const PARALLEL_SIZE: usize = 1 << 13;

/// A mesh's triangles, the tree over them as it was built, and the same in the form in which rays walk it.
#[derive(Clone)]
pub struct MeshTree {
    triangles: Triangles,
    tree: Bvh2,
    pub(in crate::bvh) wide: WideTree,
    pub(in crate::bvh) blocks: Vec<TriangleBlock>,
    wedges: Wedges,
    /// Made when somebody asks for it: most instances stand as their mesh was modelled.
    support: OnceLock<Box<Support>>,
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
        let ((tree, wide, blocks), wedges) = rayon::join(
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
            support: OnceLock::new(),
            triangles,
            tree,
            wide,
            blocks,
            build_time: start.elapsed(),
        }
    }

    /// The mesh.
    pub fn triangles(&self) -> &Triangles {
        &self.triangles
    }

    /// The tree over those triangles that are traced. Its primitives are their numbers. Boxes are widened by a few units in
    /// the last place.
    pub fn tree(&self) -> &Bvh2 {
        &self.tree
    }

    /// The number of the triangle at a place in leaf order (`first_index ..` of a leaf).
    pub fn triangle_at(&self, place: usize) -> u32 {
        self.tree.primitive_indices[place]
    }

    /// How many triangles are traced.
    pub fn traced(&self) -> usize {
        self.tree.primitive_indices.len()
    }

    /// The box around all traced triangles (a few units in the last place wider), or `None` when there is none.
    pub fn bounds(&self) -> Option<Aabb> {
        self.tree.nodes.first().map(|root| *root.aabb())
    }

    /// How far the boxes of its triangles, of which there are some, reach along a direction, and the other way: [`reach`].
    pub(super) fn reach_along(&self, direction: DVec3) -> [f64; 2] {
        reach(&self.tree, &self.support, direction)
    }

    /// The largest coordinate of its tree's box, without its sign.
    pub(in crate::bvh) fn reach(&self) -> f32 {
        self.reach
    }

    /// How narrow the wedges are that its triangles make with each other.
    pub(in crate::bvh) fn wedges(&self) -> &Wedges {
        &self.wedges
    }

    /// Memory held, in bytes: mesh and both forms of the tree.
    pub fn bytes(&self) -> usize {
        size_of_val(self.triangles.positions())
            + size_of_val(self.triangles.indices())
            + size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.primitive_indices.as_slice())
            + self.wide.bytes()
            + size_of_val(self.blocks.as_slice())
            + self.support.get().map_or(0, |_| size_of::<Support>())
            + self.wedges.bytes()
    }

    /// Statistics of the tree.
    pub fn stats(&self) -> TreeStats {
        TreeStats::of(&self.tree)
    }

    /// Statistics of the form that rays walk.
    pub fn wide_stats(&self) -> WideStats {
        let nodes = self.wide.stats();
        WideStats {
            blocks: self.blocks.len(),
            triangles_per_block: self.traced() as f64 / self.blocks.len().max(1) as f64,
            bytes: nodes.bytes + size_of_val(self.blocks.as_slice()),
            ..nodes
        }
    }

    /// The boxes of the form that rays walk, parents before children.
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

    /// Entries of a stack that a walk through it needs.
    pub(crate) fn most_pending(&self) -> usize {
        self.wide.most_pending()
    }

    /// The padded box of a triangle by its place in leaf order, in object space.
    pub(crate) fn box_at(&self, place: usize) -> Aabb {
        let corners = self.triangles.corners(self.triangle_at(place));
        triangle_box(corners.map(Vec3A::from))
    }
}

/// The tree over the triangles of these numbers, and both in the form in which rays walk it.
fn tree_over(
    triangles: &Triangles,
    numbers: &[u32],
    options: &BuildOptions,
) -> (Bvh2, WideTree, Vec<TriangleBlock>) {
    let boxes: Vec<Aabb> = (numbers.par_iter().with_min_len(PARALLEL_SIZE))
        .map(|&triangle| triangle_box(triangles.corners(triangle).map(Vec3A::from)))
        .collect();
    let mut tree = build_tree(&boxes, options);
    drop(boxes);
    for primitive in &mut tree.primitive_indices {
        *primitive = numbers[*primitive as usize];
    }
    let (wide, blocks) = WideTree::new(&tree, TriangleBlock::CAPACITY, |places, blocks| {
        TriangleBlock::append(&tree.primitive_indices[places], triangles, blocks);
    });
    (tree, wide, blocks)
}

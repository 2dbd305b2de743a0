//! A tree of wide nodes, made of a binary one.

use std::ops::Range;

use glam::Vec3;
use obvhs::{aabb::Aabb, bvh2::Bvh2};

use super::{
    collapse,
    node::{LEAF, WideNode},
};
use crate::bvh::split_plane::primitives_below;

/// What a wide tree is like, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WideStats {
    /// Nodes of up to eight children; leaves are not nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Blocks of up to eight triangles, one a leaf as a rule; 0 in a tree over instances.
    pub blocks: usize,
    /// Children a node has on average, up to 8; 0 without nodes.
    pub children_per_node: f64,
    /// Triangles a block holds on average, up to 8; 0 without blocks.
    pub triangles_per_block: f64,
    /// Most children that can wait their turn while a ray walks the tree.
    pub most_pending: usize,
    /// Memory of nodes and blocks.
    pub bytes: usize,
}

/// A box of a wide tree, for those who draw it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WideBox {
    /// Wide nodes above it; the root's box has 0.
    pub depth: u32,
    /// The node of the binary tree whose box it is.
    pub node: u32,
    /// A leaf of up to eight triangles (in a tree over instances, of one instance).
    pub is_leaf: bool,
    /// Its corners, in the tree's space.
    pub bounds: [Vec3; 2],
}

/// Wide nodes, the root first.
#[derive(Clone, Debug, Default)]
pub(crate) struct WideTree {
    pub(super) nodes: Vec<WideNode>,
    /// A node or a leaf, as a child is numbered; `None` in a tree over nothing.
    pub(super) root: Option<u32>,
    leaves: usize,
    /// Which node of the binary tree each node stands for, and each leaf, by its number.
    sources: [Vec<u32>; 2],
    /// Entries of a stack that the walk needs.
    most_pending: usize,
}

impl WideTree {
    /// Collapses a tree as [`crate::bvh::build_tree`] makes them. A leaf's block holds `capacity` primitives. For each leaf `leaf`
    /// gets its range of the tree's `primitive_indices` and returns its number, below 2^31.
    pub(crate) fn new(
        tree: &Bvh2,
        capacity: usize,
        mut leaf: impl FnMut(Range<usize>) -> u32,
    ) -> Self {
        let mut wide = Self::default();
        let plans = collapse::plan(tree, capacity);
        let Some(plan) = plans.first() else {
            return wide;
        };
        if plan.is_leaf {
            wide.root = Some(wide.add_leaf(0, leaf(primitives_below(tree, 0))));
            return wide;
        }
        wide.root = Some(wide.add_node(0));
        let mut pending = vec![(0, 0)];
        while let Some((from, to)) = pending.pop() {
            let (children, count) = collapse::children(tree, &plans, from);
            let mut node = WideNode::EMPTY;
            for (lane, &child) in children[..count].iter().enumerate() {
                let number = if plans[child].is_leaf {
                    wide.add_leaf(child, leaf(primitives_below(tree, child)))
                } else {
                    wide.add_node(child)
                };
                node.set(lane, tree.nodes[child].aabb(), number);
                if number & LEAF == 0 {
                    pending.push((child, number as usize));
                }
            }
            wide.nodes[to] = node;
        }
        wide.nodes.shrink_to_fit();
        wide.sources.iter_mut().for_each(Vec::shrink_to_fit);
        wide.most_pending = wide.count_pending();
        wide
    }

    /// Adds a leaf that stands for that node of the binary tree; what it is as a child.
    fn add_leaf(&mut self, source: usize, leaf: u32) -> u32 {
        self.leaves += 1;
        let [_, sources] = &mut self.sources;
        // Leaves of several blocks take as many numbers.
        sources.resize(leaf as usize + 1, source as u32);
        LEAF | leaf
    }

    /// Adds a node that stands for that node of the binary tree; what it is as a child.
    fn add_node(&mut self, source: usize) -> u32 {
        let [sources, _] = &mut self.sources;
        sources.push(source as u32);
        self.nodes.push(WideNode::EMPTY);
        self.nodes.len() as u32 - 1
    }

    /// The node of the binary tree that a child stands for.
    #[inline(always)]
    pub(super) fn source(&self, child: u32) -> u32 {
        let [nodes, leaves] = &self.sources;
        if child & LEAF == 0 {
            nodes[child as usize]
        } else {
            leaves[(child & !LEAF) as usize]
        }
    }

    /// While one child is walked the others wait. Children stand after their parents.
    fn count_pending(&self) -> usize {
        let mut most = vec![0; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate().rev() {
            let below = node.children().map(|(_, child)| {
                if child & LEAF == 0 {
                    most[child as usize]
                } else {
                    0
                }
            });
            most[index] = node.children().count() - 1 + below.max().unwrap_or(0);
        }
        most.first().copied().unwrap_or(0)
    }

    /// Entries of a stack that the walk needs.
    pub(crate) fn most_pending(&self) -> usize {
        self.most_pending
    }

    /// Statistics, blocks excepted.
    pub(crate) fn stats(&self) -> WideStats {
        let children: usize = self.nodes.iter().map(|node| node.children().count()).sum();
        WideStats {
            nodes: self.nodes.len(),
            leaves: self.leaves,
            children_per_node: children as f64 / self.nodes.len().max(1) as f64,
            most_pending: self.most_pending,
            bytes: self.bytes(),
            ..WideStats::default()
        }
    }

    /// Every box that a ray may be tested against, `root` first, parents before children. The root's own
    /// box is not kept: it is that of the binary tree.
    pub(crate) fn boxes(&self, root: &Aabb) -> Vec<WideBox> {
        let Some(number) = self.root else {
            return Vec::new();
        };
        let wide_box = |bounds: &Aabb, depth, child: u32| WideBox {
            depth,
            node: self.source(child),
            is_leaf: child & LEAF != 0,
            bounds: [bounds.min.into(), bounds.max.into()],
        };
        let mut boxes = vec![wide_box(root, 0, number)];
        let mut depths = vec![0; self.nodes.len()];
        // Children stand after their parents.
        for (index, node) in self.nodes.iter().enumerate() {
            for (bounds, child) in node.children() {
                let depth = depths[index] + 1;
                boxes.push(wide_box(&bounds, depth, child));
                if child & LEAF == 0 {
                    depths[child as usize] = depth;
                }
            }
        }
        boxes
    }

    /// Memory of the nodes, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        let [nodes, leaves] = &self.sources;
        size_of_val(self.nodes.as_slice())
            + size_of_val(nodes.as_slice())
            + size_of_val(leaves.as_slice())
    }

    /// The root and all that is below it, as (box of the child, child) lists.
    #[cfg(test)]
    pub(crate) fn nodes(&self) -> impl Iterator<Item = Vec<(Aabb, u32)>> + '_ {
        self.nodes.iter().map(|node| node.children().collect())
    }

    /// A node or, marked by [`LEAF`], a leaf.
    #[cfg(test)]
    pub(crate) fn root(&self) -> Option<u32> {
        self.root
    }
}

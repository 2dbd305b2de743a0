//! A tree of wide nodes, made of a binary one.

use std::ops::Range;

use glam::Vec3;
use obvhs::{aabb::Aabb, bvh2::Bvh2};
use rayon::prelude::*;

use super::{
    collapse::{self, Plan},
    node::{LEAF, WideNode},
};
use crate::bvh::measure::split_plane::primitives_below;

/// What a wide tree is like, in numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WideStats {
    /// Nodes of up to sixteen children; leaves are not nodes.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Blocks of up to eight triangles, one a leaf as a rule; 0 in a tree over instances.
    pub blocks: usize,
    /// Children a node has on average, up to 16; 0 without nodes.
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

/// A subtree of fewer primitives is converted by one thread.
const PARALLEL_SIZE: usize = 1 << 13;

/// How a binary tree becomes a wide one.
struct Conversion<'a, F> {
    tree: &'a Bvh2,
    plans: &'a [Plan],
    leaf: F,
}

/// A subtree: its nodes, the root first, and what its leaves hold, both numbered from 0.
struct Part<L> {
    nodes: Vec<WideNode>,
    leaves: usize,
    /// Which node of the binary tree each node stands for, and each leaf, by its number.
    sources: [Vec<u32>; 2],
    held: Vec<L>,
}

/// A node of the binary tree that is to become a wide one, and the wide node and lane that it is a child of.
struct Hanging {
    root: usize,
    parent: usize,
    lane: usize,
}

impl<F> Conversion<'_, F> {
    /// The whole tree, whose root is no leaf: its top, and by many threads what hangs below it.
    fn convert<L: Send>(&self) -> Part<L>
    where
        F: Fn(Range<usize>, &mut Vec<L>) + Sync,
    {
        let mut small = Vec::new();
        let mut whole = self.subtree(0, |hanging| {
            let is_small = primitives_below(self.tree, hanging.root).len() < PARALLEL_SIZE;
            if is_small {
                small.push(hanging);
            }
            !is_small
        });
        let parts: Vec<Part<L>> = (small.par_iter())
            .map(|hanging| self.subtree(hanging.root, |_| true))
            .collect();
        let count = |of: fn(&Part<L>) -> usize| parts.iter().map(of).sum();
        whole.nodes.reserve_exact(count(|part| part.nodes.len()));
        whole.held.reserve_exact(count(|part| part.held.len()));
        for (Hanging { parent, lane, .. }, mut part) in small.into_iter().zip(parts) {
            let (first_node, first_held) = (whole.nodes.len() as u32, whole.held.len() as u32);
            whole.nodes[parent].renumber(lane, first_node);
            whole.nodes.extend(
                part.nodes
                    .iter()
                    .map(|node| node.moved(first_node, first_held)),
            );
            let [nodes, leaves] = &mut whole.sources;
            nodes.append(&mut part.sources[0]);
            // What a leaf holds beyond the first has numbers too, which no leaf goes by.
            leaves.resize(whole.held.len(), 0);
            leaves.append(&mut part.sources[1]);
            whole.held.append(&mut part.held);
            whole.leaves += part.leaves;
        }
        whole
    }

    /// The subtree at a node of the binary tree that becomes a wide one. What `keep` refuses is left out.
    fn subtree<L>(&self, root: usize, mut keep: impl FnMut(Hanging) -> bool) -> Part<L>
    where
        F: Fn(Range<usize>, &mut Vec<L>),
    {
        let mut part = Part {
            nodes: vec![WideNode::EMPTY],
            leaves: 0,
            sources: [vec![root as u32], Vec::new()],
            held: Vec::new(),
        };
        let mut pending = vec![(root, 0)];
        while let Some((from, parent)) = pending.pop() {
            let (children, count) = collapse::children(self.tree, self.plans, from);
            let mut node = WideNode::EMPTY;
            for (lane, &root) in children[..count].iter().enumerate() {
                let number = if self.plans[root].is_leaf {
                    let number = part.held.len() as u32;
                    part.leaves += 1;
                    let [_, leaves] = &mut part.sources;
                    leaves.resize(number as usize, 0);
                    leaves.push(root as u32);
                    (self.leaf)(primitives_below(self.tree, root), &mut part.held);
                    LEAF | number
                } else if keep(Hanging { root, parent, lane }) {
                    part.sources[0].push(root as u32);
                    part.nodes.push(WideNode::EMPTY);
                    pending.push((root, part.nodes.len() - 1));
                    part.nodes.len() as u32 - 1
                } else {
                    0
                };
                node.set(lane, self.tree.nodes[root].aabb(), number);
            }
            part.nodes[parent] = node;
        }
        part
    }
}

/// Wide nodes, the root first.
#[derive(Clone, Debug, Default)]
pub(crate) struct WideTree {
    pub(super) nodes: Vec<WideNode>,
    /// A node or a leaf, as a child is numbered; `None` in a tree over nothing.
    pub(super) root: Option<u32>,
    leaves: usize,
    /// Whether no node has more than eight children: the other half need not be tested then. For the whole tree and not
    /// for each node, because a processor can foresee that.
    pub(super) is_narrow: bool,
    /// Which node of the binary tree each node stands for, and each leaf, by its number.
    sources: [Vec<u32>; 2],
    /// Entries of a stack that the walk needs.
    most_pending: usize,
}

impl WideTree {
    /// Collapses a tree as [`crate::bvh::build_tree`] makes them. A leaf's block holds `capacity` primitives. For each leaf
    /// `leaf` gets its range of the tree's `primitive_indices` and adds what the leaf holds to a list; the place of the
    /// first of it in the list, which comes back too, is the leaf's number, below 2^31.
    pub(crate) fn new<L: Send>(
        tree: &Bvh2,
        capacity: usize,
        leaf: impl Fn(Range<usize>, &mut Vec<L>) + Sync,
    ) -> (Self, Vec<L>) {
        let plans = collapse::plan(tree, capacity);
        let Some(plan) = plans.first() else {
            return (Self::default(), Vec::new());
        };
        let conversion = Conversion {
            tree,
            plans: &plans,
            leaf,
        };
        if plan.is_leaf {
            let mut held = Vec::new();
            (conversion.leaf)(primitives_below(tree, 0), &mut held);
            let wide = Self {
                root: Some(LEAF),
                leaves: 1,
                sources: [Vec::new(), vec![0]],
                ..Self::default()
            };
            return (wide, held);
        }
        let Part {
            nodes,
            leaves,
            sources,
            held,
        } = conversion.convert();
        let mut wide = Self {
            is_narrow: nodes.iter().all(|node| node.children().count() <= 8),
            nodes,
            root: Some(0),
            leaves,
            sources,
            most_pending: 0,
        };
        wide.most_pending = wide.count_pending();
        (wide, held)
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

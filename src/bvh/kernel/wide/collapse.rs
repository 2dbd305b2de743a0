//! Which levels of a binary tree to leave out, so that nodes of sixteen children cost rays least.
//!
//! Dynamic programming on the surface area heuristic, as Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on
//! GPUs Through Compressed Wide BVHs" (HPG 2017), section 3.1: the least cost of a subtree as at most n children of
//! some wide node follows from the costs of its two halves as at most k and n - k. What differs is the leaf: eight
//! triangles are tested at once, so a leaf costs its blocks, not its triangles.

use obvhs::bvh2::Bvh2;

use super::node::WIDTH;
use crate::bvh::measure::stats;

/// What testing a node's boxes costs, and choosing among them.
const COST_NODE: f32 = 1.0;
/// What testing a leaf's block of triangles costs. Measured: with a ratio to a node of 0.4 to 2, rays meet the same
/// number of nodes and of blocks within 1 %.
const COST_BLOCK: f32 = 1.0;

/// What becomes of a node of the binary tree.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// As at most `n` children, where `splits[n - 1]` children go to the first half; 0 where it makes no more than n - 1
    /// of them, and for n = 1. For n = 16 always a split: how the children of a wide node are divided.
    splits: [u8; WIDTH],
    /// As a single child: whether it is a leaf.
    pub(super) is_leaf: bool,
}

/// A subtree of fewer nodes is planned by one thread.
const PARALLEL_SIZE: usize = 1 << 13;

/// What the dynamic programming knows of a node.
#[derive(Clone, Copy, Default)]
struct Known {
    /// The least cost as at most n + 1 children.
    costs: [f32; WIDTH - 1],
    primitives: usize,
}

/// The plan for every node of a tree as [`crate::bvh::build_tree`] makes them. A leaf holds at most `capacity`
/// primitives in a block; leaves of the binary tree that hold more stay leaves, of several blocks.
pub(super) fn plan(tree: &Bvh2, capacity: usize) -> Vec<Plan> {
    let nothing = Plan {
        splits: [0; WIDTH],
        is_leaf: true,
    };
    let mut plans = vec![nothing; tree.nodes.len()];
    let Some((root, below)) = plans.split_first_mut() else {
        return plans;
    };
    let planning = Planning {
        tree,
        capacity,
        root_area: stats::half_area(&tree.nodes[0]),
    };
    planning.subtree(0, 1, root, below);
    plans
}

struct Planning<'a> {
    tree: &'a Bvh2,
    capacity: usize,
    root_area: f64,
}

impl Planning<'_> {
    /// Plans the node `root` and all below it, which stand from `first` on.
    fn subtree(&self, root: usize, first: usize, plan: &mut Plan, below: &mut [Plan]) -> Known {
        if below.len() < PARALLEL_SIZE {
            return self.small_subtree(root, first, plan, below);
        }
        let node = &self.tree.nodes[root];
        let child = node.first_index as usize;
        let (children, below) = below.split_at_mut(2);
        let (left, right) = children.split_at_mut(1);
        // The left child's descendants stand before the right one's.
        let right_child = &self.tree.nodes[child + 1];
        let right_first = if right_child.is_leaf() {
            first + 2 + below.len()
        } else {
            right_child.first_index as usize
        };
        let (below_left, below_right) = below.split_at_mut(right_first - first - 2);
        let known = rayon::join(
            || self.subtree(child, first + 2, &mut left[0], below_left),
            || self.subtree(child + 1, right_first, &mut right[0], below_right),
        );
        let (known, made) = self.node(root, &known.0, &known.1);
        *plan = made;
        known
    }

    fn small_subtree(
        &self,
        root: usize,
        first: usize,
        plan: &mut Plan,
        below: &mut [Plan],
    ) -> Known {
        let nodes = &self.tree.nodes;
        let mut known = vec![Known::default(); below.len()];
        let of = |known: &[Known], index: usize| -> (Known, Option<Plan>) {
            let node = &nodes[index];
            if node.is_leaf() {
                return (self.leaf(index), None);
            }
            let child = node.first_index as usize - first;
            let (known, plan) = self.node(index, &known[child], &known[child + 1]);
            (known, Some(plan))
        };
        for place in (0..below.len()).rev() {
            let (made, plan) = of(&known, first + place);
            known[place] = made;
            if let Some(plan) = plan {
                below[place] = plan;
            }
        }
        let (made, of_root) = of(&known, root);
        if let Some(of_root) = of_root {
            *plan = of_root;
        }
        made
    }

    fn area(&self, index: usize) -> f32 {
        let ratio = (stats::half_area(&self.tree.nodes[index]) / self.root_area) as f32;
        // Without an area (points, lines) the number of nodes decides.
        if ratio.is_finite() { ratio } else { 1.0 }
    }

    fn leaf(&self, index: usize) -> Known {
        let primitives = self.tree.nodes[index].prim_count as usize;
        let blocks = primitives.div_ceil(self.capacity);
        Known {
            costs: [self.area(index) * blocks as f32 * COST_BLOCK; WIDTH - 1],
            primitives,
        }
    }

    fn node(&self, index: usize, left: &Known, right: &Known) -> (Known, Plan) {
        let area = self.area(index);
        let primitives = left.primitives + right.primitives;
        // The cheapest way to have n children, and how many of them are in the left half.
        let split = |n: usize| {
            let (mut least, mut of_left) = (f32::INFINITY, 1);
            for k in 1..n {
                let cost = left.costs[k - 1] + right.costs[n - k - 1];
                if cost < least {
                    (least, of_left) = (cost, k);
                }
            }
            (least, of_left)
        };
        let mut splits = [0; WIDTH];
        let (below, k) = split(WIDTH);
        splits[WIDTH - 1] = k as u8;
        let as_node = below + area * COST_NODE;
        let as_leaf = area * COST_BLOCK;
        let is_leaf = primitives <= self.capacity && as_leaf <= as_node;
        let mut costs = [if is_leaf { as_leaf } else { as_node }; WIDTH - 1];
        for n in 2..WIDTH {
            let (cost, k) = split(n);
            if cost < costs[n - 2] {
                costs[n - 1] = cost;
                splits[n - 1] = k as u8;
            } else {
                costs[n - 1] = costs[n - 2];
            }
        }
        (Known { costs, primitives }, Plan { splits, is_leaf })
    }
}

/// The nodes of the binary tree that become the children of the wide node at `root`, which is no leaf: two to sixteen.
pub(super) fn children(tree: &Bvh2, plans: &[Plan], root: usize) -> ([usize; WIDTH], usize) {
    let mut found = [0; WIDTH];
    let mut count = 0;
    // At most one entry a child.
    let mut pending = [(0, 0); WIDTH];
    let mut waiting = 1;
    pending[0] = (root, WIDTH);
    while waiting > 0 {
        waiting -= 1;
        let (node, mut most) = pending[waiting];
        while most > 1 && plans[node].splits[most - 1] == 0 {
            most -= 1;
        }
        if most == 1 {
            found[count] = node;
            count += 1;
            continue;
        }
        let left = plans[node].splits[most - 1] as usize;
        let child = tree.nodes[node].first_index as usize;
        pending[waiting] = (child + 1, most - left);
        pending[waiting + 1] = (child, left);
        waiting += 2;
    }
    (found, count)
}

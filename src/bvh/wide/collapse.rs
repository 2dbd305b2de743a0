//! Which levels of a binary tree to leave out, so that nodes of eight children cost rays least.
//!
//! Dynamic programming on the surface area heuristic, as Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on
//! GPUs Through Compressed Wide BVHs" (HPG 2017), section 3.1: the least cost of a subtree as at most n children of
//! some wide node follows from the costs of its two halves as at most k and n - k. What differs is the leaf: eight
//! triangles are tested at once, so a leaf costs its blocks, not its triangles.

use obvhs::bvh2::Bvh2;

use super::super::stats;

/// Children of a node.
const WIDTH: usize = 8;

/// What testing a node's eight boxes costs, and choosing among them.
const COST_NODE: f32 = 1.0;
/// What testing a leaf's block of triangles costs. Measured: with a ratio to a node of 0.4 to 2, rays meet the same
/// number of nodes and of blocks within 1 %.
const COST_BLOCK: f32 = 1.0;

/// What becomes of a node of the binary tree.
#[derive(Clone, Copy)]
pub(super) struct Plan {
    /// As at most `n` children, where `splits[n - 1]` children go to the first half; 0 where it makes no more than n - 1
    /// of them, and for n = 1. For n = 8 always a split: how the children of a wide node are divided.
    splits: [u8; WIDTH],
    /// As a single child: whether it is a leaf.
    pub(super) is_leaf: bool,
}

/// The plan for every node of a tree whose children stand after their parents. A leaf holds at most `capacity`
/// primitives in a block; leaves of the binary tree that hold more stay leaves, of several blocks.
pub(super) fn plan(tree: &Bvh2, capacity: usize) -> Vec<Plan> {
    let nothing = Plan {
        splits: [0; WIDTH],
        is_leaf: true,
    };
    let mut plans = vec![nothing; tree.nodes.len()];
    let mut costs = vec![[0.0f32; WIDTH - 1]; tree.nodes.len()];
    let mut counts = vec![0usize; tree.nodes.len()];
    let root_area = tree.nodes.first().map_or(0.0, stats::half_area);
    for (index, node) in tree.nodes.iter().enumerate().rev() {
        let ratio = (stats::half_area(node) / root_area) as f32;
        // Without an area (points, lines) the number of nodes decides.
        let area = if ratio.is_finite() { ratio } else { 1.0 };
        if node.is_leaf() {
            counts[index] = node.prim_count as usize;
            let blocks = counts[index].div_ceil(capacity);
            costs[index] = [area * blocks as f32 * COST_BLOCK; WIDTH - 1];
            continue;
        }
        let child = node.first_index as usize;
        counts[index] = counts[child] + counts[child + 1];
        let (left, right) = (costs[child], costs[child + 1]);
        // The cheapest way to have n children, and how many of them are in the left half.
        let split = |n: usize| {
            (1..n)
                .map(|k| (left[k - 1] + right[n - k - 1], k))
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .unwrap_or((f32::INFINITY, 1))
        };
        let mut splits = [0; WIDTH];
        let (below, k) = split(WIDTH);
        splits[WIDTH - 1] = k as u8;
        let as_node = below + area * COST_NODE;
        let fits = counts[index] <= capacity;
        let as_leaf = area * COST_BLOCK;
        let is_leaf = fits && as_leaf <= as_node;
        let mut best = [if is_leaf { as_leaf } else { as_node }; WIDTH - 1];
        for n in 2..WIDTH {
            let (cost, k) = split(n);
            if cost < best[n - 2] {
                best[n - 1] = cost;
                splits[n - 1] = k as u8;
            } else {
                best[n - 1] = best[n - 2];
            }
        }
        costs[index] = best;
        plans[index] = Plan { splits, is_leaf };
    }
    plans
}

/// The nodes of the binary tree that become the children of the wide node at `root`, which is no leaf: two to eight.
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

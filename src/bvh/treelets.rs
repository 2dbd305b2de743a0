//! A clustered tree's last branches, built anew by binned SAH where that costs less.
//!
//! Clustering joins neighbours greedily and is at its worst among the last few primitives, where most of a
//! tree's cost is; a top-down build is at its best there. (Ganestam et al., "Bonsai: Rapid Bounding Volume
//! Hierarchy Generation using Mini Trees", 2015, join the same two ideas the other way round.)

use super::{boxes, depth::MAX_DEPTH, median, options::BuildOptions, sah, stats, top_down};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
};
use rayon::prelude::*;
use std::ops::Range;

/// Primitives of the largest treelet. Measured on 100k-triangle spheres, knots, soups and hairballs, `Medium`:
/// SAH cost against binned SAH's 1.02–1.06 with 32, 1.00–1.04 with 128, 1.00–1.01 with 512 (and 1.02–1.10
/// without treelets).
const LARGEST_TREELET: u32 = 512;

/// Below this depth treelets are halved, so that their leaves are no larger than they may be.
const DEEPEST_SAH: u32 = 32;

/// A subtree of few primitives.
struct Treelet {
    root: usize,
    /// Its part of `primitive_indices`.
    primitives: Range<usize>,
}

/// What stands in a treelet's place: nodes as [`top_down`] makes them, over these primitives.
struct Replacement {
    nodes: Vec<Bvh2Node>,
    items: Vec<Bvh2Node>,
}

/// Replaces the treelets of `tree` where that makes them cheaper. `tree` is as [`layout`](super::layout)
/// leaves it, with the boxes `boxes`; what comes back has to go there again.
pub(super) fn rebuild(mut tree: Bvh2, boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    let treelets = find(&tree);
    let replacements: Vec<Option<Replacement>> = treelets
        .par_iter()
        .map(|treelet| replacement(&tree, treelet, boxes, options))
        .collect();
    for (treelet, replacement) in treelets.into_iter().zip(replacements) {
        let Some(Replacement { nodes, items }) = replacement else {
            continue;
        };
        let first_primitive = treelet.primitives.start as u32;
        let first_node = tree.nodes.len() as u32;
        let moved = |node: &Bvh2Node| Bvh2Node {
            first_index: node.first_index
                + if node.is_leaf() {
                    first_primitive
                } else {
                    // The root goes where the old one was, so the others move up by one.
                    first_node - 1
                },
            ..*node
        };
        let mut nodes = nodes.iter().map(moved);
        if let Some(root) = nodes.next() {
            tree.nodes[treelet.root] = root;
        }
        tree.nodes.extend(nodes);
        let indices = items.iter().map(|item| item.first_index);
        for (slot, index) in tree.primitive_indices[treelet.primitives]
            .iter_mut()
            .zip(indices)
        {
            *slot = index;
        }
    }
    tree
}

/// The largest subtrees that are small enough, from left to right.
fn find(tree: &Bvh2) -> Vec<Treelet> {
    let mut counts: Vec<u32> = tree.nodes.iter().map(|node| node.prim_count).collect();
    for (index, node) in tree.nodes.iter().enumerate().rev() {
        if !node.is_leaf() {
            let child = node.first_index as usize;
            counts[index] = counts[child] + counts[child + 1];
        }
    }
    let mut treelets = Vec::new();
    let mut first_primitive = 0;
    let mut stack = vec![0];
    while let Some(root) = stack.pop() {
        if counts[root] > LARGEST_TREELET && !tree.nodes[root].is_leaf() {
            let child = tree.nodes[root].first_index as usize;
            stack.extend([child + 1, child]);
            continue;
        }
        let end = first_primitive + counts[root] as usize;
        treelets.push(Treelet {
            root,
            primitives: first_primitive..end,
        });
        first_primitive = end;
    }
    treelets
}

/// The treelet built anew, if that is cheaper.
fn replacement(
    tree: &Bvh2,
    treelet: &Treelet,
    boxes: &[Aabb],
    options: &BuildOptions,
) -> Option<Replacement> {
    if tree.nodes[treelet.root].is_leaf() {
        return None;
    }
    let mut items: Vec<Bvh2Node> = tree.primitive_indices[treelet.primitives.clone()]
        .iter()
        .map(|&p| Bvh2Node::new(boxes[p as usize], 1, p))
        .collect();
    let options = BuildOptions {
        max_depth: MAX_DEPTH as u32,
        ..*options
    };
    let nodes = top_down::build(&mut items, &|items, depth, bins| {
        if depth < DEEPEST_SAH {
            sah::cut(items, depth, &options, bins)
        } else {
            median::cut(items, depth, &options)
        }
    });
    let new_cost = cost(&with_boxes(&nodes, &items), 0);
    // Of two that cost the same (points have no area) the halved one is shallower.
    (new_cost <= cost(&tree.nodes, treelet.root)).then_some(Replacement { nodes, items })
}

/// The nodes with the boxes that [`top_down`] leaves out.
fn with_boxes(nodes: &[Bvh2Node], items: &[Bvh2Node]) -> Vec<Bvh2Node> {
    let mut nodes = nodes.to_vec();
    for index in (0..nodes.len()).rev() {
        let node = nodes[index];
        let first = node.first_index as usize;
        let below = if node.is_leaf() {
            &items[first..first + node.prim_count as usize]
        } else if first > 0 {
            &nodes[first..first + 2]
        } else {
            // A slot that no node needed.
            continue;
        };
        let bounds = boxes::union(below.iter().map(|node| *node.aabb()));
        nodes[index].set_aabb(bounds.unwrap_or_default());
    }
    nodes
}

/// Σ area × cost over a subtree: its part of the tree's SAH cost, but for a constant factor.
fn cost(nodes: &[Bvh2Node], root: usize) -> f64 {
    let mut sum = 0.0;
    let mut stack = vec![root];
    while let Some(index) = stack.pop() {
        let node = &nodes[index];
        sum += stats::half_area(node) * stats::own_cost(node);
        if !node.is_leaf() {
            let child = node.first_index as usize;
            stack.extend([child, child + 1]);
        }
    }
    sum
}

//! A clustered tree's last branches, built anew by binned SAH where that costs less.
//!
//! Clustering joins neighbours greedily and is at its worst among the last few primitives, where most of a
//! tree's cost is; a top-down build is at its best there. (Ganestam et al., "Bonsai: Rapid Bounding Volume
//! Hierarchy Generation using Mini Trees", 2015, join the same two ideas the other way round.)

use super::boxes::Item;
use super::depth::MAX_DEPTH;
use super::options::BuildOptions;
use super::top_down::{self, Grown};
use super::{median, sah};
use crate::bvh::measure::stats;
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

/// What stands in a treelet's place: a tree over these primitives.
struct Replacement {
    grown: Grown,
    items: Vec<Item>,
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
        let Some(Replacement { grown, items }) = replacement else {
            continue;
        };
        let mut nodes = grown.within(tree.nodes.len(), treelet.primitives.start);
        if let Some(root) = nodes.next() {
            tree.nodes[treelet.root] = root;
        }
        tree.nodes.extend(nodes);
        let slots = &mut tree.primitive_indices[treelet.primitives];
        for (slot, item) in slots.iter_mut().zip(&items) {
            *slot = item.number();
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
    let mut items: Vec<Item> = tree.primitive_indices[treelet.primitives.clone()]
        .iter()
        .map(|&p| Item::new(&boxes[p as usize], p))
        .collect();
    let options = BuildOptions {
        max_depth: MAX_DEPTH as u32,
        ..*options
    };
    let grown = top_down::build(&mut items, boxes, &|items, centres, depth, bins| {
        if depth < DEEPEST_SAH {
            sah::cut(items, centres, depth, &options, bins)
        } else {
            median::cut(items, centres, depth, &options)
        }
    });
    // Of two that cost the same (points have no area) the halved one is shallower.
    let is_cheaper = cost(&grown.nodes, 0) <= cost(&tree.nodes, treelet.root);
    is_cheaper.then_some(Replacement { grown, items })
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

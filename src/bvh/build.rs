//! Boxes in, tree out.

use super::{
    boxes,
    layout::{self, Draft},
    median,
    options::{BuildOptions, Builder},
    ploc, sah, top_down,
};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
};

/// No leaf of any tree is deeper (the root's depth is 0), so the stack of a traversal that keeps one child for
/// later on every level can be an array of this many entries.
pub const MAX_DEPTH: usize = 96;

/// Builds a tree over primitives of which `boxes[i]` bounds the `i`th. Boxes are finite with min ≤ max, and
/// at most 2^31 of them; callers leave out what is not.
///
/// The tree's node boxes are the exact unions of `boxes`. Its `primitive_indices` holds every index once, in
/// the order of the leaves, so that the primitives of a subtree are a range of it. Children stand side by
/// side and after their parent. No boxes, no nodes. The same boxes and options give the same tree, whatever
/// the number of threads; boxes scaled by a power of two too.
pub fn build_tree(boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    let options = options.clamped();
    match options.builder {
        _ if boxes.is_empty() => Bvh2::default(),
        Builder::None => {
            let primitives: Vec<u32> = (0..boxes.len() as u32).collect();
            let nodes = [Bvh2Node::new(Aabb::default(), boxes.len() as u32, 0)];
            finish(&nodes, &primitives, boxes, &options)
        }
        Builder::Median => top_down(boxes, &options, &|items, depth, _| {
            median::cut(items, depth, &options)
        }),
        Builder::Sah => top_down(boxes, &options, &|items, depth, bins| {
            sah::cut(items, depth, &options, bins)
        }),
        Builder::Ploc => {
            let draft = ploc::build(&boxes::normalised(boxes), &options);
            finish(&draft.nodes, &draft.primitive_indices, boxes, &options)
        }
    }
}

fn top_down<Cut>(boxes: &[Aabb], options: &BuildOptions, cut: &Cut) -> Bvh2
where
    Cut: Fn(&mut [Bvh2Node], u32, &mut Vec<sah::Bin>) -> Option<usize> + Sync,
{
    let mut items = boxes::items(&boxes::normalised(boxes));
    let nodes = top_down::build(&mut items, cut);
    let primitives: Vec<u32> = items.iter().map(|item| item.first_index).collect();
    finish(&nodes, &primitives, boxes, options)
}

fn finish(nodes: &[Bvh2Node], primitives: &[u32], boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    layout::finish(Draft { nodes, primitives }, boxes, options)
}

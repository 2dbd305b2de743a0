//! The walk through one tree, written once: closest hits, occlusion, every hit, with or without a visitor.

use obvhs::bvh2::node::Bvh2Node;

use super::{
    MAX_DEPTH,
    slab::SlabRay,
    visitor::{NodeEvent, TreeRef, Visitor},
};

/// A ray that ends here wants nothing more.
pub(crate) const STOP: f32 = f32::NEG_INFINITY;

/// Walks `nodes` along the ray, nearest child first, and hands the primitives of each leaf it reaches to
/// `leaf(first, count, limit, visitor)`, which returns the new limit: the `t` beyond which nothing matters any more,
/// or [`STOP`]. Nodes entered exactly at the limit are still walked, since ties are decided by number.
///
/// No allocation: one entry a level is pending at most, and no tree is deeper than [`MAX_DEPTH`].
#[inline(always)]
pub(crate) fn walk<V: Visitor>(
    nodes: &[Bvh2Node],
    slab: &SlabRay,
    mut limit: f32,
    tree: TreeRef,
    visitor: &mut V,
    mut leaf: impl FnMut(u32, u32, f32, &mut V) -> f32,
) -> f32 {
    let Some(root) = nodes.first() else {
        return limit;
    };
    let (entry, exit) = slab.span(root.aabb());
    let entry = entry.max(0.0);
    if entry > exit {
        visitor.node(tree, 0, NodeEvent::Missed, entry);
        return limit;
    }
    if entry > limit {
        visitor.node(tree, 0, NodeEvent::Pruned, entry);
        return limit;
    }
    visitor.node(tree, 0, NodeEvent::Entered, entry);

    let mut stack = [(0.0f32, 0u32); MAX_DEPTH];
    let mut pending = 0;
    let mut node = root;
    loop {
        let next = if node.prim_count != 0 {
            limit = leaf(node.first_index, node.prim_count, limit, visitor);
            if limit == STOP {
                return STOP;
            }
            None
        } else {
            let (left, right) = (node.first_index, node.first_index + 1);
            let (left_entry, left_exit) = slab.span(nodes[left as usize].aabb());
            let (right_entry, right_exit) = slab.span(nodes[right as usize].aabb());
            let (left_entry, right_entry) = (left_entry.max(0.0), right_entry.max(0.0));
            let left_hit = left_entry <= left_exit && left_entry <= limit;
            let right_hit = right_entry <= right_exit && right_entry <= limit;
            let mut settle = |node, hit: bool, entry: f32, exit: f32| {
                if !hit {
                    let event = if entry <= exit {
                        NodeEvent::Pruned
                    } else {
                        NodeEvent::Missed
                    };
                    visitor.node(tree, node, event, entry);
                }
            };
            settle(left, left_hit, left_entry, left_exit);
            settle(right, right_hit, right_entry, right_exit);
            match (left_hit, right_hit) {
                (true, true) => {
                    let (near, far) = if right_entry < left_entry {
                        ((right_entry, right), (left_entry, left))
                    } else {
                        ((left_entry, left), (right_entry, right))
                    };
                    stack[pending] = far;
                    pending += 1;
                    Some(near)
                }
                (true, false) => Some((left_entry, left)),
                (false, true) => Some((right_entry, right)),
                (false, false) => None,
            }
        };
        let (entry, index) = match next {
            Some(next) => next,
            None => loop {
                if pending == 0 {
                    return limit;
                }
                pending -= 1;
                let (entry, index) = stack[pending];
                if entry <= limit {
                    break (entry, index);
                }
                visitor.node(tree, index, NodeEvent::Pruned, entry);
            },
        };
        visitor.node(tree, index, NodeEvent::Entered, entry);
        node = &nodes[index as usize];
    }
}

//! The walk through one tree, written once: closest hits, occlusion, every hit, with or without a visitor.

use obvhs::bvh2::node::Bvh2Node;

use super::{
    MAX_DEPTH,
    slab::SlabRay,
    visitor::{NodeEvent, TreeRef, Visitor},
};

/// A ray that ends here wants nothing more.
pub(crate) const STOP: f32 = f32::NEG_INFINITY;

/// Nodes put off for later, with where the ray enters them: one a level at most, and no tree is deeper than this.
/// Made once for a batch of rays, since clearing it takes as long as a few nodes.
pub(crate) type Stack = [(f32, u32); MAX_DEPTH];

/// An empty stack.
pub(crate) const EMPTY: Stack = [(0.0, 0); MAX_DEPTH];

/// Walks `nodes` along the ray, from the first `t` of the span to the second, the limit, nearest child first, and hands the primitives of each leaf it reaches to
/// `leaf(first, count, limit, visitor)`, which returns the new limit: the `t` beyond which nothing matters any more,
/// or [`STOP`]. Nodes entered exactly at the limit are still walked, since ties are decided by number.
#[inline(always)]
pub(crate) fn walk<V: Visitor>(
    nodes: &[Bvh2Node],
    stack: &mut Stack,
    slab: &SlabRay,
    (start, mut limit): (f32, f32),
    tree: TreeRef,
    visitor: &mut V,
    mut leaf: impl FnMut(u32, u32, f32, &mut V) -> f32,
) -> f32 {
    let Some(root) = nodes.first() else {
        return limit;
    };
    let (entry, exit) = slab.span_from(start, root.aabb());
    if entry > exit {
        visitor.node(tree, 0, NodeEvent::Missed, entry);
        return limit;
    }
    if entry > limit {
        visitor.node(tree, 0, NodeEvent::Pruned, entry);
        return limit;
    }
    visitor.node(tree, 0, NodeEvent::Entered, entry);

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
            let children = &nodes[left as usize..][..2];
            let (left_entry, left_exit) = slab.span_from(start, children[0].aabb());
            let (right_entry, right_exit) = slab.span_from(start, children[1].aabb());
            let left_hit = (left_entry <= left_exit) & (left_entry <= limit);
            let right_hit = (right_entry <= right_exit) & (right_entry <= limit);
            let mut settle = |node, hit: bool, entry: f32, exit: f32| {
                if V::LOOKS && !hit {
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

//! The recursion that median split and binned SAH share: cut, and cut the halves, in parallel.

use super::sah::Bin;
use obvhs::bvh2::node::Bvh2Node;

/// Below this many primitives a task is cheaper done than handed to another thread (some 100 µs of work).
const PARALLEL_SIZE: usize = 4096;

/// Builds a tree over `items` by cutting them in two, over and over.
///
/// `cut(items, depth, bins)` reorders the items and answers where to cut them (inside, so that both sides
/// have some), or `None` to make a leaf; `bins` is memory that it may use as it likes. Afterwards a leaf's `first_index` is a
/// position in `items`. Node boxes are not set: [`layout`](super::layout) computes them from the true boxes.
///
/// Every subtree owns a range of node slots that depends on its number of primitives only, so threads need
/// no coordination and the result does not depend on them. Slots that no node needed stay unreachable.
pub(super) fn build<Cut>(items: &mut [Bvh2Node], cut: &Cut) -> Vec<Bvh2Node>
where
    Cut: Fn(&mut [Bvh2Node], u32, &mut Vec<Bin>) -> Option<usize> + Sync,
{
    let Some(descendants) = items.len().checked_sub(1) else {
        return Vec::new();
    };
    let mut nodes = vec![Bvh2Node::default(); 1 + 2 * descendants];
    let (root, rest) = nodes.split_at_mut(1);
    let place = Place {
        first_item: 0,
        first_slot: 1,
        depth: 0,
    };
    root[0] = subtree(items, rest, place, cut, &mut Vec::new());
    nodes
}

/// Where a subtree lies in the whole.
#[derive(Clone, Copy)]
struct Place {
    first_item: usize,
    first_slot: usize,
    depth: u32,
}

/// The root of the subtree over `items`; its descendants go into `slots`, of which there are two for each
/// item but the first. The recursion is as deep as the tree, which `cut` bounds by `MAX_DEPTH`.
fn subtree<Cut>(
    items: &mut [Bvh2Node],
    slots: &mut [Bvh2Node],
    place: Place,
    cut: &Cut,
    bins: &mut Vec<Bin>,
) -> Bvh2Node
where
    Cut: Fn(&mut [Bvh2Node], u32, &mut Vec<Bin>) -> Option<usize> + Sync,
{
    let count = items.len();
    let Some(position) = cut(items, place.depth, bins) else {
        return Bvh2Node {
            prim_count: count as u32,
            first_index: place.first_item as u32,
            ..Bvh2Node::default()
        };
    };
    let (left_items, right_items) = items.split_at_mut(position);
    let (children, slots) = slots.split_at_mut(2);
    let left_slots_len = 2 * (position - 1);
    let (left_slots, right_slots) = slots.split_at_mut(left_slots_len);
    let left = Place {
        first_item: place.first_item,
        first_slot: place.first_slot + 2,
        depth: place.depth + 1,
    };
    let right = Place {
        first_item: place.first_item + position,
        first_slot: left.first_slot + left_slots_len,
        depth: place.depth + 1,
    };
    (children[0], children[1]) = if count > PARALLEL_SIZE {
        rayon::join(
            || subtree(left_items, left_slots, left, cut, bins),
            || subtree(right_items, right_slots, right, cut, &mut Vec::new()),
        )
    } else {
        (
            subtree(left_items, left_slots, left, cut, bins),
            subtree(right_items, right_slots, right, cut, bins),
        )
    };
    Bvh2Node {
        prim_count: 0,
        first_index: place.first_slot as u32,
        ..Bvh2Node::default()
    }
}

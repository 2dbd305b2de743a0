//! The walk of a packet through a wide tree.

use super::super::super::goal::Goal;
use super::super::node::{LEAF, WIDTH};
use super::super::walk::entries_of;
use super::super::{InstructionSet, WideTree};
use super::{FEW_RAYS, Found, View};

/// What the leaves of a tree hold, as [`super::super::Leaves`].
pub(crate) trait PacketLeaves<S: InstructionSet> {
    /// Tests those rays against a leaf. The rest of the walk's stack may be used.
    fn visit(
        &mut self,
        leaf: u32,
        lanes: u32,
        view: &mut View<S>,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    );

    /// Lets those rays go on one by one from a child, a node or a leaf.
    fn alone(&mut self, child: u32, lanes: u32, found: &mut Found<S::Packet>, stack: &mut [u64]);
}

/// Walks a tree with those rays of a group, and visits each leaf that any of them reaches. What waits is a place, a node
/// and which of its children, and is tested when its turn comes.
///
/// The stack holds the tree's [`WideTree::most_pending`] and [`WIDTH`] more, and what the leaves need.
#[inline(always)]
pub(crate) fn walk_packet<S: InstructionSet, G: Goal>(
    tree: &WideTree,
    stack: &mut [u64],
    view: &mut View<S>,
    lanes: u32,
    found: &mut Found<S::Packet>,
    leaves: &mut impl PacketLeaves<S>,
) {
    let Some(root) = tree.root else {
        return;
    };
    if root & LEAF != 0 {
        leaves.visit(root & !LEAF, lanes, view, found, stack);
        return;
    }
    let mut pending = 0;
    let mut next = root;
    loop {
        let (mut hits, entries) =
            view.span(&tree.nodes[next as usize], found.farthest, tree.is_narrow);
        if hits != 0 {
            let entries = entries_of(entries);
            let window = &mut stack[pending..pending + WIDTH];
            let mut count = 0;
            while hits != 0 {
                let child = hits.trailing_zeros();
                hits &= hits - 1;
                let entry = u64::from(entries[child as usize % WIDTH].to_bits());
                let new = entry << 32 | u64::from(next << 4 | child);
                let mut place = count;
                if G::NEAREST_FIRST {
                    while place > 0 && window[(place - 1) % WIDTH] < new {
                        window[place % WIDTH] = window[(place - 1) % WIDTH];
                        place -= 1;
                    }
                }
                window[place % WIDTH] = new;
                count += 1;
            }
            pending += count;
        }
        next = loop {
            if pending == 0 {
                return;
            }
            pending -= 1;
            let waiting = stack[pending];
            if f32::from_bits((waiting >> 32) as u32) > found.farthest {
                continue;
            }
            let place = waiting as u32;
            let (node, child) = (&tree.nodes[place as usize >> 4], place & 15);
            let lanes = lanes & if G::ANY { found.active } else { lanes };
            let entered = view.enter(node, child, found.limit) & lanes;
            if entered == 0 {
                continue;
            }
            let child = node.child(child);
            if entered.count_ones() <= FEW_RAYS {
                leaves.alone(child, entered, found, &mut stack[pending..]);
            } else if child & LEAF != 0 {
                leaves.visit(child & !LEAF, entered, view, found, &mut stack[pending..]);
            } else {
                break child;
            }
            if G::ANY && lanes & found.active == 0 {
                return;
            }
        };
    }
}

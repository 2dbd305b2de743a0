//! The walk through a wide tree.

use glam::Vec3A;

use super::super::goal::{Goal, Question, is_end};
use super::super::slab::SlabRay;
use super::super::visitor::{NodeEvent, TreeRef, Visitor};
use super::{
    Eight, WideTree, by_axis,
    node::{LEAF, Sides, WIDTH, WideNode},
};
use crate::bvh::MAX_DEPTH;

/// Entries of a stack that ordinary meshes of a million triangles get by with: they need 90 to 130.
pub(crate) const FEW: usize = 160;
/// Entries that every tree gets by with: two levels of trees no deeper than [`MAX_DEPTH`], fifteen a node.
pub(crate) const MANY: usize = 2 * (WIDTH - 1) * MAX_DEPTH + WIDTH;

/// Whether a stack of [`FEW`] entries holds as many, or else one of [`MANY`] does.
#[inline(always)]
pub(crate) fn few_hold(most_pending: usize) -> bool {
    most_pending + WIDTH <= FEW
}

/// What the slab test needs of a ray, eight times over.
#[derive(Clone, Copy)]
pub(crate) struct WideRay<E> {
    /// Which faces the ray meets first.
    pub(crate) sides: &'static Sides,
    /// What those are measured from: the origin, moved along the ray or against it.
    pub(crate) near_origin: [E; 3],
    pub(crate) far_origin: [E; 3],
    /// Minus one over the direction, so that a face is what is subtracted, which may come from memory.
    pub(crate) backward: [E; 3],
    pub(crate) start: E,
}

impl<E: Eight> WideRay<E> {
    /// The part of the line from `start`, which is not negative, on.
    #[inline(always)]
    pub(crate) fn new(slab: &SlabRay, start: f32) -> Self {
        let (above, below) = (slab.above, slab.below);
        let inverse = slab.inverse;
        let backwards = inverse.cmplt(Vec3A::ZERO);
        let near = Vec3A::select(backwards, below, above);
        let far = Vec3A::select(backwards, above, below);
        let splat = |v: Vec3A| [E::splat(v.x), E::splat(v.y), E::splat(v.z)];
        Self {
            sides: Sides::of(backwards.bitmask()),
            near_origin: splat(near),
            far_origin: splat(far),
            backward: splat(-inverse),
            // No entry shall be -0.0, so that their bits are in order.
            start: E::splat(start + 0.0),
        }
    }

    /// Which children the ray enters, no later than at `limit`, and where. The numbers are those of
    /// [`SlabRay::span`]: which of a box's two faces is nearer follows from the direction's sign, because the
    /// differences and products are monotone. (Both factors have the other sign here, which changes no product but a
    /// zero's sign.)
    ///
    /// In halves, because registers of sixteen make some machines' clocks slower (a tenth, Sapphire Rapids). The second
    /// is left out where the tree `is_narrow`.
    #[inline(always)]
    fn enter(&self, node: &WideNode, limit: f32, is_narrow: bool) -> (u32, [E; 2]) {
        let (first, entries) = self.enter_half(node, 0, limit);
        if is_narrow {
            return (first, [entries, entries]);
        }
        let (second, more) = self.enter_half(node, 1, limit);
        (first | second << 8, [entries, more])
    }

    /// [`Self::enter`], of eight children.
    #[inline(always)]
    fn enter_half(&self, node: &WideNode, half: usize, limit: f32) -> (u32, E) {
        let near = by_axis!(|axis| node.faces(axis, self.sides.first[axis], half));
        let [x, y, z] = self.meet(near, &self.near_origin);
        // In pairs, since the next node waits for it; the start last, so that no entry is -0.0.
        let entry = x.max(y).max(z.max(self.start));
        let far = by_axis!(|axis| node.faces(axis, self.sides.last[axis], half));
        let [x, y, z] = self.meet(far, &self.far_origin);
        let exit = x.min(y).min(z.min(E::splat(limit)));
        (E::bits(entry.le(exit)), entry)
    }

    /// Where the ray meets three faces of each child.
    #[inline(always)]
    fn meet(&self, faces: [&[f32; 8]; 3], origin: &[E; 3]) -> [E; 3] {
        by_axis!(|axis| (origin[axis].sub(E::load(faces[axis]))).mul(self.backward[axis]))
    }
}

/// Where a ray enters a node's children, to be read one by one.
#[inline(always)]
pub(super) fn entries_of<E: Eight>([first, second]: [E; 2]) -> [f32; WIDTH] {
    bytemuck::cast([first.to_array(), second.to_array()])
}

/// A child that waits, and where the ray enters it: ordered by that.
#[inline(always)]
fn waiting(node: &WideNode, entries: &[f32; WIDTH], lane: u32) -> u64 {
    u64::from(entries[lane as usize % WIDTH].to_bits()) << 32 | u64::from(node.child(lane))
}

/// What the leaves of a tree hold. A trait and not a closure, because its method has to become part of the function
/// that is compiled for the instruction set of `E`, and only a method can be `#[inline(always)]`.
pub(crate) trait Leaves<E, G, V> {
    /// What a visitor knows the tree by.
    fn tree(&self) -> TreeRef;

    /// Tests the ray against a leaf, and returns the new limit: the `t` beyond which nothing matters any more, or
    /// [`STOP`](super::super::goal::STOP). The rest of the walk's stack may be used.
    fn visit(
        &mut self,
        leaf: u32,
        limit: f32,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    ) -> f32;

    /// Has a leaf brought nearer that the ray will visit soon.
    #[inline(always)]
    fn prefetch(&self, _leaf: u32) {}

    /// What to visit next, where that leaf was only a part of one.
    #[inline(always)]
    fn rest(&self, _leaf: u32) -> Option<u32> {
        None
    }
}

/// Walks a tree along the ray and visits each leaf it reaches: with [`Goal::NEAREST_FIRST`] in the order in which it enters
/// nodes, and else in no particular order, since sorting costs more than a ray saves that wants any hit. What is entered
/// exactly at the limit is still walked, since ties are decided by number. Returns the last limit.
///
/// The stack holds the tree's [`WideTree::most_pending`] and [`WIDTH`] more, and what the leaves need.
#[inline(always)]
pub(crate) fn walk<E: Eight, G: Goal, V: Visitor>(
    tree: &WideTree,
    stack: &mut [u64],
    ray: &WideRay<E>,
    limit: f32,
    leaves: &mut impl Leaves<E, G, V>,
    question: &mut Question<G, V>,
) -> f32 {
    match tree.root {
        Some(root) => walk_from(tree, root, stack, ray, limit, leaves, question),
        None => limit,
    }
}

/// [`walk`] from a node or, marked by [`LEAF`], a leaf on.
#[inline(always)]
pub(crate) fn walk_from<E: Eight, G: Goal, V: Visitor>(
    tree: &WideTree,
    mut next: u32,
    stack: &mut [u64],
    ray: &WideRay<E>,
    mut limit: f32,
    leaves: &mut impl Leaves<E, G, V>,
    question: &mut Question<G, V>,
) -> f32 {
    let mut pending = 0;
    // Where the ray enters what is next, and whether that was entered before: only a visitor wants to know.
    let mut entry = if V::LOOKS { ray.start.smallest() } else { 0.0 };
    let mut is_rest = false;
    loop {
        if V::LOOKS && !is_rest {
            let (name, node) = (leaves.tree(), tree.source(next));
            question.visitor.node(name, node, NodeEvent::Entered, entry);
        }
        if next & LEAF != 0 {
            let leaf = next & !LEAF;
            limit = leaves.visit(leaf, limit, &mut stack[pending..], question);
            if is_end::<G>(limit) {
                return limit;
            }
            if let Some(rest) = leaves.rest(leaf) {
                next = LEAF | rest;
                is_rest = true;
                continue;
            }
            is_rest = false;
        } else {
            let node = &tree.nodes[next as usize];
            let (mut hits, entries) = ray.enter(node, limit, tree.is_narrow);
            let mut watched = Watched {
                tree,
                name: leaves.tree(),
                visitor: &mut *question.visitor,
            };
            watched.left_out(node, ray, hits);
            if hits != 0 {
                let first = hits.trailing_zeros();
                hits &= hits - 1;
                if hits == 0 {
                    next = node.child(first);
                    if V::LOOKS {
                        entry = entries_of(entries)[first as usize % WIDTH];
                    }
                    continue;
                }
                if G::NEAREST_FIRST {
                    let entries = entries_of(entries);
                    let second = hits.trailing_zeros();
                    hits &= hits - 1;
                    let a = waiting(node, &entries, first);
                    let b = waiting(node, &entries, second);
                    let (near, far) = (a.min(b), a.max(b));
                    if hits == 0 {
                        stack[pending] = far;
                        prefetch::<E, G, V>(tree, leaves, far as u32);
                        watched.put_off(&[far]);
                        pending += 1;
                        next = near as u32;
                        entry = entry_of(near);
                        continue;
                    }
                    // The third without a branch, which nothing could foresee; what is nearest does not wait for the rest.
                    let third = waiting(node, &entries, hits.trailing_zeros());
                    hits &= hits - 1;
                    let (mut near, third) = (near.min(third), near.max(third));
                    let window = &mut stack[pending..pending + WIDTH];
                    (window[0], window[1]) = (far.max(third), far.min(third));
                    let mut count = 2;
                    while hits != 0 {
                        let new = waiting(node, &entries, hits.trailing_zeros());
                        hits &= hits - 1;
                        let farther = near.max(new);
                        near = near.min(new);
                        let mut place = count;
                        while place > 0 && window[(place - 1) % WIDTH] < farther {
                            window[place % WIDTH] = window[(place - 1) % WIDTH];
                            place -= 1;
                        }
                        window[place % WIDTH] = farther;
                        count += 1;
                    }
                    prefetch::<E, G, V>(tree, leaves, window[(count - 1) % WIDTH] as u32);
                    watched.put_off(&window[..count]);
                    next = near as u32;
                    entry = entry_of(near);
                    pending += count;
                } else {
                    next = node.child(first);
                    let entries = entries_of(entries);
                    entry = entries[first as usize % WIDTH];
                    let window = &mut stack[pending..pending + WIDTH];
                    let mut count = 0;
                    while hits != 0 {
                        let lane = hits.trailing_zeros();
                        prefetch::<E, G, V>(tree, leaves, node.child(lane));
                        window[count % WIDTH] = if V::LOOKS {
                            waiting(node, &entries, lane)
                        } else {
                            u64::from(node.child(lane))
                        };
                        hits &= hits - 1;
                        count += 1;
                    }
                    watched.put_off(&window[..count]);
                    pending += count;
                }
                continue;
            }
        }
        loop {
            if pending == 0 {
                return limit;
            }
            pending -= 1;
            let waiting = stack[pending];
            entry = entry_of(waiting);
            if !G::NEAREST_FIRST || entry <= limit {
                next = waiting as u32;
                break;
            }
            if V::LOOKS {
                let (name, node) = (leaves.tree(), tree.source(waiting as u32));
                question.visitor.node(name, node, NodeEvent::Pruned, entry);
            }
        }
    }
}

/// Has a child brought nearer that waits.
#[inline(always)]
fn prefetch<E: Eight, G: Goal, V: Visitor>(
    tree: &WideTree,
    leaves: &impl Leaves<E, G, V>,
    child: u32,
) {
    if child & LEAF != 0 {
        leaves.prefetch(child & !LEAF);
    } else if let Some(node) = tree.nodes.get(child as usize) {
        E::prefetch(node);
    }
}

/// Where the ray enters what waits.
#[inline(always)]
fn entry_of(waiting: u64) -> f32 {
    f32::from_bits((waiting >> 32) as u32)
}

/// A visitor of a tree. Every method is empty where nobody looks.
struct Watched<'a, V> {
    tree: &'a WideTree,
    name: TreeRef,
    visitor: &'a mut V,
}

impl<V: Visitor> Watched<'_, V> {
    /// The children that are not among those which the ray enters.
    #[inline(always)]
    fn left_out<E: Eight>(&mut self, node: &WideNode, ray: &WideRay<E>, entered: u32) {
        if !V::LOOKS {
            return;
        }
        let (hit, entries) = ray.enter(node, f32::INFINITY, false);
        let entries = entries_of(entries);
        for lane in node.lanes().filter(|lane| entered >> lane & 1 == 0) {
            let event = if hit >> lane & 1 == 1 {
                NodeEvent::Pruned
            } else {
                NodeEvent::Missed
            };
            let source = self.tree.source(node.child(lane));
            self.visitor
                .node(self.name, source, event, entries[lane as usize % WIDTH]);
        }
    }

    /// The children that were put onto the stack.
    #[inline(always)]
    fn put_off(&mut self, waiting: &[u64]) {
        if !V::LOOKS {
            return;
        }
        for &waiting in waiting {
            let source = self.tree.source(waiting as u32);
            self.visitor.waits(self.name, source, entry_of(waiting));
        }
    }
}

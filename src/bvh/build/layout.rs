//! The last step of every builder: nodes in depth-first order, exact boxes, a bounded depth.

use super::{
    boxes::{self, Item},
    depth::MAX_DEPTH,
    median,
    options::BuildOptions,
    top_down,
};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, DEFAULT_MAX_STACK_DEPTH, node::Bvh2Node},
};

/// Where a path that would become too deep is cut off: what lies below is built anew by halving, and 32
/// halvings tell all primitives apart that a `u32` can number.
const REBUILD_DEPTH: usize = MAX_DEPTH - 32;

/// A tree of what has been laid out already: nodes in depth-first order with their boxes, the root first, and the primitives
/// in the order of the leaves. `depth` is that of the deepest leaf.
pub(in crate::bvh) fn tree(
    nodes: Vec<Bvh2Node>,
    primitive_indices: Vec<u32>,
    depth: usize,
) -> Bvh2 {
    Bvh2 {
        nodes,
        primitive_indices,
        max_depth: DEFAULT_MAX_STACK_DEPTH.max(depth + 1),
        children_are_ordered_after_parents: true,
        ..Bvh2::default()
    }
}

/// Makes a tree of a draft, whatever made that, with these properties:
/// - nodes stand in depth-first order, the two children of a node side by side and after it;
/// - `primitive_indices` stands in the order of the leaves, so a subtree's primitives are a range of it;
/// - every box is the union of the primitives' `boxes`, not of what the builder made of them;
/// - no leaf is deeper than [`MAX_DEPTH`].
pub(super) fn finish(draft: &Bvh2, boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    if draft.nodes.is_empty() {
        return Bvh2::default();
    }
    let mut tree = tree(
        Vec::with_capacity(draft.nodes.len()),
        Vec::with_capacity(boxes.len()),
        0,
    );
    tree.nodes.push(Bvh2Node::default());
    let root = Visit {
        from: 0,
        to: 0,
        depth: 0,
    };
    let depth = copy(draft, root, &mut tree, boxes, options);
    tree.nodes.shrink_to_fit();
    tree.max_depth = tree.max_depth.max(depth + 1);
    tree.refit_all();
    tree
}

/// A node of the draft on its way to its place in the tree.
#[derive(Clone, Copy)]
struct Visit {
    from: usize,
    to: usize,
    depth: usize,
}

/// Copies the subtree at `start` behind the nodes that are there, and answers the depth of its deepest leaf.
/// Leaves get their boxes.
fn copy(
    draft: &Bvh2,
    start: Visit,
    tree: &mut Bvh2,
    boxes: &[Aabb],
    options: &BuildOptions,
) -> usize {
    let mut deepest = 0;
    let mut stack = vec![start];
    while let Some(visit) = stack.pop() {
        let node = draft.nodes[visit.from];
        if node.is_leaf() {
            let first = node.first_index as usize;
            let primitives = &draft.primitive_indices[first..first + node.prim_count as usize];
            tree.nodes[visit.to] = leaf(primitives, tree.primitive_indices.len(), boxes);
            tree.primitive_indices.extend_from_slice(primitives);
            deepest = deepest.max(visit.depth);
            continue;
        }
        if visit.depth == REBUILD_DEPTH
            && exceeds(&draft.nodes, visit.from, MAX_DEPTH - REBUILD_DEPTH)
        {
            deepest = deepest.max(rebuild(draft, visit, tree, boxes, options));
            continue;
        }
        let children = tree.nodes.len();
        tree.nodes[visit.to].make_inner(children as u32);
        tree.nodes.extend([Bvh2Node::default(); 2]);
        // The left child comes off the stack first, so leaves are met from left to right.
        for side in [1, 0] {
            stack.push(Visit {
                from: node.first_index as usize + side,
                to: children + side,
                depth: visit.depth + 1,
            });
        }
    }
    deepest
}

fn leaf(primitives: &[u32], first: usize, boxes: &[Aabb]) -> Bvh2Node {
    let bounds = boxes::union(primitives.iter().map(|&p| boxes[p as usize]));
    Bvh2Node::new(
        bounds.unwrap_or_default(),
        primitives.len() as u32,
        first as u32,
    )
}

/// Is any leaf more than `levels` below `root`?
pub(super) fn exceeds(nodes: &[Bvh2Node], root: usize, levels: usize) -> bool {
    let mut stack = vec![(root, 0)];
    while let Some((index, level)) = stack.pop() {
        if level > levels {
            return true;
        }
        let node = nodes[index];
        if !node.is_leaf() {
            let child = node.first_index as usize;
            stack.extend([(child, level + 1), (child + 1, level + 1)]);
        }
    }
    false
}

/// Replaces the subtree at `visit` by a balanced one over the same primitives.
fn rebuild(
    draft: &Bvh2,
    visit: Visit,
    tree: &mut Bvh2,
    boxes: &[Aabb],
    options: &BuildOptions,
) -> usize {
    let mut items = Vec::new();
    let mut stack = vec![visit.from];
    while let Some(index) = stack.pop() {
        let node = draft.nodes[index];
        let first = node.first_index as usize;
        if node.is_leaf() {
            let primitives = &draft.primitive_indices[first..first + node.prim_count as usize];
            items.extend(primitives.iter().map(|&p| Item::new(&boxes[p as usize], p)));
        } else {
            stack.extend([first + 1, first]);
        }
    }
    let balanced = BuildOptions {
        max_depth: (MAX_DEPTH - REBUILD_DEPTH) as u32,
        ..*options
    };
    let grown = top_down::build(&mut items, boxes, &|items, centres, depth, _| {
        median::cut(items, centres, depth, &balanced)
    });
    let mut nodes = grown.within(tree.nodes.len(), tree.primitive_indices.len());
    if let Some(root) = nodes.next() {
        tree.nodes[visit.to] = root;
    }
    tree.nodes.extend(nodes);
    tree.primitive_indices
        .extend(items.iter().map(Item::number));
    visit.depth + grown.depth
}

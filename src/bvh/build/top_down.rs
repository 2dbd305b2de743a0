//! The recursion that median split and binned SAH share: cut, and cut the halves, in parallel.

use super::{boxes::Item, median, sah::Bins};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// Below this many primitives a task is cheaper done than handed to another thread (some 100 µs of work).
const PARALLEL_SIZE: usize = 4096;

/// Above so many primitives threads share the work of a single cut.
pub(super) const PARALLEL_CUT: usize = 1 << 16;

/// Where items part: the first so many from the others.
pub(in crate::bvh) struct Cut {
    /// Inside, so that both sides have some.
    pub(in crate::bvh) position: usize,
    /// Bounds of [`Item::centre`] of either side.
    pub(super) centres: [Aabb; 2],
}

/// A tree over items: nodes in depth-first order, the root first, children side by side and after their parent. A leaf's
/// `first_index` is a position in the items.
pub(in crate::bvh) struct Grown {
    pub(in crate::bvh) nodes: Vec<Bvh2Node>,
    /// The depth of the deepest leaf; the root's is 0.
    pub(in crate::bvh) depth: usize,
}

impl Grown {
    /// The nodes as a part of a larger tree, in which those below the root begin at `first_node`, and the primitives at
    /// `first_primitive`.
    pub(in crate::bvh) fn within(
        &self,
        first_node: usize,
        first_primitive: usize,
    ) -> impl Iterator<Item = Bvh2Node> {
        self.nodes.iter().map(move |node| Bvh2Node {
            first_index: if node.is_leaf() {
                node.first_index + first_primitive as u32
            } else {
                // They stand behind the root, which goes elsewhere.
                node.first_index - 1 + first_node as u32
            },
            ..*node
        })
    }
}

/// Builds a tree over `items` by cutting them in two, over and over. Its boxes are the unions of the items' `boxes`, of
/// which theirs may be copies on another scale.
///
/// `cut(items, centres, depth, bins)` reorders the items and answers where to cut them, or `None` to make a leaf; `centres`
/// bounds theirs, `bins` is memory that it may use as it likes. The tree does not depend on the number of threads.
pub(in crate::bvh) fn build<C>(items: &mut [Item], boxes: &[Aabb], cut: &C) -> Grown
where
    C: Fn(&mut [Item], &Aabb, u32, &mut Bins) -> Option<Cut> + Sync,
{
    if items.is_empty() {
        return Grown {
            nodes: Vec::new(),
            depth: 0,
        };
    }
    let centres = median::centre_bounds(items);
    let top = Place { first: 0, depth: 0 };
    let branch = Growth { boxes, cut }.branch(items, &centres, top, &mut Bins::new());
    let mut nodes = Vec::with_capacity(1 + branch.below.len());
    nodes.push(shifted(&branch.root, 1));
    branch.below.append_to(&mut nodes);
    Grown {
        nodes,
        depth: branch.depth,
    }
}

/// Where a subtree lies in the whole.
#[derive(Clone, Copy)]
struct Place {
    /// Its first item.
    first: usize,
    depth: u32,
}

/// A subtree.
struct Branch {
    /// Its children are the first two of the nodes below it.
    root: Bvh2Node,
    below: Below,
    depth: usize,
}

/// What stands below the root of a subtree.
enum Below {
    /// All nodes; inner ones count their children from the first of these.
    Nodes(Vec<Bvh2Node>),
    /// The two halves, which threads have built apart.
    Halves(Box<[Branch; 2]>),
}

/// The node, if the nodes that inner ones count from are moved up by so much.
fn shifted(node: &Bvh2Node, by: usize) -> Bvh2Node {
    let by = if node.is_leaf() { 0 } else { by as u32 };
    Bvh2Node {
        first_index: node.first_index + by,
        ..*node
    }
}

impl Below {
    fn len(&self) -> usize {
        match self {
            Self::Nodes(nodes) => nodes.len(),
            Self::Halves(halves) => halves.iter().map(|half| 1 + half.below.len()).sum(),
        }
    }

    fn append_to(&self, nodes: &mut Vec<Bvh2Node>) {
        let first = nodes.len();
        match self {
            Self::Nodes(below) => nodes.extend(below.iter().map(|node| shifted(node, first))),
            Self::Halves(halves) => {
                nodes.extend([Bvh2Node::default(); 2]);
                for (side, half) in halves.iter().enumerate() {
                    nodes[first + side] = shifted(&half.root, nodes.len());
                    half.below.append_to(nodes);
                }
            }
        }
    }
}

struct Growth<'a, C> {
    boxes: &'a [Aabb],
    cut: &'a C,
}

impl<C> Growth<'_, C>
where
    C: Fn(&mut [Item], &Aabb, u32, &mut Bins) -> Option<Cut> + Sync,
{
    /// A subtree whose halves threads share while it is large. The recursion is as deep as the tree, which `cut` bounds
    /// by [`MAX_DEPTH`](super::depth::MAX_DEPTH).
    fn branch(&self, items: &mut [Item], centres: &Aabb, place: Place, bins: &mut Bins) -> Branch {
        if items.len() <= PARALLEL_SIZE {
            let mut nodes = Vec::with_capacity(items.len());
            let (root, depth) = self.subtree(items, centres, place, bins, &mut nodes);
            let below = Below::Nodes(nodes);
            return Branch { root, below, depth };
        }
        let Some(cut) = (self.cut)(items, centres, place.depth, bins) else {
            return Branch {
                root: self.leaf(items, place.first),
                below: Below::Nodes(Vec::new()),
                depth: place.depth as usize,
            };
        };
        let (left, right) = items.split_at_mut(cut.position);
        let [left_place, right_place] = place.halves(cut.position);
        let [of_left, of_right] = &cut.centres;
        let (left, right) = rayon::join(
            || self.branch(left, of_left, left_place, bins),
            || self.branch(right, of_right, right_place, &mut Bins::new()),
        );
        Branch {
            root: parent(&left.root, &right.root, 0),
            depth: left.depth.max(right.depth),
            below: Below::Halves(Box::new([left, right])),
        }
    }

    /// The root of a subtree and the depth of its deepest leaf; all that is below the root goes into `nodes`.
    fn subtree(
        &self,
        items: &mut [Item],
        centres: &Aabb,
        place: Place,
        bins: &mut Bins,
        nodes: &mut Vec<Bvh2Node>,
    ) -> (Bvh2Node, usize) {
        let Some(cut) = (self.cut)(items, centres, place.depth, bins) else {
            return (self.leaf(items, place.first), place.depth as usize);
        };
        let (left, right) = items.split_at_mut(cut.position);
        let places = place.halves(cut.position);
        let children = nodes.len();
        nodes.extend([Bvh2Node::default(); 2]);
        let mut deepest = 0;
        for (side, half) in [left, right].into_iter().enumerate() {
            let (root, depth) = self.subtree(half, &cut.centres[side], places[side], bins, nodes);
            nodes[children + side] = root;
            deepest = deepest.max(depth);
        }
        let root = parent(&nodes[children], &nodes[children + 1], children);
        (root, deepest)
    }

    fn leaf(&self, items: &[Item], first: usize) -> Bvh2Node {
        let boxes = items.iter().map(|item| self.boxes[item.number() as usize]);
        let bounds = super::boxes::union(boxes).unwrap_or_default();
        Bvh2Node::new(bounds, items.len() as u32, first as u32)
    }
}

impl Place {
    fn halves(self, position: usize) -> [Self; 2] {
        [0, position].map(|offset| Self {
            first: self.first + offset,
            depth: self.depth + 1,
        })
    }
}

fn parent(left: &Bvh2Node, right: &Bvh2Node, first: usize) -> Bvh2Node {
    Bvh2Node::new(left.aabb().union(right.aabb()), 0, first as u32)
}

//! Watching a traversal: gizmos and counters hook in here, so that what they show is what happened.

/// Which tree a node belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TreeRef {
    /// The aggregate's own tree: over instances, or over every triangle ([`crate::bvh::Levels::One`]).
    Top,
    /// The tree of this instance's mesh.
    Mesh(u32),
}

/// What became of a node whose box was tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NodeEvent {
    /// The box was hit, and its children or primitives were looked at. Also of a tree's root.
    Entered,
    /// The box was hit, but farther away than the best hit known when its turn came.
    Pruned,
    /// The ray misses the box.
    Missed,
}

/// Told of every box and triangle a ray is tested against, in order, by the walk that traces pictures, of one ray at a
/// time.
///
/// That walk tests the boxes of a wide node's children at once. Each of them is the box of a node of the binary tree that
/// the wide one was made of, and has that node's number here; binary nodes whose levels were left out are not heard of.
///
/// Every method has an empty body, and `()` implements the trait: nobody watches then, and the walk is the one of
/// queries without a visitor.
pub trait Visitor {
    /// Whether it looks at all. What is worked out for a visitor's sake alone is left out where it does not.
    const LOOKS: bool = true;

    /// A node's box was tested. Every tested node gets exactly one event, at the moment its fate is known; none if the
    /// ray wants nothing more before that. A tree's root is entered without a test.
    /// `t_entry` is where the ray enters the box (0 where it starts inside); meaningless when `Missed`.
    #[inline(always)]
    fn node(&mut self, _tree: TreeRef, _node: u32, _event: NodeEvent, _t_entry: f32) {}

    /// A node's box was hit, and others of the same parent have their turn before: it was put onto the stack, which holds
    /// the nodes of both levels of trees. The one that was put there last comes off it next.
    #[inline(always)]
    fn waits(&mut self, _tree: TreeRef, _node: u32, _t_entry: f32) {}

    /// A triangle was tested; `hit` tells whether it became the best hit so far. All of a leaf's block are tested at
    /// once.
    #[inline(always)]
    fn triangle(&mut self, _instance: u32, _triangle: u32, _hit: bool) {}
}

impl Visitor for () {
    const LOOKS: bool = false;
}

/// Counts what a ray cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Boxes tested, and roots entered.
    pub boxes: u64,
    /// Nodes entered.
    pub nodes: u64,
    /// Triangles tested.
    pub triangles: u64,
}

impl Visitor for Counters {
    #[inline(always)]
    fn node(&mut self, _tree: TreeRef, _node: u32, event: NodeEvent, _t_entry: f32) {
        self.boxes += 1;
        self.nodes += u64::from(event == NodeEvent::Entered);
    }

    #[inline(always)]
    fn triangle(&mut self, _instance: u32, _triangle: u32, _hit: bool) {
        self.triangles += 1;
    }
}

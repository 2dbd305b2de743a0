//! The way of one ray through the trees, step by step, with the stack: to be played forwards and
//! back.

use crate::bvh::{NodeEvent, TreeRef, Visitor};
use crate::scene::RenderSettings;
use crate::trace::{RayTree, World};
use serde::Serialize;

/// The walk of one debug ray through the trees, from its first box to its last: the one that traces pictures, without
/// packets. It goes through the trees' wide form, whose boxes are those of some nodes of the binary one, and have their
/// numbers. A ray that asks several times (straight on from an edge that triangles share) starts several times at a root.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Traversal {
    /// What happened, in order.
    pub steps: Vec<Step>,
    /// The stacks after each step, one behind the other: (instance or `None` for the top tree, node),
    /// the next to be looked at last. Children that are put onto it together with a step's box stand
    /// in the stack of the step after it.
    pub stack: Vec<StackEntry>,
}

/// A node that is put off.
pub type StackEntry = (Option<u32>, u32);

/// One step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Step {
    /// What happened.
    pub kind: StepKind,
    /// In the tree of this instance's mesh; `None`: in the top tree.
    pub instance: Option<u32>,
    /// The node whose box was tested; for a triangle, the leaf that holds it.
    pub node: u32,
    /// The triangle that was tested, and whose it is.
    pub triangle: Option<[u32; 2]>,
    /// Where the ray enters the box; `None` where it misses, and for triangles.
    pub t: Option<f32>,
    /// The part of [`Traversal::stack`] that is this step's.
    pub stack: [u32; 2],
}

/// What happened in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StepKind {
    /// The box was hit, and its turn came; or it is a tree's root.
    Entered,
    /// The ray misses the box.
    Missed,
    /// The box was hit behind the nearest hit known when its turn came, or is beyond the ray's end.
    Pruned,
    /// A triangle was tested, and became the nearest hit.
    Hit,
    /// A triangle was tested, and did not.
    NotHit,
}

impl StepKind {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Entered => "enter",
            Self::Missed => "miss",
            Self::Pruned => "prune",
            Self::Hit => "hit",
            Self::NotHit => "no hit",
        }
    }
}

impl Traversal {
    /// Traces a debug ray again and writes down every step. Empty for a ray that was not traced, and
    /// where there is no ray of that index.
    pub fn of(world: &World, settings: &RenderSettings, rays: &RayTree, index: u32) -> Self {
        let mut events = Events::default();
        if (index as usize) < rays.rays.len() {
            rays.retrace(world, settings, index, &mut events);
        }
        events.0
    }

    /// The stack after a step, the next node to be looked at last.
    pub fn stack_after(&self, step: usize) -> &[StackEntry] {
        self.steps.get(step).map_or(&[], |step| {
            &self.stack[step.stack[0] as usize..step.stack[1] as usize]
        })
    }
}

/// Steps as they happen, the node that was entered last, in which tree, and the stack.
#[derive(Default)]
struct Events(Traversal, StackEntry, Vec<StackEntry>);

impl Events {
    fn add(&mut self, kind: StepKind, triangle: Option<[u32; 2]>, t: Option<f32>, at: StackEntry) {
        let Self(Traversal { steps, stack }, _, waiting) = self;
        let from = stack.len() as u32;
        stack.extend_from_slice(waiting);
        steps.push(Step {
            kind,
            instance: at.0,
            node: at.1,
            triangle,
            t,
            stack: [from, stack.len() as u32],
        });
    }
}

fn entry(tree: TreeRef, node: u32) -> StackEntry {
    match tree {
        TreeRef::Top => (None, node),
        TreeRef::Mesh(instance) => (Some(instance), node),
    }
}

impl Visitor for Events {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, t_entry: f32) {
        let here = entry(tree, node);
        let (kind, t) = match event {
            NodeEvent::Entered => (StepKind::Entered, Some(t_entry)),
            NodeEvent::Pruned => (StepKind::Pruned, Some(t_entry)),
            NodeEvent::Missed => (StepKind::Missed, None),
        };
        // What waited has its turn.
        self.2.pop_if(|top| *top == here);
        if kind == StepKind::Entered {
            self.1 = here;
        }
        self.add(kind, None, t, here);
    }

    fn waits(&mut self, tree: TreeRef, node: u32, _: f32) {
        self.2.push(entry(tree, node));
    }

    fn triangle(&mut self, instance: u32, triangle: u32, hit: bool) {
        let kind = if hit { StepKind::Hit } else { StepKind::NotHit };
        self.add(kind, Some([instance, triangle]), None, self.1);
    }
}

//! The way of one ray through the trees, step by step, with the stack: to be played forwards and
//! back.

use crate::bvh::{NodeEvent, TreeRef, Visitor};
use crate::scene::RenderSettings;
use crate::trace::{RayTree, World};
use serde::Serialize;

/// The single-ray traversal of the binary trees by one debug ray, from its first box to its last.
/// A ray that asks several times (through transparent surfaces) starts several times at the root.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Traversal {
    /// What happened, in order.
    pub steps: Vec<Step>,
    /// The stacks after each step, one behind the other: (instance or `None` for the top tree, node),
    /// the next to be looked at last.
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
    /// The box was hit, and its turn came.
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
        events.with_stacks(world)
    }

    /// The stack after a step, the next node to be looked at last.
    pub fn stack_after(&self, step: usize) -> &[StackEntry] {
        self.steps.get(step).map_or(&[], |step| {
            &self.stack[step.stack[0] as usize..step.stack[1] as usize]
        })
    }
}

/// Steps as they happen; the visitor is not told of stacks.
#[derive(Default)]
struct Events {
    steps: Vec<Step>,
    /// The node that was entered last, in which tree.
    leaf: (Option<u32>, u32),
}

impl Visitor for Events {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, t_entry: f32) {
        let instance = match tree {
            TreeRef::Top => None,
            TreeRef::Mesh(instance) => Some(instance),
        };
        let (kind, t) = match event {
            NodeEvent::Entered => (StepKind::Entered, Some(t_entry)),
            NodeEvent::Pruned => (StepKind::Pruned, Some(t_entry)),
            NodeEvent::Missed => (StepKind::Missed, None),
        };
        if kind == StepKind::Entered {
            self.leaf = (instance, node);
        }
        self.steps.push(Step {
            kind,
            instance,
            node,
            triangle: None,
            t,
            stack: [0; 2],
        });
    }

    fn triangle(&mut self, instance: u32, triangle: u32, hit: bool) {
        let (tree, node) = self.leaf;
        self.steps.push(Step {
            kind: if hit { StepKind::Hit } else { StepKind::NotHit },
            instance: tree,
            node,
            triangle: Some([instance, triangle]),
            t: None,
            stack: [0; 2],
        });
    }
}

impl Events {
    /// Works out the stacks. Both boxes of an inner node's children are tested when it is entered;
    /// those that are missed or pruned at once are told of at once; of two that are left the nearer is
    /// entered next, and the other goes onto the stack.
    fn with_stacks(self, world: &World) -> Traversal {
        let mut traversal = Traversal {
            steps: self.steps,
            stack: Vec::new(),
        };
        let mut stack: Vec<StackEntry> = Vec::new();
        // Per level of trees the last inner node entered, and its children that are done with.
        let mut parents: Vec<Parent> = Vec::new();
        for step in &mut traversal.steps {
            let here = (step.instance, step.node);
            if step.triangle.is_none() {
                // Back in the top tree, or at a root again: what was left of another tree is dropped.
                while parents.last().is_some_and(|p| p.instance != step.instance)
                    && parents.iter().any(|p| p.instance == step.instance)
                {
                    let gone = parents.pop().map(|p| p.instance);
                    stack.retain(|entry| Some(entry.0) != gone);
                }
                if step.node == 0 {
                    parents.retain(|p| p.instance != step.instance);
                    stack.retain(|entry| entry.0 != step.instance);
                    if step.instance.is_none() {
                        parents.clear();
                        stack.clear();
                    }
                }
                let children = parents
                    .last()
                    .filter(|p| p.instance == step.instance)
                    .map(|p| (p.left, p.done));
                if stack.last() == Some(&here) {
                    stack.pop();
                } else if let Some((left, done)) = children
                    && (left..=left + 1).contains(&step.node)
                {
                    let side = (step.node - left) as usize;
                    if step.kind == StepKind::Entered && !done[1 - side] {
                        stack.push((step.instance, left + 1 - side as u32));
                    }
                    if let Some(parent) = parents.last_mut() {
                        parent.done[side] = true;
                    }
                }
                if step.kind == StepKind::Entered
                    && let Some(left) = left_child(world, step.instance, step.node)
                {
                    parents.retain(|p| p.instance != step.instance);
                    parents.push(Parent {
                        instance: step.instance,
                        left,
                        done: [false; 2],
                    });
                }
            }
            let from = traversal.stack.len() as u32;
            traversal.stack.extend_from_slice(&stack);
            step.stack = [from, traversal.stack.len() as u32];
        }
        traversal
    }
}

struct Parent {
    instance: Option<u32>,
    left: u32,
    done: [bool; 2],
}

/// The left child of a node; `None` for a leaf.
fn left_child(world: &World, instance: Option<u32>, node: u32) -> Option<u32> {
    let tree = match instance {
        None => world.aggregate.tree(),
        Some(instance) => world.aggregate.instances()[instance as usize].mesh.tree(),
    };
    let node = &tree.nodes[node as usize];
    (!node.is_leaf()).then_some(node.first_index)
}

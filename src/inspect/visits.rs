//! Which nodes the debug rays entered, and which they passed by.

use super::color::{RED, WHITE};
use super::line_set::{LineSet, Stands, Thinned};
use super::rays::is_shown;
use super::trees::TreeView;
use super::{Subject, System};
use crate::bvh::{NodeEvent, TreeRef, Visitor};
use crate::scene::RenderSettings;
use crate::trace::{RayTree, TracedRay, World};
use bevy::platform::collections::HashMap;

/// How often each node was entered, and how often it was hit but pruned, by the walk of some rays that
/// traces pictures. Nodes of the binary trees that are no boxes of their wide form are never met.
#[derive(Clone, Debug, Default)]
pub struct Visits {
    nodes: HashMap<(TreeRef, u32), [u32; 2]>,
}

impl Visits {
    /// Traces those rays of a tree of rays again for which `chosen` is true.
    pub fn of(
        world: &World,
        settings: &RenderSettings,
        rays: &RayTree,
        chosen: impl Fn(&TracedRay) -> bool,
    ) -> Self {
        let mut visits = Self::default();
        for (index, ray) in (0..).zip(&rays.rays) {
            if chosen(ray) {
                rays.retrace(world, settings, index, &mut visits);
            }
        }
        visits
    }

    /// How often a node was entered.
    pub fn entered(&self, tree: TreeRef, node: u32) -> u32 {
        self.nodes.get(&(tree, node)).map_or(0, |counts| counts[0])
    }

    /// How often its box was hit, behind the nearest hit known by then.
    pub fn pruned(&self, tree: TreeRef, node: u32) -> u32 {
        self.nodes.get(&(tree, node)).map_or(0, |counts| counts[1])
    }

    /// All nodes of which either happened, the top tree's first.
    pub fn nodes(&self) -> Vec<(TreeRef, u32)> {
        let mut nodes: Vec<_> = self.nodes.keys().copied().collect();
        nodes.sort_unstable_by_key(|&(tree, node)| match tree {
            TreeRef::Top => (0, 0, node),
            TreeRef::Mesh(instance) => (1, instance, node),
        });
        nodes
    }
}

impl Visitor for Visits {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, _t_entry: f32) {
        let which = match event {
            NodeEvent::Entered => 0,
            NodeEvent::Pruned => 1,
            NodeEvent::Missed => return,
        };
        self.nodes.entry((tree, node)).or_default()[which] += 1;
    }
}

/// Boxes of visited nodes, white, and of pruned ones, red. A node that one ray entered and another
/// pruned is white.
pub(super) fn visits(subject: &Subject) -> LineSet {
    let mut set = LineSet::of(System::Visits, subject.inspect);
    let settings = &subject.inspect.rays;
    let Some(rays) = subject.rays else {
        set.notes
            .push("no pixel was picked, so no ray visited anything".into());
        return set;
    };
    let visits = match rays.rays.get(settings.nodes_of as usize) {
        Some(one) => Visits::of(subject.world, subject.settings, rays, |ray| {
            std::ptr::eq(ray, one)
        }),
        None => Visits::of(subject.world, subject.settings, rays, |ray| {
            is_shown(settings, ray)
        }),
    };
    set.notes.push(
        "as the walk that traces pictures visits them: the boxes of the trees' wide form".into(),
    );
    let nodes: Vec<_> = visits
        .nodes()
        .into_iter()
        .filter_map(|(tree, node)| {
            let color = if visits.entered(tree, node) > 0 {
                settings.visited.then_some(WHITE)
            } else {
                settings.pruned.then_some(RED)
            };
            Some((TreeView::new(subject.world, tree)?, node, color?))
        })
        .collect();
    let most = subject.inspect.max_lines as usize / 12;
    for (view, node, color) in nodes.iter().take(most) {
        let stands = Stands::Node {
            instance: view.instance().map(|(instance, _)| instance),
            node: *node,
        };
        set.edges(&view.corners(*node), *color, stands);
    }
    if nodes.len() > most {
        set.thinned = Some(Thinned {
            what: "nodes",
            drawn: most,
            of: nodes.len(),
            rule: "the nodes that stand first in their trees",
        });
    }
    set
}

//! What the lines over the picture stand for: beside the pointer, and of the chosen node in a corner.

use super::answer::{Answer, clickable, corner_free};
use super::line_legend;
use super::says::Says;
use crate::bvh::primitives_below;
use crate::editor::inspection::choice::Node;
use crate::editor::inspection::{DebugRay, Hovered, Inspected};
use crate::editor::navigation::frame_points;
use crate::editor::pick::to_points;
use crate::editor::trees::pair::TreePair;
use crate::inspect::{InspectSettings, Names, Stands, System, Told, TreeView, node_told, tell};
use crate::sync::Traced;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Grid, Id, Order, Rect, RichText, Ui, pos2};
use std::sync::Arc;

/// Points that a card beside the pointer takes, until it is known.
const USUAL: egui::Vec2 = egui::vec2(200.0, 120.0);

/// What was told last, of what.
#[derive(Resource, Default)]
pub(super) struct Tales {
    hovered: Option<(Of, Option<Told>)>,
    node: Option<(Of, Option<Told>)>,
}

/// A thing of a world and of a tree of rays, by their address and number.
#[derive(Clone, Copy, PartialEq)]
struct Of {
    stands: (Stands, System),
    world: usize,
    rays: u64,
    names: u64,
}

pub(super) fn told_ui(context: &egui::Context, free: Rect, world: &mut World, tales: &mut Tales) {
    if !free.is_positive() || !world.contains_resource::<Inspected>() {
        return;
    }
    hovered_ui(context, free, world, tales);
    node_ui(context, free, world, tales);
}

/// The figures of what is under the pointer.
fn hovered_ui(context: &egui::Context, free: Rect, world: &World, tales: &mut Tales) {
    let hovered = world.get_resource::<Hovered>();
    let Some((hovered, stands)) = hovered.and_then(|h| Some((h, h.found?))) else {
        tales.hovered = None;
        return;
    };
    let chosen = world.resource::<Inspected>().node();
    let is_chosen = |stands| match stands {
        Stands::Node { instance, node } => {
            chosen.is_some_and(|chosen| (chosen.instance, chosen.node) == (instance, node))
        }
        _ => false,
    };
    let answer = world.get_resource::<Answer>();
    let is_asked = answer.is_some_and(|answer| answer.is_asked_at(hovered.at));
    if is_chosen(stands.0) || is_asked {
        // Its figures stand in the corner, or would lie over the answer.
        return;
    }
    let traced = &world.resource::<Traced>().world;
    let pair = world.get_resource::<TreePair>();
    let traced = pair.map_or(traced, |pair| pair.meant(hovered.side, stands.1, traced));
    let ray = world.resource::<DebugRay>();
    let names = world.resource::<Names>();
    let of = Of {
        stands,
        world: Arc::as_ptr(traced) as usize,
        rays: ray.number(),
        names: names.version,
    };
    if tales.hovered.as_ref().is_none_or(|(known, _)| *known != of) {
        let inspect = world.resource::<InspectSettings>();
        let rays = ray.rays().map(Arc::as_ref);
        tales.hovered = Some((of, tell(stands, traced, rays, inspect, names)));
    }
    let Some((_, Some(told))) = &tales.hovered else {
        return;
    };
    let at = to_points(context, hovered.at);
    let id = Id::new("what is under the pointer");
    let known = context.memory(|memory| memory.area_rect(id));
    let size = known.map_or(USUAL, |known| known.size());
    let (pivot, corner) = corner_free(free, at, [18.0, 14.0], size, &clickable(context));
    egui::Area::new(id)
        .order(Order::Tooltip)
        .interactable(false)
        .pivot(pivot)
        .fixed_pos(corner)
        .constrain_to(free)
        .show(context, |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(egui::Margin::same(6))
                .show(ui, |ui| figures_ui(ui, told));
        });
}

fn figures_ui(ui: &mut Ui, told: &Told) {
    // Small: it lies over what it is about.
    ui.spacing_mut().interact_size.y = 0.0;
    ui.label(RichText::new(&told.title).strong().size(12.0));
    if told.figures.is_empty() {
        return;
    }
    Grid::new(("figures", &told.title))
        .num_columns(2)
        .spacing([8.0, 0.0])
        .show(ui, |ui| {
            for (name, value) in &told.figures {
                ui.label(RichText::new(*name).weak().size(11.0));
                ui.label(RichText::new(value).monospace().size(10.5));
                ui.end_row();
            }
        });
}

/// The chosen node, and the ways from it.
fn node_ui(context: &egui::Context, free: Rect, world: &mut World, tales: &mut Tales) {
    let inspected = world.resource::<Inspected>();
    let Some(node) = inspected.node().cloned() else {
        tales.node = None;
        return;
    };
    let names = world.resource::<Names>();
    let of = Of {
        stands: (
            Stands::Node {
                instance: node.instance,
                node: node.node,
            },
            System::Boxes,
        ),
        world: Arc::as_ptr(&node.world) as usize,
        rays: 0,
        names: names.version,
    };
    if tales.node.as_ref().is_none_or(|(known, _)| *known != of) {
        let told = node_told(&node.world, node.instance, node.node, names);
        tales.node = Some((of, told));
    }
    let Some((_, Some(told))) = &tales.node else {
        world.resource_mut::<Inspected>().choose_node(None);
        return;
    };
    let mut next = Some(node.clone());
    let mut frames = false;
    // Below the legend, where there is one.
    let legend = context.memory(|memory| {
        let is_shown = memory.areas().visible_last_frame(&line_legend::layer());
        let rect = memory.area_rect(line_legend::layer().id);
        rect.filter(|_| is_shown)
    });
    let top = legend.map_or(free.min.y + 10.0, |legend| legend.max.y + 6.0);
    egui::Area::new(Id::new("the chosen node"))
        .order(Order::Middle)
        .fixed_pos(pos2(free.min.x + 10.0, top))
        .constrain_to(free)
        .show(context, |ui| {
            egui::Frame::popup(ui.style())
                .inner_margin(egui::Margin::same(6))
                .show(ui, |ui| {
                    figures_ui(ui, told);
                    frames = ways_ui(ui, &node, &mut next);
                });
        });
    if frames && let Some(view) = TreeView::of(&node.world, node.instance) {
        frame_points(world, view.corners(node.node));
    }
    let is = |a: &Node| (a.instance, a.node) == (node.instance, node.node);
    if !next.as_ref().is_some_and(is) {
        world.resource_mut::<Inspected>().choose_node(next);
    }
}

/// Where to go from a node; true where the view is to show it.
fn ways_ui(ui: &mut Ui, node: &Node, next: &mut Option<Node>) -> bool {
    let Some(view) = TreeView::of(&node.world, node.instance) else {
        return false;
    };
    let Some(here) = view.tree.nodes.get(node.node as usize) else {
        return false;
    };
    let parent = parent_of(&view, node.node);
    let children = (!here.is_leaf()).then_some([here.first_index, here.first_index + 1]);
    let ways = [
        (
            "Parent",
            parent,
            "Chooses the node that this one is a child of",
        ),
        ("Left", children.map(|c| c[0]), "Chooses its first child"),
        ("Right", children.map(|c| c[1]), "Chooses its second child"),
    ];
    ui.horizontal(|ui| {
        for (name, to, says) in ways {
            let button = ui.add_enabled(to.is_some(), egui::Button::new(name).small());
            if button.says(says).clicked()
                && let Some(to) = to
            {
                *next = Some(Node {
                    node: to,
                    ..node.clone()
                });
            }
        }
        let frame = ui.small_button("Frame it");
        let frames = frame
            .says("Moves the view so that its box fills it")
            .clicked();
        let close = ui.small_button("✖");
        if close.says("No node is chosen (Esc)").clicked() {
            *next = None;
        }
        frames
    })
    .inner
}

fn parent_of(view: &TreeView, node: u32) -> Option<u32> {
    let place = primitives_below(view.tree, node as usize).start;
    let path = view.path(place);
    let at = path.iter().position(|&known| known == node)?;
    at.checked_sub(1).map(|before| path[before])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::headless_app;
    use crate::io::{OpenOptions, SceneSource, open};

    #[test]
    fn the_parent_of_a_node_is_the_one_whose_child_it_is() {
        let mut app = headless_app();
        let source = SceneSource::named(std::path::Path::new("knot"));
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let world = app.world().resource::<Traced>().world.clone();
        for instance in [None, Some(0)] {
            let view = TreeView::of(&world, instance).unwrap();
            assert_eq!(parent_of(&view, 0), None);
            for (index, node) in view.tree.nodes.iter().enumerate() {
                if !node.is_leaf() {
                    for child in [node.first_index, node.first_index + 1] {
                        assert_eq!(parent_of(&view, child), Some(index as u32));
                    }
                }
            }
        }
    }
}

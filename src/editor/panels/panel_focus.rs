//! F6: the keyboard goes from panel to panel, and from the last one back to the picture, whose keys are commands.

use crate::editor::command::{Command, commands};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui::{Context, Id, Order, PanelState, Pos2, Rect};

/// The panels around the picture, in the order in which the keyboard goes through them.
const AROUND: [&str; 6] = [
    "menu",
    "toolbar",
    "hierarchy",
    "inspector",
    "rays",
    "status",
];

/// Where the keyboard shall go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Next,
    Previous,
}

/// A step that was asked for and not made yet.
#[derive(Resource, Default)]
pub(super) struct PanelStep(Option<Step>);

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "view.next-panel" "Keyboard to the next panel" ["F6"] "Tab goes on from there; after the last panel keys are the picture's again"
            => |world| world.resource_mut::<PanelStep>().0 = Some(Step::Next),
        "view.previous-panel" "Keyboard to the previous panel" ["Shift+F6"] "Tab goes on from there; before the first panel keys are the picture's"
            => |world| world.resource_mut::<PanelStep>().0 = Some(Step::Previous),
    }
}

/// A control that the keyboard can go to.
#[derive(Clone, Copy)]
struct Stop {
    id: Id,
    at: Pos2,
    /// Which panel it is in: the panels around the picture, what lies over it, then windows from the top left on.
    panel: (usize, [i32; 2], u64),
}

/// Goes where it was asked to go. Panels without a control are passed by.
pub(super) fn step(context: &Context, world: &mut World) {
    let Some(step) = world.resource_mut::<PanelStep>().0.take() else {
        return;
    };
    let stops = stops(context);
    let focused = context.memory(|memory| memory.focused());
    let now = focused.and_then(|id| stops.iter().find(|stop| stop.id == id));
    let now = now.map(|stop| stop.panel);
    let panels = stops.iter().map(|stop| stop.panel);
    // None of them, which comes before the first and after the last, is the picture.
    let panel = match (step, now) {
        (Step::Next, None) => panels.min(),
        (Step::Next, Some(now)) => panels.filter(|panel| *panel > now).min(),
        (Step::Previous, None) => panels.max(),
        (Step::Previous, Some(now)) => panels.filter(|panel| *panel < now).max(),
    };
    // As one reads: by rows.
    let in_panel = stops.iter().filter(|stop| Some(stop.panel) == panel);
    let place = |stop: &&Stop| (stop.at.y as i32, stop.at.x as i32);
    let first = in_panel.min_by_key(place);
    context.memory_mut(|memory| match (first, focused) {
        (Some(first), _) => memory.request_focus(first.id),
        (None, Some(focused)) => memory.surrender_focus(focused),
        (None, None) => {}
    });
}

/// All controls of this frame that can be seen.
fn stops(context: &Context) -> Vec<Stop> {
    let around =
        AROUND.map(|name| PanelState::load(context, Id::new(name)).map(|state| state.rect));
    let panel_of = |at: Pos2| {
        let contains = |panel: &Option<Rect>| panel.is_some_and(|rect| rect.contains(at));
        around.iter().position(contains).unwrap_or(AROUND.len())
    };
    let windows = context.memory(|memory| {
        let corner = |layer: Id| memory.area_rect(layer).map(|rect| rect.min);
        let layers = memory.layer_ids().map(|layer| (layer, corner(layer.id)));
        layers.collect::<Vec<_>>()
    });
    context.viewport(|viewport| {
        let mut stops = Vec::new();
        for (layer, controls) in viewport.this_pass.widgets.layers() {
            let window = windows.iter().find(|(known, _)| known == layer);
            let corner = window.and_then(|(_, corner)| *corner).unwrap_or_default();
            for control in controls {
                // Edges that change a panel's size are dragged alone.
                let is_stop = control.sense.is_focusable() && control.sense.senses_click();
                if !is_stop || !control.enabled || !control.interact_rect.is_positive() {
                    continue;
                }
                let at = control.interact_rect.center();
                let panel = match layer.order {
                    Order::Background => (panel_of(at), [0, 0], 0),
                    _ => {
                        let corner = [corner.y as i32, corner.x as i32];
                        (AROUND.len() + 1, corner, layer.id.value())
                    }
                };
                stops.push(Stop {
                    id: control.id,
                    at: control.interact_rect.min,
                    panel,
                });
            }
        }
        stops
    })
}

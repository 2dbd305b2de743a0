//! A drag of a field, or typing into it, is one step of the history: from the press to the release,
//! from the first letter to leaving the field.

use super::state::Panels;
use crate::editor::history::Gesture;
use bevy::ecs::world::World;
use bevy_egui::egui;

/// Begins and ends the gesture that panels make. One that others have begun is left alone.
pub(super) fn note_gesture(context: &egui::Context, world: &mut World, panels: &mut Panels) {
    let busy = context.egui_is_using_pointer() || context.text_edit_focused();
    if busy == panels.in_gesture {
        return;
    }
    if !busy {
        panels.in_gesture = false;
        world.resource_mut::<Gesture>().end();
    } else if !world.resource::<Gesture>().active() {
        panels.in_gesture = true;
        // The change that comes of it says best what was done.
        world.resource_mut::<Gesture>().begin("");
    }
}

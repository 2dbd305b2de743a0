//! A drag of a field, or typing into it, is one step of the history: from the press to the release,
//! from the first letter to leaving the field.

use crate::editor::history::Gesture;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use bevy_egui::egui;

/// Whether the gesture that is under way is the panels' own: a field is being dragged or typed into.
#[derive(Resource, Default)]
pub(super) struct OwnGesture(bool);

/// Begins and ends the gesture that panels make. One that others have begun is left alone.
pub(super) fn note_gesture(context: &egui::Context, world: &mut World) {
    let busy = context.egui_is_using_pointer() || context.text_edit_focused();
    let mut own = world.resource_mut::<OwnGesture>();
    if busy == own.0 {
        return;
    }
    if !busy {
        own.0 = false;
        world.resource_mut::<Gesture>().end();
    } else if !world.resource::<Gesture>().active() {
        world.resource_mut::<OwnGesture>().0 = true;
        // The change that comes of it says best what was done.
        world.resource_mut::<Gesture>().begin("");
    }
}

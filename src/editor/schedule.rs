//! When the editor works: once a frame, after the systems of `Update` and before what is derived
//! from the scene. An app's own systems run before or after all of it, never in between.

use super::embed::{Editing, Switched};
use super::history::within;
use bevy::app::{App, MainScheduleOrder, Update};
use bevy::ecs::schedule::{ScheduleLabel, SystemSet};
use bevy::ecs::system::Local;
use bevy::ecs::world::World;

/// Everything that answers to a hand: keys, pointer, actions, files.
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct EditorUpdate;

/// In [`EditorUpdate`]: what was asked for is done. Keys and pointer are read before, the view and the handles follow
/// after.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Dispatch;

/// Runs [`EditorUpdate`].
#[derive(ScheduleLabel, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct RunEditor;

pub(super) fn add_to(app: &mut App) {
    app.init_schedule(EditorUpdate).add_systems(RunEditor, run);
    app.world_mut()
        .resource_mut::<MainScheduleOrder>()
        .insert_after(Update, RunEditor);
}

fn run(world: &mut World, mut before: Local<Option<bool>>) {
    let on = world.get_resource::<Editing>().is_none_or(|on| on.0);
    if before.replace(on).is_some_and(|before| before != on) {
        within(world, |world| {
            world.trigger(Switched { on });
            world.flush();
        });
    }
    if on {
        within(world, |world| world.run_schedule(EditorUpdate));
    }
}

//! Where all that is asked for in messages is done, in the order in which it was asked.

use super::action::Action;
use super::document::{FileTask, request};
use super::history::{History, commit};
use super::schedule::{Dispatch, EditorUpdate};
use super::{command, edits, inspection, navigation};
use bevy::app::{App, Plugin};
use bevy::ecs::message::Messages;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::world::World;

/// Does what [`Action`]s ask for.
pub(super) struct DispatchPlugin;

impl Plugin for DispatchPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<Action>()
            .init_resource::<command::CommandTable>()
            .add_systems(EditorUpdate, dispatch.in_set(Dispatch));
    }
}

/// Once a frame, and once more after the panels were drawn: what is clicked there is traced in the
/// same frame.
pub(super) fn dispatch(world: &mut World) {
    let actions: Vec<Action> = world.resource_mut::<Messages<Action>>().drain().collect();
    if !actions.is_empty() && world.contains_resource::<History>() {
        // What was changed before is a step of its own, and can be undone.
        commit(world);
    }
    for action in actions {
        match action {
            Action::Run(id) => command::run(world, &id),
            Action::Open(path) => request(world, FileTask::Open(path)),
            Action::SaveAs(path) => request(world, FileTask::SaveAs(path)),
            Action::Import(path, at) => request(world, FileTask::Import(path, at)),
            Action::Add(what) => edits::step_add(world, &what),
            Action::Select(ids) => edits::select(world, ids),
            Action::Rename(id, name) => edits::step_rename(world, id, &name),
            Action::Reparent(ids, parent) => edits::step_reparent(world, &ids, parent),
            Action::AssignMaterial(ids, material) => edits::step_assign(world, &ids, material),
            Action::LookThrough(camera) => navigation::look_through(world, camera),
            Action::ShootPixel(column, row) => inspection::shoot_pixel(world, [column, row].into()),
        }
    }
}

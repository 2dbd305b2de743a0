//! The commands that select.

use super::{SceneIndex, scene_entity};
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::notice::Notices;
use crate::editor::selection::{Escaped, Selection};
use crate::scene::{SceneId, UsesMaterial};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use std::collections::HashSet;

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "select.all" "Select all" ["Ctrl+A"] "Selects every entity"
            => select_all; menu("Edit", 3); over(&[Over::Nothing]),
        "select.none" "Select nothing" ["Escape"] "Selects no entity, lets go of a chosen ray or box, and brings the panels back"
            => select_none; menu("Edit", 3),
        "select.invert" "Invert the selection" ["Ctrl+Shift+I"] "Selects every entity that is not selected, and no other"
            => select_others; menu("Edit", 3),
        "select.same-material" "Select what shares its material" [] "Selects all objects that have the material which is selected, or that of a selected object"
            => select_sharing; menu("Edit", 3); over(&[Over::Entity]); state(is_any_selected),
    }
}

pub(super) fn is_any_selected(world: &World) -> State {
    let any = !world.resource::<Selection>().is_empty();
    State::when(any, "Nothing is selected.")
}

/// Selects these, as far as they are entities of the scene, and no others.
pub(in crate::editor) fn select(world: &mut World, ids: Vec<SceneId>) {
    let index = world.resource::<SceneIndex>();
    let ids: Vec<SceneId> = ids
        .into_iter()
        .filter(|&id| index.find(world, id).is_some())
        .collect();
    let mut selection = world.resource_mut::<Selection>();
    if selection.ids() != ids {
        selection.set(ids);
    }
}

pub(super) fn selected(world: &World) -> Vec<SceneId> {
    world.resource::<Selection>().ids().to_vec()
}

fn select_all(world: &mut World) {
    let mut all = world.query::<&SceneId>();
    let mut all: Vec<SceneId> = all.iter(world).copied().collect();
    all.sort_unstable();
    select(world, all);
}

fn select_others(world: &mut World) {
    let mut all = world.query::<&SceneId>();
    let now = world.resource::<Selection>();
    let others = all.iter(world).filter(|id| !now.contains(**id));
    let mut others: Vec<SceneId> = others.copied().collect();
    others.sort_unstable();
    select(world, others);
}

fn select_none(world: &mut World) {
    select(world, Vec::new());
    world.trigger(Escaped);
}

/// Selects the objects that have the selected materials, or those of the selected objects.
fn select_sharing(world: &mut World) {
    let chosen = selected(world).into_iter();
    let chosen = chosen
        .filter_map(|id| scene_entity(world, id))
        .map(|entity| {
            let material = world.get::<UsesMaterial>(entity);
            material.map_or(entity, |material| material.0)
        });
    let chosen: HashSet<Entity> = chosen.collect();
    let mut users = world.query::<(&SceneId, &UsesMaterial)>();
    let users = users
        .iter(world)
        .filter(|(_, material)| chosen.contains(&material.0));
    let mut users: Vec<SceneId> = users.map(|(id, _)| *id).collect();
    users.sort_unstable();
    if users.is_empty() {
        let text = "No object shares the material of what is selected.";
        world.resource_mut::<Notices>().tell(text);
        return;
    }
    select(world, users);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::{Action, Addition};
    use crate::editor::headless_editor;
    use bevy::app::App;

    #[test]
    fn what_was_not_selected_is_and_what_was_is_not() {
        let mut app = headless_editor();
        let act = |app: &mut App, action: Action| {
            app.world_mut().write_message(action);
            app.update();
        };
        let mut ids = Vec::new();
        for _ in 0..3 {
            act(&mut app, Action::Add(Addition::Group));
            ids.extend(app.world().resource::<Selection>().active());
        }
        act(&mut app, Action::Select(vec![ids[1]]));
        act(&mut app, Action::run("select.invert"));
        assert_eq!(app.world().resource::<Selection>().ids(), [ids[0], ids[2]]);
        act(&mut app, Action::run("select.invert"));
        assert_eq!(app.world().resource::<Selection>().ids(), [ids[1]]);
    }
}

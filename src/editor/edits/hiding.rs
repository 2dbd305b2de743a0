//! Hiding and showing: what is selected, all objects but those, and whatever is hidden.

use super::plugin::{call, step};
use super::selecting::selected;
use super::{SceneIndex, ancestors, is_object, roots_of, scene_entity, with_descendants};
use crate::editor::command::{Command, Over, State, commands};
use crate::editor::notice::Notices;
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::camera::visibility::Visibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use std::collections::HashSet;

pub(super) fn commands() -> Vec<Command> {
    commands! {
        "edit.hide" "Hide or show" ["H"] "A hidden entity is not traced"
            => |world| step(world, step_hide); menu("Edit", 2); over(&[Over::Entity]); state(can_be_hidden),
        "edit.hide-others" "Hide all other objects" ["Shift+H"] "Leaves the selected objects and what is below them, with the lights, to look at them alone"
            => |world| step(world, step_hide_others); menu("Edit", 2); over(&[Over::Entity]); state(is_any_object_selected),
        "edit.show-all" "Show all that is hidden" ["Ctrl+H"] "Shows every hidden entity again"
            => |world| step(world, step_show_all); menu("Edit", 2); over(&[Over::Nothing]); state(is_any_hidden),
    }
}

/// Shows or hides entities. What is below a hidden one is hidden too, unless it says otherwise.
pub fn set_visible(world: &mut World, ids: &[SceneId], visible: bool) {
    for &id in ids {
        let Some(entity) = scene_entity(world, id) else {
            continue;
        };
        let Some(now) = world.get::<Visibility>(entity).copied() else {
            continue;
        };
        let wanted = match (visible, now) {
            (false, _) => Visibility::Hidden,
            (true, Visibility::Hidden) => Visibility::Inherited,
            (true, shown) => shown,
        };
        if wanted != now {
            world.entity_mut(entity).insert(wanted);
        }
    }
}

fn visibility(world: &World, id: SceneId) -> Option<Visibility> {
    let entity = scene_entity(world, id)?;
    world.get::<Visibility>(entity).copied()
}

fn can_be_hidden(world: &World) -> State {
    let ids = world.resource::<Selection>().ids();
    if ids.is_empty() {
        return State::when(false, "Nothing is selected.");
    }
    let any = ids.iter().any(|&id| visibility(world, id).is_some());
    State::when(any, "Cameras and materials are neither shown nor hidden.")
}

fn is_any_object_selected(world: &World) -> State {
    let ids = world.resource::<Selection>().ids();
    let roots = ids.iter().filter_map(|&id| scene_entity(world, id));
    let any = roots
        .flat_map(|root| with_descendants(world, root))
        .any(|entity| is_object(world, entity));
    State::when(any, "No object is selected.")
}

fn is_any_hidden(world: &World) -> State {
    let any = world
        .try_query::<(&SceneId, &Visibility)>()
        .is_some_and(|mut all| all.iter(world).any(|(_, now)| *now == Visibility::Hidden));
    State::when(any, "Nothing is hidden.")
}

fn step_hide(world: &mut World) -> Option<String> {
    let mut ids = selected(world);
    ids.retain(|&id| visibility(world, id).is_some());
    let show = !ids
        .iter()
        .any(|&id| visibility(world, id) != Some(Visibility::Hidden));
    let verb = if show { "Show" } else { "Hide" };
    let name = format!("{verb} {}", call(world, &ids));
    set_visible(world, &ids, show);
    Some(name)
}

/// Hides the objects that are neither selected, nor below or above what is. What is below one of them is hidden with it, and
/// shown with it again.
fn step_hide_others(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let mut stay: HashSet<Entity> = HashSet::new();
    for id in roots_of(world, &ids) {
        if let Some(root) = world.resource::<SceneIndex>().find(world, id) {
            stay.extend(with_descendants(world, root));
            stay.extend(ancestors(world, root));
        }
    }
    let is_hidden = |entity: Entity| world.get::<Visibility>(entity) == Some(&Visibility::Hidden);
    let mut others: Vec<SceneId> = Vec::new();
    let mut all = world.try_query::<(Entity, &SceneId)>()?;
    for (entity, &id) in all.iter(world) {
        if is_object(world, entity)
            && !stay.contains(&entity)
            && !is_hidden(entity)
            && !ancestors(world, entity).any(is_hidden)
        {
            others.push(id);
        }
    }
    let others = roots_of(world, &others);
    if others.is_empty() {
        let text = "No other object is shown.";
        world.resource_mut::<Notices>().tell(text);
        return None;
    }
    let name = format!("Hide all but {}", call(world, &ids));
    set_visible(world, &others, false);
    Some(name)
}

fn step_show_all(world: &mut World) -> Option<String> {
    let mut all = world.query::<(&SceneId, &Visibility)>();
    let hidden = all.iter(world);
    let hidden = hidden.filter(|(_, now)| **now == Visibility::Hidden);
    let mut hidden: Vec<SceneId> = hidden.map(|(id, _)| *id).collect();
    hidden.sort_unstable();
    let name = format!("Show {}", call(world, &hidden));
    set_visible(world, &hidden, true);
    Some(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Action;
    use crate::editor::headless_editor;
    use crate::editor::history::{History, reset, undo};
    use crate::scene::{MeshSource, Phong, PointLamp, SceneCamera};
    use bevy::app::App;
    use bevy::ecs::hierarchy::ChildOf;
    use bevy::ecs::name::Name;
    use bevy::transform::components::Transform;

    /// A shed with a door, a tree in a garden that is a group, a lamp, a camera and a material.
    fn garden() -> App {
        let mut app = headless_editor();
        let world = app.world_mut();
        let object = || {
            let shape = MeshSource::default();
            (shape, Transform::default(), Visibility::default())
        };
        let shed = world.spawn((SceneId(1), Name::new("Shed"), object())).id();
        world.spawn((SceneId(2), Name::new("Door"), object(), ChildOf(shed)));
        let group = (Transform::default(), Visibility::default());
        let garden = world.spawn((SceneId(3), Name::new("Garden"), group)).id();
        world.spawn((SceneId(4), Name::new("Tree"), object(), ChildOf(garden)));
        world.spawn((SceneId(5), Name::new("Bench"), object(), ChildOf(garden)));
        world.spawn((SceneId(6), Name::new("Lamp"), PointLamp::default()));
        world.spawn((SceneId(7), Name::new("Camera"), SceneCamera::default()));
        world.spawn((SceneId(8), Name::new("Red"), Phong::default()));
        app.update();
        reset(app.world_mut());
        app
    }

    fn run(app: &mut App, ids: &[u64], id: &'static str) {
        let ids = ids.iter().map(|&id| SceneId(id)).collect();
        app.world_mut().write_message(Action::Select(ids));
        app.update();
        app.world_mut().write_message(Action::run(id));
        app.update();
    }

    /// The numbers of what says that it is hidden.
    fn hidden(app: &App) -> Vec<u64> {
        let is_hidden =
            |&id: &u64| visibility(app.world(), SceneId(id)) == Some(Visibility::Hidden);
        (1..=8).filter(is_hidden).collect()
    }

    fn told(app: &mut App) -> Option<String> {
        let mut notices = app.world_mut().resource_mut::<Notices>();
        notices.shown().last().map(|notice| notice.text.clone())
    }

    #[test]
    fn what_is_neither_shown_nor_hidden_is_said_to_be_so_and_makes_no_step() {
        for nothing_to_hide in [&[7][..], &[8], &[7, 8]] {
            let mut app = garden();
            run(&mut app, nothing_to_hide, "edit.hide");
            let text = told(&mut app).unwrap_or_default();
            assert!(text.contains("neither shown nor hidden"), "{text:?}");
            assert_eq!(app.world().resource::<History>().steps().count(), 0);
        }
        // Beside what can be hidden they do not count.
        let mut app = garden();
        run(&mut app, &[6, 7], "edit.hide");
        assert_eq!(hidden(&app), [6]);
        let history = app.world().resource::<History>();
        assert_eq!(history.undo_text(), Some("Hide Lamp"));
        run(&mut app, &[6, 7], "edit.hide");
        assert!(hidden(&app).is_empty());
    }

    #[test]
    fn all_other_objects_are_hidden_in_one_step_and_lights_go_on_shining() {
        let mut app = garden();
        run(&mut app, &[4], "edit.hide-others");
        assert_eq!(hidden(&app), [1, 5], "the door with its shed");
        let history = app.world().resource::<History>();
        assert_eq!(history.undo_text(), Some("Hide all but Tree"));
        assert!(undo(app.world_mut()).is_some());
        assert!(hidden(&app).is_empty());
        // Of a group and of a parent all that is below stays.
        run(&mut app, &[3], "edit.hide-others");
        assert_eq!(hidden(&app), [1]);
        run(&mut app, &[3], "edit.hide-others");
        assert_eq!(told(&mut app).as_deref(), Some("No other object is shown."));
        run(&mut app, &[6, 7], "edit.hide-others");
        assert_eq!(hidden(&app), [1], "a lamp is no object");
    }

    #[test]
    fn all_that_is_hidden_is_shown_again_in_one_step() {
        let mut app = garden();
        run(&mut app, &[], "edit.show-all");
        assert_eq!(told(&mut app).as_deref(), Some("Nothing is hidden."));
        run(&mut app, &[2, 3, 6], "edit.hide");
        assert_eq!(hidden(&app), [2, 3, 6]);
        run(&mut app, &[], "edit.show-all");
        assert!(hidden(&app).is_empty());
        let history = app.world().resource::<History>();
        assert_eq!(history.undo_text(), Some("Show 3 entities"));
        assert!(undo(app.world_mut()).is_some());
        assert_eq!(hidden(&app), [2, 3, 6]);
    }
}

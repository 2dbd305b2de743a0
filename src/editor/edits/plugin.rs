//! The commands that edit, each a step of its own.

use super::free_place::free_place;
use super::selecting::{is_any_selected, select, selected};
use super::{
    AddAt, Clipboard, SceneIndex, add, assign_material, copy, delete, duplicate, group, hiding,
    import, is_group, name_of, paste, rename, reparent, roots_of, scene_entity, selecting, ungroup,
};
use crate::editor::action::{Addition, shapes};
use crate::editor::command::{AddCommands, Command, Over, State, commands};
use crate::editor::history::{Gesture, History, commit, redo, undo};
use crate::editor::notice::Notices;
use crate::editor::selection::Selection;
use crate::scene::SceneId;
use bevy::app::{App, Plugin};
use bevy::ecs::world::World;
use bevy::transform::components::Transform;

/// Does what [`Action`](crate::editor::Action)s ask for that edit the scene or select in it. Needs
/// [`HistoryPlugin`](crate::editor::history::HistoryPlugin).
pub struct EditsPlugin;

impl Plugin for EditsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Clipboard>()
            .init_resource::<AddAt>()
            .init_resource::<Selection>()
            .init_resource::<Notices>()
            .init_resource::<SceneIndex>()
            .add_commands(commands())
            .add_commands(hiding::commands())
            .add_commands(selecting::commands())
            .add_commands(import::commands())
            .add_commands(shape_commands());
    }
}

const ANY: &[Over] = &[Over::Entity];
const ANYWHERE: &[Over] = &[Over::Entity, Over::Nothing];

fn commands() -> Vec<Command> {
    commands! {
        "edit.undo" "Undo" ["Ctrl+Z"] "Takes the last step back"
            => step_back; menu("Edit", 0); repeats(); state(about_undo),
        "edit.redo" "Redo" ["Ctrl+Shift+Z", "Ctrl+Y"] "Does the step again that was taken back"
            => step_forth; menu("Edit", 0); repeats(); state(about_redo),
        "edit.cut" "Cut" ["Ctrl+X"] "Keeps the selected entities for pasting, and removes them and their children"
            => |world| step(world, step_cut); menu("Edit", 2); over(ANY); state(is_any_selected),
        "edit.copy" "Copy" ["Ctrl+C"] "Keeps the selected entities for pasting"
            => |world| { keep_selected(world); }; menu("Edit", 2); over(ANY); state(is_any_selected),
        "edit.paste" "Paste" ["Ctrl+V"] "Adds what was copied"
            => |world| step(world, step_paste); menu("Edit", 2); over(ANYWHERE); state(is_any_copied),
        "edit.duplicate" "Duplicate" ["Ctrl+D"] "Adds a copy of the selected entities where they are"
            => |world| step(world, step_duplicate); menu("Edit", 2); over(ANY); state(is_any_selected),
        "edit.delete" "Delete" ["Delete", "X"] "Removes the selected entities and their children"
            => |world| step(world, step_delete); menu("Edit", 2); over(ANY); state(is_any_selected),
        "edit.group" "Group" ["Ctrl+G"] "Puts the selected entities below a new group: what is done to it is done to all of them"
            => |world| step(world, step_group); menu("Edit", 2); over(ANY); state(can_be_grouped),
        "edit.ungroup" "Ungroup" ["Ctrl+Shift+G"] "Takes the selected groups away; what is below them stays, and stays where it is"
            => |world| step(world, step_ungroup); menu("Edit", 2); over(ANY); state(is_any_group_selected),
        "add.point-light" "Point light" [] "A lamp that shines in all directions from one point; with a cone it is a spot"
            => |world| step_add(world, &Addition::PointLamp); menu("Add", 2),
        "add.directional-light" "Directional light" [] "Shines from infinitely far, like the sun"
            => |world| step_add(world, &Addition::DirectionalLamp); menu("Add", 2),
        "add.segment-light" "Segment light" [] "A lamp like a tube: a glowing line with a colour at each end, soft shadows"
            => |world| step_add(world, &Addition::SegmentLamp); menu("Add", 2),
        "add.parallelogram-light" "Parallelogram light" [] "An area lamp: a glowing surface with a colour at each corner, soft shadows"
            => |world| step_add(world, &Addition::ParallelogramLamp); menu("Add", 2),
        "add.camera" "Camera" [] "Adds a camera at what the view looks at; Keep this view as a camera adds one where the view stands"
            => |world| step_add(world, &Addition::Camera); menu("Add", 3),
        "add.material" "Shared material" [] "A material that several objects can use: one change reaches all of them"
            => |world| step_add(world, &Addition::Material); menu("Add", 3),
        "add.group" "Empty group" [] "An empty place: what is dragged onto it in the list moves with it"
            => |world| step_add(world, &Addition::Group); menu("Add", 3),
    }
}

/// A command for each shape.
fn shape_commands() -> impl Iterator<Item = Command> {
    shapes().into_iter().map(|(name, _)| {
        let id = format!("add.{}", name.to_lowercase());
        let what = Addition::Shape(name.into());
        // By other words for it, too, the palette finds it.
        let known_as = match name {
            "Cuboid" => "A box, to begin with a cube",
            "Sphere" => "A ball",
            "Cylinder" => "A round rod, closed at both ends",
            "Torus" => "A ring, like a doughnut",
            "Ground" => "A level floor, a plane whose texture repeats in tiles",
            "Quad" => "A flat parallelogram, like a wall",
            "Quadrilateral" => "A surface between four corners",
            "Triangle" => "A single triangle, by its three corners",
            "Prism" => "A wedge with a polygon as its base",
            "Teapot" => "Newell's teapot, a pot of curved patches",
            "Head" => "A smooth head",
            "Knot" => "A knotted rope of many triangles",
            _ => "A shape",
        };
        let help = format!("{known_as}: added at what the view looks at, beside what is there");
        Command::new(id, name, help, move |world: &mut World| {
            step_add(world, &what)
        })
        .menu("Add/Shape", 0)
    })
}

fn can_be_grouped(world: &World) -> State {
    let nothing = is_any_selected(world);
    if nothing.why_not.is_some() {
        return nothing;
    }
    let stands = |&id: &SceneId| {
        scene_entity(world, id).is_some_and(|entity| world.get::<Transform>(entity).is_some())
    };
    let any = world.resource::<Selection>().ids().iter().any(stands);
    State::when(any, "A material stands nowhere: it is in no group.")
}

fn is_any_group_selected(world: &World) -> State {
    let mut selected = world.resource::<Selection>().ids().iter();
    let any = selected.any(|&id| scene_entity(world, id).is_some_and(|id| is_group(world, id)));
    State::when(any, "No group is selected.")
}

fn is_any_copied(world: &World) -> State {
    let any = !world.resource::<Clipboard>().text.is_empty();
    State::when(any, "Nothing was copied.")
}

fn about_undo(world: &World) -> State {
    let text = world.resource::<History>().undo_text();
    about_step(world, text, "Nothing to undo")
}

fn about_redo(world: &World) -> State {
    let text = world.resource::<History>().redo_text();
    about_step(world, text, "Nothing to redo")
}

/// Which step it is about. A gesture that is under way becomes one.
fn about_step(world: &World, text: Option<&str>, why_not: &'static str) -> State {
    let gesture = world.resource::<Gesture>().active();
    State {
        detail: text.map(str::to_owned),
        ..State::when(text.is_some() || gesture, why_not)
    }
}

fn step_back(world: &mut World) {
    if let Some(name) = undo(world) {
        tell(world, "Undone", &name);
    }
}

fn step_forth(world: &mut World) {
    if let Some(name) = redo(world) {
        tell(world, "Done again", &name);
    }
}

/// Whether they are kept; why not is said.
fn keep_selected(world: &mut World) -> bool {
    match copy(world, &selected(world)) {
        Ok(clipboard) => {
            world.insert_resource(clipboard);
            true
        }
        Err(error) => {
            world.resource_mut::<Notices>().fault(error.to_string());
            false
        }
    }
}

/// Makes a step of what `change` does; it tells how the step is to be called.
pub(in crate::editor) fn step(
    world: &mut World,
    change: impl FnOnce(&mut World) -> Option<String>,
) {
    // What was changed before is a step of its own.
    world.resource_mut::<Gesture>().end();
    commit(world);
    if let Some(name) = change(world) {
        world.resource_mut::<History>().name_next(name);
    }
    commit(world);
}

/// Adds one thing where the view looks, beside what is there, and selects it.
pub(in crate::editor) fn step_add(world: &mut World, what: &Addition) {
    step(world, |world| {
        let at = *world.resource::<AddAt>();
        let at = free_place(world, what, at);
        let Some(id) = add(world, what, at) else {
            let text = format!("{what:?} is no shape that can be added");
            world.resource_mut::<Notices>().fault(text);
            return None;
        };
        select(world, vec![id]);
        Some(format!("Add {}", name_of(world, id)))
    });
}

/// Gives an entity a name, or takes it away.
pub(in crate::editor) fn step_rename(world: &mut World, id: SceneId, name: &str) {
    step(world, |world| {
        let old = name_of(world, id);
        rename(world, id, name);
        Some(match name.trim() {
            "" => format!("Take the name from {old}"),
            name => format!("Rename {old} to {name}"),
        })
    });
}

/// Puts entities below another one, or at the top.
pub(in crate::editor) fn step_reparent(
    world: &mut World,
    ids: &[SceneId],
    parent: Option<SceneId>,
) {
    step(world, |world| {
        let whose = call(world, ids);
        reparent(world, ids, parent);
        Some(match parent {
            Some(parent) => format!("Put {whose} below {}", name_of(world, parent)),
            None => format!("Put {whose} at the top"),
        })
    });
}

/// Gives objects a shared material.
pub(in crate::editor) fn step_assign(world: &mut World, ids: &[SceneId], material: SceneId) {
    step(world, |world| {
        let given = assign_material(world, ids, material);
        let name = name_of(world, material);
        (!given.is_empty()).then(|| format!("Give {} the material {name}", call(world, &given)))
    });
}

fn step_group(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let name = format!("Group {}", call(world, &roots_of(world, &ids)));
    let group = group(world, &ids)?;
    select(world, vec![group]);
    Some(name)
}

fn step_ungroup(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let name = format!("Ungroup {}", call(world, &ids));
    let ungrouped = ungroup(world, &ids);
    select(world, ungrouped.freed);
    if ungrouped.lost_motion {
        let text = "The group's motion went with it: what was below it stands still.";
        world.resource_mut::<Notices>().tell(text);
    }
    Some(name)
}

fn step_paste(world: &mut World) -> Option<String> {
    let clipboard = world.resource::<Clipboard>().clone();
    match paste(world, &clipboard) {
        Ok(new) if !new.is_empty() => {
            let name = format!("Paste {}", call(world, &new));
            select(world, new);
            Some(name)
        }
        Ok(_) => None,
        Err(error) => {
            world.resource_mut::<Notices>().fault(error.to_string());
            None
        }
    }
}

fn step_duplicate(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let name = format!("Duplicate {}", call(world, &ids));
    let new = duplicate(world, &ids);
    select(world, new.roots);
    let mut notices = world.resource_mut::<Notices>();
    notices.notes(&name, new.lost);
    Some(name)
}

/// What could not be kept is not removed.
fn step_cut(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let name = format!("Cut {}", call(world, &ids));
    keep_selected(world).then(|| {
        delete(world, &ids);
        name
    })
}

fn step_delete(world: &mut World) -> Option<String> {
    let ids = selected(world);
    let name = format!("Delete {}", call(world, &ids));
    delete(world, &ids);
    Some(name)
}

/// One by its name, several by their number.
pub(super) fn call(world: &World, ids: &[SceneId]) -> String {
    match ids {
        [one] => name_of(world, *one),
        ids => format!("{} entities", ids.len()),
    }
}

fn tell(world: &mut World, verb: &str, name: &str) {
    let text = format!("{verb}: {name}");
    world.resource_mut::<Notices>().tell_in_place(verb, text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::{Action, Addition};
    use crate::editor::headless_editor;
    use crate::sync::Traced;

    #[test]
    fn what_is_added_is_traced_in_the_same_frame() {
        let mut app = headless_editor();
        app.update();
        let traced = |app: &App| app.world().resource::<Traced>().world.objects.len();
        assert_eq!(traced(&app), 0);
        let cuboid = Addition::Shape("Cuboid".into());
        app.world_mut().write_message(Action::Add(cuboid));
        app.update();
        assert_eq!(traced(&app), 1);
    }

    #[test]
    fn what_is_cut_is_gone_in_one_step_and_pasted_with_its_children() {
        let mut app = headless_editor();
        let act = |app: &mut App, action: Action| {
            app.world_mut().write_message(action);
            app.update();
        };
        let count = |app: &mut App| {
            let mut all = app.world_mut().query::<&SceneId>();
            all.iter(app.world()).count()
        };
        act(&mut app, Action::run("edit.cut"));
        let none = count(&mut app);
        act(&mut app, Action::Add(Addition::Group));
        let group = app.world().resource::<Selection>().active().unwrap();
        act(&mut app, Action::Add(Addition::PointLamp));
        let lamp = app.world().resource::<Selection>().active().unwrap();
        act(&mut app, Action::Reparent(vec![lamp], Some(group)));
        act(&mut app, Action::Select(vec![group]));
        let before = app.world().resource::<History>().steps().count();
        act(&mut app, Action::run("edit.cut"));
        assert_eq!(count(&mut app), none);
        let history = app.world().resource::<History>();
        assert_eq!(history.steps().count(), before + 1);
        assert_eq!(history.undo_text(), Some("Cut Group"));
        act(&mut app, Action::run("edit.paste"));
        assert_eq!(count(&mut app), none + 2);
        act(&mut app, Action::run("edit.undo"));
        act(&mut app, Action::run("edit.undo"));
        assert_eq!(count(&mut app), none + 2);
        assert!(scene_entity(app.world(), group).is_some());
    }

    #[test]
    fn undo_and_redo_tell_the_step_that_they_are_of() {
        let mut app = headless_editor();
        let act = |app: &mut App, action: Action| {
            app.world_mut().write_message(action);
            app.update();
        };
        let told = |app: &mut App| {
            let mut notices = app.world_mut().resource_mut::<Notices>();
            notices.shown().last().map(|notice| notice.text.clone())
        };
        act(&mut app, Action::Add(Addition::Group));
        let id = app.world().resource::<Selection>().active().unwrap();
        let group = scene_entity(app.world(), id).unwrap();
        // A drag that is under way is the step.
        let world = app.world_mut();
        world.resource_mut::<Gesture>().begin("Drag it");
        world.get_mut::<Transform>(group).unwrap().translation.x = 1.0;
        act(&mut app, Action::run("edit.undo"));
        assert_eq!(told(&mut app).as_deref(), Some("Undone: Drag it"));
        act(&mut app, Action::run("edit.redo"));
        assert_eq!(told(&mut app).as_deref(), Some("Done again: Drag it"));
        act(&mut app, Action::Rename(id, " Crane ".into()));
        act(&mut app, Action::Rename(id, " ".into()));
        let steps: Vec<&str> = app.world().resource::<History>().steps().collect();
        assert_eq!(
            steps[2..],
            ["Rename Group to Crane", "Take the name from Crane"]
        );
    }
}

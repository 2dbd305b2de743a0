//! The actions that edit and select, each a step of its own.

use super::{
    AddAt, Clipboard, SceneIndex, add, add_model, copy, delete, duplicate, name_of, paste, rename,
    reparent, scene_entity, set_visible,
};
use crate::editor::action::Action;
use crate::editor::history::{Gesture, History, commit, redo, undo};
use crate::editor::notice::Notices;
use crate::editor::schedule::EditorUpdate;
use crate::editor::selection::Selection;
use crate::io::FileError;
use crate::scene::SceneId;
use bevy::app::{App, Plugin};
use bevy::camera::visibility::Visibility;
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::system::Local;
use bevy::ecs::world::World;
use std::path::Path;

/// Does what [`Action`]s ask for that edit the scene or select in it. Needs
/// [`HistoryPlugin`](crate::editor::history::HistoryPlugin).
pub struct EditsPlugin;

impl Plugin for EditsPlugin {
    fn build(&self, app: &mut App) {
        app.add_message::<Action>()
            .init_resource::<Clipboard>()
            .init_resource::<AddAt>()
            .init_resource::<Selection>()
            .init_resource::<Notices>()
            .init_resource::<SceneIndex>()
            .add_systems(EditorUpdate, edit);
    }
}

fn edit(world: &mut World, mut cursor: Local<MessageCursor<Action>>) {
    let actions: Vec<Action> = {
        let messages = world.resource::<Messages<Action>>();
        cursor.read(messages).cloned().collect()
    };
    for action in &actions {
        perform(world, action);
    }
}

/// Does what an action asks for, if it is one that edits or selects, and says whether it is.
fn perform(world: &mut World, action: &Action) -> bool {
    let selected = || world.resource::<Selection>().ids().to_vec();
    match action {
        Action::Select(ids) => {
            let ids: Vec<SceneId> = ids.clone();
            select(world, ids);
            return true;
        }
        Action::SelectNone => {
            select(world, Vec::new());
            return true;
        }
        Action::SelectAll => {
            let mut all = world.query::<&SceneId>();
            let mut all: Vec<SceneId> = all.iter(world).copied().collect();
            all.sort_unstable();
            select(world, all);
            return true;
        }
        Action::Copy => {
            let ids = selected();
            if !ids.is_empty() {
                match copy(world, &ids) {
                    Ok(clipboard) => world.insert_resource(clipboard),
                    Err(error) => world.resource_mut::<Notices>().fault(error.to_string()),
                }
            }
            return true;
        }
        Action::Undo => {
            let text = world.resource::<History>().undo_text().map(str::to_owned);
            let done = undo(world);
            tell(world, done, "Undone", text, "Nothing to undo");
            return true;
        }
        Action::Redo => {
            let text = world.resource::<History>().redo_text().map(str::to_owned);
            let done = redo(world);
            tell(world, done, "Done again", text, "Nothing to redo");
            return true;
        }
        Action::Add(_)
        | Action::Import(_)
        | Action::Paste
        | Action::Duplicate
        | Action::Delete
        | Action::Rename(..)
        | Action::Reparent(..)
        | Action::ToggleVisible => {}
        _ => return false,
    }
    // What was changed before is a step of its own.
    world.resource_mut::<Gesture>().end();
    commit(world);
    if let Some(name) = change(world, action) {
        world.resource_mut::<History>().name_next(name);
    }
    commit(world);
    true
}

/// Does it; how the step is to be called.
fn change(world: &mut World, action: &Action) -> Option<String> {
    let selected = world.resource::<Selection>().ids().to_vec();
    match action {
        Action::Add(what) => {
            let at = *world.resource::<AddAt>();
            match add(world, what, at) {
                Some(id) => {
                    select(world, vec![id]);
                    return Some(format!("Add {}", name_of(world, id)));
                }
                None => {
                    let text = format!("{what:?} is no shape that can be added");
                    world.resource_mut::<Notices>().fault(text);
                }
            }
        }
        Action::Import(file) => match add_file(world, file) {
            Ok(name) => return Some(name),
            Err(error) => world.resource_mut::<Notices>().fault(error.to_string()),
        },
        Action::Paste => {
            let clipboard = world.resource::<Clipboard>().clone();
            match paste(world, &clipboard) {
                Ok(new) if !new.is_empty() => {
                    let name = format!("Paste {}", call(world, &new));
                    select(world, new);
                    return Some(name);
                }
                Ok(_) => {}
                Err(error) => world.resource_mut::<Notices>().fault(error.to_string()),
            }
        }
        Action::Duplicate if !selected.is_empty() => {
            let name = format!("Duplicate {}", call(world, &selected));
            let new = duplicate(world, &selected);
            select(world, new);
            return Some(name);
        }
        Action::Delete if !selected.is_empty() => {
            let name = format!("Delete {}", call(world, &selected));
            delete(world, &selected);
            return Some(name);
        }
        Action::Rename(id, name) => {
            let old = name_of(world, *id);
            rename(world, *id, name);
            return Some(format!("Rename {old} to {name}"));
        }
        Action::Reparent(ids, parent) => {
            let whose = call(world, ids);
            reparent(world, ids, *parent);
            return Some(match parent {
                Some(parent) => format!("Put {whose} below {}", name_of(world, *parent)),
                None => format!("Put {whose} at the top"),
            });
        }
        Action::ToggleVisible if !selected.is_empty() => {
            let shown = |&id: &SceneId| {
                let entity = scene_entity(world, id);
                let now = entity.and_then(|entity| world.get::<Visibility>(entity));
                now.is_some_and(|now| *now != Visibility::Hidden)
            };
            let show = !selected.iter().any(shown);
            let verb = if show { "Show" } else { "Hide" };
            let name = format!("{verb} {}", call(world, &selected));
            set_visible(world, &selected, show);
            return Some(name);
        }
        _ => {}
    }
    None
}

/// Adds a model as a step of its own, for who asks again where that fails.
pub(in crate::editor) fn import(world: &mut World, file: &Path) -> Result<(), FileError> {
    world.resource_mut::<Gesture>().end();
    commit(world);
    let name = add_file(world, file)?;
    world.resource_mut::<History>().name_next(name);
    commit(world);
    Ok(())
}

fn add_file(world: &mut World, file: &Path) -> Result<String, FileError> {
    let (root, imported) = add_model(world, file)?;
    let name = file
        .file_name()
        .unwrap_or(file.as_os_str())
        .to_string_lossy();
    let mut notices = world.resource_mut::<Notices>();
    notices.notes(&name, imported.notes.lines());
    select(world, root.into_iter().collect());
    Ok(format!("Import {name}"))
}

fn select(world: &mut World, ids: Vec<SceneId>) {
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

/// One by its name, several by their number.
fn call(world: &World, ids: &[SceneId]) -> String {
    match ids {
        [one] => name_of(world, *one),
        ids => format!("{} entities", ids.len()),
    }
}

fn tell(world: &mut World, done: bool, verb: &str, text: Option<String>, nothing: &str) {
    let text = match (done, text) {
        (true, Some(text)) => format!("{verb}: {text}"),
        (true, None) => verb.to_owned(),
        (false, _) => nothing.to_owned(),
    };
    world.resource_mut::<Notices>().tell(text);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::action::Addition;
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
}

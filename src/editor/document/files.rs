//! New, open, save, quit.

use super::question::{Purpose, Question};
use super::{Document, adopt, dialog, note_state_now};
use crate::editor::action::Action;
use crate::editor::edits;
use crate::editor::history::{Gesture, History};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::render_job::RenderJob;
use crate::editor::selection::Selection;
use crate::editor::texts::path_text;
use crate::io::{
    OpenOptions, Problem, SceneFiles, SceneSource, has_changed, open, open_empty, save,
};
use bevy::app::AppExit;
use bevy::ecs::world::World;
use std::path::Path;

/// Does what an action asks for, if it is about files, or asks first.
pub(super) fn perform(world: &mut World, action: &Action) {
    match action {
        Action::New | Action::Open(_) | Action::Quit => request(world, action),
        Action::OpenDialog => dialog::ask(world, Purpose::Open),
        Action::ImportDialog => dialog::ask(world, Purpose::Import),
        Action::SaveAsDialog => dialog::ask(world, Purpose::SaveAs),
        Action::Save | Action::SaveAs(_) => perform_now(world, action),
        _ => {}
    }
}

/// Does it, unless unsaved changes would be lost: then that is asked.
pub(super) fn request(world: &mut World, action: &Action) {
    let loses = matches!(action, Action::New | Action::Open(_) | Action::Quit);
    world.resource_mut::<Gesture>().end();
    note_state_now(world);
    if loses && world.resource::<Document>().unsaved {
        let then = action.clone();
        world.resource_mut::<Document>().question = Some(Question::Unsaved { then });
    } else {
        perform_now(world, action);
    }
}

/// Does it.
pub(super) fn perform_now(world: &mut World, action: &Action) {
    match action {
        Action::New => {
            open_empty(world);
            finish_opening(world, "Untitled".into(), None);
        }
        Action::Open(path) => open_file(world, path, false),
        Action::Import(file) => match edits::import(world, file) {
            Ok(()) => world.resource_mut::<Document>().give_up(),
            Err(error) => dialog::refuse(world, error.to_string()),
        },
        Action::Save => match world.resource::<Document>().path.clone() {
            Some(path) => save_to(world, &path),
            None => dialog::ask(world, Purpose::SaveAs),
        },
        Action::SaveAs(path) => save_to(world, path),
        Action::Quit => {
            let job = world.get_resource::<RenderJob>();
            let rendered = job.and_then(RenderJob::progress);
            match rendered.map(|progress| progress.file) {
                Some(file) => {
                    world.resource_mut::<Document>().question = Some(Question::Rendering { file });
                }
                None => quit(world),
            }
        }
        _ => {}
    }
}

/// Ends the app, and a render to a file with it.
pub(super) fn quit(world: &mut World) {
    if let Some(mut job) = world.get_resource_mut::<RenderJob>() {
        job.cancel();
    }
    world.write_message(AppExit::Success);
}

/// Whether saving writes back to such a file: a model's would lose most of a scene.
pub(super) fn is_scene(path: &Path) -> bool {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().to_lowercase());
    name.is_some_and(|name| name.ends_with(".scn.ron"))
}

/// Opens a file or a built-in scene; what is open stays open where that fails.
pub(in crate::editor) fn open_file(world: &mut World, path: &Path, allow_outside: bool) {
    let source = SceneSource::named(path);
    let is_file = matches!(source, SceneSource::File(_));
    let files = world.get_resource::<SceneFiles>();
    let options = OpenOptions {
        allow_outside,
        limits: files.map(|files| files.limits.clone()).unwrap_or_default(),
        // What it cannot show is said, and can be mended here.
        tolerant: true,
        unframed: false,
    };
    match open(world, &source, options) {
        Ok(opened) => {
            finish_opening(world, opened.name.clone(), is_file.then_some(path));
            let mut notices = world.resource_mut::<Notices>();
            notices.notes(&opened.name, opened.notes.lines());
        }
        Err(error)
            if matches!(
                error.problem,
                Problem::RefersOutside { .. } | Problem::Outside
            ) && !allow_outside =>
        {
            world.resource_mut::<Document>().question = Some(Question::Outside {
                file: path.to_path_buf(),
                says: error.to_string(),
            });
        }
        Err(error) => {
            if matches!(error.problem, Problem::NotFound)
                && let Some(mut preferences) = world.get_resource_mut::<Preferences>()
            {
                preferences.forget(path);
            }
            dialog::refuse(world, error.to_string());
        }
    }
}

fn finish_opening(world: &mut World, name: String, path: Option<&Path>) {
    world.resource_mut::<Selection>().set([]);
    adopt(world, name, path);
    if let Some(path) = path {
        remember(world, path);
    }
}

fn remember(world: &mut World, path: &Path) {
    if let Some(mut preferences) = world.get_resource_mut::<Preferences>() {
        preferences.remember(path);
    }
}

/// Opens the scene's file again, as another program has left it.
pub(super) fn reload(world: &mut World, path: &Path) {
    let files = world.get_resource::<SceneFiles>();
    let allow_outside = files.is_some_and(|files| files.folder.allow_outside);
    open_file(world, path, allow_outside);
}

/// Writes the scene, unless that would undo what another program did to the file: then that is asked.
pub(super) fn save_to(world: &mut World, path: &Path) {
    if has_changed(world, path) {
        let file = path.to_path_buf();
        world.resource_mut::<Document>().question = Some(Question::Changed { file });
    } else {
        write_to(world, path);
    }
}

/// Writes the scene, and then does what was waiting for that. A model file is an export: the
/// document stays the scene it was. Where writing fails the old file stays, and so does the
/// document.
pub(super) fn write_to(world: &mut World, path: &Path) {
    world.resource_mut::<Gesture>().end();
    note_state_now(world);
    let notes = match save(world, path) {
        Ok(notes) => notes,
        Err(error) => {
            let mut document = world.resource_mut::<Document>();
            // Another path may do, and then goes on what waited.
            if document.given.is_none() {
                document.then = None;
            }
            dialog::refuse(world, error.to_string());
            return;
        }
    };
    let then = world.resource_mut::<Document>().then.take();
    world.resource_mut::<Document>().given = None;
    let name = path
        .file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let is_scene = is_scene(path);
    let mut notices = world.resource_mut::<Notices>();
    let verb = if is_scene { "Saved" } else { "Exported" };
    notices.tell(format!("{verb} {}", path_text(path)));
    notices.notes(&name, notes.lines());
    if !is_scene {
        return;
    }
    // Saving numbers what has no number yet.
    note_state_now(world);
    let state = world.resource::<History>().state();
    world
        .resource_mut::<Document>()
        .opened(name, Some(path.to_path_buf()), state);
    remember(world, path);
    if let Some(then) = then {
        perform_now(world, &then);
    }
}

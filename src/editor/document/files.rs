//! New, open, save, quit.

use super::question::{FileTask, Purpose, Question};
use super::{Document, adopt, dialog, note_state_now, recovery};
use crate::editor::edits;
use crate::editor::history::{Gesture, History};
use crate::editor::notice::Notices;
use crate::editor::preferences::Preferences;
use crate::editor::render_job::RenderJob;
use crate::editor::selection::Selection;
use crate::editor::texts::{file_name, path_text};
use crate::io::{
    FileError, OpenOptions, Problem, SceneFiles, SceneSource, extension, has_changed, open,
    open_new, save,
};
use bevy::app::AppExit;
use bevy::ecs::world::World;
use std::path::Path;

/// Does it, unless unsaved changes would be lost: then that is asked.
pub(in crate::editor) fn request(world: &mut World, task: FileTask) {
    let loses = matches!(task, FileTask::New | FileTask::Open(_) | FileTask::Quit);
    if !loses {
        return perform_now(world, task);
    }
    let question = &world.resource::<Document>().question;
    if matches!(question, Some(Question::Waiting { .. })) {
        // The question that follows would stand in its place, and two would be waited for.
        dialog::give_up(world);
        let mut document = world.resource_mut::<Document>();
        document.question = None;
        document.give_up();
    }
    world.resource_mut::<Gesture>().end();
    note_state_now(world);
    if world.resource::<Document>().unsaved {
        world.resource_mut::<Document>().question = Some(Question::Unsaved { then: task });
    } else {
        perform_now(world, task);
    }
}

/// Does it.
pub(super) fn perform_now(world: &mut World, task: FileTask) {
    match task {
        FileTask::New => {
            open_new(world);
            finish_opening(world, "Untitled".into(), None);
        }
        FileTask::Open(path) => open_file(world, &path, false),
        FileTask::Import(path, at) => match edits::import(world, &path, at) {
            Ok(()) => {
                world.resource_mut::<Document>().give_up();
                remember_folder_of(world, &path);
            }
            Err(error) => dialog::refuse(world, error.to_string()),
        },
        FileTask::SaveAs(path) => save_to(world, &path),
        FileTask::Quit => {
            let job = world.get_resource::<RenderJob>();
            let rendered = job.and_then(RenderJob::progress);
            // What is only being written will be.
            let unfinished = rendered.filter(|progress| !progress.writing);
            match unfinished.map(|progress| progress.file) {
                Some(file) => {
                    world.resource_mut::<Document>().question = Some(Question::Rendering { file });
                }
                None => quit(world),
            }
        }
    }
}

/// Keeps a picture that was chosen for who asked for one, where there is a file.
pub(super) fn note_picture(world: &mut World, path: &Path) {
    if !path.is_file() {
        return dialog::refuse(world, FileError::new(path, Problem::NotFound).to_string());
    }
    remember_folder_of(world, path);
    let mut document = world.resource_mut::<Document>();
    document.give_up();
    document.picture = Some(path.to_path_buf());
}

/// Writes the scene to its file; where it has none, asks for one.
pub(super) fn save_here(world: &mut World) {
    match world.resource::<Document>().path.clone() {
        Some(path) => save_to(world, &path),
        None => dialog::ask(world, Purpose::SaveAs),
    }
}

/// Ends the app, and a render to a file with it. Whoever gets here has said what becomes of the work: it is saved, or
/// need not be kept.
pub(super) fn quit(world: &mut World) {
    recovery::give_up_work(world);
    if let Some(mut job) = world.get_resource_mut::<RenderJob>() {
        job.cancel();
    }
    world.write_message(AppExit::Success);
}

/// Whether saving writes back to such a file: a model's would lose most of a scene.
pub(super) fn is_scene(path: &Path) -> bool {
    extension(path) == "scn.ron"
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

/// What is imported or exported is no document to open again; more may lie in its folder.
fn remember_folder_of(world: &mut World, path: &Path) {
    if let Some(mut preferences) = world.get_resource_mut::<Preferences>() {
        preferences.remember_folder_of(path);
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
    let name = file_name(path);
    let is_scene = is_scene(path);
    let mut notices = world.resource_mut::<Notices>();
    let verb = if is_scene { "Saved" } else { "Exported" };
    notices.tell(format!("{verb} {}", path_text(path)));
    notices.notes(&name, notes.lines());
    if !is_scene {
        remember_folder_of(world, path);
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
        perform_now(world, then);
    }
}

//! What a person has to decide, and what follows.

use super::files::{self, perform_now};
use super::{Document, dialog, recovery};
use bevy::ecs::world::World;
use bevy::math::Vec2;
use std::path::{Path, PathBuf};

/// What is done with a file, at once or after a question.
#[derive(Clone, Debug, PartialEq)]
pub enum FileTask {
    /// Begins an empty scene.
    New,
    /// Opens a file, or a built-in scene by its name.
    Open(PathBuf),
    /// Adds a model's content to the open scene, where it was dropped in the window, in logical pixels.
    Import(PathBuf, Option<Vec2>),
    /// Writes the scene.
    SaveAs(PathBuf),
    /// Ends the program.
    Quit,
}

/// What has to be decided before anything else goes on.
#[derive(Clone, Debug, PartialEq)]
pub enum Question {
    /// Unsaved changes would be lost by this. Answers: `Yes` saves first, `No` loses them, `Cancel`.
    Unsaved {
        /// What was asked for.
        then: FileTask,
    },
    /// A path to type, where there is no native dialog. Answers: `Path`, `Cancel`.
    Path {
        /// What for.
        purpose: Purpose,
        /// What to begin with.
        suggestion: PathBuf,
        /// Why the path that was given before did not do.
        refused: Option<String>,
    },
    /// A native dialog is open, or should be. Answers: `No` asks for a path to type instead, `Cancel`.
    Waiting {
        /// What for.
        purpose: Purpose,
    },
    /// Whether a file that exists is to be replaced. Answers: `Yes`, `Cancel`.
    Replace {
        /// The file.
        file: PathBuf,
        /// What writes it.
        then: FileTask,
    },
    /// Another program has changed the scene's file since it was read or written here; asked when that is seen, and
    /// before it would be written over. Answers: `Yes` overwrites it,
    /// `No` opens it as it is now, `Elsewhere` asks for another file, `Cancel`.
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// Whether a scene may refer to files outside its folder. Answers: `Yes`, `Cancel`.
    Outside {
        /// The scene.
        file: PathBuf,
        /// What it refers to.
        says: String,
    },
    /// Whether to quit although a picture is being rendered to a file. Answers: `Yes`, `Cancel`.
    Rendering {
        /// What would not be written.
        file: PathBuf,
    },
    /// Whether work that was not saved before a crash is to be opened. Answers: `Yes`, `No` deletes
    /// it, `Cancel` asks again next time.
    Recover(recovery::Recovered),
}

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A scene or a model to open.
    Open,
    /// Where to save the scene.
    SaveAs,
    /// A model to add to the scene.
    Import,
    /// A picture for a material or the environment.
    Picture,
}

/// What a person decided.
#[derive(Clone, Debug, PartialEq)]
pub enum Answer {
    /// Save, replace, overwrite, allow, quit, recover.
    Yes,
    /// Go on without saving; delete what could be recovered; reload.
    No,
    /// Save under another name.
    Elsewhere,
    /// Leave everything as it is.
    Cancel,
    /// This file.
    Path(PathBuf),
}

/// Answers the question that is open, if the answer fits it.
pub fn answer(world: &mut World, answer: Answer) {
    let Some(question) = world.resource_mut::<Document>().question.take() else {
        return;
    };
    match (question, answer) {
        (Question::Unsaved { then }, Answer::Yes) => {
            world.resource_mut::<Document>().then = Some(then);
            files::save_here(world);
        }
        (Question::Unsaved { then }, Answer::No) => perform_now(world, then),
        (Question::Path { .. }, Answer::Path(path)) if path.as_os_str().is_empty() => {
            world.resource_mut::<Document>().then = None;
        }
        (Question::Path { purpose, .. }, Answer::Path(path)) => take(world, purpose, &path, None),
        (Question::Waiting { purpose }, Answer::No) => dialog::type_instead(world, purpose),
        (Question::Waiting { .. }, Answer::Cancel) => {
            dialog::give_up(world);
            world.resource_mut::<Document>().give_up();
        }
        (Question::Replace { then, .. }, Answer::Yes) => perform_now(world, then),
        (Question::Changed { file }, Answer::Yes) => files::write_to(world, &file),
        (Question::Changed { file }, Answer::No) => {
            world.resource_mut::<Document>().then = None;
            files::reload(world, &file);
        }
        (Question::Changed { .. }, Answer::Elsewhere) => dialog::ask(world, Purpose::SaveAs),
        (Question::Outside { file, .. }, Answer::Yes) => files::open_file(world, &file, true),
        (Question::Rendering { .. }, Answer::Yes) => files::quit(world),
        (Question::Recover(found), Answer::Yes) => recovery::recover(world, &found),
        (Question::Recover(found), Answer::No) => found.delete(),
        (_, Answer::Cancel) => world.resource_mut::<Document>().give_up(),
        // An answer to another question.
        (question, _) => world.resource_mut::<Document>().question = Some(question),
    }
}

/// Goes on with a path that was chosen or typed; where that fails it is asked for again. The desktop's own dialog has
/// asked whether `asked` may be replaced.
pub(super) fn take(world: &mut World, purpose: Purpose, path: &Path, asked: Option<&Path>) {
    world.resource_mut::<Document>().given = Some((purpose, path.to_path_buf()));
    let Some(task) = chosen(purpose, path) else {
        return files::note_picture(world, path);
    };
    let FileTask::SaveAs(file) = &task else {
        return files::request(world, task);
    };
    let own = world.resource::<Document>().path.as_deref() == Some(file);
    let replaced = if file.exists() {
        (!own && asked != Some(file)).then(|| file.clone())
    } else {
        // An OBJ brings its materials along.
        let materials = file.with_extension("mtl");
        (crate::io::extension(file) == "obj" && materials.exists()).then_some(materials)
    };
    match replaced {
        Some(file) => {
            let then = task;
            world.resource_mut::<Document>().question = Some(Question::Replace { file, then });
        }
        None => perform_now(world, task),
    }
}

/// What a chosen path asks for; `None` for a picture, which somebody waits for. A scene without an extension gets ours.
fn chosen(purpose: Purpose, path: &Path) -> Option<FileTask> {
    Some(match purpose {
        Purpose::Open => FileTask::Open(path.to_path_buf()),
        Purpose::Import => FileTask::Import(path.to_path_buf(), None),
        Purpose::SaveAs if path.extension().is_none() => {
            let mut name = path.as_os_str().to_owned();
            name.push(".scn.ron");
            FileTask::SaveAs(name.into())
        }
        Purpose::SaveAs => FileTask::SaveAs(path.to_path_buf()),
        Purpose::Picture => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::notice::Notices;
    use crate::editor::render_job::{RenderFrom, RenderJob, RenderRequest, start_render};
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use crate::scene::RenderSettings;
    use bevy::app::{App, AppExit};
    use bevy::ecs::message::Messages;

    /// Cornell's box in an editor, of which a picture has just been asked for.
    fn rendering(file: &Path) -> App {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let world = app.world_mut();
        let request = RenderRequest {
            file: file.to_path_buf(),
            camera: RenderFrom::FirstCamera,
            settings: world.resource::<RenderSettings>().clone(),
        };
        start_render(world, request).unwrap();
        app
    }

    #[test]
    fn quitting_asks_while_a_picture_is_rendered_to_a_file_and_not_otherwise() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.png");
        let mut app = rendering(&file);
        let world = app.world_mut();
        for (given, goes_on) in [(Answer::Cancel, true), (Answer::Yes, false)] {
            perform_now(world, FileTask::Quit);
            let asked = world.resource::<Document>().question.clone();
            assert_eq!(asked, Some(Question::Rendering { file: file.clone() }));
            answer(world, given);
            let exits = world.resource::<Messages<AppExit>>();
            assert_eq!(exits.is_empty(), goes_on);
            let progress = world.resource::<RenderJob>().progress();
            assert_eq!(progress.is_some(), goes_on);
        }
        perform_now(world, FileTask::Quit);
        assert_eq!(world.resource::<Document>().question, None);
    }

    #[test]
    fn a_render_that_has_not_begun_ends_with_the_scene_that_it_is_of() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = rendering(&folder.path().join("a.png"));
        let world = app.world_mut();
        world.resource_mut::<Notices>().close_all();
        perform_now(world, FileTask::New);
        assert!(world.resource::<RenderJob>().progress().is_none());
        assert!(!world.resource::<Notices>().is_empty(), "it is said");
    }

    #[test]
    fn nothing_is_replaced_that_nobody_was_asked_about() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a.scn.ron", "b.mtl", "c.obj", "c.mtl"] {
            std::fs::write(at(name), "").unwrap();
        }
        let mut app = headless_editor();
        let world = app.world_mut();
        for (chosen, asked, about) in [
            // The desktop asks about `a`, and what is written is `a.scn.ron`.
            ("a", Some("a"), Some("a.scn.ron")),
            ("a.scn.ron", None, Some("a.scn.ron")),
            ("b.obj", Some("b.obj"), Some("b.mtl")),
            ("c.obj", Some("c.obj"), None),
            ("c.obj", None, Some("c.obj")),
            ("d", Some("d"), None),
        ] {
            world.resource_mut::<Document>().question = None;
            let asked = asked.map(at);
            take(world, Purpose::SaveAs, &at(chosen), asked.as_deref());
            let question = world.resource::<Document>().question.clone();
            let file = match question {
                Some(Question::Replace { file, .. }) => Some(file),
                _ => None,
            };
            assert_eq!(file, about.map(at), "{chosen}");
        }
    }

    #[test]
    fn where_a_path_does_not_do_it_is_asked_for_again_with_what_was_typed() {
        let mut app = headless_editor();
        app.update();
        let world = app.world_mut();
        crate::editor::document::adopt(world, "nothing", None);
        for (purpose, path) in [
            (Purpose::Open, "/no/such.scn.ron"),
            (Purpose::Import, "/no/such.obj"),
            (Purpose::SaveAs, "/no/such/folder/a.scn.ron"),
        ] {
            world.resource_mut::<Document>().question = Some(Question::Path {
                purpose,
                suggestion: PathBuf::new(),
                refused: None,
            });
            let path = PathBuf::from(path);
            answer(world, Answer::Path(path.clone()));
            let asked = world.resource::<Document>().question.clone();
            let again = matches!(&asked, Some(Question::Path { purpose: of, suggestion, refused: Some(why) })
                if (*of, suggestion) == (purpose, &path) && !why.is_empty());
            assert!(again, "{purpose:?}: {asked:?}");
            assert!(world.resource::<Notices>().is_empty(), "it is said there");
            answer(world, Answer::Cancel);
            assert_eq!(world.resource::<Document>().question, None);
        }
        // Without a dialog it is said in a notice, of another file too.
        perform_now(world, FileTask::Open("/no/such.scn.ron".into()));
        assert_eq!(world.resource::<Document>().question, None);
        assert!(!world.resource::<Notices>().is_empty());
    }

    #[test]
    fn who_waits_for_a_dialog_that_does_not_come_can_type_the_path() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let purpose = Purpose::Import;
        let waits = || Some(Question::Waiting { purpose });
        world.resource_mut::<Document>().question = waits();
        answer(world, Answer::No);
        let asked = world.resource::<Document>().question.clone();
        assert!(matches!(
            asked,
            Some(Question::Path {
                purpose: Purpose::Import,
                ..
            })
        ));
        world.resource_mut::<Document>().question = waits();
        answer(world, Answer::Cancel);
        assert_eq!(world.resource::<Document>().question, None);
    }
}

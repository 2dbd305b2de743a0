//! Asking for a file, without making the frame wait.

use super::question::{Purpose, Question, take};
use super::{Document, dialog_native};
use crate::editor::background::{Background, Outcome};
use crate::editor::notice::Notices;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Nobody reads a dialog and closes it within this time: where one is gone so soon, there was none.
const NO_DIALOG: Duration = Duration::from_millis(400);

/// The native dialog that is open.
#[derive(Resource, Default)]
pub(super) struct Dialogs {
    open: Option<OpenDialog>,
    /// A native dialog was tried and did not appear.
    broken: bool,
}

struct OpenDialog {
    purpose: Purpose,
    since: Instant,
    choice: Background<Option<PathBuf>>,
}

/// Asks for a file: with the desktop's own dialog where there is one, else by a typed path.
pub(super) fn ask(world: &mut World, purpose: Purpose) {
    let suggestion = suggestion(world, purpose);
    let question = &world.resource::<Document>().question;
    let waits = matches!(question, Some(Question::Waiting { .. }));
    let mut dialogs = world.resource_mut::<Dialogs>();
    if dialogs.open.is_some() && waits {
        return;
    }
    // Another question took the place of the one that waited for it.
    dialogs.open = None;
    if !dialogs.broken && dialog_native::is_available() {
        let start = suggestion.clone();
        let choose = move |_: &_| dialog_native::choose(purpose, &start);
        if let Ok(choice) = Background::start("file dialog", choose) {
            dialogs.open = Some(OpenDialog {
                purpose,
                since: Instant::now(),
                choice,
            });
            world.resource_mut::<Document>().question = Some(Question::Waiting { purpose });
            return;
        }
    }
    ask_for_path(world, purpose, suggestion);
}

/// No dialog has appeared, or a person would rather type; what may still come of it is not waited
/// for.
pub(super) fn type_instead(world: &mut World, purpose: Purpose) {
    let mut dialogs = world.resource_mut::<Dialogs>();
    dialogs.open = None;
    dialogs.broken = true;
    let suggestion = suggestion(world, purpose);
    ask_for_path(world, purpose, suggestion);
}

/// Nobody waits for the dialog any more.
pub(super) fn give_up(world: &mut World) {
    world.resource_mut::<Dialogs>().open = None;
}

fn ask_for_path(world: &mut World, purpose: Purpose, suggestion: PathBuf) {
    world.resource_mut::<Document>().question = Some(Question::Path {
        purpose,
        suggestion,
        refused: None,
    });
}

/// Opening, importing or saving has failed: asks for another path, beginning with the one that was given; where none was
/// it is said in a notice.
pub(super) fn refuse(world: &mut World, why: String) {
    let mut document = world.resource_mut::<Document>();
    match document.given.take() {
        Some((purpose, suggestion)) => {
            document.question = Some(Question::Path {
                purpose,
                suggestion,
                refused: Some(why),
            });
        }
        None => world.resource_mut::<Notices>().fault(why),
    }
}

/// What a path is likely to begin with.
fn suggestion(world: &World, purpose: Purpose) -> PathBuf {
    let document = world.resource::<Document>();
    match (purpose, &document.path) {
        (Purpose::SaveAs, Some(path)) => path.clone(),
        (Purpose::SaveAs, None) => {
            let stem = document.name.split('.').next().unwrap_or("scene");
            PathBuf::from(format!("{stem}.scn.ron"))
        }
        (_, Some(path)) => path
            .parent()
            .map(|folder| folder.join(""))
            .unwrap_or_default(),
        (_, None) => PathBuf::new(),
    }
}

/// Goes on when a choice was made.
pub(super) fn take_choices(world: &mut World) {
    let mut dialogs = world.resource_mut::<Dialogs>();
    let Some(open) = &dialogs.open else {
        return;
    };
    let choice = match open.choice.take() {
        Outcome::Pending => return,
        Outcome::Done(choice) => choice,
        Outcome::Lost => None,
    };
    let (purpose, was_short) = (open.purpose, open.since.elapsed() < NO_DIALOG);
    dialogs.open = None;
    let mut document = world.resource_mut::<Document>();
    if matches!(document.question, Some(Question::Waiting { .. })) {
        document.question = None;
    }
    match choice {
        Some(path) => take(world, purpose, &path, Some(&path)),
        _ if was_short => type_instead(world, purpose),
        _ => world.resource_mut::<Document>().give_up(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::{Answer, FileTask, answer, request};

    #[test]
    fn a_scene_without_a_file_can_be_saved_when_the_program_is_left_with_a_dialog_open() {
        let mut app = crate::editor::headless_editor();
        let world = app.world_mut();
        crate::editor::document::adopt(world, "nothing", None);
        let (keeps, waits) = std::sync::mpsc::channel::<()>();
        let choose = move |_: &_| {
            let _ = waits.recv();
            None
        };
        let purpose = Purpose::Open;
        *world.resource_mut::<Dialogs>() = Dialogs {
            open: Some(OpenDialog {
                purpose,
                since: Instant::now(),
                choice: Background::start("file dialog", choose).unwrap(),
            }),
            broken: true,
        };
        let mut document = world.resource_mut::<Document>();
        document.question = Some(Question::Waiting { purpose });
        world.spawn(crate::scene::SceneId(1));
        let then = FileTask::Quit;
        request(world, then.clone());
        let asked = world.resource::<Document>().question.clone();
        assert_eq!(asked, Some(Question::Unsaved { then }));
        assert!(world.resource::<Dialogs>().open.is_none());
        answer(world, Answer::Yes);
        let asked = &world.resource::<Document>().question;
        let purpose = Purpose::SaveAs;
        assert!(
            matches!(asked, Some(Question::Path { purpose: of, .. }) if *of == purpose),
            "{asked:?}"
        );
        drop(keeps);
    }
}

//! What has to be decided before anything else goes on.

use super::super::says::Says;
use super::Dialogs;
use super::modal_ui;
use super::path::{PathForm, path_ui};
use crate::editor::document::{Answer, Document, Purpose, Question, answer};
use crate::editor::preferences::Preferences;
use crate::editor::texts::path_text;
use bevy::ecs::world::World;
use bevy_egui::egui::{self, Event, InputState, Key, Ui};
use std::path::Path;

/// Shows the document's question, if one is open; true where it is.
pub(super) fn question_ui(
    context: &egui::Context,
    world: &mut World,
    dialogs: &mut Dialogs,
) -> bool {
    let Some(question) = world.resource::<Document>().question.clone() else {
        dialogs.typed_path = None;
        return false;
    };
    let name = world.resource::<Document>().name.clone();
    let mut answered = None;
    let title = match &question {
        Question::Unsaved { .. } => "Unsaved changes",
        Question::Path { purpose, .. } => match purpose {
            Purpose::Open => "Open",
            Purpose::SaveAs => "Save as",
            Purpose::Import => "Import",
            Purpose::Picture => "Picture",
        },
        Question::Waiting { .. } => "A file dialog is open",
        Question::Replace { .. } => "The file exists",
        Question::Changed { .. } => "The file has changed",
        Question::Outside { .. } => "Files outside the folder",
        Question::Rendering { .. } => "A picture is being rendered",
        Question::Recover(_) => "Unsaved work was found",
    };
    let stays = modal_ui(context, title, 460.0, |ui| match &question {
        Question::Unsaved { .. } => {
            ui.label(format!("{name} has changes that are not saved."));
            answered = buttons_ui(
                ui,
                &[
                    ("Save", "Saves the scene, then goes on", Answer::Yes),
                    ("Don't save", "Goes on; the changes are lost", Answer::No),
                    ("Cancel", "Leaves everything as it is", Answer::Cancel),
                ],
            );
        }
        Question::Path {
            purpose,
            suggestion,
            refused,
        } => {
            let form = dialogs.typed_path.get_or_insert_with(|| {
                let preferences = world.get_resource::<Preferences>();
                let recent = preferences.map_or(&[][..], |all| &all.recent_folders);
                PathForm::new(suggestion, recent)
            });
            answered = path_ui(ui, form, *purpose, refused.as_deref());
        }
        Question::Waiting { .. } => {
            ui.label("The desktop's own dialog waits for an answer.");
            answered = buttons_ui(
                ui,
                &[
                    (
                        "Type the path",
                        "Asks here, where no dialog has appeared",
                        Answer::No,
                    ),
                    ("Cancel", "Leaves everything as it is", Answer::Cancel),
                ],
            );
        }
        Question::Replace { file, .. } => {
            ui.label(format!("{} is there already.", path_text(file)));
            answered = buttons_ui(
                ui,
                &[
                    ("Cancel", "Leaves it as it is", Answer::Cancel),
                    ("Replace", "The old file is lost", Answer::Yes),
                ],
            );
        }
        Question::Changed { file } => {
            ui.label(format!(
                "Another program has changed {} since it was opened or saved here.",
                path_text(file)
            ));
            answered = buttons_ui(
                ui,
                &[
                    (
                        "Save as…",
                        "Keeps both: asks for another name for what is open here",
                        Answer::Elsewhere,
                    ),
                    (
                        "Reload",
                        "Opens the file as it is now; the changes made here are lost",
                        Answer::No,
                    ),
                    (
                        "Overwrite",
                        "Saves what is open here; the other program's changes are lost",
                        Answer::Yes,
                    ),
                    ("Cancel", "Leaves everything as it is", Answer::Cancel),
                ],
            );
        }
        Question::Outside { file, says } => {
            ui.label(format!("{}: {says}", path_text(file)));
            ui.label("Open it with files from outside its folder? Do so only if you trust it.");
            answered = buttons_ui(
                ui,
                &[
                    ("Cancel", "Leaves the open scene as it is", Answer::Cancel),
                    (
                        "Open",
                        "Reads files outside the scene's folder too",
                        Answer::Yes,
                    ),
                ],
            );
        }
        Question::Rendering { file } => {
            ui.label(format!("{} is not finished.", path_text(file)));
            answered = buttons_ui(
                ui,
                &[
                    (
                        "Go on",
                        "Leaves everything as it is: it is rendered and written",
                        Answer::Cancel,
                    ),
                    ("Quit", "The picture is not written", Answer::Yes),
                ],
            );
        }
        Question::Recover(found) => {
            let ago = match found.age.as_secs() / 60 {
                0 => "less than a minute ago".to_owned(),
                1 => "about a minute ago".to_owned(),
                minutes @ 2..120 => format!("about {minutes} minutes ago"),
                minutes @ 120..2880 => format!("about {} hours ago", minutes / 60),
                minutes => format!("about {} days ago", minutes / 1440),
            };
            ui.label(format!(
                "{} had changes when Glassbox ended unexpectedly, {ago}.",
                found.name
            ));
            answered = buttons_ui(
                ui,
                &[
                    ("Recover", "Opens what was kept of it", Answer::Yes),
                    ("Delete", "Takes the copy away", Answer::No),
                    ("Later", "Asks again at the next start", Answer::Cancel),
                ],
            );
        }
    });
    // A click beside it is no answer while something else is waited for.
    let leaves = !stays && !matches!(question, Question::Waiting { .. });
    let answered = answered.or(leaves.then_some(Answer::Cancel));
    if let Some(answered) = answered {
        dialogs.typed_path = None;
        answer(world, answered);
    }
    true
}

/// One button for each answer; Enter gives the first, which therefore loses nothing and trusts nobody.
fn buttons_ui(ui: &mut Ui, answers: &[(&str, &str, Answer)]) -> Option<Answer> {
    ui.add_space(8.0);
    let mut answered = None;
    ui.horizontal(|ui| {
        for (name, says, answer) in answers {
            if ui.button(*name).says(says).clicked() {
                answered = Some(answer.clone());
            }
        }
    });
    let enter = ui.input(|input| is_pressed_anew(input, Key::Enter));
    let first = answers.first().filter(|_| enter);
    answered.or(first.map(|(_, _, answer)| answer.clone()))
}

/// Whether a key goes down in this frame. One that is still held from what was answered before answers nothing.
pub(super) fn is_pressed_anew(input: &InputState, key: Key) -> bool {
    input.events.iter().any(|event| {
        matches!(event, Event::Key { key: of, pressed: true, repeat: false, .. } if *of == key)
    })
}

/// Where a path leads to, unless it says so itself.
pub(super) fn whole_path_ui(ui: &mut Ui, path: &Path) {
    let whole = path_text(path);
    if !path.as_os_str().is_empty() && Path::new(&whole) != path {
        ui.weak(whole);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::FileTask;
    use crate::editor::panels::tests::Desk;
    use bevy_egui::egui::Modifiers;

    fn enter(pressed: bool) -> Event {
        Event::Key {
            key: Key::Enter,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: Modifiers::NONE,
        }
    }

    #[test]
    fn enter_replaces_no_file_and_trusts_no_scene() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("a.scn.ron");
        std::fs::write(&file, "old").unwrap();
        let mut desk = Desk::open("cornell-box");
        let name = desk.world().resource::<Document>().name.clone();
        let then = FileTask::SaveAs(file.clone());
        let (of, says) = (file.clone(), "it refers to ../b.png".to_owned());
        for question in [
            Question::Replace {
                file: of.clone(),
                then,
            },
            Question::Outside { file: of, says },
        ] {
            desk.world().resource_mut::<Document>().question = Some(question);
            desk.settle();
            desk.frame(vec![enter(true)]);
            desk.frame(vec![enter(false)]);
            desk.settle();
            let document = desk.world().resource::<Document>();
            assert_eq!(document.question, None);
            assert_eq!(document.name, name);
            assert_eq!(std::fs::read(&file).unwrap(), b"old");
        }
    }

    #[test]
    fn a_key_that_is_still_held_answers_nothing() {
        let mut desk = Desk::open("cornell-box");
        desk.frame(vec![enter(true)]);
        let then = FileTask::New;
        let asked = Some(Question::Unsaved { then });
        desk.world().resource_mut::<Document>().question = asked.clone();
        desk.frame(vec![enter(true)]);
        desk.frame(vec![enter(true)]);
        assert_eq!(desk.world().resource::<Document>().question, asked);
        desk.frame(vec![enter(false)]);
        desk.frame(vec![enter(true)]);
        assert_ne!(desk.world().resource::<Document>().question, asked);
    }
}

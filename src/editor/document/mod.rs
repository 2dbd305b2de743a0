//! The open scene as a file: where it lies, whether it has changed, and what is asked before
//! changes are lost.
//!
//! | module | does |
//! |---|---|
//! | `files` | new, open, save |
//! | `question` | what a person has to decide, and what follows from the answer |
//! | `dialog` | asks for a file: natively where that works, else by a typed path |
//! | `recovery` | copies of unsaved work, and offering them after a crash |
//! | `watch` | meshes and textures that change on disk |
//! | `changed` | the scene's own file that another program changes |
//! | `window` | the title, closing, and files dropped on it |

mod changed;
mod dialog;
mod dialog_native;
mod files;
mod question;
mod recovery;
mod watch;
mod window;

pub(super) use files::{open_file, request};
pub use question::{Answer, FileTask, Purpose, Question, answer};
pub(super) use recovery::give_up_work;
pub use recovery::{Recovered, RecoveryFolder};
pub(super) use window::{picture_at, typed_picture};

use super::command::{AddCommands, Command, commands};
use super::history::{History, commit};
use super::notice::Notices;
use super::schedule::{Dispatch, EditorUpdate};
use crate::io::LoadProblems;
use bevy::app::{App, Last, Plugin};
use bevy::ecs::change_detection::{DetectChanges, DetectChangesMut};
use bevy::ecs::event::Event;
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::{Local, Res, ResMut};
use bevy::ecs::world::World;
use std::path::{Path, PathBuf};

/// Another scene is open. What was picked, chosen or begun is of the one before, and numbers of
/// entities mean others.
#[derive(Event, Clone, Copy, Debug)]
pub struct SceneOpened;

/// The open scene as a file.
#[derive(Resource, Debug)]
pub struct Document {
    /// What the scene is called: its file's name, or the built-in scene's.
    pub name: String,
    /// Where saving writes. `None` for built-in scenes, models, and what was never saved.
    pub path: Option<PathBuf>,
    /// What has to be decided before anything else goes on.
    pub question: Option<Question>,
    /// [`History::state`] when it was last saved; `None` where no state of it was.
    saved: Option<u64>,
    unsaved: bool,
    /// What was waiting for the scene to be saved.
    then: Option<FileTask>,
    /// The path that was given last, while nothing has come of it.
    given: Option<(Purpose, PathBuf)>,
    /// A picture that was chosen, until who asked for it takes it.
    picture: Option<PathBuf>,
}

impl Default for Document {
    fn default() -> Self {
        Self {
            name: "Untitled".into(),
            path: None,
            question: None,
            saved: None,
            unsaved: false,
            then: None,
            given: None,
            picture: None,
        }
    }
}

impl Document {
    /// Whether anything would be lost if it were closed now.
    pub fn unsaved(&self) -> bool {
        self.unsaved
    }

    /// For the window's title: the name, with an asterisk where something is unsaved.
    pub fn title(&self) -> String {
        let star = if self.unsaved { "*" } else { "" };
        format!("{}{star} – Glassbox", self.name)
    }

    /// Another scene was opened, from this file or from none.
    fn opened(&mut self, name: String, path: Option<PathBuf>, state: u64) {
        self.name = name;
        // Work that is recovered may be saved by an editor that was started in another folder.
        self.path = path.map(|path| std::path::absolute(&path).unwrap_or(path));
        self.saved = Some(state);
        self.unsaved = false;
        self.give_up();
    }

    /// Nothing is waited for any more.
    fn give_up(&mut self) {
        (self.then, self.given, self.picture) = (None, None, None);
    }

    /// The picture that was chosen since it was [asked for](ask_for_picture), once.
    pub(super) fn take_picture(&mut self) -> Option<PathBuf> {
        self.picture.take()
    }
}

/// New, open, save, quit; autosave, recovery, reloading, and what a window does with files. Needs
/// [`HistoryPlugin`](super::history::HistoryPlugin) and [`EditsPlugin`](super::edits::EditsPlugin).
#[derive(Default)]
pub struct DocumentPlugin {
    /// Where copies of unsaved work are kept; `None` keeps none.
    pub recovery: Option<PathBuf>,
    /// Whether copies that others have left there are not offered at the start.
    pub leaves_recovered: bool,
    /// The window keeps its own title.
    pub keeps_title: bool,
}

impl Plugin for DocumentPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Document>()
            .init_resource::<Notices>()
            .init_resource::<dialog::Dialogs>()
            .add_commands(commands())
            .add_systems(EditorUpdate, dialog::take_choices.before(Dispatch))
            .add_systems(Last, (note_state, tell_load_problems));
        if let Some(folder) = &self.recovery {
            recovery::add_to(app, folder, !self.leaves_recovered);
        }
        watch::add_to(app);
        changed::add_to(app);
        window::add_to(app, self.keeps_title);
    }
}

fn commands() -> Vec<Command> {
    commands! {
        "file.new" "New" ["Ctrl+N"] "Starts a new scene: a cube on a floor, a lamp above, and a camera that sees them"
            => |world| request(world, FileTask::New); menu("File", 0),
        "file.open" "Open…" ["Ctrl+O"] "Opens a scene or a model: .scn.ron, .obj, .gltf, .glb, .stl, .ply"
            => |world| dialog::ask(world, Purpose::Open); menu("File", 0),
        "file.import" "Import…" ["Ctrl+I"] "Adds a model's meshes, materials, lights and cameras to this scene"
            => |world| dialog::ask(world, Purpose::Import); menu("File", 1); menu("Add", 1),
        "file.save" "Save" ["Ctrl+S"] "Writes the scene to its file"
            => files::save_here; menu("File", 2),
        "file.save-as" "Save as…" ["Ctrl+Shift+S"] "Writes the scene to another file: .scn.ron, .obj or .glb"
            => |world| dialog::ask(world, Purpose::SaveAs); menu("File", 2),
        "file.quit" "Quit" ["Ctrl+Q"] "Closes the editor; asks where changes would be lost"
            => |world| request(world, FileTask::Quit); menu("File", 5),
    }
}

/// Asks for a picture, which [`Document::take_picture`] has when it was chosen.
pub(super) fn ask_for_picture(world: &mut World) {
    world.resource_mut::<Document>().give_up();
    dialog::ask(world, Purpose::Picture);
}

/// Says that the scene came from somewhere: for who opened it with [`io::open`](crate::io::open()).
pub fn adopt(world: &mut World, name: impl Into<String>, path: Option<&Path>) {
    super::history::reset(world);
    let state = world.resource::<History>().state();
    let path = path
        .filter(|path| files::is_scene(path))
        .map(Path::to_path_buf);
    let mut document = world.resource_mut::<Document>();
    document.opened(name.into(), path, state);
    document.question = None;
    world.resource_mut::<Notices>().close_notes();
    world.trigger(SceneOpened);
}

/// Brings [`Document::unsaved`] up to date with the history.
fn note_state(history: Res<History>, mut document: ResMut<Document>) {
    let unsaved = document.saved != Some(history.state());
    if document.unsaved != unsaved {
        document.unsaved = unsaved;
    }
}

/// The same at once.
fn note_state_now(world: &mut World) {
    commit(world);
    let state = world.resource::<History>().state();
    let mut document = world.resource_mut::<Document>();
    let document = document.bypass_change_detection();
    document.unsaved = document.saved != Some(state);
}

/// What could not be loaded is said once.
fn tell_load_problems(
    problems: Option<Res<LoadProblems>>,
    mut told: Local<Vec<String>>,
    mut notices: ResMut<Notices>,
) {
    let Some(problems) = problems.filter(|problems| problems.is_changed()) else {
        return;
    };
    let now: Vec<String> = problems
        .problems
        .iter()
        .map(|problem| format!("{}: {}", problem.what, problem.error))
        .collect();
    for text in &now {
        if !told.contains(text) {
            notices.fault(text.clone());
        }
    }
    *told = now;
}

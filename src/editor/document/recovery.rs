//! Copies of unsaved work, for when the editor does not end as it should.
//!
//! While there are unsaved changes a copy of the scene is written every minute, under a temporary
//! name that is then changed, so that it is complete at any time. Beside it lies a file that this
//! process holds locked: the lock goes with the process, however that ends, so the next editor
//! knows which copies nobody is working on.
//!
//! The copy goes where the work is saved, or somebody said that it shall not be. However else the program ends, by a
//! signal too, a last copy is written where there is time, and stays.

use super::question::Question;
use super::{Document, adopt, note_state_now};
use crate::editor::history::{Gesture, History};
use crate::editor::notice::Notices;
use crate::editor::selection::Selection;
use crate::io::{
    OnDisk, OpenOptions, SceneContent, SceneFiles, SceneSource, TEXT_BYTES, open, open_regular,
    read_text, replace_file,
};
use bevy::app::{App, AppExit, Last, Startup};
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::resource::Resource;
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::Local;
use bevy::ecs::world::{Mut, World};
use serde::{Deserialize, Serialize};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

/// How often unsaved work is copied.
const EVERY: Duration = Duration::from_secs(60);

/// Where copies are kept, and which is this editor's.
#[derive(Resource, Debug)]
pub struct RecoveryFolder {
    folder: PathBuf,
    /// What this editor's files are called.
    session: String,
    /// Held as long as the editor runs.
    lock: Option<File>,
    every: Duration,
    next: Instant,
    /// The state that the copy holds.
    copied: Option<u64>,
    /// The copy that is being written, and of which state.
    writing: Option<(JoinHandle<Result<(), String>>, u64)>,
    failed: bool,
    /// Whether copies of editors that are gone are offered.
    offers: bool,
    /// The state that somebody does not want to keep.
    given_up: Option<u64>,
}

/// Unsaved work of an editor that did not end as it should.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovered {
    /// What the scene was called.
    pub name: String,
    /// Where it lay.
    pub path: Option<PathBuf>,
    /// How old the copy is.
    pub age: Duration,
    /// The scene's file as that editor knew it.
    on_disk: Option<OnDisk>,
    copy: PathBuf,
}

/// What is said about a copy in the file beside it.
#[derive(Serialize, Deserialize)]
struct Label {
    name: String,
    path: Option<PathBuf>,
    /// Of the file at the path.
    #[serde(default)]
    on_disk: Option<OnDisk>,
}

const COPY: &str = "scn.ron";
const LABEL: &str = "label.ron";
const LOCK: &str = "lock";

impl Recovered {
    /// Takes the copy away.
    pub fn delete(&self) {
        for extension in [COPY, LABEL, LOCK] {
            // What cannot be deleted is offered again; nothing is lost by that.
            let _ = fs::remove_file(beside(&self.copy, extension));
        }
    }
}

/// The file of the same editor with another extension.
fn beside(copy: &Path, extension: &str) -> PathBuf {
    let name = copy.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.split('.').next().unwrap_or_default();
    copy.with_file_name(format!("{stem}.{extension}"))
}

pub(super) fn add_to(app: &mut App, folder: &Path, offers: bool) {
    app.insert_resource(RecoveryFolder {
        folder: folder.to_path_buf(),
        session: session_name(),
        lock: None,
        every: EVERY,
        next: Instant::now() + EVERY,
        copied: None,
        writing: None,
        failed: false,
        offers,
        given_up: None,
    })
    .add_systems(Startup, offer)
    .add_systems(Last, (copy_unsaved, end).chain());
}

/// Another for every editor: process numbers are used again.
fn session_name() -> String {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
    let since = since.map_or(0, |since| since.as_nanos());
    format!("{}-{since}", std::process::id())
}

/// Looks for work that nobody is doing any more.
fn offer(world: &mut World) {
    let asked = world.resource::<Document>().question.is_some();
    if asked || !world.resource::<RecoveryFolder>().offers {
        // Next time.
        return;
    }
    let folder = world.resource::<RecoveryFolder>().folder.clone();
    let mut found: Vec<Recovered> = abandoned(&folder);
    found.sort_by_key(|found| found.age);
    if let Some(newest) = found.into_iter().next() {
        world.resource_mut::<Document>().question = Some(Question::Recover(newest));
    }
}

/// Copies whose editor is gone.
fn abandoned(folder: &Path) -> Vec<Recovered> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let read = |copy: PathBuf| -> Option<Recovered> {
        if !copy.file_name()?.to_str()?.ends_with(".scn.ron") {
            return None;
        }
        let lock = beside(&copy, LOCK);
        if let Ok(lock) = open_regular(&lock)
            && lock.try_lock().is_err()
        {
            return None;
        }
        let age = fs::metadata(&copy).ok()?.modified().ok()?.elapsed();
        let label = read_text(&beside(&copy, LABEL), TEXT_BYTES).ok();
        let label = label.and_then(|text| ron::from_str::<Label>(&text).ok());
        let label = label.unwrap_or_else(|| Label {
            name: "a scene".into(),
            path: None,
            on_disk: None,
        });
        Some(Recovered {
            name: label.name,
            path: label.path,
            on_disk: label.on_disk,
            age: age.unwrap_or_default(),
            copy,
        })
    };
    entries
        .flatten()
        .filter_map(|entry| read(entry.path()))
        .collect()
}

/// Opens what was recovered: unsaved, and called what it was called.
pub(super) fn recover(world: &mut World, found: &Recovered) {
    let source = SceneSource::File(found.copy.clone());
    let files = world.get_resource::<SceneFiles>();
    let limits = files.map(|files| files.limits.clone());
    // Its paths lead from our folder to wherever the files lie.
    let options = OpenOptions {
        allow_outside: true,
        tolerant: true,
        limits: limits.unwrap_or_default(),
        unframed: false,
    };
    if let Err(error) = open(world, &source, options) {
        world.resource_mut::<Notices>().fault(error.to_string());
        return;
    }
    world.resource_mut::<Selection>().set([]);
    let on_disk = found.on_disk.clone();
    world.resource_mut::<SceneFiles>().set_on_disk(on_disk);
    adopt(world, found.name.clone(), found.path.as_deref());
    let mut document = world.resource_mut::<Document>();
    document.saved = None;
    document.unsaved = true;
    finish_copy(world);
    if let Some(mut folder) = world.get_resource_mut::<RecoveryFolder>() {
        // The copy is deleted: until it is saved this editor needs one of its own.
        folder.copied = None;
    }
    copy_now(world);
    if finish_copy(world) {
        found.delete();
    }
}

/// Waits for the copy that is being written. True where there is one that is complete.
fn finish_copy(world: &mut World) -> bool {
    let recovery = world.get_resource_mut::<RecoveryFolder>();
    let Some((writing, state)) = recovery.and_then(|mut recovery| recovery.writing.take()) else {
        return false;
    };
    let written = writing.join().unwrap_or_else(|_| Err("a bug".to_owned()));
    let mut recovery = world.resource_mut::<RecoveryFolder>();
    match written {
        Ok(()) => {
            recovery.copied = Some(state);
            let again = std::mem::take(&mut recovery.failed);
            if again {
                let mut notices = world.resource_mut::<Notices>();
                notices.tell("unsaved work is copied again");
            }
            true
        }
        Err(why) => {
            complain(world, &why);
            false
        }
    }
}

/// Each time: the next try is a minute away, and the work is at risk until it succeeds.
fn complain(world: &mut World, why: &str) {
    world.resource_mut::<RecoveryFolder>().failed = true;
    let text = format!("unsaved work is not copied: {why}");
    world.resource_mut::<Notices>().fault(text);
}

/// The program ends, and the work as it is now need not be kept: somebody said so, or a script ends it. Nobody says so of
/// work that stays open: where another scene was to be opened instead and could not be, the copy is still wanted.
pub(in crate::editor) fn give_up_work(world: &mut World) {
    world.resource_mut::<Gesture>().end();
    note_state_now(world);
    let state = Some(world.resource::<History>().state());
    if let Some(mut recovery) = world.get_resource_mut::<RecoveryFolder>() {
        recovery.given_up = state;
    }
}

/// Writes a copy where there is something that no file and no copy holds, once a minute.
fn copy_unsaved(world: &mut World) {
    let Some(recovery) = world.get_resource::<RecoveryFolder>() else {
        return;
    };
    match &recovery.writing {
        Some((writing, _)) if !writing.is_finished() => return,
        Some(_) => {
            finish_copy(world);
        }
        None => {}
    }
    // A file holds the work, and a copy of what it was before would be offered as work that none holds.
    if !world.resource::<Document>().unsaved {
        world.resource_mut::<RecoveryFolder>().remove();
    }
    if world.resource::<RecoveryFolder>().next <= Instant::now() {
        copy_now(world);
    }
}

/// Begins a copy, if there is something that no file and no copy holds.
fn copy_now(world: &mut World) {
    if !world.contains_resource::<RecoveryFolder>() {
        return;
    }
    let result = world.resource_scope(|world, mut recovery: Mut<RecoveryFolder>| {
        recovery.next = Instant::now() + recovery.every;
        let state = world.resource::<History>().state();
        let document = world.resource::<Document>();
        if !document.unsaved {
            recovery.remove();
            return Ok(());
        }
        if recovery.copied == Some(state) {
            return Ok(());
        }
        let files = world.get_resource::<SceneFiles>();
        let label = Label {
            name: document.name.clone(),
            path: document.path.clone(),
            on_disk: files.and_then(SceneFiles::on_disk).cloned(),
        };
        recovery.begin(world, label, state)
    });
    if let Err(why) = result {
        complain(world, &why);
    }
}

impl RecoveryFolder {
    /// How often unsaved work is copied, from now on; a minute where nothing is said.
    pub fn copy_every(&mut self, every: Duration) {
        self.every = every;
        self.next = Instant::now();
    }

    fn file(&self, extension: &str) -> PathBuf {
        self.folder.join(format!("{}.{extension}", self.session))
    }

    /// Takes the scene's content, and writes it on a thread of its own.
    fn begin(&mut self, world: &mut World, label: Label, state: u64) -> Result<(), String> {
        if self.lock.is_none() {
            fs::create_dir_all(&self.folder)
                .map_err(|error| format!("{}: {error}", self.folder.display()))?;
            let file = self.file(LOCK);
            let lock =
                File::create(&file).map_err(|error| format!("{}: {error}", file.display()))?;
            lock.try_lock()
                .map_err(|error| format!("{}: {error}", file.display()))?;
            self.lock = Some(lock);
        }
        let (copy, beside) = (self.file(COPY), self.file(LABEL));
        let content = SceneContent::of_scene(world, &copy).map_err(|error| error.to_string())?;
        let write = move || {
            let label = ron::to_string(&label).map_err(|error| error.to_string())?;
            if fs::read(&beside).is_ok_and(|old| old != label.as_bytes()) {
                // Of another scene than the copy will be: a copy without one is saved over no file.
                fs::remove_file(&beside).map_err(|error| error.to_string())?;
            }
            content
                .write(&copy)
                .and_then(|_| replace_file(&beside, |out| out.write_all(label.as_bytes())))
                .map_err(|error| error.to_string())
        };
        let thread = thread::Builder::new().name("autosave".into()).spawn(write);
        let thread = thread.map_err(|error| error.to_string())?;
        self.writing = Some((thread, state));
        Ok(())
    }

    /// Takes this editor's copy away.
    fn remove(&mut self) {
        if let Some((writing, _)) = self.writing.take() {
            // What it wrote is deleted.
            let _ = writing.join();
        }
        if self.lock.take().is_some() {
            for extension in [COPY, LABEL, LOCK] {
                let _ = fs::remove_file(self.file(extension));
            }
        }
        self.copied = None;
    }
}

/// The program ends. An exit alone is nobody's consent: Ctrl+C in a terminal asks for one too.
fn end(world: &mut World, mut exits: Local<MessageCursor<AppExit>>) {
    if exits
        .read(world.resource::<Messages<AppExit>>())
        .next()
        .is_none()
    {
        return;
    }
    // What is dragged or typed until now is work, too.
    world.resource_mut::<Gesture>().end();
    note_state_now(world);
    let state = world.resource::<History>().state();
    let unsaved = world.resource::<Document>().unsaved;
    let mut recovery = world.resource_mut::<RecoveryFolder>();
    if !unsaved || recovery.given_up == Some(state) {
        recovery.remove();
        return;
    }
    finish_copy(world);
    copy_now(world);
    finish_copy(world);
    let kept = world.resource::<RecoveryFolder>().copied == Some(state);
    let what = match kept {
        true => "note: unsaved work was kept; the next start offers it",
        false => "error: unsaved work could not be kept",
    };
    // The window is gone, and where standard error is closed nobody listens.
    let _ = writeln!(std::io::stderr(), "{what}");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::edits::rename;
    use crate::editor::headless_editor;
    use crate::scene::SceneId;

    #[test]
    fn what_is_being_dragged_or_typed_is_kept_when_the_program_is_ended() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = headless_editor();
        add_to(&mut app, folder.path(), false);
        let world = app.world_mut();
        world.spawn((SceneId(1), crate::scene::PointLamp::default()));
        adopt(world, "nothing", None);
        app.update();
        let world = app.world_mut();
        world.resource_mut::<Gesture>().begin("Drag");
        rename(world, SceneId(1), "Dragged");
        world.write_message(AppExit::Success);
        app.update();
        let copy = app.world().resource::<RecoveryFolder>().file(COPY);
        let kept = fs::read_to_string(copy).unwrap();
        assert!(kept.contains("Dragged"), "{kept}");
    }

    #[test]
    fn what_is_being_dragged_is_given_up_with_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let mut app = headless_editor();
        add_to(&mut app, folder.path(), false);
        let world = app.world_mut();
        world.spawn((SceneId(1), crate::scene::PointLamp::default()));
        adopt(world, "nothing", None);
        app.update();
        let world = app.world_mut();
        world.resource_mut::<Gesture>().begin("Drag");
        rename(world, SceneId(1), "Dragged");
        give_up_work(world);
        world.write_message(AppExit::Success);
        app.update();
        assert!(!app.world().resource::<RecoveryFolder>().file(COPY).exists());
    }
}

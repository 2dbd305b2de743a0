//! Meshes and textures that change on disk are loaded again.
//!
//! A thread looks at the files once a second. Asking for the time of a few dozen files takes
//! microseconds, works the same on every system and on network drives, where notifications do not
//! arrive, and needs no library. A file that has changed is loaded when it has stood still from one
//! look to the next, on that thread, and replaces what was loaded before. Where it cannot be loaded
//! what was loaded before stays.

use crate::editor::notice::Notices;
use crate::editor::schedule::EditorUpdate;
use crate::editor::texts::file_name;
use crate::io::{Folder, Limits, Reloaded, SceneFiles, SourceFile, beside, source_files};
use crate::scene::{Environment, MeshSource, Phong};
use bevy::app::App;
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::query::{Changed, Or};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Local, Query, Res};
use bevy::ecs::world::World;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant, SystemTime};

/// How often files are looked at.
const EVERY: Duration = Duration::from_secs(1);

/// What is watched.
struct Order {
    files: Vec<SourceFile>,
    folder: Folder,
    limits: Limits,
}

/// What became of a file that changed.
struct News {
    file: PathBuf,
    /// Of the scene that named it: the same path means another file in another folder.
    folder: Folder,
    result: Result<Reloaded, String>,
}

/// The thread that looks at files.
#[derive(Resource)]
struct Watcher {
    orders: Mutex<Sender<Order>>,
    news: Mutex<Receiver<News>>,
    asked: Vec<SourceFile>,
    next: Instant,
    /// Something may name other files than before.
    stale: bool,
}

pub(super) fn add_to(app: &mut App) {
    let (orders, inbox) = channel();
    let (outbox, news) = channel();
    let thread = thread::Builder::new()
        .name("watch".into())
        .spawn(move || work(&inbox, &outbox));
    if thread.is_err() {
        // A system without threads to spare: files are then not watched.
        return;
    }
    app.insert_resource(Watcher {
        orders: Mutex::new(orders),
        news: Mutex::new(news),
        asked: Vec::new(),
        next: Instant::now(),
        stale: true,
    })
    .add_systems(EditorUpdate, (note_changes, watch));
}

type NamesFiles = Or<(Changed<MeshSource>, Changed<Phong>)>;

fn note_changes(
    changed: Query<(), NamesFiles>,
    environment: Option<Res<Environment>>,
    files: Option<Res<SceneFiles>>,
    mut watcher: bevy::ecs::system::ResMut<Watcher>,
) {
    use bevy::ecs::change_detection::DetectChangesMut;
    if !changed.is_empty()
        || environment.is_some_and(|environment| environment.is_changed())
        || files.is_some_and(|files| files.is_changed())
    {
        watcher.bypass_change_detection().stale = true;
    }
}

/// Tells the thread what to watch, and takes over what it loaded.
fn watch(world: &mut World, mut told: Local<HashMap<PathBuf, String>>) {
    let Some(mut watcher) = world.get_resource_mut::<Watcher>() else {
        return;
    };
    let mut news = Vec::new();
    if let Ok(inbox) = watcher.news.get_mut() {
        news.extend(inbox.try_iter());
    }
    let due = watcher.stale && watcher.next <= Instant::now();
    for News {
        file,
        folder,
        result,
    } in news
    {
        let open = world.get_resource::<SceneFiles>();
        if open.is_none_or(|open| open.folder.path != folder.path) {
            continue;
        }
        let name = file_name(&file);
        match result {
            Ok(reloaded) => {
                told.remove(&file);
                if reloaded.apply(world) {
                    let mut notices = world.resource_mut::<Notices>();
                    notices.tell(format!("{name} has changed and was loaded again"));
                }
            }
            Err(why) => {
                if told.insert(file, why.clone()) != Some(why.clone()) {
                    let text = format!("{why}; what was loaded before stays");
                    world.resource_mut::<Notices>().fault(text);
                }
            }
        }
    }
    if due {
        order(world);
    }
}

fn order(world: &mut World) {
    let files = source_files(world);
    let Some(scene) = world.get_resource::<SceneFiles>() else {
        return;
    };
    let (folder, mut limits) = (scene.folder.clone(), scene.limits.clone());
    limits.memory = beside(&limits.memory, world);
    let mut watcher = world.resource_mut::<Watcher>();
    watcher.stale = false;
    watcher.next = Instant::now() + EVERY;
    if watcher.asked == files {
        return;
    }
    watcher.asked.clone_from(&files);
    if let Ok(orders) = watcher.orders.get_mut() {
        // It fails only where the thread is gone, and then nothing is watched any more.
        let _ = orders.send(Order {
            files,
            folder,
            limits,
        });
    }
}

/// When a file was written last, and its size; `None` where it is not there.
pub(super) type Stamp = Option<(SystemTime, u64)>;

pub(super) fn stamp(file: &Path) -> Stamp {
    let metadata = std::fs::metadata(file).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

#[derive(Clone, Copy)]
struct Seen {
    /// Of what was loaded.
    loaded: Stamp,
    /// At the last look.
    last: Stamp,
}

/// Until the editor is gone.
fn work(inbox: &Receiver<Order>, outbox: &Sender<News>) {
    let mut order: Option<Order> = None;
    let mut seen: HashMap<PathBuf, Seen> = HashMap::new();
    loop {
        match inbox.recv_timeout(EVERY) {
            Ok(new) => {
                let mut known = std::mem::take(&mut seen);
                for file in &new.files {
                    let now = stamp(&file.file);
                    let fresh = Seen {
                        loaded: now,
                        last: now,
                    };
                    let old = known.remove(&file.file).unwrap_or(fresh);
                    seen.insert(file.file.clone(), old);
                }
                order = Some(new);
                continue;
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return,
        }
        let Some(order) = &order else { continue };
        for file in &order.files {
            let Some(seen) = seen.get_mut(&file.file) else {
                continue;
            };
            let now = stamp(&file.file);
            let stands_still = seen.last == now;
            seen.last = now;
            if now == seen.loaded || !stands_still {
                continue;
            }
            seen.loaded = now;
            let result = file
                .load(&order.folder, &order.limits)
                .map_err(|error| error.to_string());
            let news = News {
                file: file.file.clone(),
                folder: order.folder.clone(),
                result,
            };
            if outbox.send(news).is_err() {
                return;
            }
        }
    }
}

//! Another program writes the open scene's file. That is noticed when the window is turned to again, and while it is in
//! front, before anybody works on with what is no longer true.
//!
//! The file's time and size are looked at, which costs microseconds; only where they have changed is it read. What was
//! asked once is asked again when the file changes again, and where it would be written over.

use super::watch::{Stamp, stamp};
use super::{Document, Question};
use crate::editor::history::Gesture;
use crate::editor::schedule::EditorUpdate;
use crate::io::has_changed;
use bevy::app::App;
use bevy::ecs::message::{MessageCursor, Messages};
use bevy::ecs::system::Local;
use bevy::ecs::world::World;
use bevy::window::{Window, WindowFocused};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// How often the file is looked at while the window is in front.
const EVERY: Duration = Duration::from_secs(2);

pub(super) fn add_to(app: &mut App) {
    app.add_message::<WindowFocused>()
        .add_systems(EditorUpdate, look);
}

/// What was seen last.
#[derive(Default)]
struct Seen {
    path: Option<PathBuf>,
    stamp: Stamp,
    at: Option<Instant>,
    /// The window was turned to, and there was no time to look.
    is_due: bool,
}

fn look(
    world: &mut World,
    mut focused: Local<MessageCursor<WindowFocused>>,
    mut seen: Local<Seen>,
) {
    let messages = world.resource::<Messages<WindowFocused>>();
    seen.is_due |= focused.read(messages).any(|message| message.focused);
    let rested = seen.at.is_none_or(|at| at.elapsed() >= EVERY);
    if !seen.is_due && rested {
        let mut windows = world.query::<&Window>();
        seen.is_due = windows.iter(world).any(|window| window.focused);
    }
    if !seen.is_due || world.resource::<Gesture>().active() {
        return;
    }
    let document = world.resource::<Document>();
    if document.question.is_some() {
        return;
    }
    seen.is_due = false;
    seen.at = Some(Instant::now());
    let Some(path) = document.path.clone() else {
        return;
    };
    let now = stamp(&path);
    if seen.path.as_ref() == Some(&path) && seen.stamp == now {
        return;
    }
    seen.stamp = now;
    seen.path = Some(path.clone());
    if has_changed(world, &path) {
        world.resource_mut::<Document>().question = Some(Question::Changed { file: path });
    }
}

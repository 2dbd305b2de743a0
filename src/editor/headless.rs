//! The editor without a window, for whoever drives it by program.

use super::dispatch::DispatchPlugin;
use super::document::DocumentPlugin;
use super::edits::EditsPlugin;
use super::history::HistoryPlugin;
use super::render_job::RenderJobPlugin;
use crate::app::headless_app_with;
use bevy::app::App;
use std::path::Path;

/// Scenes, files, edits and undo, without a renderer, a window or an event loop: send
/// [`Action`](super::Action)s and call `update`.
pub fn headless_editor() -> App {
    editor(DocumentPlugin::default())
}

/// The same, with copies of unsaved work in this folder.
pub fn headless_editor_with_recovery(folder: &Path) -> App {
    editor(DocumentPlugin {
        recovery: Some(folder.to_path_buf()),
        ..DocumentPlugin::default()
    })
}

fn editor(document: DocumentPlugin) -> App {
    headless_app_with((
        DispatchPlugin,
        HistoryPlugin,
        EditsPlugin,
        document,
        RenderJobPlugin,
    ))
}

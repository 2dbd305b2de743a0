//! The editor without a window: edits, undo, files.

mod changed;
mod files;
mod light_edits;
mod pasting;
mod random;
mod recovery;
mod rendering;
mod scene_copy;
mod steps;
mod tasks;

use bevy::app::App;
use glassbox::editor::history::History;
use glassbox::editor::{Action, headless_editor};
use glassbox::io::{OpenOptions, SceneSource, open};
use glassbox::scene::SceneId;

/// An editor with a built-in scene open, after its first frame.
fn editor(scene: &str) -> App {
    let mut app = headless_editor();
    open(
        app.world_mut(),
        &SceneSource::named(scene),
        OpenOptions::default(),
    )
    .unwrap_or_else(|error| panic!("{error}"));
    glassbox::editor::document::adopt(app.world_mut(), scene, None);
    app.update();
    app.update();
    app
}

/// Asks for something, and waits until it is done.
fn act(app: &mut App, action: Action) {
    app.world_mut().write_message(action);
    app.update();
}

fn history(app: &App) -> &History {
    app.world().resource::<History>()
}

/// The entity with this name.
fn named(app: &mut App, name: &str) -> SceneId {
    let world = app.world_mut();
    let mut names = world.query::<(&SceneId, &bevy::prelude::Name)>();
    let found = names.iter(world).find(|(_, other)| other.as_str() == name);
    *found
        .unwrap_or_else(|| panic!("nothing is called {name}"))
        .0
}

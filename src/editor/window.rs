//! The editor as a program: its window, and the scene that it opens with.

use super::document::{DocumentPlugin, open_file};
use super::pace::PacePlugin;
use super::plugins::parts;
use super::preferences::config_folder;
use super::script::Script;
use crate::io::{Limits, SceneFiles, SceneSource};
use crate::view::TracedPickingPlugin;
use bevy::DefaultPlugins;
use bevy::app::{App, AppExit, PluginGroup, PluginGroupBuilder};
use bevy::log::{Level, LogPlugin};
use bevy::window::{Window, WindowPlugin};
use std::path::Path;
use std::process::ExitCode;

/// Nobody observes pointers in the editor's own window: nothing is picked for them.
fn parts_of_program(document: DocumentPlugin) -> PluginGroupBuilder {
    parts(document).disable::<TracedPickingPlugin>()
}

/// Opens the window with this scene, until it is closed, and plays the script in it. All scenes that are opened share
/// the limits.
pub fn run(scene: SceneSource, script: Option<Script>, limits: Limits) -> ExitCode {
    let mut app = App::new();
    let window = WindowPlugin {
        primary_window: Some(Window {
            title: "Glassbox".into(),
            resolution: (1280, 720).into(),
            ..Window::default()
        }),
        // The document asks first, where changes would be lost.
        close_when_requested: false,
        ..WindowPlugin::default()
    };
    // What the renderer says of the machine is nobody's concern; RUST_LOG asks for it.
    let log = LogPlugin {
        level: Level::ERROR,
        filter: "glassbox=info".into(),
        ..LogPlugin::default()
    };
    let document = DocumentPlugin {
        recovery: config_folder().map(|folder| folder.join("recovery")),
        // A script finds the same editor every time.
        leaves_recovered: script.is_some(),
        ..DocumentPlugin::default()
    };
    app.add_plugins(DefaultPlugins.set(window).set(log))
        .add_plugins(parts_of_program(document))
        .add_plugins(PacePlugin);
    #[cfg(unix)]
    app.add_plugins(super::signals::SignalsPlugin);
    let world = app.world_mut();
    world.resource_mut::<SceneFiles>().limits = limits;
    match &scene {
        SceneSource::File(path) => open_file(world, path, false),
        SceneSource::Builtin(scene) => open_file(world, Path::new(scene.name), false),
    }
    if let Some(script) = script {
        script.play_in(&mut app);
    }
    match app.run() {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_picked_for_pointers_in_the_editors_own_window() {
        let program = parts_of_program(DocumentPlugin::default());
        assert!(!program.enabled::<TracedPickingPlugin>());
        let guest = parts(DocumentPlugin::default());
        assert!(guest.enabled::<TracedPickingPlugin>());
    }
}

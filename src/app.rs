//! The app that the command line runs: everything but a window.

use crate::io::IoPlugin;
use crate::scene::ScenePlugin;
use crate::sync::{SyncPlugin, TreeBuilding};
use bevy::app::{App, Plugins, TaskPoolPlugin};
use bevy::asset::{AssetApp, AssetPlugin};
use bevy::camera::visibility::VisibilityPlugin;
use bevy::ecs::schedule::{Schedules, SingleThreadedExecutor};
use bevy::image::Image;
use bevy::mesh::MeshPlugin;
use bevy::transform::TransformPlugin;

/// Scenes, files and the sync to the tracer's world, without a renderer, a window or an event loop.
///
/// Spawn entities or [`open`](crate::io::open) a scene, call `update` once, and read
/// [`Traced`](crate::sync::Traced) and [`TracedCameras`](crate::sync::TracedCameras).
/// Systems run on the calling thread, and trees are built there and then
/// ([`TreeBuilding::AtOnce`]), in the rayon pool it belongs to.
pub fn headless_app() -> App {
    headless_app_with(())
}

/// The same with more plugins, an app's own or `view::StandardMappingPlugin` for a scene of Bevy's
/// materials and lights.
pub fn headless_app_with<M>(plugins: impl Plugins<M>) -> App {
    let mut app = App::new();
    app.add_plugins((
        TaskPoolPlugin::default(),
        // Reads no files: scenes load their own, and check where these lie.
        AssetPlugin::default(),
        TransformPlugin,
        MeshPlugin,
        VisibilityPlugin,
    ))
    .init_asset::<Image>()
    .add_plugins((ScenePlugin, IoPlugin, SyncPlugin))
    .insert_resource(TreeBuilding::AtOnce)
    .add_plugins(plugins);
    app.finish();
    app.cleanup();
    let mut schedules = app.world_mut().resource_mut::<Schedules>();
    for (_, schedule) in schedules.iter_mut() {
        schedule.set_executor(SingleThreadedExecutor::new());
    }
    app
}

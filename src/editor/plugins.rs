//! The plugins that make up the editor: in its own window, and over an app's own scene.

use super::cameras::CamerasPlugin;
use super::dispatch::DispatchPlugin;
use super::document::DocumentPlugin;
use super::edits::EditsPlugin;
use super::embed::EmbedPlugin;
use super::handles::HandlesPlugin;
use super::history::HistoryPlugin;
use super::inspection::InspectionPlugin;
use super::keys::KeysPlugin;
use super::navigation::NavigationPlugin;
use super::notice::Notices;
use super::panels::PanelsPlugin;
use super::pointer::PointerPlugin;
use super::render_job::RenderJobPlugin;
use super::selection::Selection;
use super::trees::TreesPlugin;
use super::viewport::{self, RegionDrag, Viewport};
use crate::view::{GlassboxPlugins, RasterPlugin, SymbolsPlugin};
use bevy::app::{App, Plugin, PluginGroup, PluginGroupBuilder};

/// The editor over the scene of an app of its own, in the app's window.
///
/// ```no_run
/// # use bevy::prelude::*;
/// App::new()
///     .add_plugins((DefaultPlugins, glassbox::editor::EditorPlugins))
///     .run();
/// ```
///
/// **Expects** `DefaultPlugins` with a primary window. It contains
/// [`GlassboxPlugins`](crate::view::GlassboxPlugins): add one of the two. An app with egui panels of
/// its own adds its `EguiPlugin` before, and a camera with a `PrimaryEguiContext` is the editor's.
///
/// **Adds** the tracer, the panels, a camera that looks at the scene, undo, and files. The scene is
/// what the app has spawned: every mesh with its `StandardMaterial`, every light and every 3-D
/// camera of the window, by the table of
/// [`StandardMappingPlugin`](crate::view::StandardMappingPlugin); entities with
/// [`NotTraced`](crate::scene::NotTraced) are left out. The view begins where the app's first camera
/// stands.
///
/// **While it is on** ([`Editing`](super::Editing), which the app may switch) the app's cameras of that window rest,
/// and so does its picking: no observer of the app's hears of the editor's clicks. What the editor draws lies in
/// layers of its own ([`OVERLAY_LAYER`](crate::view::OVERLAY_LAYER)), which the app's cameras do not show.
/// The app's systems go on; those that shall not are given the run condition `not(in_editor)`
/// ([`in_editor`](super::in_editor)). What they do to the scene is shown and is no step: undo takes back only what was
/// done in the editor. A deleted entity is disabled until undo brings it back: it is the same `Entity`, with its
/// observers and all that hangs on it, and no observer hears of its components. It is despawned when another
/// scene is opened.
///
/// **Components of the app's own** that are registered for reflection are shown in the inspector, edited by their fields,
/// undone, copied and given to other entities. Scene files keep those that the app
/// [asks for](crate::io::KeepInSceneFiles).
///
/// **Does not touch** the app's assets, its window's title, how often it draws, or its files. An
/// edit of a place, a name, a visibility or a camera's field of view is one of the app's own
/// components; an edit of a material or a light reaches the traced picture alone, until the app
/// changes its own. New and Open do remove the scene's entities, those of the app too. Saving keeps
/// what Glassbox knows: meshes that the app made itself are named as left out. For a question before
/// unsaved changes are lost set `WindowPlugin::close_when_requested` to false: the window's button then ends the app, or
/// asks, which switches the editor on.
pub struct EditorPlugins;

impl PluginGroup for EditorPlugins {
    fn build(self) -> PluginGroupBuilder {
        parts(DocumentPlugin {
            keeps_title: true,
            ..DocumentPlugin::default()
        })
        .add(EmbedPlugin)
    }
}

/// What the editor consists of wherever it runs.
pub(super) fn parts(document: DocumentPlugin) -> PluginGroupBuilder {
    PluginGroupBuilder::start::<EditorPlugins>()
        .add_group(GlassboxPlugins)
        .add(RasterPlugin)
        .add(SymbolsPlugin)
        .add(StatePlugin)
        .add(DispatchPlugin)
        .add(HistoryPlugin)
        .add(EditsPlugin)
        .add(document)
        .add(RenderJobPlugin)
        .add(PanelsPlugin)
        .add(CamerasPlugin)
        .add(NavigationPlugin)
        .add(PointerPlugin)
        .add(KeysPlugin)
        .add(HandlesPlugin)
        .add(InspectionPlugin)
        .add(TreesPlugin)
}

/// What several of the plugins read and write.
pub(super) struct StatePlugin;

impl Plugin for StatePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Selection>()
            .init_resource::<Viewport>()
            .init_resource::<RegionDrag>()
            .init_resource::<Notices>()
            .add_observer(viewport::forget_scene);
    }
}

//! The app with a window: its plugins, and the two cameras that draw into it.

use super::action::Action;
use super::document::{DocumentPlugin, adopt};
use super::edits::EditsPlugin;
use super::handles::HandlesPlugin;
use super::history::HistoryPlugin;
use super::inspection::InspectionPlugin;
use super::keys::KeysPlugin;
use super::navigation::NavigationPlugin;
use super::notice::Notices;
use super::pace::PacePlugin;
use super::panels::PanelsPlugin;
use super::pointer::PointerPlugin;
use super::preferences::config_folder;
use super::render_job::RenderJobPlugin;
use super::script::Script;
use super::selection::Selection;
use super::viewport::{EditorCamera, Viewport};
use crate::io::{OpenOptions, SceneSource, open};
use crate::view::{GlassboxPlugins, RASTER_LAYER, RasterPlugin, SymbolsPlugin, TracedView, raster};
use bevy::DefaultPlugins;
use bevy::app::{App, AppExit, PluginGroup, PostUpdate, PreStartup};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, Camera2d, ClearColorConfig, PerspectiveProjection, Projection};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::query::With;
use bevy::ecs::system::{Commands, Res, Single};
use bevy::gizmos::transform_gizmo::TransformGizmoCamera;
use bevy::math::Vec2;
use bevy::prelude::IntoScheduleConfigs;
use bevy::render::view::Msaa;
use bevy::transform::TransformSystems;
use bevy::window::{PrimaryWindow, Window, WindowPlugin};
use bevy_egui::{EguiGlobalSettings, EguiStartupSet, PrimaryEguiContext};
use std::process::ExitCode;

/// The layer that holds the editor's user interface.
const UI_LAYER: usize = 30;

/// Opens the window with this scene, until it is closed, and plays the script in it.
pub fn run(scene: SceneSource, script: Option<Script>) -> ExitCode {
    let mut app = App::new();
    app.add_plugins(DefaultPlugins.set(WindowPlugin {
        primary_window: Some(Window {
            title: "Glassbox".into(),
            resolution: (1280, 720).into(),
            ..Window::default()
        }),
        // The document asks first, where changes would be lost.
        close_when_requested: false,
        ..WindowPlugin::default()
    }))
    .add_plugins((
        GlassboxPlugins,
        RasterPlugin,
        SymbolsPlugin,
        HistoryPlugin,
        EditsPlugin,
        DocumentPlugin {
            // A script finds the same editor every time.
            recovery: config_folder()
                .filter(|_| script.is_none())
                .map(|folder| folder.join("recovery")),
        },
        RenderJobPlugin,
        PanelsPlugin,
    ))
    .add_plugins((
        NavigationPlugin,
        PointerPlugin,
        KeysPlugin,
        HandlesPlugin,
        InspectionPlugin,
        PacePlugin,
    ))
    .add_message::<Action>()
    .init_resource::<Selection>()
    .init_resource::<Viewport>()
    .init_resource::<Notices>()
    .insert_resource(EguiGlobalSettings {
        auto_create_primary_context: false,
        ..EguiGlobalSettings::default()
    })
    .add_systems(
        PreStartup,
        spawn_cameras.before(EguiStartupSet::InitContexts),
    )
    .add_systems(PostUpdate, fit_viewport.before(TransformSystems::Propagate));
    let world = app.world_mut();
    let path = match &scene {
        SceneSource::File(path) => Some(path.clone()),
        SceneSource::Builtin(_) => None,
    };
    match open(world, &scene, OpenOptions::default()) {
        Ok(opened) => {
            adopt(world, opened.name, path.as_deref());
            for note in opened.notes {
                world.resource_mut::<Notices>().tell(note);
            }
        }
        Err(problem) => world.resource_mut::<Notices>().fault(problem.to_string()),
    }
    if let Some(script) = script {
        script.play_in(&mut app);
    }
    match app.run() {
        AppExit::Success => ExitCode::SUCCESS,
        AppExit::Error(code) => ExitCode::from(code.get()),
    }
}

/// One camera for the scene, one for the panels.
fn spawn_cameras(mut commands: Commands) {
    commands.spawn((
        EditorCamera,
        TransformGizmoCamera,
        TracedView::default(),
        Msaa::Off,
        raster::exposure(),
        RenderLayers::from_layers(&[0, RASTER_LAYER]),
        Projection::Perspective(PerspectiveProjection::default()),
    ));
    commands.spawn((
        PrimaryEguiContext,
        Camera2d,
        Msaa::Off,
        RenderLayers::layer(UI_LAYER),
        Camera {
            // The handles' camera is between the two.
            order: 2,
            clear_color: ClearColorConfig::None,
            ..Camera::default()
        },
    ));
}

/// The scene's camera draws into the part of the window that the panels leave free.
fn fit_viewport(
    viewport: Res<Viewport>,
    window: Single<&Window, With<PrimaryWindow>>,
    camera: Single<(&mut Camera, &mut TracedView, &mut RenderLayers), With<EditorCamera>>,
) {
    let (mut camera, mut view, mut layers) = camera.into_inner();
    let scale = window.scale_factor();
    let whole = window.physical_size();
    let min = (viewport.rect.min * scale)
        .round()
        .max(Vec2::ZERO)
        .as_uvec2();
    let max = (viewport.rect.max * scale)
        .round()
        .max(Vec2::ZERO)
        .as_uvec2();
    let max = max.min(whole);
    let is_empty = min.x >= max.x || min.y >= max.y;
    let wanted = (!is_empty).then(|| bevy::camera::Viewport {
        physical_position: min,
        physical_size: max - min,
        depth: 0.0..1.0,
    });
    let same = match (&camera.viewport, &wanted) {
        (Some(a), Some(b)) => {
            a.physical_position == b.physical_position && a.physical_size == b.physical_size
        }
        (None, None) => true,
        _ => false,
    };
    if !same {
        camera.viewport = wanted;
    }
    if camera.is_active == is_empty {
        camera.is_active = !is_empty;
    }
    let divider = viewport.traced_from();
    if view.divider != divider {
        view.divider = divider;
    }
    // What the traced picture covers is not drawn beneath it.
    let wanted = if divider > 0.0 {
        RenderLayers::from_layers(&[0, RASTER_LAYER])
    } else {
        RenderLayers::layer(0)
    };
    layers.set_if_neq(wanted);
}

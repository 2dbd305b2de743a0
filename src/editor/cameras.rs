//! The two cameras that draw into the window: one for the scene, one for the panels.

use super::embed::Editing;
use super::trees::LEFT_TREES_LAYER;
use super::viewport::{EditorCamera, Viewport};
use crate::scene::NotTraced;
use crate::view::{
    OVERLAY_LAYER, RASTER_LAYER, TracedRender, TracedView, interface_camera, picture_camera,
};
use bevy::app::{App, Plugin, PostUpdate, PreStartup};
use bevy::camera::Camera;
use bevy::camera::visibility::RenderLayers;
use bevy::ecs::change_detection::{DetectChangesMut, Mut};
use bevy::ecs::query::{With, Without};
use bevy::ecs::system::{Commands, Res, Single};
use bevy::gizmos::transform_gizmo::TransformGizmoCamera;
use bevy::math::{UVec2, Vec2};
use bevy::prelude::IntoScheduleConfigs;
use bevy::transform::TransformSystems;
use bevy::window::{PrimaryWindow, Window};
use bevy_egui::{EguiGlobalSettings, EguiStartupSet, PrimaryEguiContext};

/// Spawns them, and keeps the scene's where the panels leave room.
pub(super) struct CamerasPlugin;

impl Plugin for CamerasPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(EguiGlobalSettings {
            auto_create_primary_context: false,
            ..EguiGlobalSettings::default()
        })
        .add_systems(
            PreStartup,
            spawn_cameras.before(EguiStartupSet::InitContexts),
        )
        .add_systems(PostUpdate, fit_viewport.before(TransformSystems::Propagate));
    }
}

fn spawn_cameras(mut commands: Commands) {
    commands.spawn((
        EditorCamera,
        NotTraced,
        TransformGizmoCamera,
        picture_camera(),
    ));
    commands.spawn((PrimaryEguiContext, NotTraced, interface_camera()));
}

/// A place of the window in its pixels.
fn pixels(place: Vec2, scale: f32) -> UVec2 {
    (place * scale).round().max(Vec2::ZERO).as_uvec2()
}

/// Has a camera draw into a part of the window, unless it does already.
pub(super) fn draw_into(camera: &mut Mut<Camera>, part: Option<bevy::camera::Viewport>) {
    let place = |part: &bevy::camera::Viewport| (part.physical_position, part.physical_size);
    if camera.viewport.as_ref().map(place) != part.as_ref().map(place) {
        camera.viewport = part;
    }
}

type SceneCamera = (
    &'static mut Camera,
    &'static mut TracedView,
    &'static TracedRender,
    &'static mut RenderLayers,
);

/// The scene's camera draws into the part of the window that the panels leave free.
pub(super) fn fit_viewport(
    viewport: Res<Viewport>,
    editing: Option<Res<Editing>>,
    window: Single<&Window, With<PrimaryWindow>>,
    camera: Single<SceneCamera, With<EditorCamera>>,
    panels: Single<&mut Camera, (With<PrimaryEguiContext>, Without<EditorCamera>)>,
) {
    let editing = editing.is_none_or(|editing| editing.0);
    let mut panels = panels.into_inner();
    if panels.is_active != editing {
        panels.is_active = editing;
    }
    let (mut camera, mut view, render, mut layers) = camera.into_inner();
    let scale = window.scale_factor();
    let min = pixels(viewport.rect.min, scale);
    let max = pixels(viewport.rect.max, scale).min(window.physical_size());
    let is_empty = min.x >= max.x || min.y >= max.y;
    let wanted = (!is_empty).then(|| bevy::camera::Viewport {
        physical_position: min,
        physical_size: max - min,
        depth: 0.0..1.0,
    });
    draw_into(&mut camera, wanted);
    let is_active = editing && !is_empty;
    if camera.is_active != is_active {
        camera.is_active = is_active;
    }
    // Nothing is traced for a view that nobody sees.
    let divider = if editing { viewport.traced_from() } else { 1.0 };
    if view.divider != divider {
        view.divider = divider;
    }
    // What the traced picture covers is not drawn beneath it, once there is one.
    let wanted = if divider > 0.0 || render.shown().is_none() {
        RenderLayers::from_layers(&[0, RASTER_LAYER, OVERLAY_LAYER, LEFT_TREES_LAYER])
    } else {
        RenderLayers::from_layers(&[0, OVERLAY_LAYER, LEFT_TREES_LAYER])
    };
    layers.set_if_neq(wanted);
}

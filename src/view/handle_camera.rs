//! Bevy draws its transform gizmo with a camera of its own; this makes it see as that one does whose
//! gizmo it is.

use crate::scene::NotTraced;
use bevy::app::{App, Plugin, PostStartup, PostUpdate};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, ClearColorConfig, Projection};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::change_detection::Mut;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{With, Without};
use bevy::ecs::system::{Commands, Query, Single};
use bevy::gizmos::transform_gizmo::{
    TransformGizmoCamera, TransformGizmoFocus, TransformGizmoMeshMarker, TransformGizmoPlugin,
};
use bevy::prelude::IntoScheduleConfigs;
use bevy::render::view::Msaa;

/// Bevy's transform gizmo over a camera with a [`TracedView`](super::TracedView) that has a
/// `TransformGizmoCamera`. Its parts are no objects of the scene.
pub struct HandleCameraPlugin;

impl Plugin for HandleCameraPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(TransformGizmoPlugin)
            .add_systems(PostStartup, leave_untraced)
            .add_systems(
                PostUpdate,
                fit_camera.before(bevy::camera::CameraUpdateSystems),
            );
    }
}

/// The layer that Bevy puts its gizmo in (`GIZMO_RENDER_LAYER` of `bevy_gizmos_render` 0.19).
const LAYER: usize = 15;

type Overlay = (Without<TransformGizmoCamera>, With<Camera>);

/// Whether a camera in these layers is the one that Bevy draws its gizmo with.
pub fn draws_handles(layers: Option<&RenderLayers>) -> bool {
    layers == Some(&RenderLayers::layer(LAYER))
}

/// Its arrows have meshes and are no objects.
fn leave_untraced(mut commands: Commands, parts: Query<Entity, With<TransformGizmoMeshMarker>>) {
    for part in &parts {
        commands.entity(part).insert(NotTraced);
    }
}

/// The same projection, and the same kind of target, so that the two draw into one picture. It rests
/// while there is no gizmo: a camera costs time even where it draws nothing.
fn fit_camera(
    mut commands: Commands,
    eye: Single<(&Camera, &Projection), With<TransformGizmoCamera>>,
    mut overlays: Query<
        (
            Entity,
            &mut Camera,
            &mut Projection,
            &RenderLayers,
            Option<&Tonemapping>,
        ),
        Overlay,
    >,
    focus: Query<(), With<TransformGizmoFocus>>,
) {
    let (eye, seen) = eye.into_inner();
    for (entity, mut camera, mut projection, layers, tonemapping) in &mut overlays {
        if !draws_handles(Some(layers)) {
            continue;
        }
        if tonemapping != Some(&Tonemapping::None) {
            commands
                .entity(entity)
                .insert((Msaa::Off, Tonemapping::None));
            camera.clear_color = ClearColorConfig::None;
        }
        let active = eye.is_active && !focus.is_empty();
        if camera.is_active != active {
            camera.is_active = active;
        }
        see_as(&mut projection, seen);
    }
}

/// Has a camera see as another one does, unless it does already.
pub(crate) fn see_as(projection: &mut Mut<Projection>, seen: &Projection) {
    let same = match (&**projection, seen) {
        (Projection::Perspective(a), Projection::Perspective(b)) => {
            (a.fov, a.near, a.far, a.aspect_ratio) == (b.fov, b.near, b.far, b.aspect_ratio)
        }
        (Projection::Orthographic(a), Projection::Orthographic(b)) => {
            (a.scale, a.near, a.far, a.area) == (b.scale, b.near, b.far, b.area)
        }
        _ => false,
    };
    if !same {
        **projection = seen.clone();
    }
}

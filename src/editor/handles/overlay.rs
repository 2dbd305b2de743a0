//! Bevy draws its gizmo with a camera of its own; this makes it see as the editor's does.

use super::super::viewport::EditorCamera;
use crate::scene::NotTraced;
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{Camera, ClearColorConfig, Projection};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::{With, Without};
use bevy::ecs::system::{Commands, Query, Single};
use bevy::gizmos::transform_gizmo::{TransformGizmoFocus, TransformGizmoMeshMarker};
use bevy::render::view::Msaa;

/// The layer that Bevy puts its gizmo in (`GIZMO_RENDER_LAYER` of `bevy_gizmos_render` 0.19).
const LAYER: usize = 15;

type Overlay = (Without<EditorCamera>, With<Camera>);

/// Its arrows have meshes and are no objects.
pub(super) fn leave_untraced(
    mut commands: Commands,
    parts: Query<Entity, With<TransformGizmoMeshMarker>>,
) {
    for part in &parts {
        commands.entity(part).insert(NotTraced);
    }
}

/// The same projection, and the same kind of target, so that the two draw into one picture. It rests
/// while there is no gizmo: a camera costs time even where it draws nothing.
pub(super) fn fit_overlay(
    mut commands: Commands,
    editor: Single<(&Camera, &Projection), With<EditorCamera>>,
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
    let (editor, seen) = editor.into_inner();
    for (entity, mut camera, mut projection, layers, tonemapping) in &mut overlays {
        if *layers != RenderLayers::layer(LAYER) {
            continue;
        }
        if tonemapping != Some(&Tonemapping::None) {
            commands
                .entity(entity)
                .insert((Msaa::Off, Tonemapping::None));
            camera.clear_color = ClearColorConfig::None;
        }
        let active = editor.is_active && !focus.is_empty();
        if camera.is_active != active {
            camera.is_active = active;
        }
        let same = match (&*projection, seen) {
            (Projection::Perspective(a), Projection::Perspective(b)) => {
                a.fov == b.fov && a.near == b.near && a.aspect_ratio == b.aspect_ratio
            }
            (Projection::Orthographic(a), Projection::Orthographic(b)) => {
                a.area == b.area && a.far == b.far
            }
            _ => false,
        };
        if !same {
            *projection = seen.clone();
        }
    }
}

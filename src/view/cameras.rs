//! The cameras of a window that shows a traced picture with an interface around it. The camera of
//! [handles](super::HandleCameraPlugin) is between the two.

use super::{OVERLAY_LAYER, RASTER_LAYER, ShowsPictureOf, TracedView, raster};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{
    Camera, Camera2d, Camera3d, ClearColorConfig, PerspectiveProjection, Projection,
};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::bundle::Bundle;
use bevy::ecs::entity::Entity;
use bevy::render::view::Msaa;

/// The layer that holds an interface.
const INTERFACE_LAYER: usize = 30;

/// Shows the scene traced, and as Bevy's renderer shows it.
pub fn picture_camera() -> impl Bundle {
    (
        TracedView::default(),
        Msaa::Off,
        // Our materials are shown as bright as they are traced.
        Tonemapping::None,
        raster::exposure(),
        raster::ambient(),
        RenderLayers::from_layers(&[0, RASTER_LAYER, OVERLAY_LAYER]),
        Projection::Perspective(PerspectiveProjection::default()),
    )
}

/// Shows once more what the camera of a traced picture shows, beside it in the window; it traces nothing itself. It rests
/// until it is made active.
pub fn twin_camera(of: Entity, order: isize) -> impl Bundle {
    (
        ShowsPictureOf(of),
        Camera3d::default(),
        Camera {
            order,
            clear_color: ClearColorConfig::None,
            is_active: false,
            ..Camera::default()
        },
        Msaa::Off,
        Tonemapping::None,
        raster::exposure(),
        raster::ambient(),
    )
}

/// Shows an interface over the whole window, and leaves what is beneath.
pub fn interface_camera() -> impl Bundle {
    (
        Camera2d,
        Msaa::Off,
        RenderLayers::layer(INTERFACE_LAYER),
        Camera {
            order: 2,
            clear_color: ClearColorConfig::None,
            ..Camera::default()
        },
    )
}

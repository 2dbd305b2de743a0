//! The cameras of a window that shows a traced picture with an interface around it. The camera of
//! [handles](super::HandleCameraPlugin) is between the two.

use super::{OVERLAY_LAYER, RASTER_LAYER, TracedView, raster};
use bevy::camera::visibility::RenderLayers;
use bevy::camera::{
    Camera, Camera2d, Camera3d, Camera3dDepthLoadOp, ClearColorConfig, PerspectiveProjection,
    Projection,
};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::ecs::bundle::Bundle;
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

/// Shows lines of a layer over a picture that stands in the window already, against its depth. It rests
/// until it is made active.
pub fn lines_camera(order: isize, layer: usize) -> impl Bundle {
    (
        Camera3d {
            depth_load_op: Camera3dDepthLoadOp::Load,
            ..Camera3d::default()
        },
        Camera {
            order,
            clear_color: ClearColorConfig::None,
            is_active: false,
            ..Camera::default()
        },
        Msaa::Off,
        Tonemapping::None,
        RenderLayers::layer(layer),
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

//! The camera of the window goes where the view stands.

use super::super::viewport::{EditorCamera, Viewport};
use super::{Eye, LookThrough};
use crate::view::TracedView;
use bevy::camera::{
    Camera, OrthographicProjection, PerspectiveProjection, Projection, ScalingMode,
};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::query::With;
use bevy::ecs::system::{Res, Single};
use bevy::math::Vec2;
use bevy::transform::components::Transform;
use bevy::window::{PrimaryWindow, Window};

/// How far the pointer moves over the view before what is rendered first follows it, as a part of
/// the view's size.
const FOCUS_STEP: f32 = 0.02;

/// Gives the camera of the window the place and projection of the eye.
pub(super) fn place_view(
    eye: Res<Eye>,
    through: Res<LookThrough>,
    viewport: Res<Viewport>,
    window: Single<&Window, With<PrimaryWindow>>,
    camera: Single<(&mut Transform, &mut Projection, &mut TracedView, &Camera), With<EditorCamera>>,
) {
    let (mut transform, mut projection, mut view, camera) = camera.into_inner();
    let exact = through.camera.and(through.seen.as_ref());
    let wanted = exact.map_or_else(|| eye.transform(), |(_, place, _)| *place);
    transform.set_if_neq(wanted);
    let reach = exact.map_or(0.0, |_| through.reach);
    set_projection(&mut projection, &eye, reach, camera);
    if view.optics_of != through.camera {
        view.optics_of = through.camera;
    }
    let pointer = window.cursor_position().filter(|_| viewport.hovered);
    let focus = pointer.map_or(Vec2::splat(0.5), |at| {
        viewport.place(at - viewport.offset(at))
    });
    if (focus - view.focus).abs().max_element() > FOCUS_STEP {
        view.focus = focus;
    }
}

/// `reach` is how far it has to see at least, in metres.
fn set_projection(
    projection: &mut bevy::prelude::Mut<Projection>,
    eye: &Eye,
    reach: f32,
    camera: &Camera,
) {
    if eye.orthographic {
        let height = eye.height();
        let far = (eye.distance + 2.0 * eye.back).max(reach) + 1.0;
        let same = matches!(&**projection, Projection::Orthographic(p)
            if p.far == far && matches!(p.scaling_mode,
                ScalingMode::FixedVertical { viewport_height } if viewport_height == height));
        if same {
            return;
        }
        let mut orthographic = OrthographicProjection {
            near: 0.0,
            far,
            scaling_mode: ScalingMode::FixedVertical {
                viewport_height: height,
            },
            ..OrthographicProjection::default_3d()
        };
        if let Some(size) = camera.logical_viewport_size() {
            bevy::camera::CameraProjection::update(&mut orthographic, size.x, size.y);
        }
        **projection = Projection::Orthographic(orthographic);
        return;
    }
    // As near as the pivot allows: depth has to last for what is far.
    let near = (0.01 * eye.distance).clamp(1e-4, 0.1);
    let same = matches!(&**projection, Projection::Perspective(p)
        if p.fov == eye.fov_y && p.near == near);
    if !same {
        let mut perspective = PerspectiveProjection {
            fov: eye.fov_y,
            near,
            ..PerspectiveProjection::default()
        };
        if let Some(size) = camera.logical_viewport_size() {
            bevy::camera::CameraProjection::update(&mut perspective, size.x, size.y);
        }
        **projection = Projection::Perspective(perspective);
    }
}

//! Taking hold of the gizmo's handles where the button goes down.
//!
//! Bevy's gizmo begins a drag with the handle that was under the pointer in the frame before, at the place where the
//! pointer is when the frame ends. Where frames are slow, who moves and presses within one would drag another handle,
//! or none. So a press is looked at by itself: the drag begins here, and Bevy's gizmo goes on with it.

use super::super::pick;
use super::gizmo::StandIn;
use bevy::camera::Camera;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::gizmos::transform_gizmo::{
    AXIS_START_OFFSET, TransformGizmoAxis as Axis, TransformGizmoFocus, TransformGizmoMode as Mode,
    TransformGizmoSettings, TransformGizmoState, VIEW_CIRCLE_MAJOR, VIEW_RING_MAJOR,
    axis_direction, effective_space, gizmo_rotation, intersect_plane, point_to_ring_screen_dist,
    point_to_segment_dist, translation_plane_normal,
};
use bevy::math::{Quat, Ray3d, Vec2, Vec3};
use bevy::transform::components::{GlobalTransform, Transform};
use bevy::window::{PrimaryWindow, Window};

/// The gizmo as it stands.
struct Stand {
    entity: Entity,
    place: Transform,
    rotation: Quat,
    /// Its size in the world.
    scale: f32,
}

fn stand(world: &mut World, eye: &GlobalTransform) -> Option<Stand> {
    let mut focus =
        world.query_filtered::<(Entity, &Transform), (With<StandIn>, With<TransformGizmoFocus>)>();
    let (entity, place) = focus.single(world).ok()?;
    let place = *place;
    let settings = world.resource::<TransformGizmoSettings>();
    let rotation = gizmo_rotation(&GlobalTransform::from(place), effective_space(settings));
    let distance = eye.translation().distance(place.translation);
    Some(Stand {
        entity,
        place,
        rotation,
        scale: distance * settings.screen_scale_factor,
    })
}

/// Begins a drag of the handle at a place of the window, in logical pixels. `false` where there is none.
pub(in super::super) fn take_hold(world: &mut World, at: Vec2) -> bool {
    let Some((camera, eye)) = pick::camera(world) else {
        return false;
    };
    let Some(stand) = stand(world, &eye) else {
        return false;
    };
    let settings = world.resource::<TransformGizmoSettings>();
    let mode = settings.mode;
    let held = nearest_handle(settings, &stand, &camera, &eye, at).and_then(|axis| {
        let ray = camera.viewport_to_world(&eye, at).ok()?;
        let origin = stand.place.translation;
        let direction = axis_direction(axis, stand.rotation, &eye).normalize();
        Some((axis, drag_start(mode, axis, direction, ray, origin)?))
    });
    let mut state = world.resource_mut::<TransformGizmoState>();
    let Some((axis, drag_start_world)) = held else {
        state.hovered_axis = None;
        return false;
    };
    *state = TransformGizmoState {
        hovered_axis: Some(axis),
        active: true,
        axis: Some(axis),
        start_transform: stand.place,
        entity: Some(stand.entity),
        drag_start_world,
        gizmo_origin: stand.place.translation,
    };
    true
}

/// Has the handle lit up that a press would take hold of: Bevy's gizmo chooses another one in its middle.
pub(super) fn hover(world: &mut World) {
    let state = world.resource::<TransformGizmoState>();
    if state.active || state.hovered_axis.is_none() {
        return;
    }
    let mut windows = world.query_filtered::<&Window, With<PrimaryWindow>>();
    let at = windows.single(world).ok().and_then(Window::cursor_position);
    let Some((at, (camera, eye))) = at.zip(pick::camera(world)) else {
        return;
    };
    let Some(stand) = stand(world, &eye) else {
        return;
    };
    let settings = world.resource::<TransformGizmoSettings>();
    let handle = nearest_handle(settings, &stand, &camera, &eye, at);
    world.resource_mut::<TransformGizmoState>().hovered_axis = handle;
}

/// The handle that is nearest to a place, and near enough, as Bevy's gizmo chooses it; but all of the circle in the middle
/// moves along the view. An arrow that points at the viewer would be nearer there, and carry things far away.
fn nearest_handle(
    settings: &TransformGizmoSettings,
    stand: &Stand,
    camera: &Camera,
    eye: &GlobalTransform,
    at: Vec2,
) -> Option<Axis> {
    let origin = stand.place.translation;
    let seen = |point: Vec3| camera.world_to_viewport(eye, point).ok();
    let ring = |normal, radius| {
        let radius = radius * stand.scale;
        point_to_ring_screen_dist(at, camera, eye, origin, normal, radius)
    };
    let distance = |axis: Axis| {
        let direction = axis_direction(axis, stand.rotation, eye);
        Some(match (settings.mode, axis) {
            (Mode::Scale, Axis::View) => return None,
            (Mode::Rotate, Axis::View) => ring(direction, VIEW_RING_MAJOR),
            (Mode::Rotate, _) => ring(direction, settings.rotate_ring_radius),
            // A circle that faces the camera, and looks as one in the middle of the picture.
            (Mode::Translate, Axis::View) => {
                let edge = origin + eye.right() * (VIEW_CIRCLE_MAJOR * stand.scale);
                let middle = seen(origin)?;
                (at.distance(middle) - seen(edge)?.distance(middle)).max(0.0)
            }
            (Mode::Translate | Mode::Scale, _) => {
                let [from, to] = [AXIS_START_OFFSET, settings.axis_length]
                    .map(|part| seen(origin + direction * (part * stand.scale)));
                point_to_segment_dist(at, from?, to?)
            }
        })
    };
    // The first of those that are as near.
    [Axis::View, Axis::X, Axis::Y, Axis::Z]
        .into_iter()
        .filter_map(|axis| Some((axis, distance(axis)?)))
        .filter(|(_, distance)| *distance < settings.axis_hit_distance)
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(axis, _)| axis)
}

/// Where a drag begins, as Bevy's gizmo notes it: a point of the arrow or of the plane that faces the camera, and of a
/// ring the direction. `None` where the ray runs along that plane.
fn drag_start(mode: Mode, axis: Axis, direction: Vec3, ray: Ray3d, origin: Vec3) -> Option<Vec3> {
    match (mode, axis) {
        (Mode::Rotate, _) => Some((intersect_plane(ray, direction, origin)? - origin).normalize()),
        (_, Axis::View) => intersect_plane(ray, direction, origin),
        _ => {
            let normal = translation_plane_normal(ray, direction);
            let from_origin = intersect_plane(ray, normal, origin)? - origin;
            Some(origin + direction * from_origin.dot(direction))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::camera::{CameraProjection, PerspectiveProjection, RenderTargetInfo};
    use bevy::math::UVec2;

    #[test]
    fn the_middle_of_the_gizmo_moves_along_the_view_even_where_an_arrow_points_at_the_viewer() {
        let mut camera = Camera::default();
        camera.computed.clip_from_view = PerspectiveProjection::default().get_clip_from_view();
        camera.computed.target_info = Some(RenderTargetInfo {
            physical_size: UVec2::splat(600),
            scale_factor: 1.0,
        });
        let settings = TransformGizmoSettings {
            axis_hit_distance: 12.0,
            ..TransformGizmoSettings::default()
        };
        let stand = Stand {
            entity: Entity::PLACEHOLDER,
            place: Transform::IDENTITY,
            rotation: Quat::IDENTITY,
            scale: 1.0,
        };
        // Slightly from above, and from where all arrows can be seen.
        for from in [Vec3::new(0.0, 0.4, 8.0), Vec3::new(4.0, 3.0, 6.0)] {
            let eye = Transform::from_translation(from).looking_at(Vec3::ZERO, Vec3::Y);
            let eye = GlobalTransform::from(eye);
            let at = |point: Vec3| camera.world_to_viewport(&eye, point).unwrap();
            let handle = |at: Vec2| nearest_handle(&settings, &stand, &camera, &eye, at);
            let middle = at(Vec3::ZERO);
            let radius = at(0.9 * VIEW_CIRCLE_MAJOR * eye.right()).distance(middle);
            for direction in [Vec2::ZERO, Vec2::X, Vec2::NEG_X, Vec2::Y, Vec2::NEG_Y] {
                let inside = middle + radius * direction;
                assert_eq!(handle(inside), Some(Axis::View), "{direction}");
            }
            assert_eq!(handle(at(0.8 * Vec3::X)), Some(Axis::X));
            assert_eq!(handle(at(0.8 * Vec3::Y)), Some(Axis::Y));
            assert_eq!(handle(middle + Vec2::new(-200.0, 0.0)), None);
        }
        let eye = Transform::from_xyz(4.0, 3.0, 6.0).looking_at(Vec3::ZERO, Vec3::Y);
        let eye = GlobalTransform::from(eye);
        let tip = camera.world_to_viewport(&eye, 0.8 * Vec3::Z).unwrap();
        let handle = nearest_handle(&settings, &stand, &camera, &eye, tip);
        assert_eq!(handle, Some(Axis::Z));
    }
}

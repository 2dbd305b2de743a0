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

/// The handle that is nearest to a place, and near enough, as Bevy's gizmo chooses it.
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
                (at.distance(middle) - seen(edge)?.distance(middle)).abs()
            }
            (Mode::Translate | Mode::Scale, _) => {
                let [from, to] = [AXIS_START_OFFSET, settings.axis_length]
                    .map(|part| seen(origin + direction * (part * stand.scale)));
                point_to_segment_dist(at, from?, to?)
            }
        })
    };
    [Axis::X, Axis::Y, Axis::Z, Axis::View]
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

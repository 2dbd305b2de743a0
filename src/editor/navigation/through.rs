//! The scene's camera that the view looks through: the view follows it, and moves it where it is
//! locked.

use super::super::extent::{world_from_entity, world_from_parent};
use super::commands::farthest;
use super::{Eye, LookThrough};
use crate::editor::edits;
use crate::scene::{Projection, SceneCamera, SceneId};
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::transform::components::Transform;

/// Follows the camera that is looked through.
pub(super) fn see_through(world: &mut World) {
    let Some(id) = world.resource::<LookThrough>().camera else {
        return;
    };
    let found = edits::scene_entity(world, id).and_then(|entity| {
        let projection = world.get::<SceneCamera>(entity)?.projection;
        let (_, rotation, translation) =
            world_from_entity(world, entity)?.to_scale_rotation_translation();
        let finite = rotation.is_finite() && translation.is_finite();
        finite.then(|| {
            let place = Transform::from_translation(translation).with_rotation(rotation);
            (id, place, projection)
        })
    });
    let Some(seen) = found else {
        world.resource_mut::<LookThrough>().camera = None;
        return;
    };
    if world.resource::<LookThrough>().seen.as_ref() == Some(&seen) {
        return;
    }
    let (_, place, projection) = seen;
    let before = world.resource::<Eye>().clone();
    // The pivot stays as far ahead as it was, or where the last one was passed.
    let ahead = (before.pivot - place.translation).dot(place.rotation * Vec3::NEG_Z);
    let distance = if ahead > 1e-3 { ahead } else { before.distance };
    let mut eye = Eye::from_transform(&place, distance);
    eye.fov_y = before.fov_y;
    match projection {
        Projection::Perspective { fov_y } => eye.fov_y = fov_y,
        Projection::Orthographic { height } => {
            // The height that it has is that of the pivot's plane.
            eye.orthographic = true;
            eye.distance = 0.5 * height / (0.5 * eye.fov_y).tan();
            eye.pivot = place.translation + eye.forward() * eye.distance;
        }
    }
    // The view begins at the camera, so that its depth ends where the scene does and not behind the pivot.
    let reach = match eye.orthographic {
        true => farthest(world, place.translation),
        false => 0.0,
    };
    *world.resource_mut::<Eye>() = eye;
    world.resource_mut::<LookThrough>().reach = reach;
    world.resource_mut::<LookThrough>().seen = Some(seen);
}

/// Puts a camera of the scene where the eye is.
pub(super) fn move_camera(world: &mut World, id: SceneId, eye: &Eye) {
    let Some(entity) = edits::scene_entity(world, id) else {
        return;
    };
    let parent = world_from_parent(world, entity);
    let placed = eye.transform();
    let (_, parent_rotation, _) = parent.to_scale_rotation_translation();
    let translation = parent
        .affine()
        .inverse()
        .transform_point3(placed.translation);
    let rotation = (parent_rotation.inverse() * placed.rotation).normalize();
    if !(translation.is_finite() && rotation.is_finite()) {
        return;
    }
    if let Some(mut transform) = world.get_mut::<Transform>(entity) {
        let scale = transform.scale;
        transform.set_if_neq(Transform {
            translation,
            rotation,
            scale,
        });
    }
    let projection = scene_projection(eye);
    if let Some(mut camera) = world.get_mut::<SceneCamera>(entity)
        && !same_projection(&camera.projection, &projection)
    {
        camera.projection = projection;
    }
}

fn scene_projection(eye: &Eye) -> Projection {
    if eye.orthographic {
        Projection::Orthographic {
            height: eye.height(),
        }
    } else {
        Projection::Perspective { fov_y: eye.fov_y }
    }
}

/// The same but for rounding.
fn same_projection(a: &Projection, b: &Projection) -> bool {
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * a.abs().max(b.abs());
    match (a, b) {
        (Projection::Perspective { fov_y: a }, Projection::Perspective { fov_y: b }) => {
            near(*a, *b)
        }
        (Projection::Orthographic { height: a }, Projection::Orthographic { height: b }) => {
            near(*a, *b)
        }
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::editor::viewport::Viewport;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use bevy::math::Vec3;

    #[test]
    fn an_orthographic_camera_that_is_looked_through_reaches_the_end_of_the_scene() {
        let mut app = headless_editor();
        app.init_resource::<Eye>()
            .init_resource::<LookThrough>()
            .init_resource::<Viewport>();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        app.update();
        let world = app.world_mut();
        let id = SceneId(4711);
        let place = Transform::from_xyz(0.0, 0.0, 50.0).looking_at(Vec3::ZERO, Vec3::Y);
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = SceneCamera {
            projection,
            ..SceneCamera::default()
        };
        let entity = world.spawn((id, place, camera)).id();
        app.update();
        let world = app.world_mut();
        world.resource_mut::<LookThrough>().camera = Some(id);
        see_through(world);
        let reach = world.resource::<LookThrough>().reach;
        assert!(reach >= 50.0, "{reach} m");
        // Its place in the scene stays: the eye stands where it does.
        assert_eq!(world.resource::<Eye>().back, 0.0);
        let fov_y = 1.0;
        let mut camera = world.get_mut::<SceneCamera>(entity).unwrap();
        camera.projection = Projection::Perspective { fov_y };
        see_through(world);
        assert_eq!(world.resource::<LookThrough>().reach, 0.0);
    }
}

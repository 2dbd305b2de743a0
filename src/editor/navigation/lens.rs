//! The field of view: of the scene's camera that is looked through, else of the view itself.

use super::{Eye, LookThrough};
use crate::editor::edits;
use crate::editor::history::Gesture;
use crate::scene::{Projection, SceneCamera};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;

/// How much one notch of the wheel narrows it.
const NOTCH: f32 = 0.95;
/// Its limits, in radians: those of a camera.
const LIMITS: [f32; 2] = [1_f32.to_radians(), 170_f32.to_radians()];

/// The vertical one, in radians. `None` where the view has no perspective.
pub(in crate::editor) fn field_of_view(world: &World) -> Option<f32> {
    let eye = world.get_resource::<Eye>()?;
    match through(world) {
        Some(entity) => match world.get::<SceneCamera>(entity)?.projection {
            Projection::Perspective { fov_y } => Some(fov_y),
            Projection::Orthographic { .. } => None,
        },
        None => (!eye.orthographic).then_some(eye.fov_y),
    }
}

/// Sets it, within its limits. That of a camera is a change of the scene.
pub(in crate::editor) fn set_field_of_view(world: &mut World, fov_y: f32) {
    let Some(before) = field_of_view(world) else {
        return;
    };
    let fov_y = fov_y.clamp(LIMITS[0], LIMITS[1]);
    if fov_y == before || fov_y.is_nan() {
        return;
    }
    match through(world) {
        Some(entity) => {
            if let Some(mut camera) = world.get_mut::<SceneCamera>(entity) {
                camera.projection = Projection::Perspective { fov_y };
            }
        }
        None => world.resource_mut::<Eye>().fov_y = fov_y,
    }
}

fn through(world: &World) -> Option<Entity> {
    let id = world.get_resource::<LookThrough>()?.camera?;
    edits::scene_entity(world, id)
}

/// The wheel was turned by so many notches to change it; without perspective it is the view's height
/// that changes.
pub(in crate::editor) fn widen(world: &mut World, notches: f32) {
    let Some(fov_y) = field_of_view(world) else {
        let pivot = world.resource::<Eye>().pivot;
        return super::move_view(world, |eye| eye.zoom(NOTCH.powf(notches), pivot));
    };
    let drags = world.resource::<Gesture>().active();
    if !drags {
        let name = through(world).map_or_else(String::new, |_| "Change the field of view".into());
        world.resource_mut::<Gesture>().begin(name);
    }
    // By the size of things in the picture, so that a notch is as much at any angle.
    let tan = (0.5 * fov_y).tan() * NOTCH.powf(notches);
    set_field_of_view(world, 2.0 * tan.atan());
    if !drags {
        world.resource_mut::<Gesture>().end();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::document::adopt;
    use crate::editor::headless_editor;
    use crate::editor::history::History;
    use crate::io::open_new;
    use crate::scene::SceneId;

    fn camera(world: &mut World) -> (SceneId, f32) {
        let mut cameras = world.query::<(&SceneId, &SceneCamera)>();
        let (id, camera) = cameras.single(world).unwrap();
        let Projection::Perspective { fov_y } = camera.projection else {
            panic!("{:?}", camera.projection);
        };
        (*id, fov_y)
    }

    #[test]
    fn a_cameras_field_of_view_is_a_step_and_the_views_own_is_none() {
        let mut app = headless_editor();
        open_new(app.world_mut());
        adopt(app.world_mut(), "empty", None);
        app.update();
        let world = app.world_mut();
        world.init_resource::<Eye>();
        world.init_resource::<LookThrough>();
        let own = field_of_view(world).unwrap();
        widen(world, 1.0);
        assert!(field_of_view(world).unwrap() < own, "it narrows");
        app.update();
        assert_eq!(app.world().resource::<History>().steps().count(), 0);

        let (id, before) = camera(app.world_mut());
        app.world_mut().resource_mut::<LookThrough>().camera = Some(id);
        widen(app.world_mut(), -2.0);
        app.update();
        let steps: Vec<&str> = app.world().resource::<History>().steps().collect();
        assert_eq!(steps, ["Change the field of view"]);
        assert!(camera(app.world_mut()).1 > before, "it widens");
        set_field_of_view(app.world_mut(), 1e9);
        assert_eq!(field_of_view(app.world()), Some(LIMITS[1]));
    }
}

//! What a lens is focused on: by clicking it, and what a new lens begins with.

use super::super::command::State;
use super::super::edits::{name_of, scene_entity, step};
use super::super::extent::{scene_extent, world_from_entity};
use super::super::notice::Notices;
use super::super::pick;
use super::super::pointer::{self, Armed};
use super::super::selection::Selection;
use crate::scene::{Lens, SceneCamera, SceneId};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{Vec2, Vec3};

/// The opening of a new lens, in distances to what it is focused on: what stands half as far again is blurred by about a
/// hundredth of a picture's height, which is seen, and is not all that is seen.
const OPENING: f32 = 1.0 / 40.0;

/// The next click in the view is what the selected cameras are focused on.
pub(super) fn arm(world: &mut World) {
    pointer::arm(world, Armed::Focus);
}

pub(super) fn may_focus(world: &World) -> State {
    let any = selected_cameras(world).next().is_some();
    State::when(any, "A camera has to be selected.")
}

fn selected_cameras(world: &World) -> impl Iterator<Item = (SceneId, Entity)> {
    let ids = world.resource::<Selection>().ids().iter();
    let entities = ids.filter_map(move |&id| Some((id, scene_entity(world, id)?)));
    entities.filter(move |(_, entity)| world.get::<SceneCamera>(*entity).is_some())
}

/// Metres along a camera's axis to a point; `None` where that is not in front of it.
fn depth(world: &World, camera: Entity, point: Vec3) -> Option<f32> {
    let place = world_from_entity(world, camera)?;
    let depth = (point - place.translation()).dot(*place.forward());
    (depth.is_finite() && depth > 0.0).then_some(depth)
}

/// Focuses the selected cameras on what is at this place of the window. One without a lens gets one.
pub(in super::super) fn focus(world: &mut World, at: Vec2) {
    let Some(target) = pick::at(world, at) else {
        let text = "There is nothing to focus on: click an object.";
        world.resource_mut::<Notices>().tell(text);
        return;
    };
    let cameras: Vec<(SceneId, Entity)> = selected_cameras(world).collect();
    step(world, |world| {
        let mut focused = Vec::new();
        for (id, camera) in cameras {
            let Some(depth) = depth(world, camera, target.point) else {
                continue;
            };
            match world.get_mut::<Lens>(camera) {
                Some(mut lens) => lens.focus_distance = depth,
                None => {
                    world.entity_mut(camera).insert(lens_for(depth));
                }
            }
            focused.push(id);
        }
        let whose = match focused.as_slice() {
            [] => {
                let text = "What was clicked is not in front of the selected camera.";
                world.resource_mut::<Notices>().tell(text);
                return None;
            }
            [one] => name_of(world, *one),
            several => format!("{} cameras", several.len()),
        };
        Some(format!("Focus {whose} on {}", name_of(world, target.id)))
    });
}

fn lens_for(distance: f32) -> Lens {
    Lens {
        aperture_radius: OPENING * distance,
        focus_distance: distance,
        ..Lens::default()
    }
}

/// A lens whose blur is seen, focused on what stands in the middle of the camera's picture.
pub(in super::super) fn new_lens(world: &mut World, camera: Entity) -> Lens {
    let seen = world_from_entity(world, camera).and_then(|place| {
        let point = pick::along(world, place.translation(), *place.forward())?;
        depth(world, camera, point)
    });
    let distance = seen.or_else(|| {
        let middle = scene_extent(world)?.centre();
        depth(world, camera, middle)
    });
    lens_for(distance.unwrap_or(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::io::{OpenOptions, SceneSource, builtin, open};
    use bevy::ecs::query::With;

    #[test]
    fn a_new_lens_is_open_and_focused_on_what_the_camera_looks_at() {
        let mut app = headless_editor();
        let source = SceneSource::Builtin(builtin::find("cornell-box").unwrap());
        open(app.world_mut(), &source, OpenOptions::default()).unwrap();
        app.update();
        let world = app.world_mut();
        let mut cameras = world.query_filtered::<Entity, With<SceneCamera>>();
        let camera = cameras.single(world).unwrap();
        let lens = new_lens(world, camera);
        let place = world_from_entity(world, camera).unwrap();
        let seen = pick::along(world, place.translation(), *place.forward()).unwrap();
        let distance = seen.distance(place.translation());
        assert!(
            (lens.focus_distance / distance - 1.0).abs() < 1e-4,
            "{lens:?}, {distance} m"
        );
        assert!(
            lens.aperture_radius > 0.01 * distance,
            "{lens:?}, {distance} m"
        );
        // Away from everything it takes the scene's middle, and behind it a metre.
        world
            .entity_mut(camera)
            .insert(bevy::transform::components::Transform::from_xyz(
                0.0, 9.0, 50.0,
            ));
        assert!(new_lens(world, camera).focus_distance > 40.0);
        world
            .entity_mut(camera)
            .insert(bevy::transform::components::Transform::from_xyz(
                0.0, 9.0, -50.0,
            ));
        assert_eq!(new_lens(world, camera).focus_distance, 1.0);
    }
}

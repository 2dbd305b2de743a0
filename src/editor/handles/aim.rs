//! Turning lights and cameras so that they look at what is clicked.

use super::super::command::State;
use super::super::edits::{name_of, scene_entity, step};
use super::super::extent::{world_from_entity, world_from_parent};
use super::super::notice::Notices;
use super::super::pick;
use super::super::pointer::{self, Armed};
use super::super::selection::Selection;
use super::bodies::{Body, Change};
use crate::scene::{DirectionalLamp, ParallelogramLamp, PointLamp, SceneCamera, SceneId};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec2, Vec3};
use bevy::transform::components::Transform;

/// The next click in the view is what the selection looks at.
pub(super) fn arm(world: &mut World) {
    pointer::arm(world, Armed::Aim);
}

pub(super) fn may_aim(world: &World) -> State {
    let mut selected = world.resource::<Selection>().ids().iter();
    let any = selected
        .any(|&id| scene_entity(world, id).is_some_and(|entity| looks(world, entity).is_some()));
    State::when(
        any,
        "A spot, a directional light, a parallelogram light or a camera has to be selected.",
    )
}

/// From where in the world and in which direction an entity looks or shines; `None` for what does
/// so everywhere.
fn looks(world: &World, entity: Entity) -> Option<(Vec3, Vec3)> {
    let own = world.get_entity(entity).ok()?;
    let place = world_from_entity(world, entity)?.affine();
    let (from, direction) = if let Some(lamp) = own.get::<ParallelogramLamp>() {
        let [a, b] = lamp.edges;
        let edges = [a, b].map(|edge| place.transform_vector3(edge));
        let middle = place.transform_point3(lamp.corner + 0.5 * (a + b));
        (middle, edges[0].cross(edges[1]))
    } else {
        let is_spot = own
            .get::<PointLamp>()
            .is_some_and(|lamp| lamp.cone.is_some());
        if !is_spot && !own.contains::<DirectionalLamp>() && !own.contains::<SceneCamera>() {
            return None;
        }
        (
            place.translation.into(),
            place.transform_vector3(Vec3::NEG_Z),
        )
    };
    Some((from, direction.try_normalize()?))
}

/// Turns what is selected to what is at this place of the window.
pub(in super::super) fn aim(world: &mut World, at: Vec2) {
    let Some(target) = pick::at(world, at) else {
        let text = "There is nothing to aim at: click an object.";
        world.resource_mut::<Notices>().tell(text);
        return;
    };
    let ids = world.resource::<Selection>().ids().to_vec();
    let mut any = false;
    step(world, |world| {
        let mut aimed = Vec::new();
        for id in ids {
            if turn_to(world, id, target.point) {
                aimed.push(id);
            }
        }
        any = !aimed.is_empty();
        let whose = match aimed.as_slice() {
            [] => return None,
            [one] => name_of(world, *one),
            several => format!("{} entities", several.len()),
        };
        Some(format!("Aim {whose} at {}", name_of(world, target.id)))
    });
    if !any {
        let text = "Nothing that is selected can be turned there.";
        world.resource_mut::<Notices>().tell(text);
    }
}

/// Turns one entity to a point of the world; `false` where it has no direction or is there itself.
fn turn_to(world: &mut World, id: SceneId, point: Vec3) -> bool {
    let entity = scene_entity(world, id);
    let found = entity.and_then(|entity| Some((entity, looks(world, entity)?)));
    let Some((entity, (from, direction))) = found else {
        return false;
    };
    let (Some(wanted), Some(own)) = (
        (point - from).try_normalize(),
        world.get::<Transform>(entity).copied(),
    ) else {
        return false;
    };
    let body = Body {
        own,
        world_from_parent: world_from_parent(world, entity),
    };
    let turn = match world.get::<SceneCamera>(entity) {
        // A camera stays upright.
        Some(_) => {
            let now = body.world_from_parent * own;
            Transform::default().looking_to(wanted, Vec3::Y).rotation * now.rotation().inverse()
        }
        None => Quat::from_rotation_arc(direction, wanted),
    };
    let Some(turned) = body.changed(Change::Turn(turn), from) else {
        return false;
    };
    if let Some(mut own) = world.get_mut::<Transform>(entity) {
        *own = turned;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Cone;
    use bevy::ecs::hierarchy::ChildOf;

    #[test]
    fn spots_lamps_and_cameras_turn_to_a_point_whatever_they_hang_on() {
        let mut app = crate::editor::headless_editor();
        let world = app.world_mut();
        let parent = Transform::from_xyz(1.0, 2.0, 0.0)
            .with_rotation(Quat::from_rotation_z(0.8))
            .with_scale(Vec3::splat(2.0));
        let parent = world.spawn((SceneId(1), parent)).id();
        let spot = PointLamp {
            cone: Some(Cone::default()),
            ..PointLamp::default()
        };
        let place = Transform::from_xyz(0.5, 1.0, -1.0);
        world.spawn((SceneId(2), spot, place, ChildOf(parent)));
        let lamp = ParallelogramLamp {
            corner: Vec3::new(1.0, 0.0, 0.0),
            ..ParallelogramLamp::default()
        };
        world.spawn((SceneId(3), lamp, place));
        world.spawn((SceneId(4), SceneCamera::default(), place));
        world.spawn((SceneId(5), PointLamp::default(), place));
        app.update();
        let world = app.world_mut();
        let point = Vec3::new(-2.0, 0.3, 4.0);
        for id in [2, 3, 4] {
            let entity = scene_entity(world, SceneId(id)).unwrap();
            let (before, _) = looks(world, entity).unwrap();
            assert!(turn_to(world, SceneId(id), point));
            let (from, direction) = looks(world, entity).unwrap();
            let miss = direction.distance((point - from).normalize());
            assert!(miss < 1e-4, "{id} misses by {miss}");
            assert!(from.distance(before) < 1e-4, "{id} moved");
        }
        assert!(!turn_to(world, SceneId(5), point), "it shines everywhere");
    }
}

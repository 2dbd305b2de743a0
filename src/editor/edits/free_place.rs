//! Where the next thing is added: where the view looks, or beside what stands there already.

use super::AddAt;
use super::add::stands_from;
use crate::editor::action::Addition;
use crate::editor::extent::{Extent, extent_as_placed};
use crate::scene::SceneId;
use bevy::ecs::entity::Entity;
use bevy::ecs::query::With;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::transform::components::Transform;

/// From one place that is tried to the next, in sizes of what is added.
const STEP: f32 = 1.25;
/// How many steps away it is looked for, in each direction.
const FARTHEST: i32 = 6;
/// What is so many sizes large, from its middle, is a room or a floor, in which things stand.
const ROOM: f32 = 3.0;

/// The free place that is nearest to `at` on its level, first to the right as the view sees it. Where all are taken, `at`.
pub(super) fn free_place(world: &mut World, what: &Addition, at: AddAt) -> AddAt {
    let Some(offset) = stands_from(what, at) else {
        return at;
    };
    let taken = taken(world, at.size);
    let right = level_axis(at.view * Vec3::X);
    let back = right.cross(Vec3::Y);
    let mut places = steps().into_iter().map(|[across, along]| {
        let by = across as f32 * right + along as f32 * back;
        at.place + STEP * at.size * by
    });
    // A little less, so that what touches is beside it.
    let half = Vec3::splat(0.49 * at.size);
    let is_free = |place: &Vec3| {
        let middle = *place + offset;
        let own = Extent {
            least: middle - half,
            most: middle + half,
        };
        !taken.iter().any(|other| own.meets(*other))
    };
    let place = places.find(is_free).unwrap_or(at.place);
    AddAt { place, ..at }
}

/// The rooms of what is seen and stands somewhere.
fn taken(world: &mut World, size: f32) -> Vec<Extent> {
    let mut placed = world.query_filtered::<Entity, (With<SceneId>, With<Transform>)>();
    let placed: Vec<Entity> = placed.iter(world).collect();
    let rooms = placed
        .into_iter()
        .filter_map(|entity| extent_as_placed(world, entity));
    rooms.filter(|room| room.radius() < ROOM * size).collect()
}

/// The axis of the floor that is nearest to a direction: places along it have few digits.
fn level_axis(direction: Vec3) -> Vec3 {
    match direction.x.abs() >= direction.z.abs() {
        true => Vec3::X * 1_f32.copysign(direction.x),
        false => Vec3::Z * 1_f32.copysign(direction.z),
    }
}

/// All pairs of steps, the nearest first: those to the right before those to the left, the front and the back.
fn steps() -> Vec<[i32; 2]> {
    let all = -FARTHEST..=FARTHEST;
    let mut steps: Vec<[i32; 2]> = all
        .clone()
        .flat_map(|across| all.clone().map(move |along| [across, along]))
        .collect();
    steps.sort_by_key(|&[across, along]| (across * across + along * along, -across, along));
    steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::edits::plugin::step_add;
    use crate::editor::edits::scene_entity;
    use crate::editor::headless_editor;
    use crate::editor::selection::Selection;

    fn place(world: &mut World, what: &Addition) -> Vec3 {
        step_add(world, what);
        let id = world.resource::<Selection>().ids()[0];
        let entity = scene_entity(world, id).unwrap();
        world.get::<Transform>(entity).unwrap().translation
    }

    #[test]
    fn things_added_one_after_another_stand_beside_each_other() {
        for what in [
            Addition::PointLamp,
            Addition::DirectionalLamp,
            Addition::SegmentLamp,
            Addition::ParallelogramLamp,
            Addition::Camera,
            Addition::Shape("Cuboid".into()),
            Addition::Shape("Quad".into()),
        ] {
            for updates in [false, true] {
                let mut app = headless_editor();
                let size = app.world().resource::<AddAt>().size;
                let mut places: Vec<Vec3> = Vec::new();
                for _ in 0..9 {
                    let place = place(app.world_mut(), &what);
                    let apart = places.iter().map(|other| other.distance(place));
                    let nearest = apart.fold(f32::INFINITY, f32::min);
                    assert!(nearest > size, "{what:?}: {place} of {places:?}");
                    places.push(place);
                    if updates {
                        app.update();
                    }
                }
                let farthest = places.iter().map(|place| place.distance(places[0]));
                assert!(
                    farthest.fold(0.0, f32::max) < 2.0 * STEP * size,
                    "{places:?}"
                );
                assert_eq!(places[1] - places[0], STEP * size * Vec3::X, "{what:?}");
            }
        }
    }

    #[test]
    fn a_lamp_is_added_beside_another_kind_of_lamp_and_above_what_stands_below_it() {
        let mut app = headless_editor();
        let cube = place(app.world_mut(), &Addition::Shape("Cuboid".into()));
        let point = place(app.world_mut(), &Addition::PointLamp);
        let area = place(app.world_mut(), &Addition::ParallelogramLamp);
        assert_eq!([point.x, point.z], [cube.x, cube.z]);
        assert_eq!(area - point, STEP * Vec3::X);
    }

    #[test]
    fn a_floor_is_no_reason_to_stand_elsewhere() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let before = *world.resource::<AddAt>();
        let wide = AddAt {
            size: 10.0,
            ..before
        };
        world.insert_resource(wide);
        place(world, &Addition::Shape("Ground".into()));
        app.update();
        let world = app.world_mut();
        world.insert_resource(before);
        let found = place(world, &Addition::Shape("Cuboid".into()));
        assert_eq!(found, before.place);
    }
}

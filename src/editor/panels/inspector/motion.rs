//! What moves while the shutter is open, by itself and with what it hangs below.

use super::super::fields::row;
use super::super::says::Says;
use super::camera::optional_ui;
use super::switches::switches_ui;
use crate::editor::edits::AddAt;
use crate::editor::extent::{extent_below, scene_extent, world_from_entity, world_from_parent};
use crate::editor::handles::Tools;
use crate::inspect::vector_text;
use crate::scene::{
    DirectionalLamp, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp, SceneCamera,
    SegmentLamp,
};
use crate::sync::WorldMotions;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec3};
use bevy::mesh::Mesh3d;
use bevy_egui::egui::Ui;

pub(super) fn motion_ui(ui: &mut Ui, world: &mut World, entities: &[Entity]) {
    let movable = |&entity: &Entity| is_movable(world, entity);
    let movable: Vec<Entity> = entities.iter().copied().filter(movable).collect();
    if let Some(&active) = movable.first()
        && let Some(velocity) = inherited(world, active)
    {
        let says = "Metres in the world that it moves from time 0 to 1 with what it hangs below";
        row(ui, "Carried along", says, |ui| {
            ui.weak(vector_text(velocity)).says(says)
        });
    }
    optional_ui::<Motion>(
        ui,
        world,
        &movable,
        "Motion",
        new_motion,
        |ui, world, several| {
            switches_ui(ui, world, "Its smear", &["features.motion"]);
            several.properties(ui, &["velocity", "samples"]);
        },
    );
}

/// A motion that is seen: by half of the room that it takes with what hangs below, or, where that is a point, by a twentieth of
/// the scene's.
fn new_motion(world: &mut World, entity: Entity) -> Motion {
    let own = extent_below(world, entity);
    let own = own.map(|own| own.radius()).filter(|radius| *radius > 0.0);
    let way = own.or_else(|| Some(0.1 * scene_extent(world)?.radius()));
    let way = way.filter(|way| *way > 0.0).unwrap_or(0.1);
    let is_local = (world.get_resource::<Tools>()).is_some_and(|tools| tools.local);
    let turn = world_from_entity(world, entity).filter(|_| is_local);
    let turn = turn.map_or(Quat::IDENTITY, |place| place.rotation());
    let view = world
        .get_resource::<AddAt>()
        .copied()
        .unwrap_or_default()
        .view;
    let direction = off_the_arrows(view, turn);
    let parent_from_world = world_from_parent(world, entity).affine().inverse();
    let velocity = parent_from_world.transform_vector3(way * direction);
    Motion {
        // What hangs below something without size moves nowhere.
        velocity: if velocity.is_finite() {
            velocity
        } else {
            Vec3::ZERO
        },
        ..Motion::default()
    }
}

/// The direction along the floor that a view shows farthest from the arrows of the move tool, which lie along the axes of
/// `turn`: there its line can be seen, and its tip taken hold of.
fn off_the_arrows(view: Quat, turn: Quat) -> Vec3 {
    let seen = |direction: Vec3| (view.inverse() * direction).truncate();
    let arrows = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| seen(turn * axis));
    let apart = |direction: Vec3| {
        let tip = seen(direction);
        let to_arrow = arrows.map(|arrow| {
            let along = tip.dot(arrow) / arrow.length_squared().max(f32::MIN_POSITIVE);
            tip.distance(along.clamp(0.0, 1.0) * arrow)
        });
        to_arrow.into_iter().fold(f32::INFINITY, f32::min)
    };
    let all = [Vec3::NEG_X, Vec3::X, Vec3::NEG_Z, Vec3::Z];
    let between = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]
        .map(|(x, z)| Vec3::new(x, 0.0, z).normalize());
    let mut best = all[0];
    for direction in all.into_iter().chain(between) {
        // The first of several that are as good.
        if apart(direction) > apart(best) + 1e-3 {
            best = direction;
        }
    }
    best
}

/// Whether a motion of it can be seen: of itself, or of what hangs below it. A material stands nowhere, and a
/// directional lamp shines from infinitely far; where one of them has a motion, it can be taken away.
fn is_movable(world: &World, entity: Entity) -> bool {
    let Ok(entity) = world.get_entity(entity) else {
        return false;
    };
    let is_seen_moving = entity.contains::<Mesh3d>()
        || entity.contains::<MeshSource>()
        || entity.contains::<SceneCamera>()
        || entity.contains::<PointLamp>()
        || entity.contains::<SegmentLamp>()
        || entity.contains::<ParallelogramLamp>();
    let stands_still = entity.contains::<Phong>() || entity.contains::<DirectionalLamp>();
    let carries = entity.contains::<Children>() || entity.contains::<Motion>();
    is_seen_moving || carries || !stands_still
}

/// The velocity that an entity has of its ancestors, in the world.
fn inherited(world: &World, entity: Entity) -> Option<Vec3> {
    let parent = world.get::<ChildOf>(entity)?.parent();
    let motion = world.resource::<WorldMotions>().of(parent)?;
    Some(motion.velocity)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneId;

    #[test]
    fn what_can_be_seen_moving_and_what_carries_others_can_be_given_a_motion() {
        let mut world = World::new();
        let lamps = [
            world.spawn(PointLamp::default()).id(),
            world.spawn(SegmentLamp::default()).id(),
            world.spawn(ParallelogramLamp::default()).id(),
        ];
        let camera = world.spawn(SceneCamera::default()).id();
        let object = world.spawn((MeshSource::default(), Phong::default())).id();
        let group = world.spawn_empty().id();
        let sun = world.spawn(DirectionalLamp::default()).id();
        let material = world.spawn(Phong::default()).id();
        for entity in lamps.into_iter().chain([camera, object, group]) {
            assert!(is_movable(&world, entity), "{entity}");
        }
        for entity in [sun, material] {
            assert!(!is_movable(&world, entity), "{entity}");
        }
        world.entity_mut(lamps[0]).insert(ChildOf(sun));
        assert!(is_movable(&world, sun), "it carries a lamp");
        world.despawn(lamps[1]);
        assert!(!is_movable(&world, lamps[1]), "it is gone");
    }

    #[test]
    fn a_new_motion_moves_by_as_much_as_is_seen_in_the_world_whatever_it_hangs_on() {
        use bevy::transform::components::{GlobalTransform, Transform};
        let mut world = World::new();
        let half = Transform::from_scale(Vec3::splat(0.5));
        let parent = world.spawn((SceneId(1), half)).id();
        let ends = [Vec3::ZERO, Vec3::Y * 4.0];
        let lamp = SegmentLamp {
            ends,
            ..SegmentLamp::default()
        };
        let place = (Transform::default(), GlobalTransform::from(half));
        let lamp = world.spawn((SceneId(2), lamp, place, ChildOf(parent))).id();
        // Two metres in the world, of which its half is one: two of its parent's.
        assert_eq!(new_motion(&mut world, lamp).velocity, -2.0 * Vec3::X);
        // A point moves by a part of the scene.
        let at = (Transform::default(), GlobalTransform::default());
        let point = world.spawn((SceneId(3), PointLamp::default(), at)).id();
        let way = new_motion(&mut world, point).velocity.length();
        assert!((0.05..1.0).contains(&way), "{way} m");
    }

    #[test]
    fn a_new_motion_is_seen_beside_the_arrows_of_the_move_tool_from_everywhere() {
        for turn in [Quat::IDENTITY, Quat::from_rotation_y(0.7)] {
            for yaw in 0..24 {
                for pitch in [-1.2_f32, -0.6, -0.3, 0.0] {
                    let yaw = (yaw as f32 * 15.0).to_radians();
                    let view = Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch);
                    let seen = |direction: Vec3| (view.inverse() * direction).truncate();
                    let tip = seen(off_the_arrows(view, turn));
                    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
                        let arrow = seen(turn * axis);
                        let apart = (0..=50).map(|i| tip.distance(i as f32 / 50.0 * arrow));
                        let apart = apart.fold(f32::INFINITY, f32::min);
                        // Of the length of an arrow, which is 90 pixels.
                        assert!(apart > 0.25, "{apart} from {axis} at {yaw}, {pitch}");
                    }
                }
            }
        }
    }
}

//! What moves while the shutter is open, by itself and with what it hangs below.

use super::super::fields::row;
use super::super::says::Says;
use super::camera::optional_ui;
use crate::editor::inspection::column::vector_text;
use crate::scene::{
    DirectionalLamp, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp, SceneCamera,
    SegmentLamp,
};
use crate::sync::WorldMotions;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::world::World;
use bevy::math::Vec3;
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
    optional_ui::<Motion>(ui, world, &movable, "Motion", |ui, several| {
        several.properties(ui, &["velocity", "samples"]);
    });
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
}

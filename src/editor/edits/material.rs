//! Which shared material an object has.

use super::scene_entity;
use crate::scene::{MeshSource, Phong, SceneId, UsesMaterial};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use bevy::mesh::Mesh3d;
use bevy::transform::components::Transform;

/// What has a surface: what the outline calls an object, without a search through all of it.
pub(in crate::editor) fn is_object(world: &World, entity: Entity) -> bool {
    world.get::<Mesh3d>(entity).is_some() || world.get::<MeshSource>(entity).is_some()
}

/// Gives objects a shared material; those that have it already are not touched.
pub(in crate::editor) fn share_material(world: &mut World, objects: &[Entity], material: Entity) {
    for &object in objects {
        if world.get::<UsesMaterial>(object) != Some(&UsesMaterial(material)) {
            world.entity_mut(object).insert(UsesMaterial(material));
        }
    }
}

/// The same by their numbers. What is no object gets none, and nothing does what is no material by itself; returns
/// those that have another one now.
pub fn assign_material(world: &mut World, ids: &[SceneId], material: SceneId) -> Vec<SceneId> {
    let is_shared = |&entity: &Entity| {
        let is_placed = world.get::<Transform>(entity).is_some();
        world.get::<Phong>(entity).is_some() && !is_placed && !is_object(world, entity)
    };
    let Some(material) = scene_entity(world, material).filter(is_shared) else {
        return Vec::new();
    };
    let uses = UsesMaterial(material);
    let others = |&id: &SceneId| {
        let object = scene_entity(world, id).filter(|&entity| is_object(world, entity))?;
        (world.get(object) != Some(&uses)).then_some((id, object))
    };
    let (ids, objects): (Vec<SceneId>, Vec<Entity>) = ids.iter().filter_map(others).unzip();
    share_material(world, &objects, material);
    ids
}

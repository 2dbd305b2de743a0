//! Taking entities away.

use super::parents::{roots_of, with_descendants};
use super::scene_entity;
use crate::editor::history::remove;
use crate::scene::{Phong, SceneId, UsesMaterial};
use bevy::ecs::entity::Entity;
use bevy::ecs::world::World;
use std::collections::BTreeSet;

/// Removes entities and what is below them. Objects that used a removed material keep its look:
/// they get a material of their own.
pub fn delete(world: &mut World, ids: &[SceneId]) {
    let roots: Vec<Entity> = roots_of(world, ids)
        .into_iter()
        .filter_map(|id| scene_entity(world, id))
        .collect();
    let gone: BTreeSet<Entity> = roots
        .iter()
        .flat_map(|&root| with_descendants(world, root))
        .collect();
    let mut users = world.query::<(Entity, &UsesMaterial)>();
    let users: Vec<(Entity, Entity)> = users
        .iter(world)
        .filter(|(user, uses)| gone.contains(&uses.0) && !gone.contains(user))
        .map(|(user, uses)| (user, uses.0))
        .collect();
    for (user, material) in users {
        let look = world.get::<Phong>(material).cloned();
        let mut user = world.entity_mut(user);
        user.remove::<UsesMaterial>();
        if let Some(look) = look {
            user.insert(look);
        }
    }
    for root in roots {
        remove(world, root);
    }
}

use crate::scene::SceneId;
use bevy::prelude::{Entity, World};
use std::collections::BTreeSet;

/// Gives a number to each of these entities that has none, or one that an earlier entity has:
/// the next ones after the largest in the world, in the order given.
pub(crate) fn assign_ids(world: &mut World, entities: &[Entity]) {
    let mut all = world.query::<&SceneId>();
    let mut next = all.iter(world).map(|id| id.0).max().unwrap_or(0);
    let mut taken = BTreeSet::new();
    for &entity in entities {
        let id = world.get::<SceneId>(entity).copied().unwrap_or_default();
        if id.is_unassigned() || !taken.insert(id) {
            next += 1;
            world.entity_mut(entity).insert(SceneId(next));
            taken.insert(SceneId(next));
        }
    }
}

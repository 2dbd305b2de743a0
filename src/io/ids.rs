use crate::scene::SceneId;
use bevy::prelude::{Entity, World};
use std::collections::BTreeSet;

/// Gives a number to each of these entities that has none, or one that an earlier entity has:
/// the next ones after the largest in the world that are free, in the order given.
pub(crate) fn assign_ids(world: &mut World, entities: &[Entity]) {
    let mut all = world.query::<&SceneId>();
    let known: BTreeSet<u64> = all.iter(world).map(|id| id.0).collect();
    let mut next = known.last().copied().unwrap_or(0);
    let mut taken = BTreeSet::new();
    for &entity in entities {
        let id = world.get::<SceneId>(entity).copied().unwrap_or_default();
        if id.is_unassigned() || !taken.insert(id) {
            // A file may say u64::MAX: then what comes next is whatever is free from 1 on. Scene files cannot name
            // multiples of 2^32.
            loop {
                next = next.wrapping_add(1);
                if !known.contains(&next) && next.trailing_zeros() < 32 {
                    break;
                }
            }
            world.entity_mut(entity).insert(SceneId(next));
            taken.insert(SceneId(next));
        }
    }
}

use crate::scene::SceneId;
use bevy::prelude::{Entity, World};
use std::collections::BTreeSet;

/// Gives a number to each of these entities that has none, or one that an earlier entity has:
/// the next ones after the largest in the world that are free, in the order given.
pub(crate) fn assign_ids(world: &mut World, entities: &[Entity]) {
    let mut all = world.query::<&SceneId>();
    let known: BTreeSet<SceneId> = all.iter(world).copied().collect();
    let mut last = known.last().copied().unwrap_or_default();
    let mut taken = BTreeSet::new();
    for &entity in entities {
        let id = world.get::<SceneId>(entity).copied().unwrap_or_default();
        if id.is_unassigned() || !taken.insert(id) {
            last = last.next_free(|id| known.contains(&id));
            world.entity_mut(entity).insert(last);
            taken.insert(last);
        }
    }
}

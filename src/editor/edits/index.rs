//! Which entity has which number.

use crate::editor::history::LaidAside;
use crate::scene::SceneId;
use bevy::app::App;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::{Insert, Remove};
use bevy::ecs::observer::On;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, ResMut};
use bevy::ecs::world::World;
use std::collections::{HashMap, HashSet};

/// Entities by their numbers.
#[derive(Resource, Default)]
pub struct SceneIndex {
    entities: HashMap<SceneId, Entity>,
    /// The largest number that was ever seen: those of deleted entities are not given to others.
    largest: u64,
}

impl SceneIndex {
    /// The entity that has this number; none where it was deleted.
    pub fn find(&self, world: &World, id: SceneId) -> Option<Entity> {
        let entity = *self.entities.get(&id)?;
        let is_there =
            world.get::<SceneId>(entity) == Some(&id) && world.get::<LaidAside>(entity).is_none();
        is_there.then_some(entity)
    }

    /// Numbers that were changed in place are noticed by those who look at changes.
    pub(in crate::editor) fn learn(&mut self, world: &World, id: SceneId, entity: Entity) {
        self.largest = self.largest.max(id.0);
        // Of two with the same number the first keeps it; `sync` gives the other another.
        if self.find(world, id).is_none() {
            self.entities.insert(id, entity);
        }
    }

    pub(in crate::editor) fn watch(app: &mut App) {
        app.add_observer(
            |new: On<Insert, SceneId>, ids: Query<&SceneId>, mut index: ResMut<Self>| {
                let Ok(&id) = ids.get(new.entity) else { return };
                if id.is_unassigned() {
                    return;
                }
                index.largest = index.largest.max(id.0);
                let known = index.entities.get(&id).copied();
                if known.is_none_or(|entity| ids.get(entity) != Ok(&id)) {
                    index.entities.insert(id, new.entity);
                }
            },
        )
        .add_observer(
            |gone: On<Remove, SceneId>, ids: Query<&SceneId>, mut index: ResMut<Self>| {
                if let Ok(id) = ids.get(gone.entity)
                    && index.entities.get(id) == Some(&gone.entity)
                {
                    index.entities.remove(id);
                }
            },
        );
    }
}

/// The entity that has this number.
pub fn scene_entity(world: &World, id: SceneId) -> Option<Entity> {
    world.get_resource::<SceneIndex>()?.find(world, id)
}

/// Numbers that no entity has or had.
pub(super) struct FreeIds {
    taken: HashSet<SceneId>,
    last: SceneId,
}

impl FreeIds {
    pub fn new(world: &mut World) -> Self {
        let mut all = world.query::<&SceneId>();
        let taken: HashSet<SceneId> = all.iter(world).copied().collect();
        let largest = SceneId(world.resource::<SceneIndex>().largest);
        Self {
            last: taken.iter().copied().fold(largest, SceneId::max),
            taken,
        }
    }

    pub fn next(&mut self) -> SceneId {
        self.last = self.last.next_free(|id| self.taken.contains(&id));
        self.last
    }
}

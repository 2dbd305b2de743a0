use super::reading::Switched;
use crate::scene::{AnyLamp, NotTraced, Phong, SceneCamera, SceneId};
use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::query::{Added, Changed, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, ResMut, SystemParam};
use bevy::mesh::Mesh3d;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::transform::components::Transform;

/// Which entity has which number.
#[derive(Resource, Default)]
pub struct IdOwners {
    owners: HashMap<u64, Entity>,
    /// The other way round.
    numbers: EntityHashMap<u64>,
    /// The largest number that was ever seen. Numbers of deleted entities are not given to others,
    /// so that undo can bring them back.
    largest: u64,
}

impl IdOwners {
    /// Whose number it was when the scene was last taken over.
    pub fn owner(&self, id: SceneId) -> Option<Entity> {
        self.owners.get(&id.0).copied()
    }

    /// The entity has no number any more.
    fn free(&mut self, entity: Entity) {
        if let Some(number) = self.numbers.remove(&entity) {
            self.owners.remove(&number);
        }
    }

    fn give(&mut self, id: SceneId, entity: Entity) {
        self.free(entity);
        self.owners.insert(id.0, entity);
        self.numbers.insert(entity, id.0);
    }
}

#[cfg(test)]
impl IdOwners {
    /// How many are known.
    pub fn kept(&self) -> usize {
        self.owners.len().max(self.numbers.len())
    }
}

type OfScene = Or<(With<Mesh3d>, With<Phong>, AnyLamp, With<SceneCamera>)>;

/// What has a place and no number.
type Place = (With<Transform>, Without<SceneId>, Without<NotTraced>);

/// Whose numbers, or whose need of one, may be others than before.
#[derive(SystemParam)]
pub(super) struct Edited<'w, 's> {
    changed: Query<'w, 's, Entity, Changed<SceneId>>,
    missing: Query<'w, 's, Entity, (OfScene, Without<SceneId>, Without<NotTraced>)>,
    hung: Query<'w, 's, Entity, (Changed<ChildOf>, With<SceneId>)>,
    placed: Query<'w, 's, Entity, (Added<Transform>, With<Children>, Place)>,
    no_id: RemovedComponents<'w, 's, SceneId>,
    traced_again: RemovedComponents<'w, 's, NotTraced>,
    switched: Switched<'w, 's>,
}

/// Gives every entity of the scene a number of its own, and so every place that one of them hangs on. Of two
/// with the same number the one that had it first keeps it; among those that appear in the same frame, the one with the lower index.
pub(super) fn assign_scene_ids(
    mut edited: Edited,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    places: Query<Entity, Place>,
    ids: Query<&SceneId>,
    mut known: ResMut<IdOwners>,
    mut commands: Commands,
) {
    let switched: Vec<Entity> = edited.switched.read().collect();
    let bared: Vec<Entity> = (edited.no_id.read())
        .chain(edited.traced_again.read())
        .collect();
    // Who was made disabled has none when it is enabled.
    let mut numbered: Vec<Entity> = edited.changed.iter().chain(switched.clone()).collect();
    let mut without: Vec<Entity> = edited.missing.iter().collect();
    // What is above them needs a number too.
    let mut lower: Vec<Entity> = without.clone();
    lower.extend(&edited.hung);
    let may_be_above = switched.iter().chain(&bared).copied().chain(&edited.placed);
    lower.extend(may_be_above.filter_map(|place| {
        let mut below = places.get(place).into_iter();
        below.find_map(|place| {
            let mut all = children.iter_descendants(place);
            all.find(|entity| ids.contains(*entity))
        })
    }));
    if numbered.is_empty() && bared.is_empty() && lower.is_empty() {
        return;
    }

    for &entity in numbered.iter().chain(&bared) {
        let now = ids.get(entity).ok().map(|id| id.0);
        if known.numbers.get(&entity).copied() != now {
            known.free(entity);
        }
    }
    numbered.retain(|entity| ids.contains(*entity));
    numbered.sort_unstable_by_key(|entity| entity.index_u32());
    numbered.dedup();
    for &entity in &numbered {
        let Ok(&id) = ids.get(entity) else { continue };
        known.largest = known.largest.max(id.0);
        let owner = known.owners.get(&id.0).copied();
        if id.is_unassigned() || owner.is_some_and(|owner| owner != entity) {
            without.push(entity);
        } else {
            known.give(id, entity);
        }
    }
    let mut above: HashSet<Entity> = HashSet::default();
    for entity in numbered.into_iter().chain(lower) {
        // What is above one that was met already was met with it.
        let news = parents
            .iter_ancestors(entity)
            .take_while(|entity| above.insert(*entity));
        without.extend(news.filter(|entity| places.contains(*entity)));
    }
    without.sort_unstable_by_key(|entity| entity.index_u32());
    without.dedup();
    for entity in without {
        let id = next(&mut known);
        known.give(id, entity);
        commands.entity(entity).insert(id);
    }
}

fn next(known: &mut IdOwners) -> SceneId {
    let next = SceneId(known.largest).next_free(|id| known.owners.contains_key(&id.0));
    known.largest = next.0;
    next
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::app::{App, Update};

    fn app() -> App {
        let mut app = App::new();
        app.init_resource::<IdOwners>()
            .add_systems(Update, assign_scene_ids);
        app
    }

    fn id(app: &App, entity: Entity) -> u64 {
        app.world().get::<SceneId>(entity).map_or(0, |id| id.0)
    }

    #[test]
    fn entities_without_a_number_get_the_next_one_and_keep_it() {
        let mut app = app();
        let fixed = app.world_mut().spawn(SceneId(7)).id();
        let zero = app.world_mut().spawn(SceneId(0)).id();
        let none = app.world_mut().spawn(Phong::default()).id();
        app.update();
        assert_eq!([id(&app, fixed), id(&app, zero), id(&app, none)], [7, 8, 9]);
        app.update();
        assert_eq!([id(&app, fixed), id(&app, zero), id(&app, none)], [7, 8, 9]);
    }

    #[test]
    fn a_copy_gets_a_new_number_and_the_original_keeps_its_own() {
        let mut app = app();
        let gone = app.world_mut().spawn_empty().id();
        let original = app.world_mut().spawn(SceneId(3)).id();
        app.update();
        // The copy takes the freed, lower index, and must not win by it.
        app.world_mut().despawn(gone);
        let copy = app.world_mut().spawn(SceneId(3)).id();
        app.update();
        assert_eq!([id(&app, original), id(&app, copy)], [3, 4]);
    }

    #[test]
    fn what_an_object_hangs_on_is_of_the_scene_too_and_what_it_carries_is_not() {
        let mut app = app();
        let world = app.world_mut();
        let root = world.spawn(Transform::default()).id();
        let middle = world.spawn((Transform::default(), ChildOf(root))).id();
        let object = world.spawn((Phong::default(), ChildOf(middle))).id();
        let other = world.spawn((Transform::default(), ChildOf(object))).id();
        let own = world.spawn((Transform::default(), NotTraced)).id();
        world.spawn((Phong::default(), ChildOf(own)));
        app.update();
        let ids = [root, middle, object, other, own].map(|entity| id(&app, entity) > 0);
        assert_eq!(ids, [true, true, true, false, false]);
        let late = app.world_mut().spawn(Transform::default()).id();
        app.world_mut().entity_mut(root).insert(ChildOf(late));
        app.world_mut().entity_mut(object).insert(ChildOf(late));
        app.update();
        assert!(id(&app, late) > 0, "it hangs on it now");
    }

    #[test]
    fn the_number_of_a_deleted_entity_is_not_given_to_another() {
        let mut app = app();
        let first = app.world_mut().spawn(SceneId(5)).id();
        app.update();
        app.world_mut().despawn(first);
        app.update();
        let second = app.world_mut().spawn(SceneId(0)).id();
        app.update();
        assert_eq!(id(&app, second), 6);
    }

    #[test]
    fn a_number_that_scene_files_cannot_name_is_given_to_none() {
        let mut app = app();
        app.world_mut().spawn(SceneId(u32::MAX.into()));
        app.update();
        let new = app.world_mut().spawn(SceneId(0)).id();
        app.update();
        assert_eq!(id(&app, new), (1 << 32) + 1);
    }

    #[test]
    fn the_largest_number_leaves_room_for_others() {
        let mut app = app();
        let last = app.world_mut().spawn(SceneId(u64::MAX)).id();
        let first = app.world_mut().spawn(SceneId(1)).id();
        app.update();
        let new = app.world_mut().spawn(SceneId(0)).id();
        app.update();
        assert_eq!(
            [id(&app, last), id(&app, first), id(&app, new)],
            [u64::MAX, 1, 2]
        );
    }
}

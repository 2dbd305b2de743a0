use super::reading::Switched;
use crate::scene::{
    DirectionalLamp, NotTraced, ParallelogramLamp, Phong, PointLamp, SceneCamera, SceneId,
    SegmentLamp,
};
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::query::{Changed, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Commands, Query, ResMut};
use bevy::mesh::Mesh3d;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::transform::components::Transform;

/// Which entity has which number.
#[derive(Resource, Default)]
pub(super) struct IdOwners {
    owners: HashMap<u64, Entity>,
    /// The largest number that was ever seen. Numbers of deleted entities are not given to others,
    /// so that undo can bring them back.
    largest: u64,
}

#[cfg(test)]
impl IdOwners {
    /// How many are known.
    pub fn kept(&self) -> usize {
        self.owners.len()
    }
}

type OfScene = Or<(
    With<Mesh3d>,
    With<Phong>,
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
    With<SceneCamera>,
)>;

/// What has a place and no number.
type Place = (With<Transform>, Without<SceneId>, Without<NotTraced>);

/// Gives every entity of the scene a number of its own, and so every place that one of them hangs on. Of two
/// with the same number the one that had it first keeps it; among those that appear in the same frame, the one with the lower index.
pub(super) fn assign_scene_ids(
    changed: Query<(), Changed<SceneId>>,
    missing: Query<Entity, (OfScene, Without<SceneId>, Without<NotTraced>)>,
    hung: Query<(), (Changed<ChildOf>, With<SceneId>)>,
    parents: Query<&ChildOf>,
    places: Query<Entity, Place>,
    ids: Query<(Entity, &SceneId)>,
    mut switched: Switched,
    mut known: ResMut<IdOwners>,
    mut commands: Commands,
) {
    // Who was made disabled has none when it is enabled. Not `||`: the reader has to be emptied.
    if !switched.any() & changed.is_empty() & missing.is_empty() & hung.is_empty() {
        return;
    }
    let mut all: Vec<(Entity, SceneId)> = ids.iter().map(|(entity, id)| (entity, *id)).collect();
    all.sort_unstable_by_key(|(entity, _)| entity.index_u32());

    let mut owners = HashMap::with_capacity(all.len());
    for &(entity, id) in &all {
        known.largest = known.largest.max(id.0);
        if known.owners.get(&id.0) == Some(&entity) {
            owners.insert(id.0, entity);
        }
    }
    let mut without: Vec<Entity> = missing.iter().collect();
    let mut above: HashSet<Entity> = HashSet::default();
    for entity in all.iter().map(|(entity, _)| *entity).chain(&missing) {
        // What is above one that was met already was met with it.
        let news = parents
            .iter_ancestors(entity)
            .take_while(|entity| above.insert(*entity));
        without.extend(news.filter(|entity| places.contains(*entity)));
    }
    for (entity, id) in all {
        if id.is_unassigned() || *owners.entry(id.0).or_insert(entity) != entity {
            without.push(entity);
        }
    }
    without.sort_unstable_by_key(|entity| entity.index_u32());
    without.dedup();
    for entity in without {
        let id = next(&mut known.largest, &owners);
        owners.insert(id.0, entity);
        commands.entity(entity).insert(id);
    }
    known.owners = owners;
}

fn next(largest: &mut u64, owners: &HashMap<u64, Entity>) -> SceneId {
    // A file may say u64::MAX: then what comes next is whatever is free from 1 on.
    loop {
        *largest = largest.wrapping_add(1).max(1);
        if !owners.contains_key(largest) {
            return SceneId(*largest);
        }
    }
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

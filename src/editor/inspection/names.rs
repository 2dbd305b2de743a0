//! What objects, lights and materials are called.

use crate::inspect::Names;
use crate::scene::{SceneId, UsesMaterial};
use crate::sync::Traced;
use crate::trace::Object;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Added, Changed, Or};
use bevy::ecs::system::{Local, Query, Res, ResMut};
use bevy::platform::collections::HashMap;
use std::collections::BTreeMap;
use std::sync::Arc;

type Renamed = Or<(Changed<Name>, Changed<SceneId>)>;
/// Components whose absence is another name.
type Gone<'w, 's> = (
    RemovedComponents<'w, 's, Name>,
    RemovedComponents<'w, 's, SceneId>,
    RemovedComponents<'w, 's, UsesMaterial>,
    RemovedComponents<'w, 's, Disabled>,
);

/// What tells that a name, or who has it, may be another.
type News<'w, 's> = (
    Query<'w, 's, (), Renamed>,
    Query<'w, 's, (), Changed<UsesMaterial>>,
    Query<'w, 's, (), Added<Disabled>>,
);

/// Learns them where any may be another, and not because something merely moved.
pub(super) fn learn(
    changed: News,
    mut gone: Gone,
    traced: Res<Traced>,
    named: Query<(Option<&SceneId>, &Name)>,
    users: Query<(&SceneId, &UsesMaterial)>,
    mut of: Local<Option<Arc<Vec<Object>>>>,
    mut names: ResMut<Names>,
) {
    // All of them are read, so that none is heard of again in the next frame.
    let gone = [
        gone.0.read().count(),
        gone.1.read().count(),
        gone.2.read().count(),
        gone.3.read().count(),
    ];
    let switched = gone[3] > 0 || !changed.2.is_empty();
    let renamed = !changed.0.is_empty() || switched || gone[0] + gone[1] > 0;
    let objects = &traced.world.objects;
    let same_objects = of.as_ref().is_some_and(|of| Arc::ptr_eq(of, objects));
    let assigned = renamed || !same_objects || !changed.1.is_empty() || gone[2] > 0;
    if !assigned {
        return;
    }
    *of = Some(objects.clone());
    let mut is_other = false;
    if renamed {
        let things: BTreeMap<u64, String> = named
            .iter()
            .filter_map(|(id, name)| Some((id?.0, name.to_string())))
            .collect();
        if names.things != things {
            names.things = things;
            is_other = true;
        }
    }
    let shared: HashMap<u64, Entity> = users.iter().map(|(id, user)| (id.0, user.0)).collect();
    let materials: HashMap<u32, String> = objects
        .iter()
        .filter_map(|object| {
            let (_, name) = named.get(*shared.get(&object.id)?).ok()?;
            Some((object.material, name.to_string()))
        })
        .collect();
    if names.materials != materials {
        names.materials = materials;
        is_other = true;
    }
    if is_other {
        names.version += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::Bench;
    use super::*;
    use crate::scene::Phong;

    #[test]
    fn names_are_learnt_again_when_one_is_given_or_goes_and_not_when_something_moves() {
        let mut bench = Bench::open("cornell-box");
        let names = |bench: &Bench| {
            let names = bench.app.world().resource::<Names>();
            (names.version, names.things.clone())
        };
        let (version, things) = names(&bench);
        bench.move_something();
        assert_eq!(names(&bench), (version, things));
        let thing = (SceneId(4711), Name::new("Thing"));
        let thing = bench.app.world_mut().spawn(thing).id();
        bench.app.update();
        assert_eq!(names(&bench).1[&4711], "Thing");
        bench.app.world_mut().entity_mut(thing).despawn();
        bench.app.update();
        assert!(!names(&bench).1.contains_key(&4711));
    }

    #[test]
    fn a_material_that_an_object_is_given_is_known_by_its_name() {
        let mut bench = Bench::open("cornell-box");
        let world = bench.app.world_mut();
        let shared = (SceneId(4711), Name::new("Brass"), Phong::default());
        let shared = world.spawn(shared).id();
        let id = world.resource::<Traced>().world.objects[0].id;
        let mut objects = world.query::<(Entity, &SceneId)>();
        let object = objects.iter(world).find(|(_, other)| other.0 == id);
        let (object, _) = object.unwrap();
        world.entity_mut(object).insert(UsesMaterial(shared));
        bench.app.update();
        let world = bench.app.world();
        let material = world.resource::<Traced>().world.objects[0].material;
        let name = world.resource::<Names>().of_material(material);
        assert!(name.ends_with(" Brass"), "{name}");
    }
}

//! What an app's own entities carry besides what undo keeps: while they are deleted it is laid
//! aside, on an entity that nobody looks at, and undo gives it back.

use super::within::OnlyWithin;
use crate::io::KeptComponents;
use crate::scene::SceneId;
use bevy::ecs::entity::{Entity, EntityCloner};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::Children;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::World;
use std::collections::HashMap;

/// By the numbers of what was deleted.
#[derive(Resource, Default)]
pub(super) struct Aside(HashMap<SceneId, Entity>);

/// Removes an entity of the scene and all that is below it, so that undo can bring it back.
pub(in crate::editor) fn remove(world: &mut World, entity: Entity) {
    if world.contains_resource::<OnlyWithin>() {
        let mut below = vec![entity];
        let mut next = 0;
        while let Some(&entity) = below.get(next) {
            next += 1;
            below.extend(world.get::<Children>(entity).into_iter().flatten());
        }
        for entity in below {
            lay_aside(world, entity);
        }
    }
    // It may have gone with its parent.
    if let Ok(entity) = world.get_entity_mut(entity) {
        entity.despawn();
    }
}

fn lay_aside(world: &mut World, entity: Entity) {
    let Some(id) = world.get::<SceneId>(entity).copied() else {
        return;
    };
    let aside = world.spawn(Disabled).id();
    carry(world, entity, aside);
    let before = world.resource_mut::<Aside>().0.insert(id, aside);
    if let Some(before) = before {
        world.despawn(before);
    }
}

/// Moves all that undo does not keep from one entity to another.
fn carry(world: &mut World, from: Entity, to: Entity) {
    EntityCloner::build_opt_out(world)
        .move_components(true)
        .without_required_by_components(|cloner| {
            cloner
                .deny::<KeptComponents>()
                .deny::<(Children, Disabled)>();
        })
        .clone_entity(from, to);
}

/// Gives an entity that was made anew what was laid aside of it.
pub(super) fn give_back(world: &mut World, id: SceneId, entity: Entity) {
    let aside = world.get_resource_mut::<Aside>();
    if let Some(aside) = aside.and_then(|mut aside| aside.0.remove(&id)) {
        carry(world, aside, entity);
        world.despawn(aside);
    }
}

/// Nothing that was deleted comes back any more.
pub(super) fn forget(world: &mut World) {
    let Some(mut aside) = world.get_resource_mut::<Aside>() else {
        return;
    };
    let all: Vec<Entity> = aside.0.drain().map(|(_, entity)| entity).collect();
    for entity in all {
        world.despawn(entity);
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HistoryPlugin, redo, undo, within};
    use super::*;
    use crate::app::headless_app_with;
    use crate::editor::edits::{EditsPlugin, delete, scene_entity};
    use crate::scene::PointLamp;
    use bevy::ecs::component::Component;
    use bevy::ecs::hierarchy::ChildOf;
    use bevy::transform::components::Transform;

    /// Neither reflected nor cloned.
    #[derive(Component, Debug, PartialEq)]
    struct Own(u32);

    #[test]
    fn what_an_app_put_on_an_entity_comes_back_with_it() {
        let mut app = headless_app_with((HistoryPlugin, EditsPlugin));
        app.init_resource::<OnlyWithin>();
        let world = app.world_mut();
        let parent = (SceneId(1), Own(1), PointLamp::default());
        let parent = world
            .spawn((parent, Transform::from_xyz(1.0, 0.0, 0.0)))
            .id();
        world.spawn((SceneId(2), Own(2), PointLamp::default(), ChildOf(parent)));
        app.update();
        app.update();
        for _ in 0..2 {
            within(app.world_mut(), |world| delete(world, &[SceneId(1)]));
            app.update();
            let mut own = app.world_mut().query::<&Own>();
            assert_eq!(
                own.iter(app.world()).count(),
                0,
                "nobody finds it meanwhile"
            );
            assert!(within(app.world_mut(), undo));
            app.update();
            for (id, place) in [(1, 1.0), (2, 0.0)] {
                let entity = scene_entity(app.world(), SceneId(id)).unwrap();
                let entity = app.world().entity(entity);
                assert_eq!(entity.get::<Own>(), Some(&Own(id as u32)));
                assert_eq!(entity.get::<Transform>().unwrap().translation.x, place);
            }
            assert!(within(app.world_mut(), redo));
            assert_eq!(scene_entity(app.world(), SceneId(2)), None);
            assert!(within(app.world_mut(), undo));
            app.update();
        }
        super::super::reset(app.world_mut());
        assert!(app.world().resource::<Aside>().0.is_empty());
    }
}

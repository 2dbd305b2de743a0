//! How an app's own entities are deleted: they are laid aside, disabled and as they are, and undo takes
//! them back. So they stay the same entities, with all that the app knows them by: its components,
//! observers, and what it has kept their `Entity` for. None of its observers hears of a component that
//! came or went.

use super::Removals;
use super::within::OnlyWithin;
use crate::scene::SceneId;
use crate::view::{enter_renderer, leave_renderer};
use bevy::camera::visibility::Visibility;
use bevy::ecs::change_detection::DetectChangesMut;
use bevy::ecs::component::{Component, Mutable};
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::Children;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{EntityWorldMut, World};
use bevy::transform::components::{GlobalTransform, Transform};
use std::collections::HashMap;

/// By the numbers of what was deleted: the entity, and what hangs on it that is no part of the scene.
#[derive(Resource, Default)]
pub(super) struct Aside(HashMap<SceneId, Vec<Entity>>);

/// On what was deleted and may come back.
#[derive(Component)]
pub(in crate::editor) struct LaidAside {
    was_drawn: bool,
}

/// Removes an entity of the scene and all that is below it, so that undo can bring it back.
pub(in crate::editor) fn remove(world: &mut World, entity: Entity) {
    if !world.contains_resource::<OnlyWithin>() {
        // It may have gone with its parent.
        if let Ok(entity) = world.get_entity_mut(entity) {
            entity.despawn();
        }
        return;
    }
    let mut below = vec![(entity, None)];
    let mut next = 0;
    while let Some(&(entity, mut hangs_on)) = below.get(next) {
        next += 1;
        // What the app itself has disabled stays so.
        if world.get::<Disabled>(entity).is_some() {
            continue;
        }
        if let Some(&id) = world.get::<SceneId>(entity) {
            world.resource_mut::<Aside>().0.insert(id, Vec::new());
            world.resource_mut::<Removals>().0.push(entity);
            hangs_on = Some(id);
        }
        if let Some(id) = hangs_on {
            lay_aside(world, id, entity);
        }
        let children = world.get::<Children>(entity).into_iter().flatten();
        below.extend(children.map(|&child| (child, hangs_on)));
    }
}

fn lay_aside(world: &mut World, id: SceneId, entity: Entity) {
    let Ok(mut entity) = world.get_entity_mut(entity) else {
        return;
    };
    let was_drawn = leave_renderer(&mut entity);
    entity.insert((Disabled, LaidAside { was_drawn }));
    let entity = entity.id();
    let mut aside = world.resource_mut::<Aside>();
    aside.0.entry(id).or_default().push(entity);
}

/// Brings back what has this number. False where it is not there any more.
pub(super) fn give_back(world: &mut World, id: SceneId) -> bool {
    let aside = world.get_resource_mut::<Aside>();
    let Some(all) = aside.and_then(|mut aside| aside.0.remove(&id)) else {
        return false;
    };
    let is_there = |entity: &Entity| world.get::<LaidAside>(*entity).is_some();
    let found = all.first().is_some_and(is_there);
    for entity in all {
        let Ok(mut entity) = world.get_entity_mut(entity) else {
            continue;
        };
        let Some(LaidAside { was_drawn }) = entity.take() else {
            continue;
        };
        entity.remove::<Disabled>();
        if was_drawn {
            enter_renderer(&mut entity);
        }
        // What it hangs on may have moved or have been hidden meanwhile, and the renderer takes only what
        // has changed.
        touch::<Transform>(&mut entity);
        touch::<GlobalTransform>(&mut entity);
        touch::<Visibility>(&mut entity);
    }
    found
}

fn touch<C: Component<Mutability = Mutable>>(entity: &mut EntityWorldMut) {
    if let Some(mut component) = entity.get_mut::<C>() {
        component.set_changed();
    }
}

/// Nothing that was deleted comes back any more.
pub(super) fn forget(world: &mut World) {
    let Some(mut aside) = world.get_resource_mut::<Aside>() else {
        return;
    };
    let all: Vec<Entity> = aside.0.drain().flat_map(|(_, all)| all).collect();
    for entity in all {
        // It may have gone with its parent, or by the app.
        if world.get::<LaidAside>(entity).is_some() {
            world.despawn(entity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{HistoryPlugin, redo, undo, within};
    use super::*;
    use crate::app::headless_app_with;
    use crate::editor::edits::{EditsPlugin, delete, scene_entity};
    use crate::scene::PointLamp;
    use crate::sync::Traced;
    use bevy::app::App;
    use bevy::ecs::event::EntityEvent;
    use bevy::ecs::hierarchy::ChildOf;
    use bevy::ecs::lifecycle::{Add, Remove};
    use bevy::ecs::observer::On;
    use bevy::ecs::system::ResMut;

    /// Neither reflected nor cloned.
    #[derive(Component, Debug, PartialEq)]
    struct Own(u32);

    #[derive(EntityEvent)]
    struct Poked {
        entity: Entity,
    }

    /// What the app's observers have heard.
    #[derive(Resource, Default, Debug, PartialEq)]
    struct Heard {
        pokes: u32,
        added: u32,
        removed: u32,
    }

    /// A lamp, a lamp below it, and something below that that is no part of the scene.
    fn app() -> (App, [Entity; 3]) {
        let mut app = headless_app_with((HistoryPlugin, EditsPlugin));
        app.init_resource::<OnlyWithin>().init_resource::<Heard>();
        let world = app.world_mut();
        let parent = (SceneId(1), Own(1), PointLamp::default());
        let parent = world
            .spawn((parent, Transform::from_xyz(1.0, 0.0, 0.0)))
            .id();
        let child = (SceneId(2), Own(2), PointLamp::default(), ChildOf(parent));
        let child = world.spawn(child).id();
        let other = world.spawn((Own(3), ChildOf(child))).id();
        app.update();
        app.update();
        (app, [parent, child, other])
    }

    fn lights(app: &mut App) -> usize {
        app.update();
        app.world().resource::<Traced>().world.lights.points.len()
    }

    #[test]
    fn what_was_deleted_comes_back_as_the_same_entity_with_all_that_hangs_on_it() {
        let (mut app, all) = app();
        assert_eq!(lights(&mut app), 2);
        for _ in 0..2 {
            within(app.world_mut(), |world| delete(world, &[SceneId(1)]));
            assert_eq!(lights(&mut app), 0);
            let mut own = app.world_mut().query::<&Own>();
            assert_eq!(
                own.iter(app.world()).count(),
                0,
                "nobody finds it meanwhile"
            );
            assert!(within(app.world_mut(), undo).is_some());
            assert_eq!(lights(&mut app), 2);
            for (entity, own) in all.into_iter().zip(1..) {
                let entity = app.world().entity(entity);
                assert_eq!(entity.get::<Own>(), Some(&Own(own)));
                assert!(!entity.contains::<Disabled>());
            }
            let child = scene_entity(app.world(), SceneId(2));
            assert_eq!(child, Some(all[1]));
            assert!(within(app.world_mut(), redo).is_some());
            assert_eq!(scene_entity(app.world(), SceneId(2)), None);
            assert!(within(app.world_mut(), undo).is_some());
            app.update();
        }
        assert!(within(app.world_mut(), redo).is_some());
        super::super::reset(app.world_mut());
        assert!(app.world().resource::<Aside>().0.is_empty());
        assert!(
            all.iter()
                .all(|entity| app.world().get_entity(*entity).is_err())
        );
    }

    #[test]
    fn the_apps_observers_hear_nothing_of_it_and_those_of_the_entity_are_there_again() {
        let (mut app, [parent, ..]) = app();
        let poke = |app: &mut App| app.world_mut().trigger(Poked { entity: parent });
        let mut lamp = app.world_mut().entity_mut(parent);
        lamp.observe(|_: On<Poked>, mut heard: ResMut<Heard>| heard.pokes += 1);
        app.add_observer(|_: On<Add, Own>, mut heard: ResMut<Heard>| heard.added += 1)
            .add_observer(|_: On<Remove, Own>, mut heard: ResMut<Heard>| heard.removed += 1);
        poke(&mut app);
        within(app.world_mut(), |world| delete(world, &[SceneId(1)]));
        app.update();
        assert!(within(app.world_mut(), undo).is_some());
        app.update();
        poke(&mut app);
        let expected = Heard {
            pokes: 2,
            added: 0,
            removed: 0,
        };
        assert_eq!(*app.world().resource::<Heard>(), expected);
    }

    #[test]
    fn what_was_deleted_below_something_stays_so_when_that_is_deleted_and_comes_back() {
        let (mut app, [parent, child, _]) = app();
        within(app.world_mut(), |world| delete(world, &[SceneId(2)]));
        assert_eq!(lights(&mut app), 1);
        within(app.world_mut(), |world| delete(world, &[SceneId(1)]));
        assert_eq!(lights(&mut app), 0);
        assert!(within(app.world_mut(), undo).is_some());
        assert_eq!(lights(&mut app), 1);
        // It moves while what hangs on it is not there.
        let mut place = app.world_mut().get_mut::<Transform>(parent).unwrap();
        place.translation.x = 5.0;
        assert_eq!(lights(&mut app), 1);
        assert!(within(app.world_mut(), undo).is_some());
        assert_eq!(lights(&mut app), 2);
        let place = app.world().get::<GlobalTransform>(child).unwrap();
        assert_eq!(place.translation().x, 5.0);
    }

    #[test]
    fn what_the_app_despawned_meanwhile_is_made_anew() {
        let (mut app, [parent, ..]) = app();
        within(app.world_mut(), |world| delete(world, &[SceneId(1)]));
        app.world_mut().despawn(parent);
        assert!(within(app.world_mut(), undo).is_some());
        assert_eq!(lights(&mut app), 2);
    }
}

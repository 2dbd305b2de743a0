//! Who is whose parent.

use super::{SceneIndex, scene_entity};
use crate::editor::history::LaidAside;
use crate::io::place::world_from;
use crate::scene::SceneId;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::{ChildOf, Children};
use bevy::ecs::world::World;
use bevy::math::{Affine3A, Mat4};
use bevy::transform::components::Transform;
use std::collections::BTreeSet;

/// Those of these that have no ancestor among them, in the order given, each once.
pub fn roots_of(world: &World, ids: &[SceneId]) -> Vec<SceneId> {
    let among: BTreeSet<Entity> = ids
        .iter()
        .filter_map(|&id| scene_entity(world, id))
        .collect();
    let mut seen = BTreeSet::new();
    ids.iter()
        .copied()
        .filter(|&id| {
            scene_entity(world, id).is_some_and(|entity| {
                seen.insert(entity) && !ancestors(world, entity).any(|above| among.contains(&above))
            })
        })
        .collect()
}

/// From an entity's parent upwards.
pub(in crate::editor) fn ancestors(world: &World, entity: Entity) -> impl Iterator<Item = Entity> {
    let parent = |entity: &Entity| world.get::<ChildOf>(*entity).map(|child_of| child_of.0);
    std::iter::successors(parent(&entity), parent)
}

/// An entity and all below it that are of the scene, parents before children.
pub(super) fn with_descendants(world: &World, root: Entity) -> Vec<Entity> {
    below(world, root, |child| world.get::<SceneId>(child).is_some())
}

/// The same, of the scene or not.
pub(in crate::editor) fn all_below(world: &World, root: Entity) -> Vec<Entity> {
    below(world, root, |_| true)
}

/// An entity and those below it that are `wanted` and not deleted.
fn below(world: &World, root: Entity, wanted: impl Fn(Entity) -> bool) -> Vec<Entity> {
    let mut found = vec![root];
    let mut next = 0;
    while let Some(&entity) = found.get(next) {
        next += 1;
        let children = world.get::<Children>(entity).into_iter().flatten();
        let there = children.copied();
        let there = there.filter(|&child| world.get::<LaidAside>(child).is_none());
        found.extend(there.filter(|&child| wanted(child)));
    }
    found
}

/// Makes entities children of another, or of none. They stay where they are in the world, but for
/// shear, which a `Transform` cannot say. Those that the parent stands below itself stay as they are, and all do where the
/// parent stands nowhere, as a material: Bevy places nothing below such.
pub fn reparent(world: &mut World, ids: &[SceneId], parent: Option<SceneId>) {
    let parent = match parent {
        Some(id) => match scene_entity(world, id) {
            Some(entity) if world.get::<Transform>(entity).is_some() => Some(entity),
            _ => return,
        },
        None => None,
    };
    for id in roots_of(world, ids) {
        let Some(entity) = world.resource::<SceneIndex>().find(world, id) else {
            continue;
        };
        let now = world.get::<ChildOf>(entity).map(|child_of| child_of.0);
        let below_itself = parent.is_some_and(|parent| {
            parent == entity || ancestors(world, parent).any(|above| above == entity)
        });
        if now == parent || below_itself {
            continue;
        }
        let world_from_entity = world_from(world, entity);
        let world_from_parent =
            parent.map_or(Affine3A::IDENTITY, |parent| world_from(world, parent));
        let place = place_in(world_from_parent, world_from_entity);
        let has_place = world.get::<Transform>(entity).is_some();
        let mut entity = world.entity_mut(entity);
        match parent {
            Some(parent) => entity.insert(ChildOf(parent)),
            None => entity.remove::<ChildOf>(),
        };
        if has_place && let Some(place) = place {
            entity.insert(place);
        }
    }
}

/// The transform below a parent that gives this place in the world. `None` where the parent is flat:
/// then no transform does.
pub(super) fn place_in(
    world_from_parent: Affine3A,
    world_from_entity: Affine3A,
) -> Option<Transform> {
    let parent_from_entity = world_from_parent.inverse() * world_from_entity;
    let place = Transform::from_matrix(Mat4::from(parent_from_entity));
    let finite =
        place.translation.is_finite() && place.rotation.is_finite() && place.scale.is_finite();
    finite.then_some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::headless_editor;
    use crate::scene::Phong;
    use bevy::ecs::name::Name;

    #[test]
    fn what_stands_somewhere_becomes_no_child_of_what_does_not() {
        let mut app = headless_editor();
        let world = app.world_mut();
        let place = Transform::from_xyz(1.0, 2.0, 3.0);
        let child = world.spawn((SceneId(1), Name::new("Box"), place)).id();
        world.spawn((SceneId(2), Name::new("Red"), Phong::default()));
        world.spawn((SceneId(3), Name::new("Group"), place));
        app.update();
        let world = app.world_mut();
        reparent(world, &[SceneId(1)], Some(SceneId(2)));
        assert!(world.get::<ChildOf>(child).is_none());
        reparent(world, &[SceneId(1)], Some(SceneId(3)));
        assert!(world.get::<ChildOf>(child).is_some());
        assert_eq!(world.get::<Transform>(child), Some(&Transform::IDENTITY));
    }
}

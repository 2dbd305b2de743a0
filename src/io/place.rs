use bevy::camera::visibility::Visibility;
use bevy::ecs::hierarchy::ChildOf;
use bevy::math::Affine3A;
use bevy::prelude::{Entity, World};
use bevy::transform::components::Transform;

/// From an entity's space to the world's, computed from the transforms of its ancestors, so that
/// it holds before any system has run.
pub(crate) fn world_from(world: &World, entity: Entity) -> Affine3A {
    let mut place = local(world, entity);
    let mut at = entity;
    while let Some(&ChildOf(parent)) = world.get::<ChildOf>(at) {
        place = local(world, parent) * place;
        at = parent;
    }
    place
}

fn local(world: &World, entity: Entity) -> Affine3A {
    let transform = world.get::<Transform>(entity);
    transform.map_or(Affine3A::IDENTITY, Transform::compute_affine)
}

/// Whether an entity is hidden, by itself or by an ancestor that it inherits from.
pub(crate) fn is_hidden(world: &World, entity: Entity) -> bool {
    let mut at = entity;
    loop {
        match world.get::<Visibility>(at) {
            Some(Visibility::Hidden) => return true,
            Some(Visibility::Visible) => return false,
            Some(Visibility::Inherited) | None => {}
        }
        match world.get::<ChildOf>(at) {
            Some(&ChildOf(parent)) => at = parent,
            None => return false,
        }
    }
}

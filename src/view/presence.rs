//! Entities that the renderer forgets for a while.

use bevy::ecs::world::EntityWorldMut;
use bevy::render::sync_world::{RenderEntity, SyncToRenderWorld};

/// Takes an entity out of the renderer, which would go on drawing a disabled light or camera as it saw it
/// last. It is to be called before the entity is disabled. True where the renderer knew it.
pub(crate) fn leave_renderer(entity: &mut EntityWorldMut) -> bool {
    let was_known = entity.contains::<SyncToRenderWorld>();
    // In this order: Bevy asks which entity of the renderer's it was.
    entity.remove::<SyncToRenderWorld>();
    entity.remove::<RenderEntity>();
    was_known
}

/// Puts it back.
pub(crate) fn enter_renderer(entity: &mut EntityWorldMut) {
    entity.insert(SyncToRenderWorld);
}

//! What panels remember between two frames: a resource each, which is taken out of the world while the panel is drawn.

use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};

/// The picture fills the window, and the panels around it are not drawn.
#[derive(Resource, Default)]
pub(super) struct OnlyPicture(pub bool);

/// Draws a panel with what it remembers.
pub(super) fn with<S: Resource, R>(
    world: &mut World,
    draw: impl FnOnce(&mut World, &mut S) -> R,
) -> R {
    world.resource_scope(|world, mut state: Mut<S>| draw(world, &mut state))
}

//! What panels remember between two frames: a resource each, which is taken out of the world while the panel is drawn.

use crate::scene::SceneId;
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{Mut, World};

/// A name that is being typed.
#[derive(Clone, Debug)]
pub(super) struct Renaming {
    pub id: SceneId,
    pub text: String,
    /// The field has the keys; until then it asks for them.
    pub focused: bool,
}

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

//! Sources become handles at once, and not only in the next frame.

use super::sources::{resolve_environment, resolve_meshes, resolve_pictures};
use bevy::prelude::World;
#[cfg(feature = "editor")]
use {
    super::LoadProblems,
    crate::scene::{Environment, MeshSource, Phong},
    bevy::prelude::Entity,
};

/// What the systems of [`super::IoPlugin`] do each frame, now.
pub(super) fn resolve(world: &mut World) {
    for result in [
        world.run_system_cached(resolve_meshes),
        world.run_system_cached(resolve_pictures),
        world.run_system_cached(resolve_environment),
    ] {
        // Fails only where the plugin's resources are missing; the first frame would say the same.
        if let Err(error) = result {
            bevy::log::error!("sources were not resolved: {error}");
        }
    }
}

/// Tries again what could not be loaded.
#[cfg(feature = "editor")]
pub(super) fn retry(world: &mut World) {
    use bevy::ecs::change_detection::DetectChangesMut;
    let mut failed: Vec<(Option<Entity>, &str)> = Vec::new();
    if let Some(problems) = world.get_resource::<LoadProblems>() {
        failed.extend(problems.problems.iter().map(|p| (p.entity, p.what)));
    }
    for (entity, _) in failed {
        match entity {
            Some(entity) => {
                if let Some(mut source) = world.get_mut::<MeshSource>(entity) {
                    source.set_changed();
                }
                if let Some(mut phong) = world.get_mut::<Phong>(entity) {
                    phong.set_changed();
                }
            }
            None => {
                if let Some(mut environment) = world.get_resource_mut::<Environment>() {
                    environment.set_changed();
                }
            }
        }
    }
}

//! Adding to the open scene what a model file holds.

use super::budget::beside;
use super::error::{FileError, Place};
use super::folder::Folder;
use super::loader::{Loader, read_model};
use super::notes::Notes;
use super::open::Loaded;
use super::resolve::resolve;
use super::scene_file::Rebase;
use super::sources::SceneFiles;
use super::spawn::spawn_model;
use crate::scene::SceneId;
use bevy::camera::visibility::Visibility;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::prelude::{Entity, World};
use bevy::transform::components::Transform;
use std::path::Path;

/// What a model file added to the scene.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The entity that places all of it: the file's only root, or a group around its roots. None
    /// where the file holds materials alone.
    pub root: Option<Entity>,
    /// Materials that its objects share.
    pub materials: Vec<Entity>,
    /// What was left out or changed.
    pub notes: Notes,
}

/// Adds what a model file holds to the open scene; on an error the world is as it was.
/// `next` numbers the new entities.
///
/// A file outside the scene's folder can be imported, and the scene may from then on refer to
/// files outside it.
pub fn import(
    world: &mut World,
    file: &Path,
    mut next: impl FnMut() -> SceneId,
) -> Result<Imported, FileError> {
    world.init_resource::<SceneFiles>();
    let files = world.resource::<SceneFiles>();
    let (scene_folder, mut limits) = (files.folder.clone(), files.limits.clone());
    limits.memory = beside(&limits.memory, world);
    let folder = Folder::of(file, scene_folder.allow_outside);
    let mut model = read_model(file, &folder, &limits)?;
    let path = scene_folder.name_of(file);
    let mut loaded = Loaded::of_model(&mut model, &path, &mut Loader::new(&folder, &limits))?;
    let rebase = Rebase::between(folder, scene_folder, file);
    let mut notes = std::mem::take(&mut model.notes);
    notes.append(std::mem::take(&mut loaded.notes));
    if model.environment.is_some() {
        notes.add(
            file,
            Place::Whole,
            "an environment",
            "the scene keeps its own",
        );
    }
    for (source, _, _) in &mut loaded.pictures {
        source.path = rebase.path(&source.path, &mut notes);
    }
    for (_, phong) in &mut model.materials {
        rebase.apply(phong, &mut notes);
    }
    if path.starts_with("..") {
        world.resource_mut::<SceneFiles>().folder.allow_outside = true;
    }
    loaded.forget_known(world);
    let held = loaded.hand_over(world);
    let spawned = spawn_model(world, model, &path, &mut next);
    let roots: Vec<Entity> = spawned
        .nodes
        .iter()
        .copied()
        .filter(|&node| world.get::<ChildOf>(node).is_none())
        .collect();
    let root = match roots[..] {
        [] => None,
        [only] => Some(only),
        _ => {
            let name = file
                .file_stem()
                .map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
            let place = (Transform::default(), Visibility::default());
            let group = world.spawn((next(), Name::new(name), place)).id();
            for root in roots {
                world.entity_mut(root).insert(ChildOf(group));
            }
            Some(group)
        }
    };
    resolve(world);
    drop(held);
    Ok(Imported {
        root,
        materials: spawned.materials,
        notes,
    })
}

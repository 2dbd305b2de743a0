//! A model becomes entities.

use super::model::Model;
use super::sources::SceneFiles;
use crate::scene::{MeshSource, SceneId, UsesMaterial};
use bevy::asset::{Assets, Handle};
use bevy::camera::primitives::{Aabb, MeshAabb};
use bevy::camera::visibility::Visibility;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::name::Name;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::{Entity, World};

/// Entities that a model became.
pub(super) struct SpawnedModel {
    /// Materials that objects share.
    pub materials: Vec<Entity>,
    /// Parents before their children.
    pub nodes: Vec<Entity>,
}

/// Makes a model's entities; `path` is what its meshes' sources call the file.
pub(super) fn spawn_model(
    world: &mut World,
    model: Model,
    path: &str,
    next: &mut dyn FnMut() -> SceneId,
) -> SpawnedModel {
    let materials: Vec<Entity> = model
        .materials
        .into_iter()
        .map(|(name, phong)| world.spawn((next(), Name::new(name), phong)).id())
        .collect();
    let mut spawned: Vec<Entity> = Vec::with_capacity(model.nodes.len());
    for node in model.nodes {
        let base = (
            next(),
            Name::new(node.name),
            node.transform,
            Visibility::default(),
        );
        let material = node.material.and_then(|index| materials.get(index));
        let material = material.map(|&material| UsesMaterial(material));
        let mesh = node.mesh.map(|name| {
            let path = path.to_owned();
            let source = MeshSource::File { path, name };
            let (handle, bounds) = loaded_mesh(world, &source).unwrap_or_default();
            (source, Mesh3d(handle), bounds)
        });
        // All at once: each kind of entity that they would be on the way would keep its room for all of them.
        let mut entity = match (mesh, material) {
            (Some(mesh), Some(material)) => world.spawn((base, mesh, material)),
            (Some(mesh), None) => world.spawn((base, mesh)),
            (None, Some(material)) => world.spawn((base, material)),
            (None, None) => world.spawn(base),
        };
        if let Some(&parent) = node.parent.and_then(|parent| spawned.get(parent)) {
            entity.insert(ChildOf(parent));
        }
        if let Some(lamp) = node.point_lamp {
            entity.insert(lamp);
        }
        if let Some(lamp) = node.directional_lamp {
            entity.insert(lamp);
        }
        if let Some(camera) = node.camera {
            entity.insert(camera);
        }
        spawned.push(entity.id());
    }
    SpawnedModel {
        materials,
        nodes: spawned,
    }
}

/// The mesh of a source that has been handed over, and the box around it.
fn loaded_mesh(world: &mut World, source: &MeshSource) -> Option<(Handle<Mesh>, Aabb)> {
    let files = world.get_resource::<SceneFiles>()?;
    let id = files.loaded_mesh(source, world.get_resource::<Assets<Mesh>>()?)?;
    let mut assets = world.resource_mut::<Assets<Mesh>>();
    let bounds = assets.get(id)?.compute_aabb();
    Some((assets.get_strong_handle(id)?, bounds.unwrap_or_default()))
}

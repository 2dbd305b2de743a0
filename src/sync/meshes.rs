use super::mesh_data::{MeshFault, trace_mesh};
use super::traced::Draft;
use crate::bvh::{self, BuildOptions, Builder, Levels};
use crate::scene::{self, RenderSettings};
use crate::trace;
use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::Changed;
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::platform::collections::{HashMap, HashSet};
use rayon::prelude::*;
use std::sync::Arc;

/// The meshes that objects use, each with its tree; shared by all objects that use it.
#[derive(Resource, Default)]
pub(super) struct TracedMeshes {
    by_asset: HashMap<AssetId<Mesh>, Result<Arc<trace::Mesh>, MeshFault>>,
    options: BuildOptions,
}

impl TracedMeshes {
    /// The mesh of an asset.
    pub fn get(&self, id: AssetId<Mesh>) -> Result<&Arc<trace::Mesh>, MeshFault> {
        match self.by_asset.get(&id) {
            Some(Ok(mesh)) => Ok(mesh),
            Some(Err(fault)) => Err(fault.clone()),
            None => Err(MeshFault::Missing),
        }
    }

    /// How all trees are built.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }
}

/// Makes the trees of meshes that are new, were edited, or whose settings changed, and drops those
/// of meshes that no object uses any more.
pub(super) fn sync_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut removed: RemovedComponents<Mesh3d>,
    changed: Query<(), Changed<Mesh3d>>,
    users: Query<&Mesh3d>,
    assets: Res<Assets<Mesh>>,
    settings: Res<RenderSettings>,
    known: ResMut<TracedMeshes>,
    mut draft: ResMut<Draft>,
) {
    let known = known.into_inner();
    let options = build_options(&settings.tree);
    let mut stale = removed.read().count() > 0 || !changed.is_empty();
    if options != known.options {
        known.options = options;
        known.by_asset.clear();
        stale = true;
    }
    for event in events.read() {
        let (AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id }) =
            event
        else {
            continue;
        };
        known.by_asset.remove(id);
        stale = true;
    }
    if !stale {
        return;
    }
    let used: HashSet<AssetId<Mesh>> = users.iter().map(|mesh| mesh.id()).collect();
    known.by_asset.retain(|id, _| used.contains(id));
    let missing: Vec<AssetId<Mesh>> = used
        .into_iter()
        .filter(|id| !known.by_asset.contains_key(id))
        .collect();
    if missing.is_empty() {
        return;
    }
    // One tree over everything leaves the meshes' own unused.
    let mesh_options = match options.levels {
        Levels::One => BuildOptions {
            builder: Builder::None,
            ..options
        },
        Levels::Two => options,
    };
    let built: Vec<_> = missing
        .into_par_iter()
        .map(|id| {
            let mesh = assets.get(id).ok_or(MeshFault::Missing);
            (
                id,
                mesh.and_then(|mesh| trace_mesh(mesh, &mesh_options).map(Arc::new)),
            )
        })
        .collect();
    known.by_asset.extend(built);
    draft.changes.meshes = true;
}

/// The tree settings as the builders take them, moved into their ranges.
pub(super) fn build_options(tree: &scene::TreeSettings) -> BuildOptions {
    BuildOptions {
        builder: match tree.builder {
            scene::Builder::None => bvh::Builder::None,
            scene::Builder::Median => bvh::Builder::Median,
            scene::Builder::Sah => bvh::Builder::Sah,
            scene::Builder::Ploc => bvh::Builder::Ploc,
        },
        levels: match tree.levels {
            scene::Levels::One => bvh::Levels::One,
            scene::Levels::Two => bvh::Levels::Two,
        },
        max_depth: tree.max_depth.clamp(1, 64),
        max_leaf_size: tree.max_leaf_size.clamp(1, 255),
        bins: tree.bins.clamp(2, 64),
        preset: match tree.preset {
            scene::Preset::Fastest => bvh::Preset::Fastest,
            scene::Preset::Fast => bvh::Preset::Fast,
            scene::Preset::Medium => bvh::Preset::Medium,
            scene::Preset::Slow => bvh::Preset::Slow,
            scene::Preset::VerySlow => bvh::Preset::VerySlow,
        },
    }
}

use super::mesh_data::{MeshCopy, MeshFault, trace_mesh};
use super::posed::{PosedMesh, traced_mesh};
use super::reading::Switched;
use super::traced::Draft;
use super::tree_building::{Built, TreeBuilding, TreeThreads};
use crate::bvh::{self, BuildOptions, Builder, Levels};
use crate::scene::{self, NotTraced, RenderSettings};
use crate::trace;
use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::{Changed, Or, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::platform::collections::{HashMap, HashSet};
use rayon::prelude::*;
use std::sync::Arc;

/// The mesh of an asset with its tree, or why it has none.
pub(super) type MeshResult = Result<Arc<trace::Mesh>, MeshFault>;

/// The meshes that objects use, each with its tree; shared by all objects that use it.
#[derive(Resource, Default)]
pub(super) struct TracedMeshes {
    /// What is traced, all of it built with `options`.
    shown: HashMap<AssetId<Mesh>, MeshResult>,
    options: BuildOptions,
    /// How the trees shall be built. While these are not `options`, what was built with them waits in
    /// `ready` until all of it is there: trees of one kind are shown at a time.
    wanted: BuildOptions,
    ready: HashMap<AssetId<Mesh>, MeshResult>,
    /// What is being built, and whether it was edited since that began.
    building: HashMap<AssetId<Mesh>, bool>,
    threads: TreeThreads,
}

impl TracedMeshes {
    /// The mesh of an asset; `None` while its first tree is being built.
    pub fn get(&self, id: AssetId<Mesh>) -> Option<Result<&Arc<trace::Mesh>, MeshFault>> {
        let mesh = self.shown.get(&id)?;
        Some(mesh.as_ref().map_err(MeshFault::clone))
    }

    /// How all trees are built.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// What a mesh's own tree is built with.
    fn mesh_options(&self) -> BuildOptions {
        match self.wanted.levels {
            // One tree over everything leaves the meshes' own unused.
            Levels::One => BuildOptions {
                builder: Builder::None,
                ..self.wanted
            },
            Levels::Two => self.wanted,
        }
    }

    /// Takes what the threads have built, and says what of it has to be built again.
    fn take_built(&mut self, built: Vec<Built>, assets: &Assets<Mesh>) -> Vec<AssetId<Mesh>> {
        let mut again = Vec::new();
        for Built { id, options, mesh } in built {
            let edited = self.building.remove(&id).unwrap_or_default();
            let outdated = options != self.mesh_options();
            if edited || outdated {
                again.push(id);
            }
            // An edit follows the other in a gesture: that its beginning is seen is better than nothing.
            if !outdated && (!edited || assets.contains(id)) {
                self.ready.insert(id, mesh);
            }
        }
        again
    }

    /// Shows what is ready, and says whether anything was.
    fn show_ready(&mut self) -> bool {
        if self.options != self.wanted {
            if !self.building.is_empty() {
                return false;
            }
            self.shown = std::mem::take(&mut self.ready);
            self.options = self.wanted;
            return true;
        }
        let any = !self.ready.is_empty();
        self.shown.extend(self.ready.drain());
        any
    }
}

#[cfg(test)]
impl TracedMeshes {
    /// How many are kept.
    pub fn kept(&self) -> usize {
        self.shown.len() + self.ready.len() + self.building.len()
    }
}

/// What has another mesh now, or is posed as another.
type Dressed = (
    Or<(Changed<Mesh3d>, Changed<PosedMesh>)>,
    Without<NotTraced>,
);

/// Makes the trees of meshes that are new, were edited, or whose settings changed, and drops those
/// of meshes that no object uses any more.
pub(super) fn sync_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut removed: RemovedComponents<Mesh3d>,
    mut at_rest: RemovedComponents<PosedMesh>,
    mut switched: Switched,
    changed: Query<(), Dressed>,
    users: Query<(&Mesh3d, Option<&PosedMesh>), Without<NotTraced>>,
    assets: Res<Assets<Mesh>>,
    settings: Res<RenderSettings>,
    building: Res<TreeBuilding>,
    known: ResMut<TracedMeshes>,
    mut draft: ResMut<Draft>,
) {
    let known = known.into_inner();
    let at_once = *building == TreeBuilding::AtOnce;
    let wanted = build_options(&settings.tree);
    let rebuild = wanted != known.wanted;
    let mut stale: HashSet<AssetId<Mesh>> = HashSet::new();
    if rebuild {
        known.wanted = wanted;
        // They may hold edits that what is shown lacks.
        stale.extend(known.ready.drain().map(|(id, _)| id));
    }
    let edited = events.read().filter_map(|event| match event {
        AssetEvent::Added { id } | AssetEvent::Modified { id } | AssetEvent::Removed { id } => {
            Some(*id)
        }
        _ => None,
    });
    stale.extend(edited);
    let built = if at_once {
        known.threads.finish(known.building.len())
    } else {
        known.threads.finished()
    };
    // Not `&&`: every reader has to be emptied.
    let gone = removed.read().count() + at_rest.read().count() > 0;
    let users_changed = gone | switched.any() | !changed.is_empty();
    let nothing = !users_changed && stale.is_empty() && built.is_empty() && !rebuild;
    if nothing {
        return;
    }
    stale.extend(known.take_built(built, &assets));
    let used: HashSet<AssetId<Mesh>> = users.iter().map(traced_mesh).collect();
    known.shown.retain(|id, _| used.contains(id));
    known.ready.retain(|id, _| used.contains(id));
    let in_force = known.options == known.wanted;
    let mut to_build = Vec::new();
    for id in used {
        let is_there = known.ready.contains_key(&id) || in_force && known.shown.contains_key(&id);
        if is_there && !stale.contains(&id) {
            continue;
        }
        match known.building.get_mut(&id) {
            Some(edited) => *edited |= rebuild || stale.contains(&id),
            None => to_build.push(id),
        }
    }
    let options = known.mesh_options();
    if at_once {
        let built = to_build.into_par_iter().map(|id| {
            let mesh = assets.get(id).ok_or(MeshFault::Missing);
            let mesh = mesh.and_then(|mesh| trace_mesh(mesh, &options));
            (id, mesh.map(Arc::new))
        });
        known.ready.extend(built.collect::<Vec<_>>());
    } else {
        for id in to_build {
            let mesh = assets.get(id).ok_or(MeshFault::Missing);
            match mesh.and_then(MeshCopy::of) {
                Ok(copy) => {
                    known.threads.build(id, copy, options);
                    known.building.insert(id, false);
                }
                Err(fault) => {
                    known.ready.insert(id, Err(fault));
                }
            }
        }
    }
    draft.changes.meshes |= known.show_ready();
    draft.pending = known.building.len();
}

/// The tree settings as the builders take them, moved into their ranges.
pub(super) fn build_options(tree: &scene::TreeSettings) -> BuildOptions {
    let within = |path, number: u32| {
        scene::schema::quantity_of::<scene::TreeSettings>(path).nearest(number.into()) as u32
    };
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
        max_depth: within("max_depth", tree.max_depth),
        max_leaf_size: within("max_leaf_size", tree.max_leaf_size),
        bins: within("bins", tree.bins),
        preset: match tree.preset {
            scene::Preset::Fastest => bvh::Preset::Fastest,
            scene::Preset::Fast => bvh::Preset::Fast,
            scene::Preset::Medium => bvh::Preset::Medium,
            scene::Preset::Slow => bvh::Preset::Slow,
            scene::Preset::VerySlow => bvh::Preset::VerySlow,
        },
    }
}

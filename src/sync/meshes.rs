use super::mesh_copies::{self, MeshCopies};
use super::mesh_data::{MeshCopy, MeshFault, trace_mesh};
use super::posed::{PosedMesh, traced_mesh};
use super::reading::Switched;
use super::traced::Draft;
use super::tree_building::{Built, Threads, TreeBuilding, build_tree};
use super::uses::Uses;
use crate::bvh::{self, BuildOptions, Builder, Levels};
use crate::scene::{self, NotTraced, RenderSettings};
use crate::trace;
use bevy::asset::{AssetEvent, AssetId, Assets};
use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::message::MessageReader;
use bevy::ecs::query::{Added, Changed, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut, SystemParam};
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
    /// Those of them that are still being copied.
    copies: MeshCopies,
    threads: Threads<Built>,
    /// Which mesh each object has.
    uses: Uses<AssetId<Mesh>>,
    /// What is shown since the last frame, or shown otherwise.
    news: HashSet<AssetId<Mesh>>,
}

impl TracedMeshes {
    /// The mesh of an asset; `None` while its first tree is being built.
    pub fn get(&self, id: AssetId<Mesh>) -> Option<Result<&Arc<trace::Mesh>, MeshFault>> {
        let mesh = self.shown.get(&id)?;
        Some(mesh.as_ref().map_err(MeshFault::clone))
    }

    /// What is shown since the last frame, or shown otherwise.
    pub fn news(&self) -> &HashSet<AssetId<Mesh>> {
        &self.news
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

    /// Has a mesh's tree built where there is one: copied here where that takes no longer than what is `left` of the frame, or
    /// where it `hurries`, else some of it in each frame.
    fn build(&mut self, id: AssetId<Mesh>, assets: &Assets<Mesh>, hurries: bool, left: &mut usize) {
        let options = self.mesh_options();
        let mesh = assets.get(id).ok_or(MeshFault::Missing);
        let cost = mesh.as_ref().map_or(0, |mesh| mesh_copies::cost(mesh));
        let fault = |mesh: &Mesh| MeshCopy::fault(mesh).map_or(Ok(None), Err);
        let copy = match mesh {
            Ok(mesh) if cost > *left && !hurries => fault(mesh),
            mesh => mesh.and_then(MeshCopy::of).map(Some),
        };
        match copy {
            Ok(Some(copy)) => {
                *left = left.saturating_sub(cost);
                build_tree(&mut self.threads, id, options, move || Ok(copy));
            }
            Ok(None) => self.copies.begin(id),
            Err(fault) => {
                self.building.remove(&id);
                self.ready.insert(id, Err(fault));
                return;
            }
        }
        self.building.insert(id, false);
    }

    /// Goes on with what is being copied, and gives to the threads what is complete. What was edited meanwhile is copied at
    /// once: where one is edited in every frame none would ever be.
    fn go_on_copying(&mut self, assets: &Assets<Mesh>, left: &mut usize) {
        for id in self.copies.ids() {
            if self.building.get(&id) == Some(&true) {
                self.copies.forget(id);
                self.build(id, assets, true, left);
            }
        }
        let options = self.mesh_options();
        while let Some((id, mesh)) = self.copies.go_on(|id| assets.get(id), left) {
            match mesh {
                Ok(mesh) => {
                    build_tree(&mut self.threads, id, options, move || MeshCopy::of(&mesh));
                }
                Err(fault) => {
                    self.building.remove(&id);
                    self.ready.insert(id, Err(fault));
                }
            }
        }
    }

    /// Takes what the threads have built, and says what of it has to be built again.
    fn take_built(&mut self, built: Vec<Built>, assets: &Assets<Mesh>) -> Vec<AssetId<Mesh>> {
        let mut again = Vec::new();
        for Built { id, options, mesh } in built {
            let edited = self.building.remove(&id).unwrap_or_default();
            if !self.uses.is_used(id) {
                continue;
            }
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
            self.news.extend(self.shown.keys());
            return true;
        }
        self.news.extend(self.ready.keys());
        self.shown.extend(self.ready.drain());
        !self.news.is_empty()
    }
}

#[cfg(test)]
impl TracedMeshes {
    /// How many are kept.
    pub fn kept(&self) -> usize {
        self.shown.len() + self.ready.len() + self.building.len()
    }
}

type Users<'w, 's> =
    Query<'w, 's, (Entity, (&'static Mesh3d, Option<&'static PosedMesh>)), Without<NotTraced>>;

type OtherMesh = Or<(Changed<Mesh3d>, Changed<PosedMesh>)>;

/// Who may have another mesh now than before, or be posed as another.
#[derive(SystemParam)]
pub(super) struct Dressed<'w, 's> {
    changed: Query<'w, 's, Entity, OtherMesh>,
    no_longer: Query<'w, 's, Entity, (With<Mesh3d>, Added<NotTraced>)>,
    removed: RemovedComponents<'w, 's, Mesh3d>,
    at_rest: RemovedComponents<'w, 's, PosedMesh>,
    traced_again: RemovedComponents<'w, 's, NotTraced>,
    switched: Switched<'w, 's>,
}

impl Dressed<'_, '_> {
    fn read(&mut self) -> Vec<Entity> {
        let gone = (self.removed.read())
            .chain(self.at_rest.read())
            .chain(self.traced_again.read());
        let all = gone.chain(self.switched.read());
        all.chain(&self.changed).chain(&self.no_longer).collect()
    }
}

/// Makes the trees of meshes that are new, were edited, or whose settings changed, and drops those
/// of meshes that no object uses any more.
pub(super) fn sync_meshes(
    mut events: MessageReader<AssetEvent<Mesh>>,
    mut dressed: Dressed,
    users: Users,
    assets: Res<Assets<Mesh>>,
    settings: Res<RenderSettings>,
    building: Res<TreeBuilding>,
    known: ResMut<TracedMeshes>,
    mut draft: ResMut<Draft>,
) {
    let known = known.into_inner();
    known.news.clear();
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
    if at_once {
        // What no thread has yet is built here.
        for id in known.copies.ids() {
            known.copies.forget(id);
            known.building.remove(&id);
            stale.insert(id);
        }
    }
    let built = if at_once {
        known.threads.finish(known.building.len())
    } else {
        known.threads.finished()
    };
    let mut dressed = dressed.read();
    if draft.anew {
        dressed.extend(known.uses.entities().chain(users.iter().map(|(e, _)| e)));
        // What was edited meanwhile may have left no word.
        if assets.is_changed() {
            stale.extend(known.uses.things());
        }
    }
    let is_still = stale.is_empty() && built.is_empty() && known.copies.is_empty();
    let nothing = dressed.is_empty() && is_still && !rebuild;
    if nothing {
        return;
    }
    let mut touched = HashSet::new();
    for entity in dressed {
        let mesh = users.get(entity).map(|(_, mesh)| traced_mesh(mesh));
        let used = mesh.into_iter().collect();
        known.uses.set(entity, used, &mut touched);
    }
    stale.extend(known.take_built(built, &assets));
    touched.extend(&stale);
    if rebuild {
        touched.extend(known.uses.things());
    }
    let in_force = known.options == known.wanted;
    let mut to_build = Vec::new();
    for id in touched {
        if !known.uses.is_used(id) {
            known.shown.remove(&id);
            known.ready.remove(&id);
            if known.copies.forget(id) {
                known.building.remove(&id);
            }
            // Somebody may use it again before its tree is there.
            if let Some(edited) = known.building.get_mut(&id) {
                *edited |= stale.contains(&id);
            }
            continue;
        }
        let is_there = known.ready.contains_key(&id) || in_force && known.shown.contains_key(&id);
        if is_there && !stale.contains(&id) {
            continue;
        }
        match known.building.get_mut(&id) {
            Some(edited) => *edited |= rebuild || stale.contains(&id),
            None => to_build.push(id),
        }
    }
    if at_once {
        let options = known.mesh_options();
        let built = to_build.into_par_iter().map(|id| {
            let mesh = assets.get(id).ok_or(MeshFault::Missing);
            let mesh = mesh.and_then(|mesh| trace_mesh(mesh, &options));
            (id, mesh.map(Arc::new))
        });
        known.ready.extend(built.collect::<Vec<_>>());
    } else {
        let mut left = mesh_copies::AT_ONCE;
        known.go_on_copying(&assets, &mut left);
        for id in to_build {
            known.build(id, &assets, false, &mut left);
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

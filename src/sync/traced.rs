use super::SyncProblem;
use crate::scene::RenderSettings;
use crate::trace;
use bevy::ecs::change_detection::{DetectChanges, DetectChangesMut};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Res, ResMut};
use std::sync::Arc;

/// The tracer's world as the entities are now.
#[derive(Resource, Default)]
pub struct Traced {
    /// A new snapshot after every change; what did not change is shared with the one before.
    pub world: Arc<trace::World>,
    /// What the last frame redid.
    pub changes: Changes,
    /// What cannot be traced as it is, sorted by kind and `SceneId`.
    pub problems: Vec<SyncProblem>,
    /// How many trees are being built and textures converted: what uses a mesh that waits for its tree is traced with
    /// the mesh that it had before, or not yet, and objects stand where they did; so with textures. See [`TreeBuilding`](super::TreeBuilding).
    pub pending: usize,
}

/// What one frame redid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Changes {
    /// Triangles and trees of at least one mesh.
    pub meshes: bool,
    /// The tree over the objects: one moved, appeared, went, or has another mesh.
    pub top_level: bool,
    /// Which object has which material.
    pub objects: bool,
    /// A material.
    pub materials: bool,
    /// A texture.
    pub textures: bool,
    /// A light.
    pub lights: bool,
    /// The background or its map.
    pub environment: bool,
    /// A camera.
    pub cameras: bool,
}

impl Changes {
    /// True where the snapshot is another one than before. Cameras are not part of it.
    pub fn any_in_world(self) -> bool {
        self != Self {
            cameras: self.cameras,
            ..Self::default()
        }
    }

    /// True where anything was redone.
    pub fn any(self) -> bool {
        self != Self::default()
    }
}

/// The parts of the next snapshot, as this frame's systems leave them.
#[derive(Resource, Default)]
pub(super) struct Draft {
    pub world: trace::World,
    pub changes: Changes,
    pub problems: Problems,
    /// Meshes whose tree is being built.
    pub pending: usize,
    /// Pictures that are being converted or cut out.
    pub pending_textures: usize,
    /// Whether the tree over the objects is being built.
    pub top_level_pending: bool,
    /// Its objects are not those of the tree over them, which is being built: no snapshot of it yet.
    pub objects_ahead: bool,
    /// Whether its objects are those that the tree over them is being built for.
    pub fits_pending: bool,
    /// The newest world that fits that tree, of the end of a frame.
    pub fitting: Option<trace::World>,
    /// That world with its tree, which came when the objects were others already: where something comes or
    /// goes in every frame every tree does, and nothing new would ever be seen.
    pub late: Option<trace::World>,
    /// Some object appeared, went, or has another mesh: who merely moved keeps the material.
    pub other_objects: bool,
    /// Some part was read again, so that its problems may be others although nothing was redone.
    pub reread: bool,
    /// These systems rested, and what they know may be of anything.
    pub anew: bool,
}

/// One list per part: a part that is redone replaces its own.
#[derive(Default)]
pub(super) struct Problems {
    pub settings: Vec<SyncProblem>,
    pub instances: Vec<SyncProblem>,
    pub materials: Vec<SyncProblem>,
    pub lights: Vec<SyncProblem>,
    pub environment: Vec<SyncProblem>,
    pub cameras: Vec<SyncProblem>,
    pub left_out: Vec<SyncProblem>,
}

impl Problems {
    fn all(&self) -> Vec<SyncProblem> {
        [
            &self.settings,
            &self.instances,
            &self.materials,
            &self.lights,
            &self.environment,
            &self.cameras,
            &self.left_out,
        ]
        .into_iter()
        .flatten()
        .cloned()
        .collect()
    }
}

/// Makes a snapshot of the draft where anything is another than before. A frame without changes
/// leaves [`Traced`] unchanged for Bevy's change detection too.
pub(super) fn publish_snapshot(
    settings: Res<RenderSettings>,
    mut draft: ResMut<Draft>,
    mut traced: ResMut<Traced>,
) {
    if settings.is_changed() {
        draft.problems.settings = SyncProblem::of_settings(&settings);
        draft.reread = true;
    }
    draft.other_objects = false;
    let pending = draft.pending + draft.pending_textures + usize::from(draft.top_level_pending);
    traced.bypass_change_detection().pending = pending;
    if draft.fits_pending {
        draft.fitting = Some(draft.world.clone());
    }
    let late = draft.late.take();
    if draft.objects_ahead {
        let Some(world) = late else {
            traced.bypass_change_detection().changes = Changes::default();
            return;
        };
        // What was redone since is told again when it shows.
        traced.changes = Changes {
            top_level: true,
            ..draft.changes
        };
        traced.problems = draft.problems.all();
        traced.world = Arc::new(world.with_needs_after(&traced.world));
        return;
    }
    let changes = std::mem::take(&mut draft.changes);
    if !changes.any() && !draft.reread {
        traced.bypass_change_detection().changes = changes;
        return;
    }
    draft.reread = false;
    traced.changes = changes;
    traced.problems = draft.problems.all();
    if changes.any_in_world() {
        traced.world = Arc::new(draft.world.clone().with_needs_after(&traced.world));
    }
}

use super::meshes::TracedMeshes;
use super::motions::{WorldMotion, WorldMotions};
use super::posed::{PosedMesh, traced_mesh};
use super::problem::Fault;
use super::reading::{Reader, Switched};
use super::traced::Draft;
use super::tree_building::{TopLevelThread, TreeBuilding};
use crate::bvh::{Aggregate, BuildOptions, Instance};
use crate::scene::SceneId;
use crate::trace;
use bevy::camera::visibility::InheritedVisibility;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Changed, Or, With};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut};
use bevy::math::{Affine3A, Vec3};
use bevy::mesh::Mesh3d;
use bevy::transform::components::GlobalTransform;
use std::sync::Arc;
use std::time::Duration;

/// Which mesh stands where, sorted by `SceneId`: row `i` is instance `i` of the top level.
#[derive(Resource, Default)]
pub(super) struct TracedInstances {
    pub rows: Vec<Row>,
    options: BuildOptions,
    /// Counts how often the objects were others, wherever they stood.
    objects: u64,
    /// What that count was for the tree in the draft: where it is another one, row and instance
    /// numbers do not belong together.
    traced_objects: u64,
    /// Whether some tree has yet to be begun for the rows as they are.
    stale: bool,
    /// What the count was for the tree that is being built.
    begun_objects: u64,
    /// How long the newest tree took.
    took: Duration,
}

impl TracedInstances {
    fn of(&self, id: SceneId, entity: Entity) -> Option<&Row> {
        let place = self.rows.binary_search_by_key(&id, |row| row.id).ok()?;
        Some(&self.rows[place]).filter(|row| row.entity == entity)
    }

    /// Takes these rows, and true where some object is another one.
    fn take(&mut self, rows: Vec<Row>, options: BuildOptions) -> bool {
        let mut pairs = rows.iter().zip(&self.rows);
        let same_objects =
            rows.len() == self.rows.len() && pairs.all(|(new, old)| new.same_object(old));
        self.objects += u64::from(!same_objects);
        self.rows = rows;
        self.options = options;
        self.stale = true;
        !same_objects
    }

    /// Builds the tree over the rows, or goes on with it, and takes into the draft what is there.
    fn build(&mut self, thread: &mut TopLevelThread, at_once: bool, draft: &mut Draft) {
        if at_once && self.stale {
            thread.forget();
        }
        let wait = if at_once {
            Duration::MAX
        } else {
            Duration::ZERO
        };
        self.show(thread.finished(wait), draft);
        if self.stale && !thread.is_busy() {
            self.stale = false;
            self.begun_objects = self.objects;
            let instances = self.rows.iter().map(|row| row.instance.clone()).collect();
            let (objects, options) = (self.objects, self.options);
            let work = move || (objects, Aggregate::build(instances, &options));
            if at_once {
                self.show(Some(work()), draft);
            } else {
                thread.start(work);
                // A longer one would not be there in time, and the frame would wait for nothing.
                let in_time = self.took <= PATIENCE;
                let wait = if in_time { PATIENCE } else { Duration::ZERO };
                self.show(thread.finished(wait), draft);
            }
        }
        draft.top_level_pending = thread.is_busy();
        draft.objects_ahead = self.objects != self.traced_objects;
        draft.fits_pending = thread.is_busy() && self.objects == self.begun_objects;
    }

    /// A tree over objects that are no longer those is shown with what fitted it last.
    fn show(&mut self, built: Option<(u64, Aggregate)>, draft: &mut Draft) {
        let Some((objects, aggregate)) = built else {
            return;
        };
        self.took = aggregate.build_time();
        let fitting = draft.fitting.take();
        if objects == self.objects {
            self.traced_objects = self.objects;
            draft.world.aggregate = Arc::new(aggregate);
            draft.changes.top_level = true;
        } else if let Some(mut world) = fitting.filter(|_| objects == self.begun_objects) {
            world.aggregate = Arc::new(aggregate);
            draft.late = Some(world);
        }
    }
}

/// So long a frame waits for the tree over the objects where the one before took no longer: that of a thousand is
/// there by then, and nothing lags behind the hand.
const PATIENCE: Duration = Duration::from_micros(2000);

/// One object as the top level sees it.
pub(super) struct Row {
    pub id: SceneId,
    pub entity: Entity,
    pub mesh: Arc<trace::Mesh>,
    /// Samples that its motion asks for; 0 where it stands still.
    pub motion_samples: u32,
    /// Where its mesh stands, and how it moves.
    instance: Instance,
}

impl Row {
    /// True where it is the same object, wherever it stands.
    fn same_object(&self, other: &Self) -> bool {
        self.id == other.id
            && self.entity == other.entity
            && self.motion_samples == other.motion_samples
            && Arc::ptr_eq(&self.mesh, &other.mesh)
    }

    /// True where this mesh stands in this place and moves so.
    fn stands(&self, mesh: &Arc<trace::Mesh>, transform: &Affine3A, velocity: Vec3) -> bool {
        // Bits, because -0 and 0 may round differently on the way.
        let bits = |transform: &Affine3A, velocity: Vec3| {
            let velocity = velocity.to_array().map(f32::to_bits);
            (transform.to_cols_array().map(f32::to_bits), velocity)
        };
        let instance = &self.instance;
        Arc::ptr_eq(&self.mesh, mesh)
            && bits(transform, velocity) == bits(instance.world_from_object(), instance.velocity())
    }
}

type Moved = (
    // What has a mesh and no number is no part of the scene: handles, for example.
    With<SceneId>,
    With<Mesh3d>,
    Or<(
        Changed<Mesh3d>,
        Changed<PosedMesh>,
        Changed<GlobalTransform>,
        Changed<InheritedVisibility>,
        Changed<SceneId>,
    )>,
);

type ObjectQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        &'static SceneId,
        (&'static Mesh3d, Option<&'static PosedMesh>),
        &'static GlobalTransform,
        Option<&'static InheritedVisibility>,
        Option<&'static Name>,
    ),
>;

/// Makes the tree over the objects again where one moved, appeared, went or has another mesh.
pub(super) fn sync_instances(
    moved: Query<(), Moved>,
    mut no_mesh: RemovedComponents<Mesh3d>,
    mut at_rest: RemovedComponents<PosedMesh>,
    mut no_transform: RemovedComponents<GlobalTransform>,
    mut no_visibility: RemovedComponents<InheritedVisibility>,
    mut no_id: RemovedComponents<SceneId>,
    mut switched: Switched,
    motions: Res<WorldMotions>,
    objects: ObjectQuery,
    meshes: Res<TracedMeshes>,
    building: Res<TreeBuilding>,
    mut thread: ResMut<TopLevelThread>,
    mut known: ResMut<TracedInstances>,
    mut draft: ResMut<Draft>,
) {
    // Not `||`: every reader has to be emptied.
    let gone = no_mesh.read().count()
        + at_rest.read().count()
        + no_transform.read().count()
        + no_visibility.read().count()
        + no_id.read().count();
    let switched = switched.any() || motions.changed();
    let options_changed = known.options != *meshes.options();
    let edited = gone > 0 || !moved.is_empty() || draft.changes.meshes;
    if switched || options_changed || edited {
        draft.problems.instances.clear();
        draft.reread = true;
        let (rows, moved) = read(&objects, &motions, &meshes, &known, &mut draft);
        if moved || rows.len() != known.rows.len() || options_changed {
            draft.other_objects |= known.take(rows, *meshes.options());
        }
    }
    let at_once = *building == TreeBuilding::AtOnce;
    known.build(&mut thread, at_once, &mut draft);
}

/// The objects as they are, and whether one of them is not as it is known.
fn read(
    objects: &ObjectQuery,
    motions: &WorldMotions,
    meshes: &TracedMeshes,
    known: &TracedInstances,
    draft: &mut Draft,
) -> (Vec<Row>, bool) {
    let mut visible: Vec<_> = objects
        .iter()
        .filter(|(.., visibility, _)| visibility.is_none_or(|v| v.get()))
        .collect();
    visible.sort_unstable_by_key(|(_, id, ..)| **id);

    let mut rows: Vec<Row> = Vec::with_capacity(visible.len());
    let mut moved = false;
    for (entity, &id, mesh, transform, _, name) in visible {
        let mut reader = Reader {
            kind: "object",
            id,
            name,
            problems: &mut draft.problems.instances,
        };
        let mesh = match meshes.get(traced_mesh(mesh)) {
            Some(Ok(mesh)) => mesh,
            Some(Err(fault)) => {
                reader.note(Fault::Mesh(fault));
                continue;
            }
            // Its tree is being built.
            None => match known.of(id, entity) {
                Some(before) => &before.mesh,
                None => continue,
            },
        };
        let left_out = mesh.tree.triangles().left_out();
        if left_out > 0 {
            reader.note(Fault::TrianglesLeftOut { count: left_out });
        }
        let transform = transform.affine();
        let motion = match motions.of(entity) {
            Some(motion) => match reader.motion(motion) {
                Some(motion) => motion,
                None => continue,
            },
            None => WorldMotion::default(),
        };
        let velocity = motion.velocity;
        // Most stand where they stood.
        let before = known.rows.get(rows.len());
        let before = before.filter(|before| before.stands(mesh, &transform, velocity));
        let instance = match before {
            Some(before) => Ok(before.instance.clone()),
            None => Instance::new(mesh.tree.clone(), &transform)
                .and_then(|instance| instance.moving(velocity)),
        };
        match instance {
            Ok(instance) => {
                let row = Row {
                    id,
                    entity,
                    mesh: mesh.clone(),
                    motion_samples: motion.samples,
                    instance,
                };
                moved |= !before.is_some_and(|before| before.same_object(&row));
                rows.push(row);
            }
            Err(fault) => reader.note(Fault::Transform(fault)),
        }
    }
    (rows, moved)
}

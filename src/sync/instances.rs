use super::meshes::TracedMeshes;
use super::motions::{WorldMotion, WorldMotions};
use super::posed::{PosedMesh, traced_mesh};
use super::problem::{Fault, SyncProblem};
use super::reading::{Reader, Switched};
use super::traced::Draft;
use super::tree_building::{TopLevelThread, TreeBuilding};
use crate::bvh::{Aggregate, BuildOptions, Instance};
use crate::scene::{NotTraced, SceneId};
use crate::trace;
use bevy::camera::visibility::InheritedVisibility;
use bevy::ecs::entity::{Entity, EntityHashMap};
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Added, Changed, Or, With, Without};
use bevy::ecs::resource::Resource;
use bevy::ecs::system::{Query, Res, ResMut, SystemParam};
use bevy::math::{Affine3A, Vec3};
use bevy::mesh::Mesh3d;
use bevy::transform::components::GlobalTransform;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

/// Which mesh stands where, sorted by `SceneId`: row `i` is instance `i` of the top level.
#[derive(Resource, Default)]
pub(super) struct TracedInstances {
    pub rows: Vec<Row>,
    /// Which number each entity with a mesh had when it was read, whether it has a row or not.
    numbers: EntityHashMap<SceneId>,
    problems: BTreeMap<SceneId, Vec<SyncProblem>>,
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

/// What reading some entities again made another.
#[derive(Default)]
struct Difference {
    /// Some row: a tree has to be built.
    rows: bool,
    /// Some object appeared, went, or is another one.
    objects: bool,
    problems: bool,
}

impl TracedInstances {
    /// Where the row of a number is, or would be. Mostly they are asked for one after the other.
    fn place(&self, id: SceneId, guess: usize) -> Result<usize, usize> {
        if self.rows.get(guess).is_some_and(|row| row.id == id) {
            return Ok(guess);
        }
        self.rows.binary_search_by_key(&id, |row| row.id)
    }

    /// Takes these entities, each once, as they are now.
    fn read(&mut self, touched: &[Entity], scene: &Scene) -> Difference {
        let mut difference = Difference::default();
        // Numbers first, because one may have gone from an entity to another.
        let mut goes: Vec<(SceneId, Entity)> = Vec::new();
        for &entity in touched {
            let now = scene.objects.get(entity).ok().map(|object| *object.1);
            let before = match now {
                Some(id) => self.numbers.insert(entity, id),
                None => self.numbers.remove(&entity),
            };
            if let Some(before) = before {
                difference.problems |= self.problems.remove(&before).is_some();
                if now != Some(before) {
                    goes.push((before, entity));
                }
            }
        }
        let mut comes: Vec<Row> = Vec::new();
        let mut guess = 0;
        for &entity in touched {
            let Ok(object) = scene.objects.get(entity) else {
                continue;
            };
            let id = *object.1;
            let place = self.place(id, guess).ok();
            let place = place.filter(|place| self.rows[*place].entity == entity);
            guess = place.map_or(guess, |place| place + 1);
            let before = place.map(|place| &self.rows[place]);
            let mut problems = Vec::new();
            let row = read(object, before, scene, &mut problems);
            if !problems.is_empty() {
                difference.problems = true;
                self.problems.insert(id, problems);
            }
            match (row, place) {
                (Some(row), Some(place)) => {
                    let known = &mut self.rows[place];
                    difference.objects |= !row.same_object(known);
                    difference.rows |= !known.stands_as(&row);
                    *known = row;
                }
                (Some(row), None) => comes.push(row),
                (None, Some(_)) => goes.push((id, entity)),
                (None, None) => {}
            }
        }
        goes.sort_unstable();
        let goes_away = |row: &Row| {
            let place = goes.binary_search_by_key(&row.id, |(id, _)| *id);
            place.is_ok_and(|place| goes[place].1 == row.entity)
        };
        let before = self.rows.len();
        if !goes.is_empty() {
            self.rows.retain(|row| !goes_away(row));
        }
        difference.objects |= self.rows.len() < before || !comes.is_empty();
        if !comes.is_empty() {
            self.rows.append(&mut comes);
            self.rows.sort_by_key(|row| row.id);
        }
        difference.rows |= difference.objects;
        difference
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
            let instances = self.rows.iter().map(|row| row.instance.clone());
            let instances: Vec<Instance> = instances.collect();
            let (objects, options) = (self.objects, self.options);
            let work = move || (objects, Aggregate::build(instances, &options));
            if at_once {
                self.show(Some(work()), draft);
            } else {
                thread.start(work);
                let is_short = self.took <= SHORT;
                let wait = if is_short { PATIENCE } else { Duration::ZERO };
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

/// A frame waits for the tree over the objects where the one before took no longer: that of a thousand, so that nothing lags
/// behind the hand. That of thousands would take half of what a frame has for all of this.
const SHORT: Duration = Duration::from_millis(1);
/// So long it waits.
const PATIENCE: Duration = Duration::from_millis(2);

/// One object as the top level sees it.
pub(super) struct Row {
    pub id: SceneId,
    pub entity: Entity,
    pub mesh: Arc<trace::Mesh>,
    /// Samples that its motion asks for; 0 where it stands still.
    pub motion_samples: u32,
    /// Where its mesh stands, and how it moves. It lies here and is copied for each tree over all: of thousands that move, an
    /// allocation each would take as long as all else.
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

    /// True where its mesh is that one, and stands there and moves so.
    fn stands_as(&self, other: &Self) -> bool {
        let instance = &other.instance;
        self.stands(
            &other.mesh,
            instance.world_from_object(),
            instance.velocity(),
        )
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
        Changed<Name>,
    )>,
);

type Object = (
    Entity,
    &'static SceneId,
    (&'static Mesh3d, Option<&'static PosedMesh>),
    &'static GlobalTransform,
    Option<&'static InheritedVisibility>,
    Option<&'static Name>,
);

/// The same as it is given.
type Known<'a> = (
    Entity,
    &'a SceneId,
    (&'a Mesh3d, Option<&'a PosedMesh>),
    &'a GlobalTransform,
    Option<&'a InheritedVisibility>,
    Option<&'a Name>,
);

/// Whose row may be another one.
#[derive(SystemParam)]
pub(super) struct Edited<'w, 's> {
    moved: Query<'w, 's, Entity, Moved>,
    no_longer: Query<'w, 's, Entity, (With<Mesh3d>, Added<NotTraced>)>,
    traced_again: RemovedComponents<'w, 's, NotTraced>,
    no_mesh: RemovedComponents<'w, 's, Mesh3d>,
    at_rest: RemovedComponents<'w, 's, PosedMesh>,
    no_transform: RemovedComponents<'w, 's, GlobalTransform>,
    no_visibility: RemovedComponents<'w, 's, InheritedVisibility>,
    no_id: RemovedComponents<'w, 's, SceneId>,
    no_name: RemovedComponents<'w, 's, Name>,
    switched: Switched<'w, 's>,
}

impl Edited<'_, '_> {
    fn read(&mut self) -> Vec<Entity> {
        let gone = (self.traced_again.read())
            .chain(self.no_mesh.read())
            .chain(self.at_rest.read())
            .chain(self.no_transform.read())
            .chain(self.no_visibility.read())
            .chain(self.no_id.read())
            .chain(self.no_name.read());
        let all = gone.chain(self.switched.read());
        all.chain(&self.moved).chain(&self.no_longer).collect()
    }
}

/// What rows are made of.
#[derive(SystemParam)]
pub(super) struct Scene<'w, 's> {
    objects: Query<'w, 's, Object, Without<NotTraced>>,
    meshes: Res<'w, TracedMeshes>,
    motions: Res<'w, WorldMotions>,
}

/// Makes the tree over the objects again where one moved, appeared, went or has another mesh.
pub(super) fn sync_instances(
    mut edited: Edited,
    scene: Scene,
    building: Res<TreeBuilding>,
    mut thread: ResMut<TopLevelThread>,
    known: ResMut<TracedInstances>,
    draft: ResMut<Draft>,
) {
    let (known, draft) = (known.into_inner(), draft.into_inner());
    let mut touched = edited.read();
    touched.extend(scene.motions.others());
    let options = *scene.meshes.options();
    let options_changed = known.options != options;
    let news = scene.meshes.news();
    if draft.anew || options_changed {
        touched.extend(known.numbers.keys());
        touched.extend(scene.objects.iter().map(|object| object.0));
    } else if !news.is_empty() {
        let objects = scene.objects.iter();
        let wears = objects.filter(|object| news.contains(&traced_mesh(object.2)));
        touched.extend(wears.map(|object| object.0));
    }
    if !touched.is_empty() || options_changed {
        touched.sort_unstable();
        touched.dedup();
        let difference = known.read(&touched, &scene);
        known.options = options;
        known.stale |= difference.rows || options_changed;
        known.objects += u64::from(difference.objects);
        draft.other_objects |= difference.objects;
        if difference.problems {
            let problems = known.problems.values().flatten().cloned();
            draft.problems.instances = problems.collect();
            draft.reread = true;
        }
    }
    let at_once = *building == TreeBuilding::AtOnce;
    known.build(&mut thread, at_once, draft);
}

/// The row of an object, `before` where it is as it was; `None` where nothing of it is traced.
fn read(
    (entity, &id, mesh, transform, visibility, name): Known,
    before: Option<&Row>,
    scene: &Scene,
    problems: &mut Vec<SyncProblem>,
) -> Option<Row> {
    if visibility.is_some_and(|visibility| !visibility.get()) {
        return None;
    }
    let mut reader = Reader {
        kind: "object",
        id,
        name,
        problems,
    };
    let mesh = match scene.meshes.get(traced_mesh(mesh)) {
        Some(Ok(mesh)) => mesh,
        Some(Err(fault)) => {
            reader.note(Fault::Mesh(fault));
            return None;
        }
        // Its tree is being built.
        None => &before?.mesh,
    };
    let left_out = mesh.tree.triangles().left_out();
    if left_out > 0 {
        reader.note(Fault::TrianglesLeftOut { count: left_out });
    }
    let transform = transform.affine();
    let motion = match scene.motions.of(entity) {
        Some(motion) => reader.motion(motion)?,
        None => WorldMotion::default(),
    };
    let velocity = motion.velocity;
    let instance = match before.filter(|before| before.stands(mesh, &transform, velocity)) {
        Some(before) => before.instance.clone(),
        None => {
            let instance = Instance::new(mesh.tree.clone(), &transform);
            match instance.and_then(|instance| instance.moving(velocity)) {
                Ok(instance) => instance,
                Err(fault) => {
                    reader.note(Fault::Transform(fault));
                    return None;
                }
            }
        }
    };
    Some(Row {
        id,
        entity,
        mesh: mesh.clone(),
        motion_samples: motion.samples,
        instance,
    })
}

use super::meshes::TracedMeshes;
use super::problem::Fault;
use super::reading::{Motions, Reader, Switched};
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

/// Which mesh stands where, sorted by `SceneId`: row `i` is instance `i` of the top level.
#[derive(Resource, Default)]
pub(super) struct TracedInstances {
    pub rows: Vec<Row>,
    options: BuildOptions,
}

impl TracedInstances {
    fn of(&self, id: SceneId, entity: Entity) -> Option<&Row> {
        let place = self.rows.binary_search_by_key(&id, |row| row.id).ok()?;
        Some(&self.rows[place]).filter(|row| row.entity == entity)
    }
}

/// One object as the top level sees it.
pub(super) struct Row {
    pub id: SceneId,
    pub entity: Entity,
    pub mesh: Arc<trace::Mesh>,
    /// Samples that its motion asks for; 0 where it stands still.
    pub motion_samples: u32,
    transform: Affine3A,
    velocity: Vec3,
}

impl Row {
    /// True where it is the same object, wherever it stands.
    fn same_object(&self, other: &Self) -> bool {
        self.id == other.id
            && self.entity == other.entity
            && self.motion_samples == other.motion_samples
            && Arc::ptr_eq(&self.mesh, &other.mesh)
    }

    /// True where it stands in the same place and moves alike.
    fn same_place(&self, other: &Self) -> bool {
        // Bits, because -0 and 0 may round differently on the way.
        let bits = |row: &Self| {
            let velocity = row.velocity.to_array().map(f32::to_bits);
            (row.transform.to_cols_array().map(f32::to_bits), velocity)
        };
        bits(self) == bits(other)
    }
}

type Moved = (
    // What has a mesh and no number is no part of the scene: handles, for example.
    With<SceneId>,
    With<Mesh3d>,
    Or<(
        Changed<Mesh3d>,
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
        &'static Mesh3d,
        &'static GlobalTransform,
        Option<&'static InheritedVisibility>,
        Option<&'static Name>,
    ),
>;

/// Makes the tree over the objects again where one moved, appeared, went or has another mesh.
pub(super) fn sync_instances(
    moved: Query<(), Moved>,
    mut no_mesh: RemovedComponents<Mesh3d>,
    mut no_transform: RemovedComponents<GlobalTransform>,
    mut no_visibility: RemovedComponents<InheritedVisibility>,
    mut no_id: RemovedComponents<SceneId>,
    mut switched: Switched,
    mut motions: Motions,
    objects: ObjectQuery,
    meshes: Res<TracedMeshes>,
    building: Res<TreeBuilding>,
    mut thread: ResMut<TopLevelThread>,
    mut known: ResMut<TracedInstances>,
    draft: ResMut<Draft>,
) {
    // Not `||`: every reader has to be emptied.
    let gone = no_mesh.read().count()
        + no_transform.read().count()
        + no_visibility.read().count()
        + no_id.read().count();
    let switched = switched.any() | motions.changed();
    let options_changed = known.options != *meshes.options();
    if gone == 0 && !switched && !options_changed && moved.is_empty() && !draft.changes.meshes {
        return;
    }
    let draft = draft.into_inner();
    draft.problems.instances.clear();
    draft.reread = true;

    let mut visible: Vec<_> = objects
        .iter()
        .filter(|(.., visibility, _)| visibility.is_none_or(|v| v.get()))
        .collect();
    visible.sort_unstable_by_key(|(_, id, ..)| **id);

    let mut rows = Vec::with_capacity(visible.len());
    let mut instances = Vec::with_capacity(visible.len());
    for (entity, &id, mesh, transform, _, name) in visible {
        let mut reader = Reader {
            kind: "object",
            id,
            name,
            problems: &mut draft.problems.instances,
        };
        let mesh = match meshes.get(mesh.id()) {
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
        let motion = motions.of(entity);
        let velocity = motion.map_or(Vec3::ZERO, |(velocity, _)| velocity);
        let row = Row {
            id,
            entity,
            mesh: mesh.clone(),
            motion_samples: motion.map_or(0, |(_, samples)| reader.samples(samples)),
            transform,
            velocity,
        };
        // Most stand where they stood.
        let place = rows.len();
        let before = known.rows.get(place);
        let instance = if before.is_some_and(|b| row.same_object(b) && row.same_place(b)) {
            Ok(draft.world.aggregate.instances()[place].clone())
        } else {
            Instance::new(mesh.tree.clone(), &transform)
                .and_then(|instance| instance.moving(velocity))
        };
        match instance {
            Ok(instance) => instances.push(instance),
            Err(fault) => {
                reader.note(Fault::Transform(fault));
                continue;
            }
        }
        rows.push(row);
    }
    let same = |same: fn(&Row, &Row) -> bool| {
        let mut pairs = rows.iter().zip(&known.rows);
        rows.len() == known.rows.len() && pairs.all(|(new, old)| same(new, old))
    };
    let same_objects = same(Row::same_object);
    if same_objects && same(Row::same_place) && !options_changed {
        return;
    }
    draft.other_objects |= !same_objects;
    known.rows = rows;
    known.options = *meshes.options();
    let build = || Aggregate::build(instances, meshes.options());
    draft.world.aggregate = Arc::new(match *building {
        TreeBuilding::AtOnce => build(),
        TreeBuilding::InBackground => thread.run(build),
    });
    draft.changes.top_level = true;
}

//! Skinned and morphed meshes, traced as they stand in this frame.

use super::pose::{Bend, bent};
use super::returned::Returned;
use crate::scene::NotTraced;
use crate::sync::{LeftOut, PosedMesh, TreeBuilding};
use crate::view::TracedView;
use bevy::asset::{AssetEvent, AssetId, Assets, RenderAssetUsages};
use bevy::camera::Camera;
use bevy::ecs::query::QueryData;
use bevy::ecs::system::SystemParam;
use bevy::math::{Affine3A, Mat4};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::{SkinnedMesh, SkinnedMeshInverseBindposes};
use bevy::mesh::{Mesh, Mesh3d};
use bevy::platform::collections::HashSet;
use bevy::prelude::{
    Commands, Component, Entity, Local, MessageReader, Or, Query, RemovedComponents, Res, ResMut,
    With, Without,
};
use bevy::transform::components::GlobalTransform;

/// What an object's [`PosedMesh`] was made of.
#[derive(Component, PartialEq)]
#[component(clone_behavior = Ignore)]
pub(super) struct Pose {
    mesh: AssetId<Mesh>,
    bend: Bend,
}

#[derive(QueryData)]
pub(super) struct Bendable {
    entity: Entity,
    mesh: &'static Mesh3d,
    skin: Option<&'static SkinnedMesh>,
    morph: Option<&'static MeshMorphWeights>,
    place: &'static GlobalTransform,
    pose: Option<&'static Pose>,
    posed: Option<&'static PosedMesh>,
}

type Bends = (
    Or<(With<SkinnedMesh>, With<MeshMorphWeights>)>,
    Without<NotTraced>,
);

/// Who would see a pose.
#[derive(SystemParam)]
pub(super) struct Onlookers<'w, 's> {
    building: Option<Res<'w, TreeBuilding>>,
    views: Query<'w, 's, (&'static TracedView, &'static Camera)>,
}

impl Onlookers<'_, '_> {
    fn are_there(&self) -> bool {
        let mut views = self.views.iter();
        // A picture without a view is of trees that are waited for.
        let at_once = Some(TreeBuilding::AtOnce);
        self.building.as_deref().copied() == at_once
            || views.any(|(view, camera)| camera.is_active && view.divider < 1.0 && !view.paused)
    }
}

/// Bends what stands otherwise than it did, while somebody looks: it takes its time in every frame.
pub(super) fn pose_meshes(
    mut commands: Commands,
    mut meshes: ResMut<Assets<Mesh>>,
    bind_poses: Option<Res<Assets<SkinnedMeshInverseBindposes>>>,
    places: Query<&GlobalTransform>,
    weights: Query<&MorphWeights>,
    objects: Query<Bendable, Bends>,
    onlookers: Onlookers,
    mut events: MessageReader<AssetEvent<Mesh>>,
    // Filled anew for each object: most stand as they stood, and nothing is kept of them.
    mut now: Local<Bend>,
    mut left_out: ResMut<LeftOut>,
) {
    let edited: HashSet<AssetId<Mesh>> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Modified { id } | AssetEvent::Added { id } => Some(*id),
            _ => None,
        })
        .collect();
    let anyone = onlookers.are_there();
    for object in &objects {
        let entity = object.entity;
        if !anyone {
            if edited.contains(&object.mesh.id()) {
                commands.entity(entity).try_remove::<Pose>();
            }
            continue;
        }
        if let Err(why) = find_bend(&object, bind_poses.as_deref(), &places, &weights, &mut now) {
            at_rest(&mut commands, &mut left_out, &object, Some(why));
            continue;
        }
        let mesh = object.mesh.id();
        let is_so = |pose: &Pose| pose.mesh == mesh && pose.bend == *now;
        if object.pose.is_some_and(is_so) && !edited.contains(&mesh) {
            continue;
        }
        // What is not loaded yet is bent when it is.
        let Some(asset) = meshes.get(mesh) else {
            continue;
        };
        // Of a mesh for the GPU alone that is said anyway.
        let is_kept = asset.asset_usage.contains(RenderAssetUsages::MAIN_WORLD);
        if now.is_none() || !is_kept {
            at_rest(&mut commands, &mut left_out, &object, None);
            continue;
        }
        let posed = match bent(asset, &now) {
            Ok(posed) => posed,
            Err(why) => {
                at_rest(&mut commands, &mut left_out, &object, Some(why));
                continue;
            }
        };
        let pose = Pose {
            mesh,
            bend: now.clone(),
        };
        LeftOut::note(&mut left_out, "posed object", entity, Vec::new());
        if let Some(known) = object.posed
            && let Some(mut known) = meshes.get_mut(&known.0)
        {
            *known = posed;
            commands.entity(entity).insert(pose);
        } else {
            let posed = PosedMesh(meshes.add(posed));
            commands.entity(entity).insert((pose, posed));
        }
    }
}

/// An object whose skin and weights were taken away stands as its mesh is, and one that returns is bent anew.
pub(super) fn straighten(
    mut commands: Commands,
    mut no_skin: RemovedComponents<SkinnedMesh>,
    mut no_morph: RemovedComponents<MeshMorphWeights>,
    bent: Query<(), Bends>,
    mut returned: Returned,
    mut left_out: ResMut<LeftOut>,
) {
    for entity in returned.read() {
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.try_remove::<Pose>();
        }
    }
    for entity in no_skin.read().chain(no_morph.read()) {
        if bent.contains(entity) {
            continue;
        }
        LeftOut::note(&mut left_out, "posed object", entity, Vec::new());
        if let Ok(mut entity) = commands.get_entity(entity) {
            entity.try_remove::<(Pose, PosedMesh)>();
        }
    }
}

fn at_rest(
    commands: &mut Commands,
    left_out: &mut ResMut<LeftOut>,
    object: &BendableItem,
    why: Option<&str>,
) {
    let note = why.map(|why| format!("{why}: it is traced as its mesh is"));
    let note = note.into_iter().collect();
    LeftOut::note(left_out, "posed object", object.entity, note);
    if object.pose.is_some() || object.posed.is_some() {
        let mut entity = commands.entity(object.entity);
        entity.try_remove::<(Pose, PosedMesh)>();
    }
}

/// How an object stands now, into what has room for it.
fn find_bend(
    object: &BendableItem,
    bind_poses: Option<&Assets<SkinnedMeshInverseBindposes>>,
    places: &Query<&GlobalTransform>,
    weights: &Query<&MorphWeights>,
    bend: &mut Bend,
) -> Result<(), &'static str> {
    bend.joints.clear();
    bend.weights.clear();
    match object.morph {
        None => {}
        Some(MeshMorphWeights::Value { weights }) => bend.weights.extend(weights),
        Some(MeshMorphWeights::Reference(holder)) => {
            let holder = weights.get(*holder);
            let holder = holder.map_err(|_| "the entity with its morph weights is gone")?;
            bend.weights.extend(holder.weights());
        }
    }
    let Some(skin) = object.skin else {
        return Ok(());
    };
    let bind_poses = bind_poses.and_then(|all| all.get(&skin.inverse_bindposes));
    let bind_poses = bind_poses.ok_or("the bind poses of its skin are not loaded")?;
    if skin.joints.is_empty() || bind_poses.len() < skin.joints.len() {
        return Err("its skin has other joints than bind poses");
    }
    // Joints bend it in the world, wherever it stands itself.
    let object_from_world = object.place.affine().inverse();
    for (&joint, bind_pose) in skin.joints.iter().zip(bind_poses.iter()) {
        let place = places
            .get(joint)
            .map_err(|_| "a joint of its skin is gone")?;
        let object_from_joint: Affine3A = object_from_world * place.affine();
        bend.joints.push(Mat4::from(object_from_joint) * *bind_pose);
    }
    if bend.joints.iter().any(|joint| !joint.is_finite()) {
        return Err("its place, or that of a joint of its skin, cannot be traced");
    }
    Ok(())
}

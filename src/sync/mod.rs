//! Entities to the tracer's world: what changed, and only that.
//!
//! Once a frame, after transforms, visibility and asset events have settled, the systems of
//! [`SyncSystems`] run one after the other:
//!
//! | system | reads | redoes |
//! |---|---|---|
//! | `assign_scene_ids` | entities without a `SceneId`, or with one that another has, and what they hang on | their numbers |
//! | `sync_meshes` | `Mesh` assets that an object uses, or is posed as | that mesh's triangles and tree |
//! | `sync_motions` | `Motion`, of entities and of all above them | how fast each moves in the world |
//! | `sync_instances` | which mesh stands where, how it moves, and whether it is visible | the tree over the objects |
//! | `sync_textures` | `Image` assets that a material or the environment uses | that texture, and colours that an opacity map cuts out; large ones and skies on threads of their own |
//! | `sync_materials` | `Phong`, `PhongMaps`, `UsesMaterial` | materials, and which object has which |
//! | `sync_lights` | the four lamps | lights |
//! | `sync_environment` | `Environment`, `EnvironmentMap`, a panorama or a cube | background and map |
//! | `sync_cameras` | `SceneCamera`, `Lens` | [`TracedCameras`] |
//! | `name_left_out` | [`LeftOut`] | what is named of it |
//! | `publish_snapshot` | what the systems above redid | [`Traced`] |
//!
//! A system reads again what changed, appeared or went, and nothing else of meshes, objects, textures
//! and materials, of which there are thousands; lights, cameras and surroundings it reads again all at
//! once. A part that comes out as it was is not replaced, so a snapshot shares it with the one before. A
//! world after a thousand edits equals one that is made from the same entities at once, to the last bit:
//! tests compare them. An app may give [`SyncSystems`] a run condition: after a rest all is read again.
//!
//! Trees of meshes are built, large pictures converted and cut out on threads of their own, and what was there before is traced
//! until they are done ([`TreeBuilding`]): no frame waits for them, and for the tree over the objects 2 ms at most.
//! [`finish`] waits for all.
//!
//! What cannot be traced is left out, and named in [`Traced::problems`]; the rest stays intact.
//!
//! Visibility is Bevy's `InheritedVisibility`: an app needs its `VisibilityPlugin` (which is in
//! `CameraPlugin` and so in `DefaultPlugins`; `headless_app` adds it).

#![expect(
    clippy::too_many_arguments,
    reason = "a system's parameters are the list of what it reads"
)]

mod ahead;
mod cameras;
mod conversions;
mod cut_outs;
mod environment;
mod ids;
mod image_sampler;
mod instances;
mod left_out;
mod lights;
mod material_data;
mod materials;
mod mesh_copies;
mod mesh_data;
mod meshes;
mod motions;
mod panorama;
mod posed;
mod problem;
mod reading;
mod rest;
mod texture_data;
mod textures;
mod traced;
mod tree_building;
mod uses;

#[cfg(test)]
mod tests;

pub use cameras::{TracedCamera, TracedCameras};
pub use ids::IdOwners;
pub use left_out::LeftOut;
pub use mesh_data::MeshFault;
pub use motions::{WorldMotion, WorldMotions};
pub use posed::PosedMesh;
pub use problem::{Fault, SyncProblem};
pub use texture_data::TextureFault;
pub use traced::{Changes, Traced};
pub use tree_building::{TreeBuilding, finish};

use bevy::app::{App, First, Plugin, PostUpdate};
use bevy::asset::AssetEventSystems;
use bevy::camera::visibility::VisibilitySystems;
use bevy::ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy::transform::TransformSystems;

/// Everything of this room, in `PostUpdate`, one system after the other.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SyncSystems;

/// Keeps [`Traced`] and [`TracedCameras`] equal to the entities.
///
/// Needs `TransformPlugin`, `AssetPlugin` with `Mesh` and `Image`, `VisibilityPlugin` and
/// [`ScenePlugin`](crate::scene::ScenePlugin).
pub struct SyncPlugin;

impl Plugin for SyncPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Traced>()
            .init_resource::<TracedCameras>()
            .init_resource::<traced::Draft>()
            .init_resource::<LeftOut>()
            .init_resource::<left_out::Named>()
            .init_resource::<rest::Frames>()
            .init_resource::<ids::IdOwners>()
            .init_resource::<TreeBuilding>()
            .init_resource::<meshes::TracedMeshes>()
            .init_resource::<WorldMotions>()
            .init_resource::<textures::TracedTextures>()
            .init_resource::<instances::TracedInstances>()
            .init_resource::<materials::TracedMaterials>()
            .init_resource::<tree_building::TopLevelThread>()
            .configure_sets(
                PostUpdate,
                SyncSystems
                    .after(TransformSystems::Propagate)
                    .after(VisibilitySystems::VisibilityPropagate)
                    .after(AssetEventSystems),
            )
            .add_systems(First, rest::count_frames)
            .add_systems(
                PostUpdate,
                (
                    rest::notice_rest,
                    ids::assign_scene_ids,
                    meshes::sync_meshes,
                    motions::sync_motions,
                    instances::sync_instances,
                    textures::sync_textures,
                    materials::sync_materials,
                    lights::sync_lights,
                    environment::sync_environment,
                    cameras::sync_cameras,
                    left_out::name_left_out,
                    traced::publish_snapshot,
                )
                    .chain()
                    .in_set(SyncSystems),
            );
    }
}

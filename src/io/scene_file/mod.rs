//! `.scn.ron`: Bevy's own world serialization, with a version in it, restricted to the components
//! of the room `scene`, to what says where an entity stands, and to what an app
//! [keeps](KeepInSceneFiles) of its own.
//!
//! Entities are written in the order of their [`SceneId`], and that number is their label, so that
//! the same scene gives the same bytes. The scene's handles are not written: the sources are. Those in components of an
//! app's own are, by the paths of their assets.

mod check;
mod handles;
mod kept;
mod migrate;
mod read;
mod write;

pub use kept::KeepInSceneFiles;
pub(crate) use kept::KeptTypes;
#[cfg(feature = "editor")]
pub(crate) use kept::{AnyKeptChanged, KeptComponents, keeps, kept_components};
#[cfg(feature = "editor")]
pub(crate) use read::read_scene_text;
pub(crate) use read::{SceneFile, read_scene};
#[cfg(feature = "editor")]
pub(crate) use write::SceneContent;
pub(crate) use write::{Rebase, write_scene};

use crate::scene::{AnyLamp, MeshSource, Phong, SceneCamera, SceneId};
use bevy::ecs::{hierarchy::ChildOf, reflect::ReflectResource, resource::Resource, world::World};
use bevy::prelude::{Entity, With};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

/// Which rules a scene file follows. A file with a higher number than this program's is refused.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default)]
#[type_path = "glassbox::io"]
pub(crate) struct FileVersion(pub u32);

impl FileVersion {
    /// The rules that this program writes. What version 1 calls `specular` is
    /// the mirror, too, and its diffuse maps take the place of the colour.
    const CURRENT: Self = Self(2);
}

/// Every entity that belongs to the scene: what carries one of its components, and the ancestors
/// that place it. In no particular order, each once.
pub(crate) fn scene_entities(world: &mut World) -> Vec<Entity> {
    type Any = bevy::prelude::Or<(
        With<SceneId>,
        With<MeshSource>,
        With<Phong>,
        AnyLamp,
        With<SceneCamera>,
    )>;
    let mut query = world.query_filtered::<Entity, Any>();
    let mut entities: std::collections::BTreeSet<Entity> = query.iter(world).collect();
    let mut to_visit: Vec<Entity> = entities.iter().copied().collect();
    while let Some(entity) = to_visit.pop() {
        if let Some(ChildOf(parent)) = world.get::<ChildOf>(entity)
            && entities.insert(*parent)
        {
            to_visit.push(*parent);
        }
    }
    entities.into_iter().collect()
}

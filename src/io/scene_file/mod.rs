//! `.scn.ron`: Bevy's own world serialization, with a version in it, restricted to the components
//! of the room `scene` and to what says where an entity stands.
//!
//! Entities are written in the order of their [`SceneId`], and that number is their label, so that
//! the same scene gives the same bytes. Handles are not written: the sources are.

mod check;
mod read;
mod write;

pub(crate) use read::{SceneFile, read_scene};
pub(crate) use write::{Rebase, write_scene};

use crate::scene::{
    DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp,
    RenderSettings, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::{
    hierarchy::ChildOf, name::Name, reflect::ReflectResource, resource::Resource, world::World,
};
use bevy::prelude::{Entity, With};
use bevy::reflect::{Reflect, TypeRegistry, std_traits::ReflectDefault};
use bevy::transform::components::Transform;
use bevy::world_serialization::DynamicWorldBuilder;

/// Which rules a scene file follows. A file with a higher number than this program's is refused.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Default)]
#[type_path = "glassbox::io"]
pub(crate) struct FileVersion(pub u32);

impl FileVersion {
    /// The rules that this program writes.
    const CURRENT: Self = Self(1);
}

/// Calls a macro with the components that scene files keep.
macro_rules! for_each_kept_component {
    ($call:ident) => {
        $call!(
            SceneId,
            Name,
            ChildOf,
            Transform,
            Visibility,
            MeshSource,
            Phong,
            UsesMaterial,
            PointLamp,
            DirectionalLamp,
            SegmentLamp,
            ParallelogramLamp,
            SceneCamera,
            Lens,
            Motion
        )
    };
}

/// Knows the kept components and resources, what they are made of, and nothing else, so that
/// reading refuses any other.
fn kept_types() -> TypeRegistry {
    let mut registry = TypeRegistry::new();
    macro_rules! register {
        ($($component:ty),*) => { $(registry.register::<$component>();)* };
    }
    for_each_kept_component!(register);
    registry.register::<Environment>();
    registry.register::<RenderSettings>();
    registry.register::<FileVersion>();
    registry
}

/// Extracts the kept components and resources, and nothing else.
fn kept_only<'w>(world: &'w World, registry: &'w TypeRegistry) -> DynamicWorldBuilder<'w> {
    let mut builder = DynamicWorldBuilder::from_world(world, registry).deny_all();
    macro_rules! allow {
        ($($component:ty),*) => { $(builder = builder.allow_component::<$component>();)* };
    }
    for_each_kept_component!(allow);
    builder
        .allow_resource::<Environment>()
        .allow_resource::<RenderSettings>()
}

/// Whether a type is one of the components that scene files keep.
fn is_kept_component(id: std::any::TypeId) -> bool {
    macro_rules! any {
        ($($component:ty),*) => { $(id == std::any::TypeId::of::<$component>())||* };
    }
    for_each_kept_component!(any)
}

/// Every entity that belongs to the scene: what carries one of its components, and the ancestors
/// that place it. In no particular order, each once.
pub(crate) fn scene_entities(world: &mut World) -> Vec<Entity> {
    type Any = bevy::prelude::Or<(
        With<SceneId>,
        With<MeshSource>,
        With<Phong>,
        With<PointLamp>,
        With<DirectionalLamp>,
        With<SegmentLamp>,
        With<ParallelogramLamp>,
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

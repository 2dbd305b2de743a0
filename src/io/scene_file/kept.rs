//! Which components and resources make a scene: what files keep is what undo keeps.

use crate::scene::{
    DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp,
    RenderSettings, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use bevy::camera::visibility::Visibility;
use bevy::ecs::{hierarchy::ChildOf, name::Name, world::World};
use bevy::reflect::TypeRegistry;
use bevy::transform::components::Transform;
use bevy::world_serialization::DynamicWorldBuilder;
use std::any::TypeId;

/// Calls a macro with the components that scene files keep.
macro_rules! for_each_kept_component {
    ($call:ident) => {
        $call! {
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
        }
    };
}

macro_rules! bundle {
    ($($component:ty),*) => {
        /// One of each kept component.
        #[cfg(feature = "editor")]
        pub(crate) type KeptComponents = ($($component,)*);
        /// A kept component was changed or added.
        #[cfg(feature = "editor")]
        pub(crate) type AnyKeptChanged =
            bevy::ecs::query::Or<($(bevy::ecs::query::Changed<$component>,)*)>;

        /// Each kept component's type and how to reach it on an entity.
        #[cfg(feature = "editor")]
        pub(crate) fn kept_components() -> Vec<(TypeId, bevy::ecs::reflect::ReflectComponent)> {
            use bevy::ecs::reflect::ReflectComponent;
            use bevy::reflect::FromType;
            vec![$((
                TypeId::of::<$component>(),
                <ReflectComponent as FromType<$component>>::from_type(),
            )),*]
        }
    };
}
for_each_kept_component!(bundle);

/// Knows the kept components and resources, what they are made of, and nothing else, so that
/// reading refuses any other.
pub(crate) fn kept_types() -> TypeRegistry {
    let mut registry = TypeRegistry::new();
    macro_rules! register {
        ($($component:ty),*) => { $(registry.register::<$component>();)* };
    }
    for_each_kept_component!(register);
    registry.register::<Environment>();
    registry.register::<RenderSettings>();
    registry.register::<super::FileVersion>();
    registry
}

/// Extracts the kept components and resources, and nothing else.
pub(super) fn kept_only<'w>(
    world: &'w World,
    registry: &'w TypeRegistry,
) -> DynamicWorldBuilder<'w> {
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
pub(super) fn is_kept_component(id: TypeId) -> bool {
    macro_rules! any {
        ($($component:ty),*) => { $(id == TypeId::of::<$component>())||* };
    }
    for_each_kept_component!(any)
}

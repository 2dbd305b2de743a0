//! Which components and resources make a scene: what files keep is what undo keeps. An app adds components of its own.

use crate::scene::{
    DirectionalLamp, Environment, Lens, MeshSource, Motion, ParallelogramLamp, Phong, PointLamp,
    RenderSettings, SceneCamera, SceneId, SegmentLamp, UsesMaterial,
};
use bevy::app::App;
use bevy::camera::visibility::Visibility;
use bevy::ecs::component::Component;
use bevy::ecs::entity::EntityMapper;
use bevy::ecs::reflect::ReflectComponent;
use bevy::ecs::resource::Resource;
use bevy::ecs::{hierarchy::ChildOf, name::Name, world::World};
use bevy::reflect::{GetTypeRegistration, PartialReflect, Reflect, TypePath, TypeRegistry};
use bevy::transform::components::Transform;
use bevy::world_serialization::{DynamicWorldBuilder, WorldFilter};
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
            use bevy::reflect::FromType;
            vec![$((
                TypeId::of::<$component>(),
                <ReflectComponent as FromType<$component>>::from_type(),
            )),*]
        }
    };
}
for_each_kept_component!(bundle);

/// An app's own components that scene files keep beside the scene's.
#[derive(Resource, Default)]
struct AppComponents {
    kinds: Vec<TypeId>,
    /// They and what they are made of.
    registry: TypeRegistry,
}

/// Lets scene files keep an app's own components.
pub trait KeepInSceneFiles {
    /// From now on scene files keep this component of the scene's entities. It is registered for reflection, too, so that
    /// an editor shows it. Fields that name entities are written as the numbers of those entities where
    /// [`MapEntities`](bevy::ecs::entity::MapEntities) says which they are. Handles are written as the paths of their
    /// assets, which the app's `AssetServer` loads again; one of an asset that the app has made itself is left out, and
    /// saving says so. The app has initialised those kinds of assets (`init_asset`).
    ///
    /// A scene file that holds it is opened only by apps that keep it.
    fn keep_in_scene_files<C>(&mut self) -> &mut Self
    where
        C: Component + Reflect + TypePath + GetTypeRegistration;
}

impl KeepInSceneFiles for App {
    fn keep_in_scene_files<C>(&mut self) -> &mut Self
    where
        C: Component + Reflect + TypePath + GetTypeRegistration,
    {
        self.register_type::<C>()
            .register_type_data::<C, ReflectComponent>()
            .init_resource::<AppComponents>();
        let mut kept = self.world_mut().resource_mut::<AppComponents>();
        kept.registry.register::<C>();
        kept.registry.register_type_data::<C, ReflectComponent>();
        if !kept.kinds.contains(&TypeId::of::<C>()) {
            kept.kinds.push(TypeId::of::<C>());
        }
        self
    }
}

/// Whether scene files keep an app's own component.
#[cfg(feature = "editor")]
pub(crate) fn keeps(world: &World, component: TypeId) -> bool {
    let kept = world.get_resource::<AppComponents>();
    kept.is_some_and(|kept| kept.kinds.contains(&component))
}

/// What scene files may hold: the kept components and resources, what they are made of, and nothing else, so that
/// reading refuses any other.
pub(crate) struct KeptTypes {
    pub registry: TypeRegistry,
    /// The components of the app's own.
    own: Vec<TypeId>,
}

impl KeptTypes {
    /// Those of a world.
    pub fn of(world: &World) -> Self {
        let mut registry = TypeRegistry::new();
        macro_rules! register {
            ($($component:ty),*) => { $(registry.register::<$component>();)* };
        }
        for_each_kept_component!(register);
        registry.register::<Environment>();
        registry.register::<RenderSettings>();
        registry.register::<super::FileVersion>();
        let kept = world.get_resource::<AppComponents>();
        for registration in kept.iter().flat_map(|kept| kept.registry.iter()) {
            registry.add_registration(registration.clone());
        }
        let own = kept.map_or_else(Vec::new, |kept| kept.kinds.clone());
        Self { registry, own }
    }

    /// Extracts the kept components and resources, and nothing else.
    pub fn only_kept<'w>(&'w self, world: &'w World) -> DynamicWorldBuilder<'w> {
        let mut kinds = WorldFilter::deny_all();
        macro_rules! allow {
            ($($component:ty),*) => { $(kinds = kinds.allow::<$component>();)* };
        }
        for_each_kept_component!(allow);
        for &own in &self.own {
            kinds = kinds.allow_by_id(own);
        }
        DynamicWorldBuilder::from_world(world, &self.registry)
            .deny_all()
            .with_component_filter(kinds)
            .allow_resource::<Environment>()
            .allow_resource::<RenderSettings>()
    }

    /// Gives the entities that a component of the app's own names the names that `mapper` knows.
    pub fn name_entities(&self, component: &mut dyn PartialReflect, mapper: &mut dyn EntityMapper) {
        let Some(component) = component.try_as_reflect_mut() else {
            return;
        };
        let id = component.as_any().type_id();
        if self.is_own(id)
            && let Some(kind) = self.registry.get_type_data::<ReflectComponent>(id)
        {
            kind.map_entities(component, mapper);
        }
    }

    /// Whether it is the app's own: the scene's schema says nothing of it.
    pub fn is_own(&self, id: TypeId) -> bool {
        self.own.contains(&id)
    }

    /// Whether a type is one of the components that scene files keep.
    pub fn is_component(&self, id: TypeId) -> bool {
        macro_rules! any {
            ($($component:ty),*) => { $(id == TypeId::of::<$component>())||* };
        }
        for_each_kept_component!(any) || self.is_own(id)
    }
}

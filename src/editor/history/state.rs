//! An entity of the scene as undo keeps it: the components that scene files keep and those of an app's own, and nothing
//! that is derived from them.

use super::super::edits::SceneIndex;
use super::super::foreign::{foreign_kinds, is_same, put};
use crate::io::kept_components;
use crate::scene::{MeshSource, Phong, PhongMaps, SceneId, UsesMaterial};
use bevy::ecs::component::ComponentId;
use bevy::ecs::entity::Entity;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::resource::Resource;
use bevy::ecs::world::{EntityWorldMut, World};
use bevy::mesh::Mesh3d;
use bevy::reflect::{
    FromType, PartialReflect, Reflect, ReflectFromReflect, ReflectRef, TypeInfo, TypeRegistration,
    TypeRegistry,
};
use std::any::TypeId;
use std::sync::Arc;

/// How each kept component is reached.
#[derive(Resource)]
pub(in crate::editor) struct Kinds {
    /// The scene's first, then those of an app's own.
    kinds: Vec<(TypeId, ReflectComponent)>,
    /// How many are the scene's.
    of_scene: usize,
    registry: TypeRegistry,
}

impl Default for Kinds {
    fn default() -> Self {
        let mut kinds = kept_components();
        // Where there is no `MeshSource` the handle is all that says which mesh it is: an app's own.
        let mesh = <ReflectComponent as FromType<Mesh3d>>::from_type();
        kinds.push((TypeId::of::<Mesh3d>(), mesh));
        let of_scene = kinds.len();
        let mut registry = crate::io::KeptTypes::of(&World::new()).registry;
        registry.register::<Mesh3d>();
        Self {
            kinds,
            of_scene,
            registry,
        }
    }
}

/// The value of one component.
#[derive(Clone, Debug)]
pub(super) enum Kept {
    /// Shared between the mirror and the steps that name it.
    Value(Arc<dyn Reflect>),
    /// `ChildOf` or `UsesMaterial`, by the number of the entity it names: entities do not outlive
    /// undo, numbers do.
    Entity(SceneId),
}

impl PartialEq for Kept {
    // `Arc` is reflected itself, as something that equals nothing: hence the stars.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Value(a), Self::Value(b)) => {
                Arc::ptr_eq(a, b) || is_same((**a).as_partial_reflect(), (**b).as_partial_reflect())
            }
            (Self::Entity(a), Self::Entity(b)) => a == b,
            _ => false,
        }
    }
}

impl Kept {
    /// The component, where it is of this type.
    pub fn value<T: Reflect>(&self) -> Option<&T> {
        match self {
            Self::Value(value) => value.as_ref().as_any().downcast_ref::<T>(),
            Self::Entity(_) => None,
        }
    }

    /// About how much memory it takes.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Value(value) => {
                // The counters of the `Arc` and the allocator's own share.
                const OVERHEAD: usize = 32;
                OVERHEAD + size_of_val(value.as_ref()) + heap(value.as_ref().as_partial_reflect())
            }
            Self::Entity(_) => 0,
        }
    }
}

/// What the strings and lists in a value hold.
fn heap(value: &dyn PartialReflect) -> usize {
    if let Some(text) = value.try_downcast_ref::<String>() {
        return text.capacity();
    }
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => fields.iter_fields().map(|(_, field)| heap(field)).sum(),
        ReflectRef::TupleStruct(fields) => fields.iter_fields().map(heap).sum(),
        ReflectRef::Enum(variant) => variant.iter_fields().map(|field| heap(field.value())).sum(),
        ReflectRef::List(items) => items
            .iter()
            .map(|item| size_of_val(item) + heap(item))
            .sum(),
        _ => 0,
    }
}

/// The components of one entity, in the order of [`Kinds`].
pub(super) type EntityState = Vec<Option<Kept>>;

impl Kinds {
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// The place of a component in an [`EntityState`].
    pub fn place_of<T: 'static>(&self) -> usize {
        let wanted = TypeId::of::<T>();
        let found = self.kinds.iter().position(|(id, _)| *id == wanted);
        found.unwrap_or(self.kinds.len())
    }

    /// The type of the component at a place.
    pub fn type_at(&self, place: usize) -> Option<TypeId> {
        self.kinds.get(place).map(|(id, _)| *id)
    }

    /// What the type of the component at a place is called.
    pub fn name_at(&self, place: usize) -> Option<&'static str> {
        let info: &TypeInfo = self.registry.get_type_info(self.type_at(place)?)?;
        Some(info.type_path_table().short_path())
    }

    /// The components of an app's own: their places, and what is known of their types.
    pub fn foreign(&self) -> impl Iterator<Item = (usize, &TypeRegistration)> {
        let kinds = self.kinds.iter().enumerate().skip(self.of_scene);
        kinds.filter_map(|(place, (id, _))| Some((place, self.registry.get(*id)?)))
    }

    /// A copy of the component at a place; `None` where the entity has none.
    pub fn clone_at(
        &self,
        world: &World,
        entity: Entity,
        place: usize,
    ) -> Option<Box<dyn Reflect>> {
        let (_, kind) = self.kinds.get(place)?;
        self.copy_of(kind.reflect(world.get_entity(entity).ok()?)?)
    }

    /// Takes the component at a place away.
    pub fn remove(&self, entity: &mut EntityWorldMut, place: usize) {
        if let Some((_, kind)) = self.kinds.get(place) {
            kind.remove(entity);
        }
    }

    /// What is known of the types of components, and of what they are made of.
    pub fn registry(&self) -> &TypeRegistry {
        &self.registry
    }

    /// Whether the component at a place is an app's own.
    pub fn is_foreign(&self, place: usize) -> bool {
        place >= self.of_scene
    }

    /// Takes the components in that an app has registered since. Returns how Bevy numbers them.
    pub(super) fn learn(&mut self, world: &mut World) -> Vec<ComponentId> {
        let mut new = Vec::new();
        if let Some(all) = world.get_resource::<AppTypeRegistry>() {
            // What they are made of, too.
            for kind in all.read().iter() {
                self.registry.add_registration(kind.clone());
            }
        }
        for kind in foreign_kinds(world) {
            let id = kind.type_id();
            if let Some(component) = kind.data::<ReflectComponent>()
                && !self.kinds.iter().any(|(known, _)| *known == id)
            {
                new.push(component.register_component(world));
                self.kinds.push((id, component.clone()));
            }
        }
        new
    }

    /// A copy of a component; `None` where its type offers none.
    fn copy_of(&self, value: &dyn Reflect) -> Option<Box<dyn Reflect>> {
        value.reflect_clone().ok().or_else(|| {
            let id = value.as_any().type_id();
            let make = self.registry.get_type_data::<ReflectFromReflect>(id)?;
            make.from_reflect(value.as_partial_reflect())
        })
    }

    /// Copies of an entity's kept components, with their places.
    pub fn clones(&self, world: &World, entity: Entity) -> Vec<(usize, Box<dyn Reflect>)> {
        let Ok(entity) = world.get_entity(entity) else {
            return Vec::new();
        };
        let values = self.kinds.iter().enumerate();
        values
            .filter_map(|(place, (_, kind))| Some((place, self.copy_of(kind.reflect(entity)?)?)))
            .collect()
    }

    /// Gives an entity the component of a place.
    pub fn insert(&self, entity: &mut EntityWorldMut, place: usize, value: &dyn Reflect) {
        match self.kinds.get(place) {
            Some((_, kind)) if self.is_foreign(place) => put(entity, kind, value, &self.registry),
            Some((_, kind)) => kind.insert(entity, value.as_partial_reflect(), &self.registry),
            None => {}
        }
    }

    /// The same where it has none.
    pub fn insert_missing(&self, entity: &mut EntityWorldMut, place: usize, value: &dyn Reflect) {
        if (self.kinds.get(place)).is_some_and(|(_, kind)| !kind.contains(&*entity)) {
            self.insert(entity, place, value);
        }
    }

    /// How an entity stands now. What is as it was before is shared with that.
    pub(super) fn capture(
        &self,
        world: &World,
        entity: Entity,
        before: Option<&EntityState>,
    ) -> EntityState {
        let Ok(entity) = world.get_entity(entity) else {
            return Vec::new();
        };
        let has_source = entity.contains::<MeshSource>();
        let capture = |place: usize, (id, kind): &(TypeId, ReflectComponent)| {
            if has_source && *id == TypeId::of::<Mesh3d>() {
                return None;
            }
            let value = kind.reflect(entity)?;
            let before = before.and_then(|state| state.get(place)?.as_ref());
            if let Some(named) = named_entity(value) {
                match world.get::<SceneId>(named) {
                    Some(id) if !id.is_unassigned() => return Some(Kept::Entity(*id)),
                    // It was deleted meanwhile, and may come back.
                    None if matches!(before, Some(Kept::Entity(_))) => return before.cloned(),
                    _ => {}
                }
            }
            if let Some(Kept::Value(old)) = before
                && is_same((**old).as_partial_reflect(), value.as_partial_reflect())
            {
                return Some(Kept::Value(old.clone()));
            }
            Some(Kept::Value(Arc::from(self.copy_of(value)?)))
        };
        self.kinds
            .iter()
            .enumerate()
            .map(|(place, kind)| capture(place, kind))
            .collect()
    }

    /// Makes an entity what a state says. What is so already is not touched.
    pub(super) fn enforce(&self, world: &mut World, entity: Entity, target: &EntityState) {
        let now = self.capture(world, entity, Some(target));
        for (place, (id, _)) in self.kinds.iter().enumerate() {
            let (now, wanted) = (now.get(place), target.get(place));
            let Some(Some(wanted)) = wanted else { continue };
            if now.is_some_and(|now| now.as_ref() == Some(wanted))
                && !self.is_stale(world, entity, wanted, *id)
            {
                continue;
            }
            let named = match wanted {
                Kept::Entity(id) => world.resource::<SceneIndex>().find(world, *id),
                Kept::Value(_) => None,
            };
            let Ok(mut entity) = world.get_entity_mut(entity) else {
                return;
            };
            match wanted {
                Kept::Value(value) => {
                    self.insert(&mut entity, place, value.as_ref());
                }
                Kept::Entity(_) if *id == TypeId::of::<ChildOf>() => {
                    if let Some(parent) = named {
                        entity.insert(ChildOf(parent));
                    }
                }
                Kept::Entity(_) => {
                    entity.insert(UsesMaterial(named.unwrap_or(Entity::PLACEHOLDER)));
                }
            }
        }
        // Last, because a component brings those along that it requires.
        self.remove_others(world, entity, target);
    }

    /// Whether a reference names an entity that is gone while its number is there again.
    fn is_stale(&self, world: &World, entity: Entity, wanted: &Kept, id: TypeId) -> bool {
        let Kept::Entity(number) = wanted else {
            return false;
        };
        let named = if id == TypeId::of::<ChildOf>() {
            world.get::<ChildOf>(entity).map(|child_of| child_of.0)
        } else {
            world.get::<UsesMaterial>(entity).map(|uses| uses.0)
        };
        named != world.resource::<SceneIndex>().find(world, *number)
    }

    fn remove_others(&self, world: &mut World, entity: Entity, target: &EntityState) {
        let Ok(mut entity) = world.get_entity_mut(entity) else {
            return;
        };
        let wants = |place: usize| matches!(target.get(place), Some(Some(_)));
        for (place, (id, kind)) in self.kinds.iter().enumerate() {
            if wants(place) || !kind.contains(&entity) {
                continue;
            }
            if *id == TypeId::of::<Mesh3d>() && entity.contains::<MeshSource>() {
                continue;
            }
            kind.remove(&mut entity);
            // What was made from it goes with it.
            if *id == TypeId::of::<MeshSource>() && !wants(self.place_of::<Mesh3d>()) {
                entity.remove::<Mesh3d>();
            }
            if *id == TypeId::of::<Phong>() {
                entity.remove::<PhongMaps>();
            }
        }
    }
}

/// The other entity that a component names.
fn named_entity(value: &dyn Reflect) -> Option<Entity> {
    let value = value.as_any();
    let parent = value.downcast_ref::<ChildOf>().map(|child_of| child_of.0);
    parent.or_else(|| value.downcast_ref::<UsesMaterial>().map(|uses| uses.0))
}

use super::super::error::{FileError, Place, Problem};
#[cfg(feature = "editor")]
use super::super::notes::Notes;
use super::super::on_disk::OnDisk;
use super::super::text::{is_utf_16, no_text, utf_16};
use super::check::check_value;
use super::handles::AppAssets;
use super::migrate::migrate;
use super::{FileVersion, KeptTypes};
use crate::io::Limits;
use crate::scene::{Environment, MeshSource, Phong, RenderSettings, SceneId, UsesMaterial};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::hierarchy::ChildOf;
use bevy::prelude::{Entity, World};
use bevy::reflect::{PartialReflect, ReflectRef};
use bevy::world_serialization::serde::WorldDeserializer;
use bevy::world_serialization::{DynamicEntity, DynamicWorld};
use serde::de::{DeserializeSeed, IgnoredAny, MapAccess, Visitor};
use std::any::TypeId;
use std::cell::Cell;
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;

/// The content of a scene file, checked, before it becomes entities.
pub(crate) struct SceneFile {
    content: DynamicWorld,
    types: KeptTypes,
    /// The file that it was read from.
    pub on_disk: OnDisk,
}

/// Reads a scene file for a world and checks everything in it that can be checked without other files.
pub(crate) fn read_scene(
    world: &World,
    file: &Path,
    limits: &Limits,
) -> Result<SceneFile, FileError> {
    let Limits {
        file_bytes, memory, ..
    } = limits;
    let bytes = super::super::read_bytes_unless(file, *file_bytes, memory, no_scene)?;
    read_scene_text(world, file, &bytes, limits)
}

/// The same from the text of a file; its name is for what is wrong with it.
pub(crate) fn read_scene_text(
    world: &World,
    file: &Path,
    bytes: &[u8],
    limits: &Limits,
) -> Result<SceneFile, FileError> {
    if bytes.trim_ascii().is_empty() {
        return Err(FileError::new(file, Problem::Empty));
    }
    if let Some(problem) = no_scene(bytes) {
        return Err(FileError::new(file, problem));
    }
    // Some editors of Windows begin every text with this.
    let unmarked = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(unmarked).map_err(|error| {
        let line = unmarked[..error.valid_up_to()]
            .split(|&b| b == b'\n')
            .count();
        let problem = Problem::Malformed("is not UTF-8 text".into());
        FileError::at(file, Place::Line(line as u64), problem)
    })?;
    // What the text says, as values that know their types, and as entities.
    (limits.memory)
        .claim(4 * bytes.len() as u64)
        .map_err(|problem| FileError::new(file, problem))?;
    let version = check_version(file, text)?;
    let types = KeptTypes::of(world);
    let mut deserializer =
        ron::de::Deserializer::from_str(text).map_err(|error| ron_error(file, &error))?;
    let content = WorldDeserializer {
        type_registry: &types.registry,
        load_from_path: &mut AppAssets {
            server: world.get_resource(),
            registry: &types.registry,
        },
    }
    .deserialize(&mut deserializer)
    .and_then(|content| deserializer.end().map(|()| content))
    .map_err(|error| ron_error(file, &deserializer.span_error(error)))?;
    let mut scene = SceneFile {
        content,
        types,
        on_disk: OnDisk::new(file, bytes),
    };
    scene
        .content
        .resources
        .retain(|resource| resource.try_downcast_ref::<FileVersion>().is_none());
    migrate(&mut scene.content, version);
    scene.check(file, limits)?;
    Ok(scene)
}

/// Why a file can be no scene, by how it begins.
fn no_scene(start: &[u8]) -> Option<Problem> {
    match is_utf_16(start) {
        true => Some(utf_16("a scene")),
        false => no_text(start),
    }
}

impl SceneFile {
    fn check(&self, file: &Path, limits: &Limits) -> Result<(), FileError> {
        let count = self.content.entities.len() as u64;
        if count > limits.entities {
            let problem = Problem::TooMany {
                what: "entities",
                count,
                limit: limits.entities,
            };
            return Err(FileError::new(file, problem));
        }
        for resource in &self.content.resources {
            let is_ours =
                |id| id == TypeId::of::<Environment>() || id == TypeId::of::<RenderSettings>();
            check_kind(resource.as_ref(), is_ours)
                .and_then(|()| check_value(resource.as_ref()))
                .map_err(|problem| FileError::at(file, part("resources"), problem))?;
        }
        let labels: BTreeSet<Entity> = self.content.entities.iter().map(|e| e.entity).collect();
        let mut ids = BTreeSet::new();
        for entity in &self.content.entities {
            let place = || part(&format!("entity {}", entity.entity.to_bits()));
            let mut check = |component: &dyn PartialReflect| {
                let kind = component.get_represented_type_info();
                check_kind(component, |id| self.types.is_component(id))?;
                if !kind.is_some_and(|kind| self.types.is_own(kind.type_id())) {
                    check_value(component)?;
                }
                if let Some(id) = component.try_downcast_ref::<SceneId>()
                    && !id.is_unassigned()
                {
                    // It could not be written again: entities are named by it.
                    if Entity::try_from_bits(id.0).is_none() {
                        return Err(Problem::OutOfRange {
                            what: "SceneId".into(),
                            value: id.0.to_string().into(),
                            range: "no multiple of 2^32".into(),
                        });
                    }
                    if !ids.insert(*id) {
                        return Err(Problem::DuplicateId(id.0));
                    }
                }
                match refers_to(component) {
                    Some(other) if !labels.contains(&other) => {
                        Err(Problem::NoSuchEntity(other.to_bits().to_string()))
                    }
                    _ => Ok(()),
                }
            };
            for component in &entity.components {
                check(component.as_ref())
                    .map_err(|problem| FileError::at(file, place(), problem))?;
            }
        }
        let mut labels = BTreeSet::new();
        for entity in &self.content.entities {
            if !labels.insert(entity.entity) {
                let place = part(&format!("entity {}", entity.entity.to_bits()));
                let problem = Problem::Malformed("is there twice".into());
                return Err(FileError::at(file, place, problem));
            }
        }
        self.check_ancestors(file, limits)
    }

    /// An entity among its own ancestors would hang whatever walks up.
    fn check_ancestors(&self, file: &Path, limits: &Limits) -> Result<(), FileError> {
        let parent_of = |e: &DynamicEntity| {
            let mut components = e.components.iter();
            let parent = components.find_map(|c| c.try_downcast_ref::<ChildOf>())?;
            Some((e.entity, parent.0))
        };
        let parents: EntityHashMap<Entity> =
            self.content.entities.iter().filter_map(parent_of).collect();
        for &start in parents.keys() {
            let mut at = start;
            let mut depth = 0;
            while let Some(&parent) = parents.get(&at) {
                at = parent;
                depth += 1;
                let problem = if at == start {
                    Problem::Malformed("is among its own ancestors".into())
                } else if depth > limits.depth {
                    Problem::TooMany {
                        what: "ancestors or more",
                        count: depth,
                        limit: limits.depth,
                    }
                } else {
                    continue;
                };
                let place = part(&format!("entity {}", start.to_bits()));
                return Err(FileError::at(file, place, problem));
            }
        }
        Ok(())
    }

    /// Everything in the file of one type: entities' components and resources.
    fn all<T: bevy::reflect::Reflect>(&self) -> impl Iterator<Item = &T> {
        let entities = self.content.entities.iter();
        entities
            .flat_map(|entity| &entity.components)
            .chain(&self.content.resources)
            .filter_map(|value| value.as_ref().try_downcast_ref::<T>())
    }

    /// Where meshes come from.
    pub fn mesh_sources(&self) -> impl Iterator<Item = &MeshSource> {
        self.all::<MeshSource>()
    }

    /// Materials, which name pictures.
    pub fn materials(&self) -> impl Iterator<Item = &Phong> {
        self.all::<Phong>()
    }

    /// The environment, which may name a map.
    pub fn environment(&self) -> Option<&Environment> {
        self.all::<Environment>().next()
    }

    /// Other numbers for the entities, so that they can be added to a scene, and other paths, so
    /// that they mean the same files from another folder. Resources are left out. Returns the new
    /// numbers by the old ones.
    #[cfg(feature = "editor")]
    pub fn as_addition(
        &mut self,
        mut next: impl FnMut() -> SceneId,
        rebase: &super::Rebase,
    ) -> std::collections::HashMap<SceneId, SceneId> {
        let mut notes = Notes::default();
        let mut renumbered = std::collections::HashMap::new();
        self.content.resources.clear();
        let entities = self.content.entities.iter_mut();
        for component in entities.flat_map(|entity| &mut entity.components) {
            let new = component
                .try_downcast_ref::<SceneId>()
                .map(|old| (*old, next()));
            if let Some((old, new)) = new {
                *component = Box::new(new);
                renumbered.insert(old, new);
            }
            rebase.apply(component.as_mut(), &mut notes);
        }
        renumbered
    }

    /// Makes entities and resources. Returns the entities in the order of the file.
    pub fn spawn(self, world: &mut World) -> Result<Vec<Entity>, String> {
        let mut entities = EntityHashMap::default();
        self.content
            .write_to_world_with(world, &mut entities, &self.types.registry)
            .map_err(|error| error.to_string())?;
        let mut spawned = Vec::with_capacity(self.content.entities.len());
        for dynamic in &self.content.entities {
            let Some(&entity) = entities.get(&dynamic.entity) else {
                continue;
            };
            spawned.push(entity);
            // World serialization leaves out the hooks that make `Children`; inserting runs them.
            if let Some(&ChildOf(parent)) = world.get::<ChildOf>(entity) {
                world.entity_mut(entity).insert(ChildOf(parent));
            }
        }
        Ok(spawned)
    }
}

/// The other entity that a component names.
fn refers_to(component: &dyn PartialReflect) -> Option<Entity> {
    let parent = component.try_downcast_ref::<ChildOf>().map(|c| c.0);
    parent.or_else(|| component.try_downcast_ref::<UsesMaterial>().map(|m| m.0))
}

/// A value of a type that is kept, and all of it.
fn check_kind(value: &dyn PartialReflect, kept: impl Fn(TypeId) -> bool) -> Result<(), Problem> {
    let kind = match value.get_represented_type_info() {
        Some(info) if kept(info.type_id()) => info.type_path_table().short_path(),
        _ => {
            return Err(Problem::UnknownComponent {
                name: value.reflect_type_path().to_owned(),
            });
        }
    };
    if value.try_as_reflect().is_some() {
        return Ok(());
    }
    // What the text says is not enough to make one.
    let missing = missing_field(value).map_or_else(String::new, |field| format!(": `{field}`"));
    let text = format!("`{kind}` lacks a field{missing}");
    Err(Problem::Malformed(text))
}

/// A field that a variant has and this value of it lacks. A structure's fields have defaults.
fn missing_field(value: &dyn PartialReflect) -> Option<String> {
    match value.reflect_ref() {
        ReflectRef::Struct(fields) => {
            (0..fields.field_len()).find_map(|i| missing_field(fields.field_at(i)?))
        }
        ReflectRef::Enum(choice) => {
            let within = (0..choice.field_len()).find_map(|i| missing_field(choice.field_at(i)?));
            let info = value.get_represented_type_info()?.as_enum().ok()?;
            let variant = info.variant(choice.variant_name())?.as_struct_variant();
            let mut names = variant.iter().flat_map(|variant| variant.field_names());
            let lacks = |name: &&&str| choice.field(name).is_none();
            let own = names
                .find(lacks)
                .map(|name| format!("{}.{name}", choice.variant_name()));
            within.or(own)
        }
        _ => None,
    }
}

fn part(name: &str) -> Place {
    Place::Part(name.to_owned())
}

fn ron_error(file: &Path, error: &ron::error::SpannedError) -> FileError {
    let text = error.code.to_string();
    let unknown = text
        .split_once("no registration found for `")
        .and_then(|(_, rest)| rest.split_once('`'));
    let problem = match (&error.code, unknown) {
        (_, Some((name, _))) => Problem::UnknownComponent { name: name.into() },
        (ron::Error::Eof, _) => Problem::Truncated("the scene is incomplete".into()),
        _ => Problem::Malformed(text.split_whitespace().collect::<Vec<_>>().join(" ")),
    };
    let place = Place::LineColumn(error.span.start.line, error.span.start.col);
    FileError::at(file, place, problem)
}

/// Looks for the version before anything else is understood: a newer file may hold what this
/// program does not know, and "newer" is then the helpful answer.
fn check_version(file: &Path, text: &str) -> Result<FileVersion, FileError> {
    let found = Cell::new(None);
    let mut deserializer =
        ron::de::Deserializer::from_str(text).map_err(|error| ron_error(file, &error))?;
    let result = serde::Deserializer::deserialize_struct(
        &mut deserializer,
        "World",
        &["resources", "entities"],
        WorldProbe { found: &found },
    );
    match (found.get(), result) {
        (Some(version), _) if version > FileVersion::CURRENT.0 => Err(FileError::new(
            file,
            Problem::NewerVersion {
                found: version,
                known: FileVersion::CURRENT.0,
            },
        )),
        (Some(0), _) => {
            let problem = Problem::Malformed("is 0; the first is 1".into());
            Err(FileError::at(file, part("FileVersion"), problem))
        }
        (Some(version), _) => Ok(FileVersion(version)),
        (None, Ok(())) => Err(FileError::new(file, Problem::NoVersion)),
        (None, Err(error)) => Err(ron_error(file, &deserializer.span_error(error))),
    }
}

struct WorldProbe<'a> {
    found: &'a Cell<Option<u32>>,
}

impl<'de> Visitor<'de> for WorldProbe<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a scene: (resources: {…}, entities: {…})")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            if key == "resources" {
                map.next_value_seed(ResourcesProbe { found: self.found })?;
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

struct ResourcesProbe<'a> {
    found: &'a Cell<Option<u32>>,
}

impl<'de> DeserializeSeed<'de> for ResourcesProbe<'_> {
    type Value = ();

    fn deserialize<D: serde::Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for ResourcesProbe<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("resources: {\"type\": value, …}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            if key.ends_with("::FileVersion") {
                let (version,) = map.next_value::<(u32,)>()?;
                self.found.set(Some(version));
            } else {
                map.next_value::<IgnoredAny>()?;
            }
        }
        Ok(())
    }
}

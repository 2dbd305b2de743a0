use super::super::error::{FileError, Place, Problem};
use super::super::file_name::{BUILTIN, split_fragment};
use super::super::folder::Folder;
use super::super::ids::assign_ids;
use super::super::notes::Notes;
use super::super::on_disk::OnDisk;
use super::super::replace::{check_space, replace_file};
use super::super::sources::SceneFiles;
use super::handles::forget_nameless;
use super::{FileVersion, KeptTypes, scene_entities};
use crate::scene::{
    Environment, MeshSource, Phong, PhongMap, SceneId, TextureSource, UsesMaterial,
};
use bevy::ecs::entity::{EntityHashMap, EntityMapper};
use bevy::ecs::hierarchy::ChildOf;
use bevy::mesh::Mesh3d;
use bevy::prelude::{Entity, World};
use bevy::reflect::PartialReflect;
#[cfg(feature = "editor")]
use bevy::transform::components::Transform;
use bevy::world_serialization::serde::DynamicWorldSerializer;
use bevy::world_serialization::{DynamicWorld, serialize_ron};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes the scene. Entities without a [`SceneId`], or with one that another has, get the next
/// free number first. Paths are written relative to the new file's folder. Returns what the file cannot say.
pub(crate) fn write_scene(world: &mut World, file: &Path) -> Result<Notes, FileError> {
    let content = SceneContent::of_scene(world, file)?;
    let written = content.write(file)?;
    if let Some(mut files) = world.get_resource_mut::<SceneFiles>() {
        files.on_disk = Some(written);
    }
    Ok(content.notes)
}

/// What a scene file says, taken from the world, so that it can be written on another thread.
pub(crate) struct SceneContent {
    content: DynamicWorld,
    types: KeptTypes,
    /// What the file cannot say.
    pub notes: Notes,
}

impl SceneContent {
    /// The whole open scene, for a file at this place.
    pub fn of_scene(world: &mut World, file: &Path) -> Result<Self, FileError> {
        let entities = scene_entities(world);
        assign_ids(world, &entities);
        let rebase = Rebase::new(world, file);
        Self::new(world, &entities, file, Some(&rebase))
    }

    /// These entities alone, their paths as they are, some of them placed elsewhere. What they
    /// name outside of the list is left out.
    #[cfg(feature = "editor")]
    pub fn of_entities(
        world: &mut World,
        entities: &[Entity],
        placed: &[(Entity, Transform)],
    ) -> Result<Self, FileError> {
        let mut content = Self::new(world, entities, Path::new("clipboard"), None)?;
        let places: std::collections::HashMap<u64, Transform> = placed
            .iter()
            .filter_map(|(entity, place)| Some((world.get::<SceneId>(*entity)?.0, *place)))
            .collect();
        for entity in &mut content.content.entities {
            let Some(place) = places.get(&entity.entity.to_bits()) else {
                continue;
            };
            for component in &mut entity.components {
                if component.try_downcast_ref::<Transform>().is_some() {
                    *component = Box::new(*place);
                }
            }
        }
        Ok(content)
    }

    fn new(
        world: &mut World,
        entities: &[Entity],
        file: &Path,
        rebase: Option<&Rebase>,
    ) -> Result<Self, FileError> {
        let mut notes = Notes::default();
        let mut labels = EntityHashMap::default();
        for &entity in entities {
            let id = world.get::<SceneId>(entity).map_or(0, |id| id.0);
            // Fails for multiples of 2^32, which nobody reaches by counting.
            let label = Entity::try_from_bits(id).ok_or_else(|| {
                let problem = Problem::OutOfRange {
                    what: "a SceneId".into(),
                    value: id.to_string().into(),
                    range: "no multiple of 2^32".into(),
                };
                FileError::new(file, problem)
            })?;
            labels.insert(entity, label);
            if world.get::<Mesh3d>(entity).is_some() && world.get::<MeshSource>(entity).is_none() {
                let what = "meshes without a MeshSource, of entities";
                notes.add_named(file, Place::Whole, what, &id.to_string(), "left out");
            }
        }
        let types = KeptTypes::of(world);
        let mut builder = types
            .only_kept(world)
            .extract_entities(entities.iter().copied());
        if rebase.is_some() {
            builder = builder.extract_resources();
        }
        let mut content = builder.build();
        for dynamic in &mut content.entities {
            dynamic.components.retain_mut(|component| {
                types.name_entities(component.as_mut(), &mut Labels(&labels));
                if forget_nameless(component.as_mut(), &types.registry) {
                    let what = "handles of assets that come from no file, in components";
                    let kind = component.get_represented_type_info();
                    let kind = kind.map_or("", |kind| kind.type_path_table().short_path());
                    notes.add_named(file, Place::Whole, what, kind, "left out");
                }
                let kept = relabel(component.as_mut(), &labels);
                if !kept {
                    let what = "a reference to an entity outside the scene";
                    notes.add(file, Place::Whole, what, "left out");
                }
                if let Some(rebase) = rebase {
                    rebase.apply(component.as_mut(), &mut notes);
                }
                kept
            });
            if let Some(&label) = labels.get(&dynamic.entity) {
                dynamic.entity = label;
            }
        }
        if let Some(rebase) = rebase {
            for resource in &mut content.resources {
                rebase.apply(resource.as_mut(), &mut notes);
            }
        }
        content
            .entities
            .sort_by_key(|dynamic| dynamic.entity.to_bits());
        content.resources.push(Box::new(FileVersion::CURRENT));
        Ok(Self {
            content,
            types,
            notes,
        })
    }

    /// As the file says it.
    pub fn to_text(&self, file: &Path) -> Result<String, FileError> {
        let malformed =
            |error: ron::Error| FileError::new(file, Problem::Malformed(error.to_string()));
        let content = DynamicWorldSerializer::new(&self.content, &self.types.registry);
        let mut text = serialize_ron(content).map_err(malformed)?;
        text.push('\n');
        Ok(text)
    }

    /// Writes the file: complete, or not at all.
    pub fn write(&self, file: &Path) -> Result<OnDisk, FileError> {
        let text = self.to_text(file)?;
        check_space(file, text.len() as u64)?;
        replace_file(file, |writer| writer.write_all(text.as_bytes()))?;
        Ok(OnDisk::new(file, text.as_bytes()))
    }
}

/// Labels in place of entities; none for those that are not written.
struct Labels<'a>(&'a EntityHashMap<Entity>);

impl EntityMapper for Labels<'_> {
    fn get_mapped(&mut self, named: Entity) -> Entity {
        self.0.get(&named).copied().unwrap_or(Entity::PLACEHOLDER)
    }

    fn set_mapped(&mut self, _: Entity, _: Entity) {}
}

/// Replaces the entity that a component names by its label. False where it has none.
fn relabel(component: &mut dyn PartialReflect, labels: &EntityHashMap<Entity>) -> bool {
    let named = if let Some(ChildOf(parent)) = component.try_downcast_mut::<ChildOf>() {
        parent
    } else if let Some(UsesMaterial(material)) = component.try_downcast_mut::<UsesMaterial>() {
        material
    } else {
        return true;
    };
    match labels.get(named) {
        Some(&label) => {
            *named = label;
            true
        }
        None => false,
    }
}

/// Turns paths that start from the folder that was opened into paths from the one written to.
pub(crate) struct Rebase {
    from: Folder,
    to: Folder,
    /// The file that the paths are for, as notes call it.
    file: PathBuf,
}

impl Rebase {
    pub fn new(world: &World, file: &Path) -> Self {
        let from = world
            .get_resource::<SceneFiles>()
            .map(|files| files.folder.clone())
            .unwrap_or_default();
        Self {
            from,
            to: Folder::of(file, true),
            file: file.to_path_buf(),
        }
    }

    /// From one folder to another, for what comes from a file.
    pub fn between(from: Folder, to: Folder, file: &Path) -> Self {
        let file = file.to_path_buf();
        Self { from, to, file }
    }

    pub fn apply(&self, value: &mut dyn PartialReflect, notes: &mut Notes) {
        let mut texture = |source: &mut Option<TextureSource>| {
            if let Some(TextureSource { path, .. }) = source {
                *path = self.path(path, notes);
            }
        };
        if let Some(MeshSource::File { path, .. }) = value.try_downcast_mut::<MeshSource>() {
            *path = self.path(path, notes);
        } else if let Some(phong) = value.try_downcast_mut::<Phong>() {
            for map in PhongMap::ALL {
                texture(map.source_mut(phong));
            }
        } else if let Some(environment) = value.try_downcast_mut::<Environment>() {
            texture(&mut environment.map);
        }
    }

    /// The same file, named from the other folder.
    pub fn path(&self, path: &str, notes: &mut Notes) -> String {
        if path.starts_with(BUILTIN) {
            return path.to_owned();
        }
        let (name, fragment) = split_fragment(path);
        let full = self.from.file_of(name);
        let mut named = self.to.name_of(&full);
        // What a person typed may be a name that no scene can say as it stands.
        if self.from.name_of(&full) == named && !name.contains(['\\', ':']) {
            return path.to_owned();
        }
        if named.starts_with("..") {
            let what = "outside the folder of the file that names it:";
            let instead = "copy it there, or open with --allow-outside";
            notes.add_named(&self.file, Place::Whole, what, &named, instead);
        }
        if !fragment.is_empty() {
            named = format!("{named}#{fragment}");
        }
        named
    }
}

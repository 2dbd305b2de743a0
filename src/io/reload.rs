//! Loading again what the open scene has loaded from a file.

use super::Limits;
use super::error::FileError;
use super::file_name::{BUILTIN, split_fragment};
use super::folder::Folder;
use super::loader::Loader;
use super::picture::PictureUse;
use super::sources::{SceneFiles, mesh_key};
use crate::scene::{Environment, MeshSource, Phong, PhongMap, TextureSource};
use bevy::asset::Assets;
use bevy::image::Image;
use bevy::mesh::Mesh;
use bevy::prelude::World;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::path::PathBuf;

/// A file that the open scene reads, and what it reads from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SourceFile {
    /// Where it lies.
    pub file: PathBuf,
    meshes: Vec<MeshSource>,
    pictures: Vec<(TextureSource, PictureUse)>,
}

/// Files by where they lie.
struct Found {
    folder: Folder,
    files: BTreeMap<PathBuf, SourceFile>,
    /// Where the files lie whose paths have been met; `None` where a path may not be followed: it is no file of ours
    /// then.
    places: HashMap<String, Option<PathBuf>>,
    /// What has been met: a model may be thousands of meshes.
    seen: HashSet<String>,
}

impl Found {
    fn file(&mut self, path: &str) -> Option<&mut SourceFile> {
        if !self.places.contains_key(path) {
            let file = self.folder.resolve(path).ok();
            self.places.insert(path.to_owned(), file);
        }
        let file = self.places.get(path)?.as_ref()?;
        let entry = self.files.entry(file.clone()).or_default();
        entry.file.clone_from(file);
        Some(entry)
    }

    fn mesh(&mut self, source: &MeshSource) {
        if let MeshSource::File { path, .. } = source
            && self.seen.insert(mesh_key(source))
            && let Some(file) = self.file(path)
        {
            file.meshes.push(source.clone());
        }
    }

    fn picture(&mut self, source: Option<&TextureSource>, usage: PictureUse) {
        if let Some(source) = source
            && !source.path.starts_with(BUILTIN)
            && let Some(file) = self.file(split_fragment(&source.path).0)
        {
            let entry = (source.clone(), usage);
            if !file.pictures.contains(&entry) {
                file.pictures.push(entry);
            }
        }
    }
}

/// Every file that entities and the environment name, each once.
pub(crate) fn source_files(world: &mut World) -> Vec<SourceFile> {
    let Some(files) = world.get_resource::<SceneFiles>() else {
        return Vec::new();
    };
    let mut found = Found {
        folder: files.folder.clone(),
        files: BTreeMap::new(),
        places: HashMap::new(),
        seen: HashSet::new(),
    };
    let mut meshes = world.query::<&MeshSource>();
    for source in meshes.iter(world) {
        found.mesh(source);
    }
    let mut materials = world.query::<&Phong>();
    for phong in materials.iter(world) {
        for map in PhongMap::ALL {
            found.picture(map.source(phong), PictureUse::of(map));
        }
    }
    if let Some(environment) = world.get_resource::<Environment>() {
        found.picture(environment.map.as_ref(), PictureUse::Color);
    }
    found.files.into_values().collect()
}

impl SourceFile {
    /// Loads all of it, on any thread.
    pub fn load(&self, folder: &Folder, limits: &Limits) -> Result<Reloaded, FileError> {
        // Each time anew: what it was before is let go.
        let limits = Limits {
            memory: limits.memory.apart(),
            ..limits.clone()
        };
        let mut loader = Loader::new(folder, &limits);
        let mut meshes = Vec::new();
        for source in &self.meshes {
            meshes.push((source.clone(), loader.mesh(source)?));
        }
        let mut pictures = Vec::new();
        for (source, usage) in &self.pictures {
            let picture = loader.picture(source, *usage)?;
            pictures.push((source.clone(), *usage, picture));
        }
        Ok(Reloaded {
            meshes,
            pictures,
            read: loader.read,
        })
    }
}

/// What was loaded again.
pub(crate) struct Reloaded {
    meshes: Vec<(MeshSource, Mesh)>,
    pictures: Vec<(TextureSource, PictureUse, Image)>,
    read: BTreeSet<PathBuf>,
}

impl Reloaded {
    /// Puts it in the place of what was loaded before; handles stay. What was not loaded before is
    /// tried anew by those that name it. True where anything came of it.
    pub fn apply(self, world: &mut World) -> bool {
        let Some(mut files) = world.remove_resource::<SceneFiles>() else {
            return false;
        };
        files.note_read(self.read);
        let mut missing = false;
        let mut replaced = false;
        if let Some(mut assets) = world.get_resource_mut::<Assets<Mesh>>() {
            for (source, mesh) in self.meshes {
                match files.loaded_mesh(&source, &assets) {
                    Some(id) => replaced |= assets.insert(id, mesh).is_ok(),
                    None => missing = true,
                }
            }
        }
        if let Some(mut assets) = world.get_resource_mut::<Assets<Image>>() {
            for (source, usage, picture) in self.pictures {
                match files.loaded_picture(&source, usage, &assets) {
                    Some(id) => replaced |= assets.insert(id, picture).is_ok(),
                    None => missing = true,
                }
            }
        }
        world.insert_resource(files);
        if missing {
            super::resolve::retry(world);
        }
        replaced || missing
    }
}

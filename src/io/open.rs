use super::budget::{Budget, beside, mesh_bytes};
use super::builtin::{self, BuiltinScene};
use super::error::{FileError, Problem};
use super::file_name::encoded;
use super::folder::Folder;
use super::frame::frame;
use super::ids::assign_ids;
use super::loader::{Loader, MODEL_EXTENSIONS, read_model};
use super::model::Model;
use super::notes::Notes;
use super::picture::PictureUse;
use super::resolve::resolve;
use super::scene_file::{SceneFile, read_scene, scene_entities};
use super::sources::SceneFiles;
use super::spawn::spawn_model;
use super::{Limits, LoadProblems, extension, shapes};
use crate::scene::{
    Environment, MeshSource, Phong, PhongMap, RenderSettings, SceneId, TextureSource,
};
use bevy::asset::{Assets, Handle};
use bevy::color::LinearRgba;
use bevy::image::Image;
use bevy::mesh::Mesh;
use bevy::prelude::World;
use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};

/// What can be opened.
#[derive(Clone)]
pub enum SceneSource {
    /// `.scn.ron`, or one that holds a model: `.obj`, `.gltf`, `.glb`, `.stl`, `.ply`.
    File(PathBuf),
    /// A scene that Glassbox makes.
    Builtin(&'static BuiltinScene),
}

impl SceneSource {
    /// A built-in scene's name, or else a file. A file that is called like a built-in scene is
    /// reached as `./name`.
    pub fn named(name: impl AsRef<Path>) -> Self {
        let path = name.as_ref();
        match path.to_str().and_then(builtin::find) {
            Some(scene) => Self::Builtin(scene),
            None => Self::File(path.to_path_buf()),
        }
    }
}

/// What opening may do.
#[derive(Clone, Debug, Default)]
pub struct OpenOptions {
    /// Whether files may refer to others outside their own folder.
    pub allow_outside: bool,
    /// Whether a scene is opened although something that it names cannot be loaded, a picture that was deleted or a
    /// shape that has no size: that is left out then, and [`LoadProblems`] says why. Not so what is outside.
    pub tolerant: bool,
    /// Whether a model without a camera or a light is left without.
    pub unframed: bool,
    /// How much files may ask for.
    pub limits: Limits,
}

/// What was opened.
#[derive(Clone, Debug, Default)]
pub struct Opened {
    /// The built-in scene's name, or the file's without its folder.
    pub name: String,
    /// What was left out, changed or added.
    pub notes: Notes,
}

/// Replaces the open scene by another. Everything is loaded and checked first: on an error the
/// world is as it was.
///
/// A model file without a camera or a light gets one of each that it lacks, and a note says so, unless that is
/// [`OpenOptions::unframed`].
pub fn open(
    world: &mut World,
    source: &SceneSource,
    mut options: OpenOptions,
) -> Result<Opened, FileError> {
    // What is open stays in memory until the other scene is complete.
    options.limits.memory = beside(&options.limits.memory, world);
    let file = match source {
        SceneSource::Builtin(scene) => return Ok(open_builtin(world, scene, options)),
        SceneSource::File(file) => file,
    };
    let mut opened = Opened {
        name: file
            .file_name()
            .map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        notes: Notes::default(),
    };
    let extension = extension(file);
    if !file.exists() && extension.is_empty() {
        let names: Vec<_> = builtin::SCENES.iter().map(|scene| scene.name).collect();
        let known = names.join(", ");
        return Err(FileError::new(file, Problem::NoSuchScene { known }));
    }
    let folder = Folder::of(file, options.allow_outside);
    let unframed = options.unframed;
    match extension.as_str() {
        "scn.ron" | "ron" => opened.notes = open_scene(world, file, folder, options)?,
        model if MODEL_EXTENSIONS.contains(&model) => {
            let model = read_model(file, &folder, &options.limits)?;
            opened.notes = open_model(world, model, file, folder, options.limits)?;
            if !unframed {
                frame(world, file, &mut opened.notes);
            }
        }
        _ => {
            return Err(FileError::new(
                file,
                Problem::UnknownExtension {
                    extension,
                    wanted: "scenes; .scn.ron, .obj, .gltf, .glb, .stl and .ply are",
                },
            ));
        }
    }
    Ok(opened)
}

fn open_builtin(world: &mut World, scene: &BuiltinScene, options: OpenOptions) -> Opened {
    let folder = Folder {
        path: PathBuf::new(),
        allow_outside: options.allow_outside,
    };
    clear(world, SceneFiles::new(folder, options.limits));
    (scene.spawn)(world);
    let entities = scene_entities(world);
    assign_ids(world, &entities);
    resolve(world);
    Opened {
        name: scene.name.to_owned(),
        notes: Notes::default(),
    }
}

fn open_scene(
    world: &mut World,
    file: &Path,
    folder: Folder,
    OpenOptions {
        limits, tolerant, ..
    }: OpenOptions,
) -> Result<Notes, FileError> {
    let scene = read_scene(world, file, &limits)?;
    let on_disk = scene.on_disk.clone();
    check_shapes(&scene, &limits.memory).map_err(|problem| FileError::new(file, problem))?;
    let mut loaded = Loaded::for_scene(&scene, &folder, &limits, tolerant)
        .map_err(|error| name_referrer(file, error))?;
    let notes = std::mem::take(&mut loaded.notes);
    let mut files = SceneFiles::new(folder, limits);
    files.on_disk = Some(on_disk);
    clear(world, files);
    let held = loaded.hand_over(world);
    let entities = scene
        .spawn(world)
        .map_err(|error| FileError::new(file, Problem::Malformed(error)))?;
    assign_ids(world, &entities);
    resolve(world);
    drop(held);
    Ok(notes)
}

fn open_model(
    world: &mut World,
    model: Model,
    file: &Path,
    folder: Folder,
    limits: Limits,
) -> Result<Notes, FileError> {
    let path = file.file_name().map_or_else(String::new, encoded);
    let mut model = model;
    let mut loaded = Loaded::of_model(&mut model, &path, &mut Loader::new(&folder, &limits))?;
    let picture_notes = std::mem::take(&mut loaded.notes);
    clear(world, SceneFiles::new(folder, limits));
    if let Some(environment) = model.environment.take() {
        world.insert_resource(environment);
    }
    let held = loaded.hand_over(world);
    let mut notes = std::mem::take(&mut model.notes);
    notes.append(picture_notes);
    let mut next = 0;
    spawn_model(world, model, &path, &mut || {
        next += 1;
        SceneId(next)
    });
    resolve(world);
    drop(held);
    Ok(notes)
}

/// Refuses shapes that are too many together before the first is made. Their numbers are checked one by one.
fn check_shapes(scene: &SceneFile, memory: &Budget) -> Result<(), Problem> {
    let mut seen = std::collections::HashSet::new();
    let mut bytes = 0_u64;
    for source in scene.mesh_sources() {
        if let MeshSource::Shape(shape) = source
            && seen.insert(super::sources::mesh_key(source))
            && let Ok(triangles) = shapes::triangle_count(shape)
        {
            bytes = bytes.saturating_add(mesh_bytes(triangles, triangles));
        }
    }
    memory.apart().claim(bytes)
}

/// Replaces the open scene by a new one: a floor, a cube on it, a lamp above and a camera that sees them.
pub fn open_new(world: &mut World) {
    let limits = world.get_resource::<SceneFiles>();
    let limits = limits.map(|files| files.limits.clone()).unwrap_or_default();
    clear(world, SceneFiles::new(Folder::default(), limits));
    builtin::new_scene(world);
    resolve(world);
}

/// A scene that points at a missing or forbidden file is at fault itself: say which scene it was.
fn name_referrer(file: &Path, error: FileError) -> FileError {
    let path = error.file.display().to_string();
    match error.problem {
        Problem::Outside => FileError::new(file, Problem::RefersOutside { path }),
        Problem::NotFound => FileError::new(file, Problem::MissingFile { path }),
        Problem::Shape(text) => FileError::new(file, Problem::Shape(text)),
        _ => error,
    }
}

/// Everything that a scene's sources name, loaded before the open scene is given up.
#[derive(Default)]
pub(super) struct Loaded {
    pub meshes: Vec<(MeshSource, Mesh)>,
    pub pictures: Vec<(TextureSource, PictureUse, Image)>,
    /// Every file that was read for it.
    read: BTreeSet<PathBuf>,
    /// What is wrong with some of it.
    pub notes: Notes,
}

/// Keeps assets alive until entities hold them.
pub(super) type Held = (Vec<Handle<Mesh>>, Vec<Handle<Image>>);

impl Loaded {
    /// Where that is `tolerant`, without what cannot be loaded.
    fn for_scene(
        scene: &SceneFile,
        folder: &Folder,
        limits: &Limits,
        tolerant: bool,
    ) -> Result<Self, FileError> {
        let fatal = |error: &FileError| !tolerant || matches!(error.problem, Problem::Outside);
        let mut loaded = Self::default();
        let mut loader = Loader::new(folder, limits);
        let mut seen = HashSet::new();
        for source in scene.mesh_sources() {
            if seen.insert(super::sources::mesh_key(source)) {
                match loader.mesh(source) {
                    Ok(mesh) => loaded.meshes.push((source.clone(), mesh)),
                    Err(error) if fatal(&error) => return Err(error),
                    Err(_) => {}
                }
            }
        }
        let materials = scene.materials().flat_map(pictures_of);
        let map = scene.environment().and_then(|e| e.map.as_ref());
        let map = map.map(|map| (map, PictureUse::Color));
        for (source, usage) in materials.chain(map) {
            match loaded.load_picture(source, usage, &mut loader) {
                Err(error) if fatal(&error) => return Err(error),
                _ => {}
            }
        }
        loaded.take_notes(&mut loader);
        loaded.read = loader.read;
        Ok(loaded)
    }

    /// A model's meshes, which are taken out of it, and the pictures of its materials. One that cannot be read is
    /// noted, and its material is left without.
    pub fn of_model(model: &mut Model, path: &str, loader: &mut Loader) -> Result<Self, FileError> {
        let mut loaded = Self::default();
        let mut failed = HashSet::new();
        for (_, phong) in &mut model.materials {
            for map in PhongMap::ALL {
                let usage = PictureUse::of(map);
                let Some(source) = map.source(phong) else {
                    continue;
                };
                // One that many materials name is tried once.
                let key = (source.path.clone(), usage);
                if !failed.contains(&key)
                    && let Err(error) = loaded.load_picture(source, usage, loader)
                {
                    if error.problem.is_of_memory() {
                        return Err(error);
                    }
                    let FileError {
                        file,
                        place,
                        problem,
                    } = error;
                    let instead = "its materials have no picture there";
                    model.notes.add(&file, place, problem.to_string(), instead);
                    failed.insert(key.clone());
                }
                if failed.contains(&key) {
                    *map.source_mut(phong) = None;
                    // What it scales goes with it, but for the body that has to be seen.
                    match map {
                        PhongMap::Specular => phong.specular = LinearRgba::BLACK,
                        PhongMap::Mirror => phong.mirror = LinearRgba::BLACK,
                        PhongMap::Emission => phong.emission = LinearRgba::BLACK,
                        PhongMap::Diffuse | PhongMap::Opacity | PhongMap::Normal => {}
                    }
                }
            }
        }
        loaded.take_notes(loader);
        for (name, mesh) in std::mem::take(&mut model.meshes) {
            let path = path.to_owned();
            loaded.meshes.push((MeshSource::File { path, name }, mesh));
        }
        loaded.read.clone_from(&loader.read);
        loaded.read.extend(model.files.iter().cloned());
        Ok(loaded)
    }

    /// A picture that is used in two ways is told of once.
    fn take_notes(&mut self, loader: &mut Loader) {
        let mut told = BTreeSet::new();
        for error in loader.notes.drain(..) {
            if told.insert(error.to_string()) {
                let instead = "what there is of it is shown";
                let FileError {
                    file,
                    place,
                    problem,
                } = &error;
                (self.notes).add(file, place.clone(), problem.to_string(), instead);
            }
        }
    }

    fn load_picture(
        &mut self,
        source: &TextureSource,
        usage: PictureUse,
        loader: &mut Loader,
    ) -> Result<(), FileError> {
        let mut known = self.pictures.iter();
        if !known.any(|(other, how, _)| other.path == source.path && *how == usage) {
            let picture = loader.picture(source, usage)?;
            self.pictures.push((source.clone(), usage, picture));
        }
        Ok(())
    }

    /// Leaves out what the open scene has loaded from the same sources already.
    pub fn forget_known(&mut self, world: &World) {
        let (Some(files), Some(meshes), Some(images)) = (
            world.get_resource::<SceneFiles>(),
            world.get_resource::<Assets<Mesh>>(),
            world.get_resource::<Assets<Image>>(),
        ) else {
            return;
        };
        self.meshes
            .retain(|(source, _)| files.loaded_mesh(source, meshes).is_none());
        self.pictures
            .retain(|(source, usage, _)| files.loaded_picture(source, *usage, images).is_none());
    }

    pub fn hand_over(self, world: &mut World) -> Held {
        world.resource_mut::<SceneFiles>().note_read(self.read);
        let meshes = world.resource_scope(|world, mut files: bevy::prelude::Mut<SceneFiles>| {
            let mut assets = world.resource_mut::<Assets<Mesh>>();
            let add = |(source, mesh)| {
                let handle = assets.add(mesh);
                files.adopt_mesh(&source, &handle);
                handle
            };
            self.meshes.into_iter().map(add).collect()
        });
        let pictures = world.resource_scope(|world, mut files: bevy::prelude::Mut<SceneFiles>| {
            let mut assets = world.resource_mut::<Assets<Image>>();
            let add = |(source, usage, image)| {
                let handle = assets.add(image);
                files.adopt_picture(&source, usage, &handle);
                handle
            };
            self.pictures.into_iter().map(add).collect()
        });
        (meshes, pictures)
    }
}

/// The pictures that a material names.
fn pictures_of(phong: &Phong) -> impl Iterator<Item = (&TextureSource, PictureUse)> {
    let maps = PhongMap::ALL.into_iter();
    maps.filter_map(|map| Some((map.source(phong)?, PictureUse::of(map))))
}

/// Removes the open scene; everything else in the world stays.
fn clear(world: &mut World, files: SceneFiles) {
    for entity in scene_entities(world) {
        // It may have gone with its parent.
        if let Ok(entity) = world.get_entity_mut(entity) {
            entity.despawn();
        }
    }
    world.insert_resource(Environment::default());
    world.insert_resource(RenderSettings::default());
    world.insert_resource(LoadProblems::default());
    world.insert_resource(files);
}

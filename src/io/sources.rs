//! From what files keep to what the rest reads: `MeshSource` to `Mesh3d`, the pictures of a `Phong`
//! to `PhongMaps`, `Environment::map` to `EnvironmentMap`.
//!
//! Two objects with the same source share one mesh. Where a source cannot be loaded, what was
//! loaded before stays, and [`LoadProblems`] says why.

use super::budget::held_bytes;
use super::error::FileError;
use super::folder::Folder;
use super::loader::Loader;
use super::on_disk::OnDisk;
use super::picture::PictureUse;
use super::{LoadProblem, LoadProblems};
use crate::io::Limits;
use crate::scene::{
    Environment, EnvironmentMap, MeshSource, Phong, PhongMap, PhongMaps, TextureSource,
};
use bevy::asset::{AssetId, Assets, Handle};
use bevy::image::Image;
use bevy::mesh::{Mesh, Mesh3d};
use bevy::prelude::{
    Changed, Commands, DetectChanges, Entity, Local, Query, Res, ResMut, Resource,
};
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

/// Where the open scene's paths start from, and what was loaded from them.
///
/// It holds no asset alive: what no entity uses any more is dropped, and loaded again when needed.
#[derive(Resource, Default)]
pub struct SceneFiles {
    /// The open scene's folder.
    pub folder: Folder,
    /// How much its files may ask for.
    pub limits: Limits,
    meshes: HashMap<String, AssetId<Mesh>>,
    pictures: HashMap<(String, PictureUse), AssetId<Image>>,
    /// The scene file, as it was read or written last; none of a model or a built-in scene.
    pub(super) on_disk: Option<OnDisk>,
    /// Every file that was read for the scene but its own. What an edit does not use any more stays: undoing
    /// brings it back.
    read: BTreeSet<PathBuf>,
}

impl SceneFiles {
    /// For a scene in another folder: nothing is loaded yet.
    pub(crate) fn new(folder: Folder, limits: Limits) -> Self {
        Self {
            folder,
            limits,
            ..Self::default()
        }
    }

    /// Takes note of files that were read for the scene.
    pub(super) fn note_read(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        self.read.extend(files);
    }

    /// What the scene's own file said when it was read or written last.
    #[cfg(feature = "editor")]
    pub(crate) fn on_disk(&self) -> Option<&OnDisk> {
        self.on_disk.as_ref()
    }

    /// Says that the scene is that of another file than it was read from: of the one that its copy was made of.
    #[cfg(feature = "editor")]
    pub(crate) fn set_on_disk(&mut self, on_disk: Option<OnDisk>) {
        self.on_disk = on_disk;
    }

    /// Models, what they bring along, and pictures that were read for the scene: what writing it must not
    /// replace.
    pub fn sources(&self) -> impl Iterator<Item = &Path> {
        self.read.iter().map(PathBuf::as_path)
    }

    /// The scene's own file, and all that it was read from: what nothing else may be written over.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        let scene = self.on_disk.iter().map(OnDisk::file);
        scene.chain(self.sources())
    }

    /// The limits for what is loaded beside these assets.
    fn limits_beside(&self, meshes: &Assets<Mesh>, images: &Assets<Image>) -> Limits {
        Limits {
            memory: self.limits.memory.holding(held_bytes(meshes, images)),
            ..self.limits.clone()
        }
    }

    /// Takes over a mesh that was loaded already. The handle must live until an entity holds it.
    pub(crate) fn adopt_mesh(&mut self, source: &MeshSource, handle: &Handle<Mesh>) {
        self.meshes.insert(mesh_key(source), handle.id());
    }

    /// The same for a picture.
    pub(crate) fn adopt_picture(
        &mut self,
        source: &TextureSource,
        usage: PictureUse,
        handle: &Handle<Image>,
    ) {
        self.pictures
            .insert((source.path.clone(), usage), handle.id());
    }

    /// The mesh of this source, where one is in use.
    pub(crate) fn loaded_mesh(
        &self,
        source: &MeshSource,
        assets: &Assets<Mesh>,
    ) -> Option<AssetId<Mesh>> {
        let id = self.meshes.get(&mesh_key(source)).copied();
        id.filter(|&id| assets.contains(id))
    }

    /// The same for a picture.
    pub(crate) fn loaded_picture(
        &self,
        source: &TextureSource,
        usage: PictureUse,
        assets: &Assets<Image>,
    ) -> Option<AssetId<Image>> {
        let id = self.pictures.get(&(source.path.clone(), usage)).copied();
        id.filter(|&id| assets.contains(id))
    }

    fn mesh(
        &mut self,
        source: &MeshSource,
        assets: &mut Assets<Mesh>,
        load: impl FnOnce() -> Result<Mesh, FileError>,
    ) -> Result<Handle<Mesh>, FileError> {
        let key = mesh_key(source);
        let known = self.meshes.get(&key).copied();
        if let Some(handle) = known.and_then(|id| assets.get_strong_handle(id)) {
            return Ok(handle);
        }
        let handle = assets.add(load()?);
        self.meshes.insert(key, handle.id());
        Ok(handle)
    }

    fn picture(
        &mut self,
        source: &TextureSource,
        usage: PictureUse,
        assets: &mut Assets<Image>,
        loader: &mut Loader,
    ) -> Result<Handle<Image>, FileError> {
        let key = (source.path.clone(), usage);
        let known = self.pictures.get(&key).copied();
        if let Some(handle) = known.and_then(|id| assets.get_strong_handle(id)) {
            return Ok(handle);
        }
        let handle = assets.add(loader.picture(source, usage)?);
        self.pictures.insert(key, handle.id());
        Ok(handle)
    }
}

/// A source as a key. `Debug` prints floating point numbers so that they read back the same.
pub(crate) fn mesh_key(source: &MeshSource) -> String {
    match source {
        // Neither a path nor a shape's numbers have zeros in them.
        MeshSource::File { path, name } => [path, "\0", name].concat(),
        MeshSource::Shape(shape) => format!("{shape:?}"),
    }
}

/// Gives each object whose source changed the mesh that it names.
pub(crate) fn resolve_meshes(
    mut commands: Commands,
    mut files: ResMut<SceneFiles>,
    mut meshes: ResMut<Assets<Mesh>>,
    images: Res<Assets<Image>>,
    mut problems: ResMut<LoadProblems>,
    changed: Query<(Entity, &MeshSource, Option<&Mesh3d>), Changed<MeshSource>>,
) {
    if changed.is_empty() {
        return;
    }
    let (folder, limits) = (files.folder.clone(), files.limits_beside(&meshes, &images));
    // One for all, so that a file with many meshes is parsed once.
    let mut loader = Loader::new(&folder, &limits);
    for (entity, source, current) in &changed {
        problems.forget(entity, LoadProblem::MESH);
        match files.mesh(source, &mut meshes, || loader.mesh(source)) {
            Ok(handle) if current.is_some_and(|mesh| mesh.0 == handle) => {}
            Ok(handle) => {
                commands.entity(entity).insert(Mesh3d(handle));
            }
            Err(error) => problems.add(Some(entity), LoadProblem::MESH, error),
        }
    }
    files.note_read(loader.read);
}

/// Gives each material whose pictures changed their handles.
pub(crate) fn resolve_pictures(
    mut commands: Commands,
    mut files: ResMut<SceneFiles>,
    mut images: ResMut<Assets<Image>>,
    meshes: Res<Assets<Mesh>>,
    mut problems: ResMut<LoadProblems>,
    changed: Query<(Entity, &Phong, Option<&PhongMaps>), Changed<Phong>>,
) {
    if changed.is_empty() {
        return;
    }
    let (folder, limits) = (files.folder.clone(), files.limits_beside(&meshes, &images));
    // One for all, so that a file with many pictures is parsed once.
    let mut loader = Loader::new(&folder, &limits);
    for (entity, phong, current) in &changed {
        let before = current.cloned().unwrap_or_default();
        problems.forget(entity, LoadProblem::PICTURE);
        let mut load = |source: Option<&TextureSource>, usage, before: Option<Handle<Image>>| {
            let Some(source) = source else {
                // What no source has named is an app's own, and stays.
                return before
                    .filter(|picture| !files.pictures.values().any(|id| *id == picture.id()));
            };
            match files.picture(source, usage, &mut images, &mut loader) {
                Ok(handle) => Some(handle),
                Err(error) => {
                    problems.add(Some(entity), LoadProblem::PICTURE, error);
                    before
                }
            }
        };
        let mut maps = PhongMaps::default();
        for map in PhongMap::ALL {
            let before = map.loaded(&before).cloned();
            *map.loaded_mut(&mut maps) = load(map.source(phong), PictureUse::of(map), before);
        }
        if maps == before && (current.is_some() || maps == PhongMaps::default()) {
            continue;
        }
        commands.entity(entity).insert(maps);
    }
    files.note_read(loader.read);
    for note in loader.notes {
        problems.add(None, LoadProblem::PICTURE, note);
    }
}

/// Loads the environment's map where it changed. One that no source has named is the app's own, and stays.
pub(crate) fn resolve_environment(
    environment: Res<Environment>,
    mut files: ResMut<SceneFiles>,
    mut images: ResMut<Assets<Image>>,
    meshes: Res<Assets<Mesh>>,
    mut problems: ResMut<LoadProblems>,
    mut named: Local<Option<Handle<Image>>>,
    mut map: ResMut<EnvironmentMap>,
) {
    if !environment.is_changed() {
        return;
    }
    problems.forget_environment();
    let handle = match &environment.map {
        None if map.0 != *named => {
            *named = None;
            return;
        }
        None => None,
        Some(source) => {
            let (folder, limits) = (files.folder.clone(), files.limits_beside(&meshes, &images));
            let mut loader = Loader::new(&folder, &limits);
            let picture = files.picture(source, PictureUse::Color, &mut images, &mut loader);
            files.note_read(loader.read);
            for note in loader.notes {
                problems.add(None, LoadProblem::ENVIRONMENT, note);
            }
            match picture {
                Ok(handle) => Some(handle),
                Err(error) => {
                    problems.add(None, LoadProblem::ENVIRONMENT, error);
                    return;
                }
            }
        }
    };
    named.clone_from(&handle);
    if map.0 != handle {
        map.0 = handle;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::headless_app;

    #[test]
    fn a_picture_that_no_source_has_named_stays_and_one_that_was_goes_with_it() {
        let mut app = headless_app();
        let own = app
            .world_mut()
            .resource_mut::<Assets<Image>>()
            .add(Image::default());
        let maps = PhongMaps {
            diffuse: Some(own.clone()),
            ..PhongMaps::default()
        };
        let entity = app.world_mut().spawn((Phong::default(), maps)).id();
        app.update();
        let diffuse = |app: &bevy::app::App| {
            let maps = app.world().get::<PhongMaps>(entity).cloned();
            maps.unwrap_or_default().diffuse
        };
        assert_eq!(diffuse(&app), Some(own.clone()), "an app's own picture");
        let source = Some(TextureSource::new("builtin:uv"));
        app.world_mut()
            .get_mut::<Phong>(entity)
            .unwrap()
            .diffuse_map = source;
        app.update();
        let named = diffuse(&app);
        assert!(named.is_some() && named != Some(own));
        app.world_mut()
            .get_mut::<Phong>(entity)
            .unwrap()
            .diffuse_map = None;
        app.update();
        assert_eq!(diffuse(&app), None);
    }

    #[test]
    fn a_panorama_of_the_apps_own_stays_while_the_environment_is_edited() {
        let mut app = headless_app();
        let world = app.world_mut();
        let own = world.resource_mut::<Assets<Image>>().add(Image::default());
        world.insert_resource(EnvironmentMap(Some(own.clone())));
        let edit = |app: &mut bevy::app::App, source: Option<&str>| {
            let mut environment = app.world_mut().resource_mut::<Environment>();
            environment.intensity += 1.0;
            environment.map = source.map(TextureSource::new);
            app.update();
            app.world().resource::<EnvironmentMap>().0.clone()
        };
        assert_eq!(edit(&mut app, None), Some(own.clone()));
        let named = edit(&mut app, Some("builtin:uv"));
        assert!(named.is_some() && named != Some(own));
        assert_eq!(edit(&mut app, None), None);
    }
}

use bevy::app::App;
use bevy::asset::{AssetPlugin, Assets};
use bevy::mesh::{Indices, Mesh, Mesh3d, VertexAttributeValues};
use bevy::prelude::{Entity, World};
use glassbox::io::{IoPlugin, OpenOptions, Opened, SceneSource, open};
use glassbox::scene::ScenePlugin;
use std::fs;
use std::path::{Path, PathBuf};

/// What files need: the components, assets, and the room's own plugin.
pub fn app() -> App {
    let mut app = App::new();
    app.add_plugins((
        bevy::app::TaskPoolPlugin::default(),
        AssetPlugin::default(),
        ScenePlugin,
        IoPlugin,
    ));
    app
}

/// Opens a file in a new world.
pub fn opened(file: &Path) -> (App, Opened) {
    let mut app = app();
    let source = SceneSource::File(file.to_path_buf());
    let opened = open(app.world_mut(), &source, OpenOptions::default());
    let opened = opened.unwrap_or_else(|error| panic!("{error}"));
    (app, opened)
}

/// Writes a file into a folder.
pub fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(&path, content).unwrap();
    path
}

/// An entity's triangles, in its own space.
pub fn triangles(world: &World, entity: Entity) -> Vec<[[f32; 3]; 3]> {
    let handle = world
        .get::<Mesh3d>(entity)
        .expect("an entity without a mesh");
    let meshes = world.resource::<Assets<Mesh>>();
    let mesh = meshes.get(&handle.0).expect("a handle without a mesh");
    let Some(VertexAttributeValues::Float32x3(positions)) =
        mesh.attribute(Mesh::ATTRIBUTE_POSITION)
    else {
        panic!("no positions");
    };
    let Some(Indices::U32(indices)) = mesh.indices() else {
        panic!("no 32-bit indices");
    };
    let corners = indices.as_chunks::<3>().0.iter();
    corners.map(|c| c.map(|i| positions[i as usize])).collect()
}

use super::error::{FileError, Problem};
use super::gltf;
use super::{extension, obj, scene_file};
use bevy::prelude::World;
use std::path::Path;

/// Writes the open scene as `.scn.ron`, `.obj` (with its `.mtl`) or `.glb`; the extension decides.
/// Returns a line for each thing that the format cannot say. The file appears complete or not at
/// all. Entities without a `SceneId` get one.
pub fn save(world: &mut World, file: &Path) -> Result<Vec<String>, FileError> {
    let extension = extension(file);
    match extension.as_str() {
        "scn.ron" => scene_file::write_scene(world, file),
        "obj" => obj::write_obj(world, file),
        "glb" => gltf::write_glb(world, file),
        _ => Err(FileError::new(
            file,
            Problem::UnknownExtension {
                extension,
                wanted: "scenes that are written; .scn.ron, .obj and .glb are",
            },
        )),
    }
}

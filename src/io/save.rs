use super::error::{FileError, Problem};
use super::gltf;
use super::{check_writable, extension, obj, scene_file};
use bevy::prelude::World;
use std::path::Path;

/// Refuses a scene file that could not be written, before anything is read or made for it: by its
/// extension and its place.
pub fn check_save(file: &Path) -> Result<(), FileError> {
    match extension(file).as_str() {
        "scn.ron" | "obj" | "glb" => check_writable(file),
        _ => Err(unknown(file)),
    }
}

fn unknown(file: &Path) -> FileError {
    FileError::new(
        file,
        Problem::UnknownExtension {
            extension: extension(file),
            wanted: "scenes that are written; .scn.ron, .obj and .glb are",
        },
    )
}

/// Writes the open scene as `.scn.ron`, `.obj` (with its `.mtl`) or `.glb`; the extension decides.
/// Returns a line for each thing that the format cannot say. The file appears complete or not at
/// all. Entities without a `SceneId` get one.
pub fn save(world: &mut World, file: &Path) -> Result<Vec<String>, FileError> {
    match extension(file).as_str() {
        "scn.ron" => scene_file::write_scene(world, file),
        "obj" => obj::write_obj(world, file),
        "glb" => gltf::write_glb(world, file),
        _ => Err(unknown(file)),
    }
}

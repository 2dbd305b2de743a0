use super::error::{FileError, Problem};
use super::notes::Notes;
use super::sources::SceneFiles;
use super::{check_outputs, check_writable, extension, gltf, obj, scene_file};
use bevy::prelude::World;
use std::path::Path;

/// Refuses a file that the open scene was read from, as what is written to beside it: a picture, a table.
#[cfg(feature = "editor")]
pub(crate) fn check_not_read(world: &World, file: &Path) -> Result<(), FileError> {
    match world.get_resource::<SceneFiles>() {
        Some(files) => check_outputs([file], files.inputs()),
        None => Ok(()),
    }
}

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
/// Returns what the format cannot say. The file appears complete or not at
/// all, and so does an OBJ with all that it names. Entities without a `SceneId` get one.
///
/// Nothing that the scene was read from is written over; a scene file may be replaced by the scene itself.
pub fn save(world: &mut World, file: &Path) -> Result<Notes, FileError> {
    let extension = extension(file);
    let is_scene = extension == "scn.ron";
    let mtl = (extension == "obj").then(|| obj::mtl_of(file));
    if let Some(files) = world.get_resource::<SceneFiles>() {
        let outputs = mtl.as_deref().into_iter().chain([file]);
        match is_scene {
            true => check_outputs(outputs, files.sources())?,
            false => check_outputs(outputs, files.inputs())?,
        }
    }
    match extension.as_str() {
        "scn.ron" => scene_file::write_scene(world, file),
        "obj" => obj::write_obj(world, file),
        "glb" => gltf::write_glb(world, file),
        _ => Err(unknown(file)),
    }
}

//! Files: scenes in and out, models, pictures, and what Glassbox generates itself.
//!
//! [`open`] replaces the open scene by a file's or a built-in one, [`save`] writes it. Between the
//! two the systems of [`IoPlugin`] keep handles in step with sources. Everything that can fail ends
//! in a [`FileError`], one line that names the file, the place in it and what would help. What can be shown is shown
//! all the same: what is left out or replaced then is told in [`Notes`], and never passed over in silence.
//!
//! | file | in | out |
//! |---|---|---|
//! | `.scn.ron` | everything | everything |
//! | `.obj` with `.mtl` | meshes, materials, pictures, colours of vertices | the same, in the world's space |
//! | `.glb`, `.gltf` | meshes, hierarchy, materials, pictures, lights, cameras | `.glb`, the same |
//! | `.stl`, ASCII or binary | facets, their colours | – |
//! | `.ply`, ASCII or binary | polygons, strips, normals, colours, a picture | – |
//! | `.exr` of [`write_part`] | exact sums of some samples | the same |
//! | `.png`, `.jpg`, `.exr`, `.hdr` | pictures, by their content | pictures |
//! | WebP, TGA, BMP, DDS, GIF's first frame | pictures, by their content | – |
//!
//! Texture coordinates count from a picture's top left corner, v downwards, as Bevy and glTF do;
//! OBJ, which counts from the bottom, is turned over on the way in and out.

mod budget;
pub mod builtin;
mod error;
mod exported;
mod far_off;
pub(crate) mod file_name;
mod folder;
mod frame;
mod gltf;
mod identity;
mod ids;
mod import;
mod limits;
mod loader;
mod model;
mod names;
mod notes;
mod obj;
mod on_disk;
mod open;
mod part;
mod picture;
pub(crate) mod place;
mod ply;
mod polygon;
mod problems;
mod regular;
#[cfg(feature = "editor")]
mod reload;
mod replace;
mod resolve;
mod save;
mod scene_file;
pub mod shapes;
mod sources;
mod spawn;
mod stl;
mod text;
mod vertex_values;

#[cfg(feature = "editor")]
pub(crate) use budget::beside;
pub(crate) use budget::film_bytes;
pub use budget::{Budget, Size, check_film, check_film_of_lights};
pub use error::{FileError, Place, Problem};
pub use folder::Folder;
pub use identity::check_outputs;
pub use import::{Imported, import};
pub use limits::Limits;
pub(crate) use loader::MODEL_EXTENSIONS;
pub use notes::{FileNote, Notes};
#[cfg(feature = "editor")]
pub(crate) use on_disk::{OnDisk, has_changed};
pub use open::{OpenOptions, Opened, SceneSource, open, open_new};
pub use part::{Merge, MergeError, Part, part_bytes, read_part, write_part};
pub(crate) use picture::stage_picture;
pub use picture::{
    LightLayers, Note, PICTURE_EXTENSIONS, PictureFormat, check_picture, check_room, check_size,
    layer_name, picture_notes, write_lights, write_picture, write_picture_with_notes,
    write_rendered,
};
pub use problems::{LoadProblem, LoadProblems};
pub(crate) use regular::{TEXT_BYTES, open_regular, read_text};
use regular::{open_to_read, read_bytes, read_bytes_unless};
#[cfg(feature = "editor")]
pub(crate) use reload::{Reloaded, SourceFile, source_files};
pub use replace::check_writable;
pub(crate) use replace::{Staged, replace_file};
#[cfg(feature = "editor")]
pub(crate) use save::check_not_read;
pub use save::{check_save, save};
pub use scene_file::KeepInSceneFiles;
#[cfg(feature = "editor")]
pub(crate) use scene_file::{
    AnyKeptChanged, KeptComponents, KeptTypes, Rebase, SceneContent, keeps, kept_components,
    read_scene_text,
};
pub use sources::SceneFiles;

use crate::scene::EnvironmentMap;
use bevy::app::{App, Plugin, PostUpdate};
use bevy::asset::{AssetApp, AssetEventSystems, Assets};
use bevy::camera::visibility::VisibilitySystems;
use bevy::image::Image;
use bevy::mesh::Mesh;
use bevy::prelude::IntoScheduleConfigs;
use bevy::transform::TransformSystems;
use std::path::Path;

/// Resolves sources into handles. Needs Bevy's `AssetPlugin`, and no renderer.
pub struct IoPlugin;

impl Plugin for IoPlugin {
    fn build(&self, app: &mut App) {
        // Bevy's renderer has its own already, with what it has put into them.
        if !app.world().contains_resource::<Assets<Mesh>>() {
            app.init_asset::<Mesh>();
        }
        if !app.world().contains_resource::<Assets<Image>>() {
            app.init_asset::<Image>();
        }
        app.init_resource::<SceneFiles>()
            .init_resource::<LoadProblems>()
            .init_resource::<EnvironmentMap>()
            .add_systems(
                PostUpdate,
                (
                    sources::resolve_meshes,
                    sources::resolve_pictures,
                    sources::resolve_environment,
                )
                    .chain()
                    // What was added in this frame is drawn and traced in it.
                    .before(AssetEventSystems)
                    .before(TransformSystems::Propagate)
                    .before(VisibilitySystems::CalculateBounds)
                    .before(VisibilitySystems::VisibilityPropagate),
            );
    }
}

/// A file's extension in lower case; `scn.ron` is one.
pub(crate) fn extension(path: &Path) -> String {
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().to_lowercase());
    let name = name.unwrap_or_default();
    if name.ends_with(".scn.ron") {
        return "scn.ron".to_owned();
    }
    name.rsplit_once('.')
        .map_or_else(String::new, |(_, extension)| extension.to_owned())
}

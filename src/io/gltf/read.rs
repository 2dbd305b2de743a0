use super::super::error::{FileError, Problem};
use super::super::folder::Folder;
use super::super::model::Model;
use super::super::picture::{
    MeasuredPictures, PictureUse, ReadPicture, decode_picture, read_picture,
};
use super::document::{Document, Picture};
use super::environment::environment_of;
use super::json::Json;
use super::material::phong_of;
use super::nodes::read_nodes;
use crate::io::Limits;
use bevy::image::Image;
use std::path::Path;

/// Reads a glTF or GLB file: the default scene, or the first, or all nodes where there is none. What no node of it
/// refers to is not looked at, materials apart.
///
/// Meshes are called `Mesh0/Primitive0`, by their indices, because names need not be unique; one that a skin deforms
/// `…/Skin0`, one with morph weights of a node's own `…/Node0`. The texture coordinates are those of the base colour's
/// picture, with its transform applied.
pub(crate) fn read_gltf(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let document = Document::read(file, folder, limits)?;
    let mut model = Model {
        files: document.files(),
        environment: environment_of(document.json()),
        ..Model::default()
    };
    let used = used_materials(&document);
    let mut measured = MeasuredPictures::of(limits);
    for (index, material) in document.json().list("materials").enumerate() {
        let name = material.text("name").map(str::to_owned);
        let name = name.unwrap_or_else(|| format!("material {index}"));
        let phong = match used.get(index) {
            Some(true) => phong_of(&document, &mut measured, index, material.mark(), &name)?,
            // Its pictures may be missing, and nobody would miss them.
            _ => crate::scene::Phong::default(),
        };
        model.materials.push((name, phong));
    }
    let fault = read_nodes(&document, &mut model)?;
    if model.meshes.is_empty() {
        let nothing = || FileError::new(file, Problem::NoTriangles);
        return Err(fault.unwrap_or_else(nothing));
    }
    document.note_unread();
    model.notes = document.notes.into_inner();
    Ok(model)
}

/// Which materials any primitive of the file names.
fn used_materials(document: &Document) -> Vec<bool> {
    let json = document.json();
    let mut used = vec![false; json.list("materials").len()];
    for mesh in json.list("meshes") {
        for material in mesh.list("primitives").filter_map(|p| p.index("material")) {
            if let Some(used) = used.get_mut(material) {
                *used = true;
            }
        }
    }
    used
}

/// Reads a picture of a file: `part` is `texture` and the index of a texture. What is wrong with one that can be shown
/// goes to the notes.
pub(crate) fn read_texture(
    document: &Document,
    part: &str,
    usage: PictureUse,
    notes: &mut Vec<FileError>,
) -> Result<Image, FileError> {
    let file = &document.file;
    let count = document.json().list("textures").len();
    let index = part.strip_prefix("texture").and_then(|n| n.parse().ok());
    let Some(index) = index.filter(|&index: &usize| index < count) else {
        let name = part.to_owned();
        return Err(FileError::new(file, Problem::NoSuchTexture { name, count }));
    };
    let ReadPicture { image, doubt } = decode_texture(document, index, usage, &document.limits)?;
    notes.extend(doubt);
    Ok(image)
}

/// Decodes the picture of a texture by its index.
pub(super) fn decode_texture(
    document: &Document,
    texture: usize,
    usage: PictureUse,
    limits: &Limits,
) -> Result<ReadPicture, FileError> {
    match document.texture(texture)? {
        Picture::Beside(path) => {
            let path = document.folder.resolve(&path)?;
            read_picture(&path, usage, limits)
        }
        Picture::Inside(bytes) => {
            let name = format!("{}#texture{texture}", document.file.display());
            decode_picture(Path::new(&name), &bytes, usage, limits)
        }
    }
}

/// A name that the file gives, or what stands for it.
pub(super) fn name_of(json: Json, kind: &str, index: usize) -> String {
    let name = json.text("name").map(str::to_owned);
    name.unwrap_or_else(|| format!("{kind} {index}"))
}

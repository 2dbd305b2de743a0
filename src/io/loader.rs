use super::budget::mesh_bytes;
use super::error::{FileError, Place, Problem};
use super::file_name::{BUILTIN, split_fragment};
use super::folder::Folder;
use super::model::{Model, drop_unused};
use super::picture::{PictureUse, ReadPicture, read_picture};
use super::{Limits, extension, gltf, obj, open_regular, ply, shapes, stl};
use crate::scene::{MeshSource, TextureSource};
use bevy::image::Image;
use bevy::mesh::Mesh;
use std::collections::hash_map::Entry;
use std::collections::{BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Loads what sources name, and parses each model file once however many of its meshes are asked
/// for, and once more for its pictures. Lives as long as one pass over the changed sources.
pub(crate) struct Loader<'a> {
    folder: &'a Folder,
    limits: &'a Limits,
    models: HashMap<String, Model>,
    /// Those that hold pictures.
    documents: HashMap<PathBuf, gltf::Document>,
    /// Every file that was read.
    pub read: BTreeSet<PathBuf>,
    /// What is wrong with pictures that were loaded all the same.
    pub notes: Vec<FileError>,
}

impl<'a> Loader<'a> {
    pub fn new(folder: &'a Folder, limits: &'a Limits) -> Self {
        Self {
            folder,
            limits,
            models: HashMap::new(),
            documents: HashMap::new(),
            read: BTreeSet::new(),
            notes: Vec::new(),
        }
    }

    /// The mesh that a source names. A mesh of a file is handed out once.
    pub fn mesh(&mut self, source: &MeshSource) -> Result<Mesh, FileError> {
        let (path, name) = match source {
            MeshSource::Shape(shape) => {
                let count = shapes::triangle_count(shape).map_err(shape_error)?;
                // No shape has more vertices than triangles, but for the smallest.
                (self.limits.memory)
                    .claim(mesh_bytes(count, count))
                    .map_err(|problem| FileError::new("shape", problem))?;
                return shapes::mesh(shape).map_err(shape_error);
            }
            MeshSource::File { path, name } => (path, name),
        };
        let model = match self.models.entry(path.clone()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(free) => {
                let file = self.folder.resolve(path)?;
                let folder = Folder::of(&file, self.folder.allow_outside);
                let model = read_model(&file, &folder, self.limits)?;
                self.read.extend(model.files.iter().cloned());
                free.insert(model)
            }
        };
        let key = match model.meshes.keys().next() {
            Some(only) if name.is_empty() && model.meshes.len() == 1 => only.clone(),
            _ => name.clone(),
        };
        model.meshes.remove(&key).ok_or_else(|| {
            let mut known: Vec<_> = model.meshes.keys().take(8).cloned().collect();
            if model.meshes.len() > known.len() {
                known.push(format!("{} more", model.meshes.len() - known.len()));
            }
            let known = known.join(", ");
            FileError::new(
                path,
                Problem::NoSuchMesh {
                    name: name.clone(),
                    known,
                },
            )
        })
    }

    /// The picture that a source names.
    pub fn picture(
        &mut self,
        source: &TextureSource,
        usage: PictureUse,
    ) -> Result<Image, FileError> {
        let path = &source.path;
        if path.starts_with(BUILTIN) {
            return shapes::texture(path)
                .map_err(|error| FileError::new(path, Problem::Builtin(error.to_string())));
        }
        let (name, fragment) = split_fragment(path);
        let file = self.folder.resolve(name)?;
        let (part, usage) = match fragment.strip_suffix("alpha") {
            Some(part) => (part.trim_end_matches('.'), PictureUse::Alpha),
            None => (fragment, usage),
        };
        if part.is_empty() {
            let ReadPicture { image, doubt } = read_picture(&file, usage, self.limits)?;
            self.notes.extend(doubt);
            self.read.insert(file);
            return Ok(image);
        }
        let document = match self.documents.entry(file) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(free) => {
                let folder = Folder::of(free.key(), self.folder.allow_outside);
                let document = gltf::Document::read(free.key(), &folder, self.limits)?;
                self.read.extend(document.files());
                free.insert(document)
            }
        };
        gltf::read_texture(document, part, usage, &mut self.notes)
    }
}

fn shape_error(error: shapes::ShapeError) -> FileError {
    FileError::new("shape", Problem::Shape(error.to_string()))
}

/// How the files end that hold models, and not scenes.
pub(crate) const MODEL_EXTENSIONS: [&str; 5] = ["obj", "gltf", "glb", "stl", "ply"];

/// Reads a model file of any kind, by its extension, unless it begins like one of another kind.
pub(crate) fn read_model(
    file: &Path,
    folder: &Folder,
    limits: &Limits,
) -> Result<Model, FileError> {
    let extension = extension(file);
    let held = held_kind(file, &extension);
    let mut model = match held.unwrap_or(&extension) {
        "obj" => obj::read_obj(file, folder, limits),
        "gltf" | "glb" => gltf::read_gltf(file, folder, limits),
        "stl" => stl::read_stl(file, limits),
        "ply" => ply::read_ply(file, folder, limits),
        _ => {
            let wanted = "models; .obj, .gltf, .glb, .stl and .ply are";
            let problem = Problem::UnknownExtension { extension, wanted };
            return Err(FileError::new(file, problem));
        }
    }?;
    if let Some(kind) = held {
        let what = format!("a name that ends in .{extension}, and the content of a .{kind}");
        (model.notes).add(file, Place::Whole, what, "read as what it holds");
    }
    model.meshes.values_mut().for_each(drop_unused);
    Ok(model)
}

/// The kind of a model whose name says another, by how it begins; `None` where it does not say.
fn held_kind(file: &Path, extension: &str) -> Option<&'static str> {
    const KINDS: [(&[u8], &str, &[&str]); 5] = [
        // What files begin with that are no text may be anything.
        (b"glTF\x02\0\0\0", "glb", &["obj", "stl", "ply"]),
        (b"ply\n", "ply", &["obj", "gltf", "glb", "stl"]),
        (b"ply\r", "ply", &["obj", "gltf", "glb", "stl"]),
        (b"solid ", "stl", &["obj", "gltf", "glb", "ply"]),
        (b"{", "gltf", &["obj", "ply"]),
    ];
    let mut start = [0; 8];
    let mut reader = open_regular(file).ok()?;
    let length = reader.read(&mut start).ok()?;
    let begins = |kind: &&(&[u8], _, &[&str])| {
        kind.2.contains(&extension) && start[..length].starts_with(kind.0)
    };
    KINDS.iter().find(begins).map(|&(_, kind, _)| kind)
}

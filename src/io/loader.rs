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
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Loads what sources name, and parses each model file once however many of its meshes are asked
/// for, and once more for its pictures. Lives as long as one pass over the changed sources.
pub(crate) struct Loader<'a> {
    folder: &'a Folder,
    limits: &'a Limits,
    /// The meshes of models by their names; those that were handed out are gone.
    models: HashMap<String, BTreeMap<String, Option<Mesh>>>,
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

    /// The mesh that a source names. A file is read again for a mesh that was handed out, as that of a file with one is
    /// where sources name it both by its name and as the only one.
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
        let meshes = match self.models.entry(path.clone()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(free) => {
                let file = self.folder.resolve(path)?;
                let folder = Folder::of(&file, self.folder.allow_outside);
                let model = read_model(&file, &folder, self.limits)?;
                self.read.extend(model.files);
                let meshes = model.meshes.into_iter();
                free.insert(meshes.map(|(name, mesh)| (name, Some(mesh))).collect())
            }
        };
        let is_only = name.is_empty() && meshes.len() == 1;
        let named = match is_only {
            true => meshes.values_mut().next(),
            false => meshes.get_mut(name),
        };
        match named.map(Option::take) {
            Some(Some(mesh)) => Ok(mesh),
            Some(None) => {
                self.models.remove(path);
                self.mesh(source)
            }
            None => {
                let known = listed(meshes.keys());
                let name = name.clone();
                Err(FileError::new(path, Problem::NoSuchMesh { name, known }))
            }
        }
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

/// Names for a message: the first, and how many more there are.
fn listed<'a>(names: impl ExactSizeIterator<Item = &'a String>) -> String {
    const SHOWN: usize = 8;
    let more = names.len().saturating_sub(SHOWN);
    let mut shown: Vec<String> = names.take(SHOWN).cloned().collect();
    if more > 0 {
        shown.push(format!("{more} more"));
    }
    shown.join(", ")
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn named(path: &str, name: &str) -> MeshSource {
        MeshSource::File {
            path: path.to_owned(),
            name: name.to_owned(),
        }
    }

    #[test]
    fn the_only_mesh_is_that_of_a_file_with_one_and_not_the_last_that_is_left() {
        let folder = tempfile::tempdir().unwrap();
        let two = "v 0 0 0\nv 1 0 0\nv 0 1 0\no A\nf 1 2 3\no B\nf 1 2 3\n";
        fs::write(folder.path().join("two.obj"), two).unwrap();
        let one = two.split("o B").next().unwrap();
        fs::write(folder.path().join("one.obj"), one).unwrap();
        let folder = Folder {
            path: folder.path().into(),
            allow_outside: false,
        };
        let limits = Limits::default();
        let mut loader = Loader::new(&folder, &limits);
        assert!(loader.mesh(&named("two.obj", "A")).is_ok());
        let error = loader.mesh(&named("two.obj", "")).unwrap_err().to_string();
        assert!(error.ends_with("no mesh named ``; it has A, B"), "{error}");
        assert!(loader.mesh(&named("two.obj", "B")).is_ok());
        for names in [["A", ""], ["", "A"]] {
            let mut loader = Loader::new(&folder, &limits);
            let [first, second] = names.map(|name| {
                let mesh = loader.mesh(&named("one.obj", name));
                mesh.unwrap_or_else(|error| panic!("{names:?}: {error}"))
                    .count_vertices()
            });
            assert_eq!((first, second), (3, 3));
        }
    }
}

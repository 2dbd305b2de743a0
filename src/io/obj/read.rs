use super::super::error::{FileError, Place, Problem};
use super::super::folder::Folder;
use super::super::model::{Model, Node, triangle_mesh};
use super::blame::first_fault;
use super::lines::{Lines, Seen};
use super::mtl::{phong_of, read_mtl};
use crate::io::Limits;
use bevy::mesh::Mesh;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Reads an OBJ: one object for each `o` or `g` and material in it. The mesh is called like the
/// object where that has one material, `object/material` where it has several.
///
/// Faces with more than three corners become fans. Normals are kept as the file gives them; where
/// a part has none, or not for every corner, it is left without and is shaded flat.
pub(crate) fn read_obj(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let reader = super::super::open_to_read(file, limits.file_bytes)?;
    let mut notes = Vec::new();
    let mut files = vec![file.to_path_buf()];
    let (models, materials) = parse(file, reader, folder, limits, &mut notes, &mut files)?;
    let mut model = Model {
        notes,
        files,
        ..Model::default()
    };
    for material in &materials {
        let phong = phong_of(material, &mut model.notes);
        model.materials.push((material.name.clone(), phong));
    }
    for (key, parts) in gather(models) {
        let name = key.mesh_name(&materials, &model.meshes);
        let mesh = join(parts, &name, file, &mut model.notes)?;
        model.nodes.push(Node {
            name: name.clone(),
            mesh: Some(name.clone()),
            material: key.material,
            ..Node::default()
        });
        model.meshes.insert(name, mesh);
    }
    if model.meshes.is_empty() {
        return Err(FileError::new(file, Problem::NoTriangles));
    }
    Ok(model)
}

type Parsed = (Vec<tobj::Model>, Vec<tobj::Material>);

fn parse(
    file: &Path,
    reader: BufReader<File>,
    folder: &Folder,
    limits: &Limits,
    notes: &mut Vec<String>,
    files: &mut Vec<PathBuf>,
) -> Result<Parsed, FileError> {
    let seen = RefCell::new(Seen::default());
    let mut lines = Lines::new(reader, file, limits, &seen);
    let library_notes = RefCell::new(Vec::new());
    let libraries = RefCell::new(Vec::new());
    let loaded = tobj::load_obj_buf(&mut lines, &tobj::GPU_LOAD_OPTIONS, |path| {
        let name = path.to_string_lossy().replace('\\', "/");
        let library = read_mtl(&name, folder, limits);
        let mut seen = seen.borrow_mut();
        match library {
            Ok(library) => {
                library_notes.borrow_mut().extend(library.notes);
                libraries.borrow_mut().push(library.file);
                if let Ok((_, names)) = &library.loaded {
                    seen.materials.extend(names.keys().cloned());
                }
                library.loaded
            }
            Err(error) => {
                let place = Place::Line(seen.line);
                let error = match error.problem {
                    Problem::NotFound => {
                        FileError::at(file, place, Problem::MissingFile { path: name })
                    }
                    Problem::Outside => {
                        FileError::at(file, place, Problem::RefersOutside { path: name })
                    }
                    _ => error,
                };
                seen.error.get_or_insert(error);
                Err(tobj::LoadError::OpenFileFailed)
            }
        }
    });
    let seen = seen.into_inner();
    if let Some(error) = seen.error {
        return Err(error);
    }
    let generic = |error: tobj::LoadError| {
        first_fault(file).unwrap_or_else(|| {
            FileError::at(
                file,
                Place::Line(seen.line),
                Problem::Malformed(error.to_string()),
            )
        })
    };
    let (models, materials) = loaded.map_err(generic)?;
    let materials = materials.map_err(generic)?;
    notes.append(&mut library_notes.into_inner());
    files.append(&mut libraries.into_inner());
    if !seen.undefined.is_empty() {
        let names: Vec<_> = seen.undefined.into_iter().collect();
        notes.push(format!(
            "no mtllib defines {}: the default material is used",
            names.join(", ")
        ));
    }
    Ok((models, materials))
}

/// What makes an object: its name and its material.
#[derive(PartialEq, Eq, PartialOrd, Ord, Clone)]
struct Key {
    object: String,
    material: Option<usize>,
    several: bool,
}

impl Key {
    fn mesh_name(&self, materials: &[tobj::Material], taken: &BTreeMap<String, Mesh>) -> String {
        let material = self.material.and_then(|index| materials.get(index));
        let material = material.map_or("", |material| &material.name);
        let name = if self.several {
            format!("{}/{material}", self.object)
        } else {
            self.object.clone()
        };
        let numbered = (2_u32..).map(|n| format!("{name}#{n}"));
        std::iter::once(name.clone())
            .chain(numbered)
            .find(|name| !taken.contains_key(name))
            .unwrap_or(name)
    }
}

/// Parts of the same object and material together, in the order in which they first appear.
fn gather(models: Vec<tobj::Model>) -> Vec<(Key, Vec<tobj::Mesh>)> {
    let mut places: BTreeMap<(String, Option<usize>), usize> = BTreeMap::new();
    let mut materials_of: BTreeMap<String, usize> = BTreeMap::new();
    let mut out: Vec<(Key, Vec<tobj::Mesh>)> = Vec::new();
    for model in models {
        if model.mesh.indices.is_empty() {
            continue;
        }
        let material = model.mesh.material_id;
        let place = *places
            .entry((model.name.clone(), material))
            .or_insert_with(|| {
                *materials_of.entry(model.name.clone()).or_default() += 1;
                let key = Key {
                    object: model.name,
                    material,
                    several: false,
                };
                out.push((key, Vec::new()));
                out.len() - 1
            });
        out[place].1.push(model.mesh);
    }
    for (key, _) in &mut out {
        key.several = materials_of
            .get(&key.object)
            .is_some_and(|&count| count > 1);
    }
    out
}

/// Joins the parts of a mesh. Each part's arrays are freed as soon as they are taken over.
fn join(
    parts: Vec<tobj::Mesh>,
    name: &str,
    file: &Path,
    notes: &mut Vec<String>,
) -> Result<Mesh, FileError> {
    let total = |length: fn(&tobj::Mesh) -> usize| parts.iter().map(length).sum::<usize>();
    let vertices = total(|part| part.positions.len() / 3);
    if u32::try_from(vertices).is_err() {
        let problem = Problem::TooMany {
            what: "vertices in one object",
            count: vertices as u64,
            limit: u64::from(u32::MAX),
        };
        return Err(FileError::at(file, Place::Part(name.into()), problem));
    }
    // tobj leaves out what a corner does not have, which shifts all that follow.
    let mut whole = |what: &str, given: usize, width: usize| {
        if given != 0 && given != vertices * width {
            notes.push(format!(
                "`{name}`: only some corners have {what}, so none is used"
            ));
        }
        given != 0 && given == vertices * width
    };
    let with_normals = whole("normals", total(|part| part.normals.len()), 3);
    let with_uvs = whole("texture coordinates", total(|part| part.texcoords.len()), 2);
    let mut positions: Vec<[f32; 3]> = Vec::with_capacity(vertices);
    let mut normals = Vec::with_capacity(if with_normals { vertices } else { 0 });
    let mut uvs: Vec<[f32; 2]> = Vec::with_capacity(if with_uvs { vertices } else { 0 });
    let mut indices: Vec<u32> = Vec::new();
    indices.reserve_exact(total(|part| part.indices.len()));
    for part in parts {
        // Fits: the sum of all parts was checked.
        let first = positions.len() as u32;
        positions.extend_from_slice(part.positions.as_chunks().0);
        if with_normals {
            normals.extend_from_slice(part.normals.as_chunks().0);
        }
        if with_uvs {
            let pairs = part.texcoords.as_chunks().0.iter();
            uvs.extend(pairs.map(|&[u, v]: &[f32; 2]| [u, 1.0 - v]));
        }
        indices.extend(part.indices.iter().map(|index| first + index));
    }
    let finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
    let flat: [(&str, &[f32]); 3] = [
        ("a vertex", positions.as_flattened()),
        ("a normal", normals.as_flattened()),
        ("a texture coordinate", uvs.as_flattened()),
    ];
    for (what, values) in flat {
        if !finite(values) {
            return Err(first_fault(file).unwrap_or_else(|| {
                let problem = Problem::NotFinite { what: what.into() };
                FileError::at(file, Place::Part(name.into()), problem)
            }));
        }
    }
    Ok(triangle_mesh(positions, normals, uvs, indices))
}

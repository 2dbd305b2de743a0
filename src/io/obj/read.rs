use super::super::error::{FileError, Place, Problem};
use super::super::folder::Folder;
use super::super::model::{ColoredMaterial, FreeNames, Model, Node};
use super::super::names::Names;
use super::super::notes::Notes;
use super::super::picture::MeasuredPictures;
use super::content::{Content, Part};
use super::mtl::{MtlMaterial, read_mtl};
use super::parts::{Builder, Pictured};
use super::phong::phong_of;
use super::statements::read_content;
use super::text::unquoted;
use crate::io::Limits;
use bevy::mesh::Mesh;
use std::collections::HashMap;
use std::path::Path;

/// Reads an OBJ: one object for each `o` or `g` and material in it. The mesh is called like the object where that has
/// one material, `object/material` where it has several. Faces that lack the texture coordinates which the others
/// have, and whose material has a picture, are an object of their own, `… without picture`.
///
/// Normals are kept as the file gives them; faces without are smooth within their smoothing group, and flat where they
/// have none.
pub(crate) fn read_obj(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let mut model = Model {
        files: vec![file.to_path_buf()],
        ..Model::default()
    };
    let mut content = read_content(file, limits, &mut model.notes)?;
    let mut names = Names::new(folder);
    let mut libraries = Vec::new();
    for (library, line) in &content.libraries {
        libraries.extend(read_libraries(
            file,
            library,
            *line,
            limits,
            &mut names,
            &mut model.notes,
        )?);
    }
    model
        .files
        .extend(libraries.iter().map(|material| material.file.clone()));
    model.files.dedup();
    let mut pictured = Vec::new();
    let mut measured = MeasuredPictures::of(limits);
    for material in &libraries {
        let (phong, pictures) = phong_of(material, folder, &mut measured, &mut model.notes)?;
        model.materials.push((material.name.clone(), phong));
        pictured.push(pictures);
    }
    let chosen = choose_materials(file, &content, &libraries, &mut model.notes);
    let groups = gather(std::mem::take(&mut content.parts), &chosen);
    let objects = groups.len() as u64;
    if objects > limits.entities {
        let problem = Problem::TooMany {
            what: "objects",
            count: objects,
            limit: limits.entities,
        };
        return Err(FileError::new(file, problem));
    }
    let several = materials_of_objects(&groups);
    let (keys, parts): (Vec<_>, Vec<_>) = groups.into_iter().unzip();
    let mut free_names = FreeNames::default();
    let mut colored = ColoredMaterial::default();
    let mut builder = Builder::new(file, &content, &parts, &mut model.notes);
    for (key, part) in keys.into_iter().zip(parts) {
        let object = &content.objects[key.object as usize];
        let material = key.material.and_then(|index| libraries.get(index));
        let mut name = object.clone();
        if several[&key.object] > 1 {
            name = format!(
                "{object}/{}",
                material.map_or("", |material| &material.name)
            );
        }
        let pictures = key
            .material
            .map_or(Pictured::default(), |index| pictured[index]);
        let meshes = builder.meshes(part, &name, pictures)?;
        let plain = format!("{name} without picture");
        for (name, mesh) in [(name, meshes.mesh), (plain, meshes.without_picture)] {
            let Some(mesh) = mesh else { continue };
            let name = free_names.free(name, &model.meshes);
            let is_colored = mesh.contains_attribute(Mesh::ATTRIBUTE_COLOR);
            let material = key
                .material
                .or_else(|| is_colored.then(|| colored.place(&mut model.materials)));
            model.nodes.push(Node {
                name: name.clone(),
                mesh: Some(name.clone()),
                material,
                ..Node::default()
            });
            model.meshes.insert(name, mesh);
        }
    }
    if model.meshes.is_empty() {
        let nothing = || FileError::new(file, Problem::NoTriangles);
        return Err(content.fault.unwrap_or_else(nothing));
    }
    Ok(model)
}

/// The names in what stands after `mtllib`, of which each may have spaces in it: as many words as are the name of a file
/// that is there, or one.
fn library_names<'t>(library: &'t str, names: &mut Names) -> Vec<&'t str> {
    /// Each is looked for on the disk, so that of a line without an end only the first words are joined.
    const MOST_WORDS: usize = 8;
    const MOST_NAMES: usize = 64;
    let mut found = Vec::new();
    let mut rest = library.trim();
    while !rest.is_empty() {
        let words = match found.len() < MOST_NAMES {
            true => MOST_WORDS,
            false => 1,
        };
        let is_end = |&(at, c): &(usize, char)| {
            let mut behind = rest[at + c.len_utf8()..].chars();
            !c.is_whitespace() && behind.next().is_none_or(char::is_whitespace)
        };
        let ends = rest.char_indices().filter(is_end).take(words);
        let ends: Vec<usize> = ends.map(|(at, c)| at + c.len_utf8()).collect();
        let mut longest = ends.iter().rev();
        let there = longest.find(|&&end| names.find("", unquoted(&rest[..end])).is_ok());
        let end = there.or(ends.first()).copied().unwrap_or(rest.len());
        let (name, behind) = rest.split_at(end);
        found.push(unquoted(name));
        rest = behind.trim_start();
    }
    found
}

/// The materials of what stands after `mtllib`.
fn read_libraries(
    file: &Path,
    library: &str,
    line: u64,
    limits: &Limits,
    names: &mut Names,
    notes: &mut Notes,
) -> Result<Vec<MtlMaterial>, FileError> {
    const WITHOUT: &str = "materials are the default one";
    let mut materials = Vec::new();
    let place = || Place::Line(line);
    for name in library_names(library, names) {
        let found = match names.find("", name) {
            Ok(found) => found,
            Err(missing) => {
                notes.add_named(file, place(), missing.what("MTL file"), name, WITHOUT);
                continue;
            }
        };
        if found.is_guess {
            let what = "an MTL file whose name is spelt otherwise:";
            notes.add_named(
                file,
                place(),
                what,
                &found.path,
                "the one that was found is read",
            );
        }
        let read = names
            .file(&found.path)
            .and_then(|file| read_mtl(&file, &found.path, limits, names, notes));
        match read {
            Ok(read) => materials.extend(read),
            Err(error) if error.problem.is_of_memory() => return Err(error),
            Err(error) => notes.add(&error.file, error.place, error.problem.to_string(), WITHOUT),
        }
    }
    Ok(materials)
}

/// Which material of the libraries each name after `usemtl` means.
fn choose_materials(
    file: &Path,
    content: &Content,
    libraries: &[MtlMaterial],
    notes: &mut Notes,
) -> Vec<Option<usize>> {
    let mut exact: HashMap<&str, usize> = HashMap::new();
    let mut alike: HashMap<String, usize> = HashMap::new();
    for (index, material) in libraries.iter().enumerate() {
        alike.insert(material.name.to_lowercase(), index);
        if exact.insert(&material.name, index).is_some() {
            let place = Place::Line(material.line);
            let what = "several materials of the name";
            notes.add_named(
                &material.file,
                place,
                what,
                &material.name,
                "the last is used",
            );
        }
    }
    let find = |(name, line): &(String, u64)| {
        let before_comment = name.split_once(" #").map(|(name, _)| name.trim_end());
        for name in [Some(name.as_str()), before_comment].into_iter().flatten() {
            if let Some(&index) = exact.get(name).or_else(|| exact.get(unquoted(name))) {
                return Some(index);
            }
        }
        let place = Place::Line(*line);
        let found = alike.get(&name.to_lowercase()).copied();
        let (what, instead) = match found {
            Some(_) => (
                "another case of letters in the material",
                "the one that was found is used",
            ),
            None if content.libraries.is_empty() => (
                "no mtllib, and so no material",
                "the default material is used",
            ),
            None => (
                "no MTL file has the material",
                "the default material is used",
            ),
        };
        notes.add_named(file, place, what, name, instead);
        found
    };
    content.materials.iter().map(find).collect()
}

/// What makes an object: its name, and its material.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    object: u32,
    material: Option<usize>,
}

/// Faces of the same object and material together, in the order in which they first appear.
fn gather(parts: Vec<Part>, chosen: &[Option<usize>]) -> Vec<(Key, Part)> {
    let mut places: HashMap<Key, usize> = HashMap::new();
    let mut out: Vec<(Key, Part)> = Vec::new();
    for part in parts {
        if part.faces.is_empty() {
            continue;
        }
        let material = part.material.and_then(|name| chosen[name as usize]);
        let key = Key {
            object: part.object,
            material,
        };
        match places.get(&key) {
            Some(&place) => {
                let (_, before) = &mut out[place];
                before.faces.extend_from_slice(&part.faces);
                before.corners.extend_from_slice(&part.corners);
            }
            None => {
                places.insert(key, out.len());
                out.push((key, part));
            }
        }
    }
    out
}

fn materials_of_objects(groups: &[(Key, Part)]) -> HashMap<u32, u32> {
    let mut counts = HashMap::new();
    for (key, _) in groups {
        *counts.entry(key.object).or_default() += 1;
    }
    counts
}

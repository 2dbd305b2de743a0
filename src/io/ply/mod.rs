//! PLY (Turk 1994, "The PLY polygon file format"), ASCII and binary: what scanners and MeshLab write.
//!
//! The reader is our own. The crate `ply-rs-bw` (2.0) allocates as many elements as the header says there are, panics
//! where that number has too many digits, takes a negative length of a list for 2^64 of them, and keeps each vertex as
//! a map of named values, which is many times the file. It leaves strips, textures and their coordinates to its user.

mod body;
mod content;
mod faces;
mod header;
mod vertices;

use super::error::{FileError, Place, Problem};
use super::folder::Folder;
use super::model::{ColoredMaterial, Model, Node};
use super::{Limits, open_to_read};
use bevy::mesh::Mesh;
use body::{Body, Fault};
use content::{Content, Work};
use header::{Element, read_header};
use std::io::BufRead;
use std::path::{Path, PathBuf};

/// The name of the only mesh.
const MESH: &str = "mesh";

/// Reads a PLY: one object, called like the file, whose mesh is called `mesh`. Without normals it is flat. A picture
/// that a comment `TextureFile` names becomes its material.
pub(crate) fn read_ply(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let mut reader = open_to_read(file, limits.file_bytes)?;
    let mut work = Work::of(file, limits);
    let start = reader.fill_buf();
    let start = start.map_err(|error| FileError::reading(file, &error))?;
    // Editors of text put one in front.
    let mark: &[u8] = b"\xef\xbb\xbf";
    let mark = if start.starts_with(mark) {
        mark.len()
    } else {
        0
    };
    reader.consume(mark);
    let header = read_header(&mut reader, &mut work)?;
    let mut body = Body::of(reader, header.format, header.lines);
    let mut content = Content::default();
    let mut is_whole = true;
    for element in &header.elements {
        if let Err(error) = read_element(element, &mut body, &mut content, &mut work) {
            let (problem, is_final) = match error {
                Fault::Of(problem) => (problem, false),
                Fault::Final(problem) => (problem, true),
            };
            let error = FileError::at(file, body.place(&element.name), problem);
            if is_final || content.indices.is_empty() {
                return Err(error);
            }
            let FileError { place, problem, .. } = error;
            let instead = "what comes before is shown";
            work.notes.add(file, place, problem.to_string(), instead);
            is_whole = false;
            break;
        }
    }
    let reading = |error: std::io::Error| FileError::reading(file, &error);
    if is_whole && !body.is_at_end().map_err(reading)? {
        let what = "something behind its last element";
        work.notes.add(file, Place::Whole, what, "left out");
    }
    if content.indices.is_empty() {
        let problem = match (work.fault.take(), content.positions.len()) {
            (Some(fault), _) => return Err(fault),
            (None, 0) => Problem::NoTriangles,
            (None, count) => Problem::PointsAlone {
                count: count as u64,
            },
        };
        return Err(FileError::new(file, problem));
    }
    let mut model = Model {
        files: vec![file.to_path_buf()],
        ..Model::default()
    };
    let has_uvs = !content.uvs.is_empty();
    model.materials = header.material(has_uvs, folder, &mut work);
    let mesh = content.into_mesh(&mut work);
    if model.materials.is_empty() && mesh.contains_attribute(Mesh::ATTRIBUTE_COLOR) {
        ColoredMaterial::default().place(&mut model.materials);
    }
    let stem = file.file_stem().map(PathBuf::from).unwrap_or_default();
    model.nodes.push(Node {
        name: stem.display().to_string(),
        mesh: Some(MESH.to_owned()),
        material: (!model.materials.is_empty()).then_some(0),
        ..Node::default()
    });
    model.meshes.insert(MESH.to_owned(), mesh);
    model.notes = work.notes;
    Ok(model)
}

fn read_element(
    element: &Element,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    // There is nothing of it in the file, however many there are.
    if element.properties.is_empty() {
        return Ok(());
    }
    match element.name.as_str() {
        "vertex" => vertices::read_vertices(element, body, content, work),
        "face" => faces::read_faces(element, body, content, work),
        "tristrips" => faces::read_strips(element, body, content, work),
        name => {
            let what = "elements that are no faces:";
            (work.notes).add_named(work.file, Place::Whole, what, name, "left out");
            for _ in 0..element.count {
                for property in &element.properties {
                    body.skip(property)?;
                }
            }
            Ok(())
        }
    }
}

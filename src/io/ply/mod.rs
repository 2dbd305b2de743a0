//! PLY (Turk 1994, "The PLY polygon file format"), ASCII and binary: what scanners and MeshLab write.
//!
//! The reader is our own. The crate `ply-rs-bw` (2.0) allocates as many elements as the header says there are, panics
//! where that number has too many digits, takes a negative length of a list for 2^64 of them, and keeps each vertex as
//! a map of named values, which is many times the file. It leaves strips, textures and their coordinates to its user.

mod body;
mod content;
mod faces;
mod header;
mod own_corners;
mod vertices;

use super::error::{FileError, Place, Problem};
use super::folder::Folder;
use super::model::{ColoredMaterial, Model, Node};
use super::{Limits, open_to_read};
use bevy::mesh::Mesh;
use body::{Body, Fault};
use content::{Content, Work};
use header::{Element, Pass, read_header};
use std::io::{BufRead, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// The name of the only mesh.
const MESH: &str = "mesh";

/// Reads a PLY: one object, called like the file, whose mesh is called `mesh`. Without normals it is flat. A picture
/// that a comment `TextureFile` names becomes its material.
pub(crate) fn read_ply(file: &Path, folder: &Folder, limits: &Limits) -> Result<Model, FileError> {
    let mut reader = open_to_read(file, limits.file_bytes)?;
    let mut work = Work::of(file, limits);
    let reading = |error: std::io::Error| FileError::reading(file, &error);
    let start = reader.fill_buf().map_err(reading)?;
    // Editors of text put one in front.
    let mark: &[u8] = b"\xef\xbb\xbf";
    let mark = if start.starts_with(mark) {
        mark.len()
    } else {
        0
    };
    reader.consume(mark);
    let header = read_header(&mut reader, &mut work)?;
    let start = reader.stream_position().map_err(reading)?;
    let mut content = Content::default();
    for &pass in header.passes() {
        reader.seek(SeekFrom::Start(start)).map_err(reading)?;
        let mut body = Body::of(&mut reader, header.format, header.lines);
        let is_whole = read_elements(&header.elements, pass, &mut body, &mut content, &mut work)?;
        if is_whole && pass != Pass::Faces && !body.is_at_end().map_err(reading)? {
            let what = "something behind its last element";
            work.notes.add(file, Place::Whole, what, "left out");
        }
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

/// Reads what a pass takes in. False where an element could not be read to its end, which is noted.
fn read_elements(
    elements: &[Element],
    pass: Pass,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<bool, FileError> {
    for element in elements {
        if let Err(error) = read_element(element, pass, body, content, work) {
            let (problem, is_final) = match error {
                Fault::Of(problem) => (problem, false),
                Fault::Final(problem) => (problem, true),
            };
            let error = FileError::at(work.file, body.place(&element.name), problem);
            let is_nothing_read = match pass {
                Pass::Vertices => content.positions.is_empty(),
                Pass::All | Pass::Faces => content.indices.is_empty(),
            };
            if is_final || is_nothing_read {
                return Err(error);
            }
            let FileError { place, problem, .. } = error;
            let instead = "what comes before is shown";
            (work.notes).add(work.file, place, problem.to_string(), instead);
            return Ok(false);
        }
    }
    Ok(true)
}

fn read_element(
    element: &Element,
    pass: Pass,
    body: &mut Body<impl BufRead>,
    content: &mut Content,
    work: &mut Work,
) -> Result<(), Fault> {
    // There is nothing of it in the file, however many there are.
    if element.properties.is_empty() {
        return Ok(());
    }
    match element.name.as_str() {
        "vertex" if pass != Pass::Faces => vertices::read_vertices(element, body, content, work),
        "face" if pass != Pass::Vertices => faces::read_faces(element, body, content, work),
        "tristrips" if pass != Pass::Vertices => faces::read_strips(element, body, content, work),
        name => {
            if pass != Pass::Faces && !["vertex", "face", "tristrips"].contains(&name) {
                let what = "elements that are no faces:";
                (work.notes).add_named(work.file, Place::Whole, what, name, "left out");
            }
            for _ in 0..element.count {
                for property in &element.properties {
                    body.skip(property)?;
                }
            }
            Ok(())
        }
    }
}

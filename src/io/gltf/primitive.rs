//! The triangles of a primitive.

use super::super::budget::mesh_bytes;
use super::super::error::Problem;
use super::super::model::triangle_mesh;
use super::super::vertex_values::{clear, to_unit};
use super::accessors::{colors, floats, fractions, indices};
use super::document::Document;
use super::json::Json;
use super::pictures::placing_texture;
use super::rest::{Pose, Vertices};
use super::texture::TextureInfo;
use bevy::math::Vec2;
use bevy::mesh::Mesh;

const DRACO: &str = "KHR_draco_mesh_compression";

const LINE_STRIP: usize = 3;
const TRIANGLES: usize = 4;
const TRIANGLE_STRIP: usize = 5;
const TRIANGLE_FAN: usize = 6;

/// The triangles of a primitive at rest.
pub(super) struct Triangles {
    pub mesh: Mesh,
    /// Its skin's joints say where it is, and no node does.
    pub is_skinned: bool,
}

/// A primitive's triangles at rest; `None` where it has none, which is noted.
pub(super) fn read_primitive(
    document: &Document,
    primitive: Json,
    name: &str,
    pose: &Pose,
) -> Result<Option<Triangles>, Problem> {
    let mode = primitive.index("mode").unwrap_or(TRIANGLES);
    if mode <= LINE_STRIP {
        document.note(name, "points and lines", "left out");
        primitive.mark_all();
        return Ok(None);
    }
    if mode > TRIANGLE_FAN {
        document.note(name, "a `mode` that glTF does not have", "left out");
        primitive.mark_all();
        return Ok(None);
    }
    let is_compressed = primitive.has_extension(DRACO);
    let attributes = primitive.get("attributes");
    let Some(attributes) = attributes.filter(|attributes| attributes.index("POSITION").is_some())
    else {
        document.note(name, "a primitive without positions", "left out");
        return Ok(None);
    };
    let read = triangles(document, primitive, attributes, mode, name, pose);
    read.map_err(|problem| match is_compressed {
        // What stands beside it might have been whole.
        true => Problem::UnsupportedExtension(DRACO.to_owned()),
        false => problem,
    })
}

fn triangles(
    document: &Document,
    primitive: Json,
    attributes: Json,
    mode: usize,
    name: &str,
    pose: &Pose,
) -> Result<Option<Triangles>, Problem> {
    let missing = || Problem::Malformed("it has no positions".into());
    let positions = attributes.index("POSITION").ok_or_else(missing)?;
    let mut positions = floats::<3>(document, positions)?;
    let count = positions.len();
    let mut normals: Vec<[f32; 3]> =
        attribute(document, attributes, "NORMAL", name, count, floats)?;
    let mut tangents: Vec<[f32; 4]> =
        attribute(document, attributes, "TANGENT", name, count, floats)?;
    if normals.is_empty() && !tangents.is_empty() {
        // Without them there is nothing to be perpendicular to (glTF 2.0, 3.7.2.1).
        document.note(name, "tangents without normals", "left out");
        tangents.clear();
    }
    let mut vertices = Vertices {
        positions: &mut positions,
        normals: &mut normals,
        tangents: &mut tangents,
    };
    let is_skinned = pose.apply(document, primitive, name, &mut vertices)?;
    let material = primitive.index("material");
    let texture = placing_texture(document, material);
    let set = texture.map_or(0, |texture| texture.set);
    let set = format!("TEXCOORD_{set}");
    // Integers may be texture coordinates as they are where that is said, and a texture's transform shrinks them.
    let read_uvs = match document.uses("KHR_mesh_quantization") {
        true => floats::<2>,
        false => fractions::<2>,
    };
    let mut uvs: Vec<[f32; 2]> = attribute(document, attributes, &set, name, count, read_uvs)?;
    if texture.is_some() && uvs.is_empty() {
        let what = format!("no {set} for the pictures of its material");
        document.note(name, what, "shown without them");
    }
    if let Some(TextureInfo {
        transform: Some(transform),
        ..
    }) = texture
    {
        for uv in &mut uvs {
            *uv = transform.transform_point2(Vec2::from(*uv)).into();
        }
    }
    let mut colors: Vec<[f32; 4]> =
        attribute(document, attributes, "COLOR_0", name, count, colors)?;
    if let Some((what, instead)) = to_unit(&mut colors) {
        document.note(name, what, instead);
    }
    let repaired = clear(&mut normals) | clear(&mut uvs) | clear(&mut tangents);
    if repaired {
        let what = "normals, tangents or texture coordinates that are not finite numbers";
        document.note(name, what, "0 is taken for them");
    }
    let corners = match primitive.index("indices") {
        Some(accessor) => indices(document, accessor)?,
        None => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
    };
    if mode == TRIANGLES && !corners.len().is_multiple_of(3) {
        document.note(name, "corners too few for a last triangle", "left out");
    }
    let mut corners = triangles_of(mode, corners);
    let triangles = corners.len() as u64 / 3;
    if triangles > document.limits.triangles {
        return Err(Problem::TooMany {
            what: "triangles",
            count: triangles,
            limit: document.limits.triangles,
        });
    }
    if triangles == 0 {
        document.note(name, "a primitive without triangles", "left out");
        return Ok(None);
    }
    (document.limits.memory).claim(mesh_bytes(0, triangles))?;
    if let Some(problem) = drop_broken(&mut corners, &positions) {
        if corners.is_empty() {
            return Err(problem);
        }
        document.note(name, problem.to_string(), "its triangles are left out");
        for position in &mut positions {
            if !position.iter().all(|value| value.is_finite()) {
                *position = [0.0; 3];
            }
        }
    }
    let mut mesh = triangle_mesh(positions, normals, uvs, corners);
    if !tangents.is_empty() {
        mesh.insert_attribute(Mesh::ATTRIBUTE_TANGENT, tangents);
    }
    if colors.iter().any(|&color| color != [1.0; 4]) {
        mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
    }
    Ok(Some(Triangles { mesh, is_skinned }))
}

/// An attribute that the triangles can do without: what cannot be used is noted, unless memory is what lacks.
fn attribute<T>(
    document: &Document,
    attributes: Json,
    key: &str,
    name: &str,
    count: usize,
    read: impl Fn(&Document, usize) -> Result<Vec<T>, Problem>,
) -> Result<Vec<T>, Problem> {
    let Some(accessor) = attributes.index(key) else {
        return Ok(Vec::new());
    };
    match read(document, accessor) {
        Ok(values) if values.len() == count => return Ok(values),
        Ok(values) => {
            let what = format!("{} values of {key} for {count} vertices", values.len());
            document.note(name, what, "left out");
        }
        Err(problem) => document.do_without(name, key, problem, "left out")?,
    }
    Ok(Vec::new())
}

/// Takes out the triangles that have no place; why the first has none.
fn drop_broken(corners: &mut Vec<u32>, positions: &[[f32; 3]]) -> Option<Problem> {
    let problem_of = |&corner: &u32| match positions.get(corner as usize) {
        None => Some(Problem::IndexOutOfRange {
            what: "vertex",
            index: corner.to_string(),
            count: positions.len(),
        }),
        Some(position) if !position.iter().all(|value| value.is_finite()) => {
            let what = "a vertex".to_owned();
            Some(Problem::NotFinite { what })
        }
        Some(_) => None,
    };
    let first = corners.iter().find_map(problem_of)?;
    let whole = corners.as_chunks::<3>().0.iter();
    let whole = whole.filter(|triangle| triangle.iter().all(|c| problem_of(c).is_none()));
    *corners = whole.flatten().copied().collect();
    Some(first)
}

/// Corners of separate triangles. A strip turns every second one around (glTF 2.0, 3.7.2.1).
fn triangles_of(mode: usize, mut corners: Vec<u32>) -> Vec<u32> {
    match mode {
        TRIANGLE_STRIP => (2..corners.len())
            .flat_map(|i| match i % 2 {
                0 => [corners[i - 2], corners[i - 1], corners[i]],
                _ => [corners[i - 1], corners[i - 2], corners[i]],
            })
            .collect(),
        TRIANGLE_FAN => (2..corners.len())
            .flat_map(|i| [corners[0], corners[i - 1], corners[i]])
            .collect(),
        _ => {
            corners.truncate(corners.len() / 3 * 3);
            corners
        }
    }
}

//! The triangles of a primitive.

use super::super::budget::mesh_bytes;
use super::super::error::Problem;
use super::super::model::triangle_mesh;
use super::accessors::{floats, indices};
use super::document::Document;
use bevy::math::{Affine2, Vec2};
use bevy::mesh::Mesh;
use gltf::mesh::Mode;

/// How scenes name a primitive. By indices, because names need not be unique.
pub(super) fn mesh_name(mesh: &gltf::Mesh, primitive: &gltf::Primitive) -> String {
    format!("Mesh{}/Primitive{}", mesh.index(), primitive.index())
}

/// A primitive's triangles; `None` for points and lines.
pub(super) fn read_primitive(
    document: &Document,
    primitive: &gltf::Primitive,
    name: &str,
    notes: &mut Vec<String>,
) -> Result<Option<Mesh>, Problem> {
    let mode = primitive.mode();
    if !matches!(
        mode,
        Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan
    ) {
        notes.push(format!("{name}: points and lines were left out"));
        return Ok(None);
    }
    let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else {
        return Err(Problem::Malformed("it has no positions".into()));
    };
    let positions = floats::<3>(document, &accessor)?;
    finite("a vertex", positions.as_flattened())?;
    let count = positions.len();
    let normals = match primitive.get(&gltf::Semantic::Normals) {
        Some(accessor) => floats::<3>(document, &accessor)?,
        None => Vec::new(),
    };
    finite("a normal", normals.as_flattened())?;
    let (set, transform) = uv_set(primitive);
    let mut uvs = match primitive.get(&gltf::Semantic::TexCoords(set)) {
        Some(accessor) => floats::<2>(document, &accessor)?,
        None => Vec::new(),
    };
    finite("a texture coordinate", uvs.as_flattened())?;
    for (what, given) in [
        ("normals", normals.len()),
        ("texture coordinates", uvs.len()),
    ] {
        if given != 0 && given != count {
            return Err(Problem::Malformed(format!(
                "{given} {what} for {count} vertices"
            )));
        }
    }
    if let Some(transform) = transform {
        for uv in &mut uvs {
            *uv = transform.transform_point2(Vec2::from(*uv)).into();
        }
    }
    let corners = match primitive.indices() {
        Some(accessor) => indices(document, &accessor)?,
        None => (0..u32::try_from(count).unwrap_or(u32::MAX)).collect(),
    };
    if let Some(index) = corners.iter().find(|&&index| index as usize >= count) {
        return Err(Problem::IndexOutOfRange {
            what: "vertex",
            index: index.to_string(),
            count,
        });
    }
    let corners = triangles_of(mode, corners);
    let triangles = corners.len() as u64 / 3;
    if triangles == 0 {
        notes.push(format!("{name}: has no triangles"));
        return Ok(None);
    }
    if triangles > document.limits.triangles {
        return Err(Problem::TooMany {
            what: "triangles",
            count: triangles,
            limit: document.limits.triangles,
        });
    }
    (document.limits.memory).claim(mesh_bytes(0, triangles))?;
    if primitive.get(&gltf::Semantic::Colors(0)).is_some() {
        notes.push(format!("{name}: its vertex colours were left out"));
    }
    Ok(Some(triangle_mesh(positions, normals, uvs, corners)))
}

/// Which set of texture coordinates the base colour's picture uses, and how it moves them.
fn uv_set(primitive: &gltf::Primitive) -> (u32, Option<Affine2>) {
    let material = primitive.material();
    let Some(info) = material.pbr_metallic_roughness().base_color_texture() else {
        return (0, None);
    };
    let Some(transform) = info.texture_transform() else {
        return (info.tex_coord(), None);
    };
    // KHR_texture_transform turns counter-clockwise as seen in a picture whose v points down.
    let affine = Affine2::from_scale_angle_translation(
        transform.scale().into(),
        -transform.rotation(),
        transform.offset().into(),
    );
    (
        transform.tex_coord().unwrap_or(info.tex_coord()),
        Some(affine),
    )
}

fn finite(what: &str, values: &[f32]) -> Result<(), Problem> {
    match values.iter().all(|value| value.is_finite()) {
        true => Ok(()),
        false => Err(Problem::NotFinite { what: what.into() }),
    }
}

/// Corners of separate triangles. A strip turns every second one around (glTF 2.0, 3.7.2.1).
fn triangles_of(mode: Mode, mut corners: Vec<u32>) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => (2..corners.len())
            .flat_map(|i| match i % 2 {
                0 => [corners[i - 2], corners[i - 1], corners[i]],
                _ => [corners[i - 1], corners[i - 2], corners[i]],
            })
            .collect(),
        Mode::TriangleFan => (2..corners.len())
            .flat_map(|i| [corners[0], corners[i - 1], corners[i]])
            .collect(),
        _ => {
            corners.truncate(corners.len() / 3 * 3);
            corners
        }
    }
}

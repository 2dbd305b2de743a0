use super::super::error::FileError;
use super::super::exported::{Exported, Object, gather};
use super::super::model::MeshParts;
use super::super::place::world_from;
use super::super::replace::replace_file;
use super::write_mtl::write_mtl;
use bevy::asset::Assets;
use bevy::math::{Affine3A, Mat3A, Vec3};
use bevy::mesh::Mesh;
use bevy::prelude::World;
use std::io::{self, Write};
use std::path::Path;

/// Writes the scene's objects into an OBJ, in the world's space, its materials into an MTL beside
/// it, and pictures that are no files into PNGs beside it. Returns what could not be said.
pub(crate) fn write_obj(world: &mut World, file: &Path) -> Result<Vec<String>, FileError> {
    let mut exported = gather(world);
    exported.note_lights_and_cameras(world);
    super::super::check_writable(file)?;
    let mtl = file.with_extension("mtl");
    write_mtl(world, &mtl, &mut exported)?;
    let mtl_name = mtl.file_name().unwrap_or_default().to_string_lossy();
    let Some(meshes) = world.get_resource::<Assets<Mesh>>() else {
        return Ok(exported.notes);
    };
    let Exported {
        objects,
        materials,
        mut notes,
        ..
    } = exported;
    replace_file(file, |out| {
        writeln!(out, "# Glassbox {}", env!("CARGO_PKG_VERSION"))?;
        writeln!(out, "mtllib {mtl_name}")?;
        let mut counts = Counts::default();
        for object in &objects {
            let Some(parts) = meshes.get(object.mesh).and_then(MeshParts::of) else {
                notes.push(format!(
                    "`{}`: its mesh is no indexed triangle list",
                    object.name
                ));
                continue;
            };
            writeln!(out, "o {}", object.name)?;
            writeln!(out, "usemtl {}", materials[object.material].name)?;
            write_object(out, &parts, world_from_object(world, object), &mut counts)?;
        }
        Ok(())
    })?;
    Ok(notes)
}

fn world_from_object(world: &World, object: &Object) -> Affine3A {
    world_from(world, object.entity)
}

/// How much the objects so far have written; OBJ counts through the whole file.
#[derive(Default)]
struct Counts {
    positions: usize,
    uvs: usize,
    normals: usize,
}

fn write_object(
    out: &mut impl Write,
    parts: &MeshParts,
    world_from_object: Affine3A,
    counts: &mut Counts,
) -> io::Result<()> {
    let linear = world_from_object.matrix3;
    for &position in parts.positions {
        let [x, y, z] = world_from_object
            .transform_point3(position.into())
            .to_array();
        writeln!(out, "v {x} {y} {z}")?;
    }
    for &[u, v] in parts.uvs {
        writeln!(out, "vt {u} {}", 1.0 - v)?;
    }
    // Normals turn with the inverse transpose; the determinant's sign is left, its size is not needed.
    let straight = linear == Mat3A::IDENTITY;
    let for_normals = linear.inverse().transpose();
    for &normal in parts.normals {
        let normal = match straight {
            true => normal,
            false => (for_normals * Vec3::from(normal))
                .normalize_or_zero()
                .to_array(),
        };
        writeln!(out, "vn {} {} {}", normal[0], normal[1], normal[2])?;
    }
    let first = [counts.positions, counts.uvs, counts.normals].map(|count| count + 1);
    let (uvs, normals) = (!parts.uvs.is_empty(), !parts.normals.is_empty());
    let mirrored = linear.determinant() < 0.0;
    for mut corners in parts.triangles() {
        if mirrored {
            // A mirrored triangle faces the other way unless its corners run the other way too.
            corners.swap(1, 2);
        }
        write!(out, "f")?;
        for corner in corners {
            let [v, vt, vn] = first.map(|first| first + corner);
            match (uvs, normals) {
                (true, true) => write!(out, " {v}/{vt}/{vn}")?,
                (true, false) => write!(out, " {v}/{vt}")?,
                (false, true) => write!(out, " {v}//{vn}")?,
                (false, false) => write!(out, " {v}")?,
            }
        }
        writeln!(out)?;
    }
    counts.positions += parts.positions.len();
    counts.uvs += parts.uvs.len();
    counts.normals += parts.normals.len();
    Ok(())
}

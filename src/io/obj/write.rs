use super::super::error::{FileError, Place, Problem};
use super::super::exported::{Exported, gather};
use super::super::file_name::fits_a_line;
use super::super::folder::stays_inside;
use super::super::identity::folder_of;
use super::super::model::MeshParts;
use super::super::notes::Notes;
use super::super::place::world_from;
use super::super::replace::Staged;
use super::stem_of;
use super::write_mtl::{Library, library};
use super::written_pictures::text_of;
use crate::trace::srgb;
use bevy::asset::Assets;
use bevy::math::{Affine3A, Mat3A, Vec3};
use bevy::mesh::Mesh;
use bevy::prelude::World;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// The material file that is written with an OBJ.
pub(crate) fn mtl_of(file: &Path) -> PathBuf {
    file.with_extension("mtl")
}

/// Writes the scene's objects into an OBJ, in the world's space, its materials into an MTL beside
/// it, and pictures that are no files into PNGs beside it. Returns what could not be said.
///
/// The OBJ that lies there names a complete set of files at any time. Everything is written aside first. Pictures
/// get names that are free; the MTL does not, if it is to be called like the OBJ. Where an OBJ is there that may name
/// an MTL with another content, the new MTL is written under a name of its own beside it, and an OBJ that names
/// that one takes the old one's place; nothing needs the old MTL then, and it is replaced, and at last the OBJ
/// again.
pub(crate) fn write_obj(world: &mut World, file: &Path) -> Result<Notes, FileError> {
    let mtl = mtl_of(file);
    let mtl_name = name_in_obj(&mtl)?;
    let mut exported = gather(world, file);
    exported.note_lights_and_cameras(world, file);
    super::super::check_writable(file)?;
    super::super::check_writable(&mtl)?;
    let left = left_between(file, &mtl);
    let Library {
        text,
        pictures,
        replaced,
    } = library(world, &mtl, left.as_deref(), &mut exported)?;
    let scene = Drawn::of(world, file, &mut exported);
    let obj = |mtl: &str| Staged::new(file, |out| scene.write(mtl, out));
    let library = |mtl: &Path| Staged::new(mtl, |out| out.write_all(text.as_bytes()));

    let old = text_of(&mtl);
    let mut staged = Vec::new();
    if file.is_file() && old.as_ref().is_some_and(|old| *old != text.as_bytes()) {
        let name = free_name(&mtl);
        let place = folder_of(&mtl).join(&name);
        staged.push(Staged::new(&place, |out| {
            writeln!(out, "{}", between_line(&mtl_name))?;
            out.write_all(text.as_bytes())
        })?);
        staged.push(obj(&name)?);
    }
    if old.is_none_or(|old| old != text.as_bytes()) {
        staged.push(library(&mtl)?);
    }
    staged.push(obj(&mtl_name)?);
    // From here on an OBJ may name them.
    pictures.keep();
    staged.into_iter().try_for_each(Staged::commit)?;
    let all_between = files_between(&mtl, &mtl_name);
    for file in replaced.iter().chain(&left).chain(&all_between) {
        // It is complete without them: what cannot be removed stays.
        let _ = fs::remove_file(file);
    }
    Ok(exported.notes)
}

/// How the OBJ names its MTL.
fn name_in_obj(mtl: &Path) -> Result<String, FileError> {
    let name = mtl.file_name().and_then(|name| name.to_str());
    let name = name.filter(|name| fits_a_line(name) && stays_inside(name));
    name.map(str::to_owned).ok_or_else(|| {
        let text = "its material file is called like it, and a line of an OBJ holds no such name (line breaks, `\\`, \
                    a drive, bytes that are no UTF-8, a space or a dash at the start)";
        FileError::new(mtl.with_extension("obj"), Problem::Unnameable(text.into()))
    })
}

/// A name for a file that stands for the MTL until that can be replaced.
fn free_name(mtl: &Path) -> String {
    let stem = stem_of(mtl);
    let mut names = (1_u32..).map(|number| format!("{stem}{BETWEEN}{number}.mtl"));
    let is_free = |name: &String| !folder_of(mtl).join(name).exists();
    names.find(is_free).unwrap_or_default()
}

/// What the names of such files have before their number.
const BETWEEN: &str = "-new";

/// The first line of such a file: only what says this of itself is taken away again.
fn between_line(mtl_name: &str) -> String {
    format!("# In place of {mtl_name} while that is replaced")
}

/// All such files, those included that others left because they were killed.
fn files_between(mtl: &Path, mtl_name: &str) -> Vec<PathBuf> {
    let is_one = |path: &PathBuf| {
        let name = path.file_name().and_then(|name| name.to_str());
        let line = between_line(mtl_name);
        let mut start = Vec::new();
        name.and_then(|name| number_between(name, mtl)).is_some()
            && path.is_file()
            && fs::File::open(path).is_ok_and(|file| {
                let mut start_of = file.take(line.len() as u64);
                start_of.read_to_end(&mut start).is_ok() && start == line.as_bytes()
            })
    };
    let Ok(entries) = fs::read_dir(folder_of(mtl)) else {
        return Vec::new();
    };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    paths.filter(is_one).collect()
}

/// The number in the name of such a file.
fn number_between<'a>(name: &'a str, mtl: &Path) -> Option<&'a str> {
    let number = name.strip_prefix(&stem_of(mtl))?.strip_prefix(BETWEEN)?;
    let number = number.strip_suffix(".mtl")?;
    let is_own = !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_own.then_some(number)
}

/// Such a file that the OBJ names because whoever wrote it was killed before the end.
fn left_between(file: &Path, mtl: &Path) -> Option<PathBuf> {
    const LINES: u64 = 1 << 12;
    let is_file = file.is_file();
    let mut start = Vec::new();
    let reader = is_file.then(|| fs::File::open(file).ok()).flatten()?;
    reader.take(LINES).read_to_end(&mut start).ok()?;
    let start = String::from_utf8_lossy(&start);
    let name = start
        .lines()
        .find_map(|line| line.strip_prefix("mtllib "))?;
    number_between(name, mtl).map(|_| folder_of(mtl).join(name))
}

/// What the OBJ holds.
struct Drawn<'a> {
    objects: Vec<DrawnObject<'a>>,
}

struct DrawnObject<'a> {
    name: String,
    material: String,
    parts: MeshParts<'a>,
    world_from_object: Affine3A,
}

impl<'a> Drawn<'a> {
    fn of(world: &'a World, file: &Path, exported: &mut Exported) -> Self {
        let meshes = world.get_resource::<Assets<Mesh>>();
        let mut objects = Vec::with_capacity(exported.objects.len());
        for object in std::mem::take(&mut exported.objects) {
            let mesh = meshes.and_then(|meshes| meshes.get(object.mesh));
            let Some(parts) = mesh.and_then(MeshParts::of) else {
                let what = "a mesh that is no indexed triangle list:";
                (exported.notes).add_named(file, Place::Whole, what, &object.name, "left out");
                continue;
            };
            if parts.colors.iter().any(|color| color[3] != 1.0) {
                let what = "the alpha of the vertices' colours of";
                (exported.notes).add_named(file, Place::Whole, what, &object.name, "left out");
            }
            let material = &exported.materials[object.material];
            if !parts.tangents.is_empty() && material.phong.normal_map.is_some() {
                let what = "the tangents of";
                let instead = "left out: normal maps then follow texture coordinates";
                (exported.notes).add_named(file, Place::Whole, what, &object.name, instead);
            }
            objects.push(DrawnObject {
                name: object.name,
                material: material.name.clone(),
                parts,
                world_from_object: world_from(world, object.entity),
            });
        }
        Self { objects }
    }

    fn write(&self, mtl: &str, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "# Glassbox {}", env!("CARGO_PKG_VERSION"))?;
        writeln!(out, "mtllib {mtl}")?;
        let mut counts = Counts::default();
        for object in &self.objects {
            writeln!(out, "o {}", object.name)?;
            writeln!(out, "usemtl {}", object.material)?;
            write_object(out, &object.parts, object.world_from_object, &mut counts)?;
        }
        Ok(())
    }
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
    let mut colors = parts.colors.iter();
    for &position in parts.positions {
        let [x, y, z] = world_from_object
            .transform_point3(position.into())
            .to_array();
        write!(out, "v {x} {y} {z}")?;
        if let Some(&[r, g, b, _]) = colors.next() {
            let [r, g, b] = [r, g, b].map(srgb::encode);
            write!(out, " {r} {g} {b}")?;
        }
        writeln!(out)?;
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

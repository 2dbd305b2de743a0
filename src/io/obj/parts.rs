//! From faces to meshes of triangles: corners that are the same become one vertex, polygons triangles, and what has
//! no normal gets one where its smoothing group says so.

use super::super::error::{FileError, Place, Problem};
use super::super::model::triangle_mesh;
use super::super::notes::Notes;
use super::super::polygon::Triangulator;
use super::content::{Content, Corner, Face, NONE, Part};
use bevy::math::{Vec2, Vec3};
use bevy::mesh::Mesh;
use bevy::platform::hash::RandomState;
use std::collections::HashMap;
use std::path::Path;

/// How a material moves the texture coordinates of its picture, v upwards: `scale · uv + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Placement {
    pub scale: Vec2,
    pub offset: Vec2,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            scale: Vec2::ONE,
            offset: Vec2::ZERO,
        }
    }
}

/// A material's picture, as far as meshes need to know.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pictured {
    pub placement: Placement,
    /// Faces without texture coordinates are kept apart: they have no picture.
    pub has_pictures: bool,
}

/// Meshes of a part.
pub(super) struct Meshes {
    pub mesh: Option<Mesh>,
    /// The faces that cannot have the material's pictures.
    pub without_picture: Option<Mesh>,
}

/// Makes meshes of an OBJ's parts.
pub(super) struct Builder<'a> {
    file: &'a Path,
    content: &'a Content,
    notes: &'a mut Notes,
    triangulator: Triangulator,
    /// Made here, numbered after those of the file.
    normals: Vec<[f32; 3]>,
    /// Those of a position in a smoothing group.
    smooth: HashMap<[u32; 2], u32, RandomState>,
}

impl<'a> Builder<'a> {
    pub fn new(file: &'a Path, content: &'a Content, parts: &[Part], notes: &'a mut Notes) -> Self {
        let mut builder = Self {
            file,
            content,
            notes,
            triangulator: Triangulator::default(),
            normals: Vec::new(),
            smooth: HashMap::default(),
        };
        for part in parts {
            builder.smooth_normals(part);
        }
        for normal in &mut builder.normals {
            *normal = Vec3::from(*normal).normalize_or(Vec3::Z).to_array();
        }
        builder
    }

    /// The meshes of a part whose material has those pictures. Its corners are freed.
    pub fn meshes(
        &mut self,
        part: Part,
        name: &str,
        pictured: Pictured,
    ) -> Result<Meshes, FileError> {
        let corners = part.corners.len();
        if u32::try_from(corners).is_err() {
            let problem = Problem::TooMany {
                what: "corners in one object",
                count: corners as u64,
                limit: u32::MAX.into(),
            };
            return Err(FileError::at(self.file, Place::Part(name.into()), problem));
        }
        let is_textured = |corner: &Corner| self.uv(corner[1]).is_some();
        let textured = part.corners.iter().filter(|corner| is_textured(corner));
        let textured = textured.count();
        let is_smooth = |face: &Face| face.group != 0;
        let has_normal = |corner: &Corner| self.has_normal(corner[2]);
        let with_normals = part.faces.iter().any(is_smooth) || part.corners.iter().any(has_normal);
        let is_apart = pictured.has_pictures && textured < corners && textured > 0;
        if textured < corners && textured > 0 && !is_apart {
            let what = "corners without texture coordinates in";
            let place = Place::Line(part.faces.first().map_or(0, |face| face.line.into()));
            self.notes
                .add_named(self.file, place, what, name, "theirs are 0 0");
        }
        if pictured.has_pictures && textured == 0 {
            let what = "no texture coordinates for the pictures of its material, in";
            let place = Place::Line(part.faces.first().map_or(0, |face| face.line.into()));
            (self.notes).add_named(self.file, place, what, name, "shown without them");
        }
        let mut whole = Vertices::new(self.content, with_normals, textured > 0, pictured);
        let mut plain = Vertices::new(self.content, with_normals, false, pictured);
        let mut polygon = Vec::new();
        let mut triangles = Vec::new();
        let mut start = 0;
        let smooth = self.normals.len();
        for face in &part.faces {
            let end = start + face.corners as usize;
            let corners = &part.corners[start..end];
            start = end;
            let mut flat = None;
            self.triangles(face, corners, &mut polygon, &mut triangles);
            let is_plain = is_apart && corners.iter().any(|corner| self.uv(corner[1]).is_none());
            let out = if is_plain { &mut plain } else { &mut whole };
            for triangle in &triangles {
                for &at in triangle {
                    let mut corner = corners[at as usize];
                    if with_normals && !self.has_normal(corner[2]) {
                        corner[2] = self.own_normal(face, corner, corners, &mut flat);
                    }
                    out.push(corner, &self.normals);
                }
            }
        }
        self.normals.truncate(smooth);
        Ok(Meshes {
            mesh: whole.into_mesh(),
            without_picture: plain.into_mesh(),
        })
    }

    fn triangles(
        &mut self,
        face: &Face,
        corners: &[Corner],
        polygon: &mut Vec<Vec3>,
        triangles: &mut Vec<[u32; 3]>,
    ) {
        triangles.clear();
        if corners.len() == 3 {
            triangles.push([0, 1, 2]);
            return;
        }
        polygon.clear();
        polygon.extend(corners.iter().map(|corner| self.position(corner)));
        let fit = self.triangulator.triangulate(polygon, triangles);
        let Some((what, instead)) = fit.note() else {
            return;
        };
        let place = Place::Line(face.line.into());
        self.notes.add(self.file, place, what, instead);
    }

    fn position(&self, corner: &Corner) -> Vec3 {
        self.content.positions[corner[0] as usize].into()
    }

    fn uv(&self, index: u32) -> Option<[f32; 2]> {
        let uv = self.content.uvs.get(index as usize).copied();
        uv.filter(|uv| uv[0].is_finite())
    }

    fn has_normal(&self, index: u32) -> bool {
        let normal = self.content.normals.get(index as usize);
        normal.is_some_and(|normal| normal[0].is_finite())
    }

    fn push_normal(&mut self, normal: Vec3) -> u32 {
        self.normals.push(normal.to_array());
        // Below NONE: there are no more than corners of one part, and faces have three at least.
        (self.content.normals.len() + self.normals.len() - 1) as u32
    }

    /// The normal of a corner that the file gives none: that of its smoothing group, or the face's, which is made once.
    fn own_normal(
        &mut self,
        face: &Face,
        corner: Corner,
        corners: &[Corner],
        flat: &mut Option<u32>,
    ) -> u32 {
        let smooth = self.smooth.get(&[corner[0], face.group]).copied();
        smooth.or(*flat).unwrap_or_else(|| {
            let normal = self.newell(corners).normalize_or(Vec3::Z);
            *flat.insert(self.push_normal(normal))
        })
    }

    /// Perpendicular to a polygon, twice its area long.
    fn newell(&self, corners: &[Corner]) -> Vec3 {
        let origin = self.position(&corners[0]);
        let at = |i: usize| self.position(&corners[i % corners.len()]) - origin;
        (0..corners.len()).map(|i| at(i).cross(at(i + 1))).sum()
    }

    /// The mean of the faces' normals around each position of a smoothing group, weighted by the angle that each face
    /// has there (Thürmer, Wüthrich 1998, "Computing vertex normals from polygonal facets").
    fn smooth_normals(&mut self, part: &Part) {
        let mut start = 0;
        for face in &part.faces {
            let end = start + face.corners as usize;
            let corners = &part.corners[start..end];
            start = end;
            if face.group == 0 || corners.iter().all(|corner| self.has_normal(corner[2])) {
                continue;
            }
            let Some(normal) = self.newell(corners).try_normalize() else {
                continue;
            };
            let count = corners.len();
            for (i, corner) in corners.iter().enumerate() {
                let here = self.position(corner);
                let side = |i: usize| self.position(&corners[i % count]) - here;
                let (before, after) = (side(i + count - 1), side(i + 1));
                let angle = before.cross(after).length().atan2(before.dot(after));
                let key = [corner[0], face.group];
                let known = self.smooth.get(&key).copied();
                let index = known.unwrap_or_else(|| self.push_normal(Vec3::ZERO));
                self.smooth.insert(key, index);
                let sum = &mut self.normals[index as usize - self.content.normals.len()];
                *sum = (Vec3::from(*sum) + angle * normal).to_array();
            }
        }
    }
}

/// Vertices and triangles while they grow.
struct Vertices<'a> {
    content: &'a Content,
    with_normals: bool,
    with_uvs: bool,
    with_colors: bool,
    placement: Placement,
    numbers: HashMap<Corner, u32, RandomState>,
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    uvs: Vec<[f32; 2]>,
    colors: Vec<[f32; 4]>,
    indices: Vec<u32>,
}

impl<'a> Vertices<'a> {
    fn new(content: &'a Content, with_normals: bool, with_uvs: bool, pictured: Pictured) -> Self {
        Self {
            content,
            with_normals,
            with_uvs,
            with_colors: !content.colors.is_empty(),
            placement: pictured.placement,
            numbers: HashMap::default(),
            positions: Vec::new(),
            normals: Vec::new(),
            uvs: Vec::new(),
            colors: Vec::new(),
            indices: Vec::new(),
        }
    }

    /// Adds a corner of a triangle; `made` are normals that are numbered after the file's.
    fn push(&mut self, mut corner: Corner, made: &[[f32; 3]]) {
        if !self.with_uvs {
            corner[1] = NONE;
        }
        if !self.with_normals {
            corner[2] = NONE;
        }
        let content = self.content;
        let next = self.positions.len() as u32;
        let index = *self.numbers.entry(corner).or_insert(next);
        self.indices.push(index);
        if index != next {
            return;
        }
        let [position, uv, normal] = corner.map(|index| index as usize);
        self.positions.push(content.positions[position]);
        if self.with_normals {
            let of_file = content.normals.get(normal);
            let own = || made.get(normal.wrapping_sub(content.normals.len()));
            self.normals
                .push(of_file.or_else(own).copied().unwrap_or([0.0; 3]));
        }
        if self.with_uvs {
            let uv = content.uvs.get(uv).copied().filter(|uv| uv[0].is_finite());
            let Placement { scale, offset } = self.placement;
            // Bevy and glTF count downwards.
            self.uvs.push(uv.map_or([0.0; 2], |uv| {
                let uv = scale * Vec2::from(uv) + offset;
                [uv.x, 1.0 - uv.y]
            }));
        }
        if self.with_colors {
            let [r, g, b] = content.colors[position];
            self.colors.push([r, g, b, 1.0]);
        }
    }

    fn into_mesh(self) -> Option<Mesh> {
        if self.indices.is_empty() {
            return None;
        }
        let is_colored = self.colors.iter().any(|&color| color != [1.0; 4]);
        let mut mesh = triangle_mesh(self.positions, self.normals, self.uvs, self.indices);
        if is_colored {
            mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, self.colors);
        }
        Some(mesh)
    }
}

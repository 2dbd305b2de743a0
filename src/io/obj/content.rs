//! What an OBJ holds, as its lines said it.

use super::super::error::{FileError, Place, Problem};
use super::super::notes::Notes;
use super::super::vertex_values::to_unit;
use bevy::color::Srgba;
use std::path::Path;

/// In place of an index: there is none.
pub(super) const NONE: u32 = u32::MAX;
/// In place of an index that counts back to before the first, or has more digits than any count.
pub(super) const BEYOND: u32 = u32::MAX - 1;

/// Position, texture coordinate and normal of a corner, as indices, or [`NONE`].
pub(super) type Corner = [u32; 3];

/// A polygon.
#[derive(Clone, Copy)]
pub(super) struct Face {
    pub corners: u32,
    /// Its smoothing group; 0 is none.
    pub group: u32,
    /// Where it stands.
    pub line: u32,
}

/// The faces of one object with one material.
#[derive(Default)]
pub(super) struct Part {
    /// Index into the objects' names.
    pub object: u32,
    /// Index into the materials' names.
    pub material: Option<u32>,
    pub faces: Vec<Face>,
    /// Those of all faces, one after another.
    pub corners: Vec<Corner>,
}

/// Everything that an OBJ holds and that can be shown.
#[derive(Default)]
pub(super) struct Content {
    /// One that cannot be used is not finite.
    pub positions: Vec<[f32; 3]>,
    /// As many as positions, linear in [0, 1], or none where no vertex has one. Files hold them as screens take them,
    /// which is what scanners and Blender write.
    pub colors: Vec<[f32; 3]>,
    /// v upwards, as in the file. One that cannot be used is not finite.
    pub uvs: Vec<[f32; 2]>,
    /// One that cannot be used is not finite.
    pub normals: Vec<[f32; 3]>,
    pub objects: Vec<String>,
    /// Names after `usemtl`, and the line of the first of each.
    pub materials: Vec<(String, u64)>,
    /// What stands after `mtllib`, and its line.
    pub libraries: Vec<(String, u64)>,
    /// In the order in which their first faces come.
    pub parts: Vec<Part>,
    /// The first thing that could not be read: the reason, should nothing be left to show.
    pub fault: Option<FileError>,
}

/// What is done with most of what cannot be used.
pub(super) const LEFT_OUT: &str = "left out";

impl Content {
    /// What can be seen only once everything was read.
    pub fn finish(&mut self, file: &Path, notes: &mut Notes) {
        let content = self;
        let counts = [
            content.positions.len(),
            content.uvs.len(),
            content.normals.len(),
        ];
        for part in &mut content.parts {
            let mut kept = 0;
            let mut start = 0;
            let corners = &mut part.corners;
            let fault = &mut content.fault;
            part.faces.retain(|face| {
                let end = start + face.corners as usize;
                let place = Place::Line(face.line.into());
                let mut is_whole = true;
                for corner in &mut corners[start..end] {
                    for (kind, index) in corner.iter_mut().enumerate() {
                        if *index == NONE || (*index as usize) < counts[kind] {
                            continue;
                        }
                        let named = (u64::from(*index) + 1).to_string();
                        let problem = out_of_range(kind, &named, counts[kind]);
                        fault.get_or_insert_with(|| FileError::at(file, place.clone(), problem));
                        let what = format!(
                            "a corner of a face names a {} that there is not",
                            WHAT[kind]
                        );
                        let instead = if kind == 0 { LEFT_OUT } else { "read without" };
                        notes.add(file, place.clone(), what, instead);
                        is_whole &= kind != 0;
                        *index = NONE;
                    }
                }
                let positions = &content.positions;
                let is_finite = |corner: &Corner| positions[corner[0] as usize][0].is_finite();
                is_whole = is_whole && corners[start..end].iter().all(is_finite);
                if is_whole {
                    corners.copy_within(start..end, kept);
                    kept += end - start;
                }
                start = end;
                is_whole
            });
            corners.truncate(kept);
        }
        if let Some((what, instead)) = to_unit(&mut content.colors) {
            notes.add(file, Place::Whole, what, instead);
        }
        for value in content.colors.iter_mut().flatten() {
            *value = Srgba::gamma_function(*value);
        }
    }
}

const WHAT: [&str; 3] = ["vertex", "texture coordinate", "normal"];

/// An index that names nothing.
pub(super) fn out_of_range(kind: usize, index: &str, count: usize) -> Problem {
    Problem::IndexOutOfRange {
        what: WHAT[kind],
        index: index.into(),
        count,
    }
}

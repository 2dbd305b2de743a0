//! What has been read of a PLY, and what it becomes.

use super::super::Limits;
use super::super::budget::Growing;
use super::super::error::{FileError, Place, Problem};
use super::super::far_off::FarOff;
use super::super::model::triangle_mesh;
use super::super::notes::Notes;
use super::super::vertex_values::{clear, to_unit};
use super::body::Fault;
use super::own_corners::OwnCorners;
use bevy::color::Srgba;
use bevy::mesh::Mesh;
use std::path::Path;

/// Bytes of corners that are spoken for at a time; those of the first need not be.
const CORNERS: u64 = 10 << 20;

/// What there is to say, and what reading may take.
pub(super) struct Work<'a> {
    pub file: &'a Path,
    pub limits: &'a Limits,
    pub notes: Notes,
    /// The first thing that could not be used: the reason, should nothing be left to show.
    pub fault: Option<FileError>,
    memory: Growing<'a>,
    /// What vertices lose.
    pub far_off: FarOff,
    /// Bytes that were spoken for corners of one face.
    corner_bytes: u64,
}

impl<'a> Work<'a> {
    pub fn of(file: &'a Path, limits: &'a Limits) -> Self {
        Self {
            file,
            limits,
            notes: Notes::default(),
            fault: None,
            memory: Growing::of(&limits.memory),
            far_off: FarOff::default(),
            corner_bytes: CORNERS,
        }
    }

    /// Says that something cannot be used.
    pub fn fault(&mut self, place: Place, problem: Problem, what: &str, instead: &'static str) {
        self.notes.add(self.file, place.clone(), what, instead);
        let file = self.file;
        self.fault
            .get_or_insert_with(|| FileError::at(file, place, problem));
    }

    /// Speaks for the memory of a face's corners, of so many bytes each, before it is known how many are there.
    pub fn claim_corners(&mut self, count: usize, each: u64) -> Result<(), Fault> {
        if count as u64 * each > self.corner_bytes {
            self.limits.memory.claim(CORNERS).map_err(Fault::Final)?;
            self.corner_bytes += CORNERS;
        }
        Ok(())
    }

    /// Speaks for the memory of what there is so far.
    pub fn claim(&mut self, content: &Content) -> Result<(), Fault> {
        let vertices = content.positions.len() as u64;
        let triangles = content.indices.len() as u64 / 3;
        let too_many = |what, count, limit| Problem::TooMany { what, count, limit };
        let limits = self.limits;
        // Indices are 32 bits wide.
        if vertices > limits.vertices.min(u32::MAX.into()) {
            let problem = too_many("vertices", vertices, limits.vertices);
            return Err(Fault::Final(problem));
        }
        if triangles > limits.triangles {
            let problem = too_many("triangles", triangles, limits.triangles);
            return Err(Fault::Final(problem));
        }
        (self.memory)
            .reach(vertices, triangles, 1)
            .map_err(Fault::Final)
    }
}

/// A mesh while it grows. Columns are as long as that of positions, or empty.
#[derive(Default)]
pub(super) struct Content {
    /// Those that the file has come first; those made for faces with colours or texture coordinates of their own after.
    pub positions: Vec<[f32; 3]>,
    pub normals: Vec<[f32; 3]>,
    /// v downwards.
    pub uvs: Vec<[f32; 2]>,
    /// As screens take them, divided by what a channel of 1 is; with alpha, which is linear.
    pub colors: Vec<[f32; 4]>,
    /// What a channel of 1 is, by the numbers' type.
    pub whole: [f64; 4],
    pub indices: Vec<u32>,
    /// What faces said of vertices so far.
    pub own: OwnCorners,
}

impl Content {
    pub fn into_mesh(mut self, work: &mut Work) -> Mesh {
        let is_finite = |position: &[f32; 3]| position.iter().all(|value| value.is_finite());
        // No face uses them.
        for position in self.positions.iter_mut().filter(|p| !is_finite(p)) {
            *position = [0.0; 3];
        }
        let repaired = clear(&mut self.normals) | clear(&mut self.uvs);
        if repaired {
            let what = "normals or texture coordinates that are not finite numbers";
            (work.notes).add(work.file, Place::Whole, what, "0 is taken for them");
        }
        self.settle_colors(work);
        let is_colored = self.colors.iter().any(|&color| color != [1.0; 4]);
        let mut mesh = triangle_mesh(self.positions, self.normals, self.uvs, self.indices);
        if is_colored {
            let linear = |[r, g, b, a]: [f32; 4]| {
                let [r, g, b] = [r, g, b].map(Srgba::gamma_function);
                [r, g, b, a]
            };
            let colors: Vec<[f32; 4]> = self.colors.into_iter().map(linear).collect();
            mesh.insert_attribute(Mesh::ATTRIBUTE_COLOR, colors);
        }
        mesh
    }

    /// Brings colours into [0, 1]. Numbers up to 255 are written in every type, and nothing says so.
    fn settle_colors(&mut self, work: &mut Work) {
        const BYTE: f64 = 255.0;
        let counted = |color: &[f32; 4], i: usize| f64::from(color[i]) * self.whole[i];
        let is_wide = self.whole[..3].iter().all(|&whole| whole > BYTE);
        let channels =
            (self.colors.iter()).flat_map(|color| (0..3).map(move |i| counted(color, i)));
        let largest = channels.fold(0.0, f64::max);
        // Counted again with the rounding of floats.
        if is_wide && (0.5..BYTE + 0.5).contains(&largest) {
            let what = "vertex colours in wide integers, none above 255";
            let instead = "read as numbers up to 255";
            (work.notes).add(work.file, Place::Whole, what, instead);
            for color in &mut self.colors {
                for (channel, whole) in color.iter_mut().zip(self.whole) {
                    let factor = (whole / BYTE).max(1.0) as f32;
                    *channel = (*channel * factor).min(1.0);
                }
            }
        }
        if let Some((what, instead)) = to_unit(&mut self.colors) {
            work.notes.add(work.file, Place::Whole, what, instead);
        }
    }
}

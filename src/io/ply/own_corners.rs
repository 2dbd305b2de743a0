//! What faces of a PLY say of their corners.

use super::super::error::Place;
use super::content::{Content, Work};
use bevy::platform::hash::RandomState;
use std::collections::HashMap;

/// Gives vertices what their faces say of them: colours, texture coordinates. Where faces that share one disagree, each
/// has its own.
#[derive(Default)]
pub(super) struct OwnCorners {
    /// Vertices of the file; those of faces come behind them.
    pub count: usize,
    numbers: HashMap<(u32, [u32; 2], [u32; 4]), u32, RandomState>,
    /// Which of the file's vertices have something of a face.
    is_taken: Vec<bool>,
    has_uvs: bool,
    pub has_colors: bool,
    /// Which of both the faces have that are being read.
    says_uvs: bool,
    says_colors: bool,
    uvs_lack: bool,
}

impl OwnCorners {
    /// Makes room for what the faces that come next have. Those that have less keep what is said of their vertices.
    pub fn expect(&mut self, has_uvs: bool, has_colors: bool, content: &mut Content) {
        let count = content.positions.len();
        // The first time; elements of faces may come in turn.
        if self.is_taken.is_empty() {
            self.count = count;
        }
        (self.says_uvs, self.says_colors) = (has_uvs, has_colors);
        self.has_uvs |= has_uvs;
        self.has_colors |= has_colors;
        if self.has_uvs {
            content.uvs.resize(count, [0.0; 2]);
        }
        if self.has_colors {
            content.colors.resize(count, [1.0; 4]);
        }
        if self.has_uvs || self.has_colors {
            self.is_taken.resize(self.count, false);
        }
    }

    /// Says what faces lack.
    pub fn note(&self, work: &mut Work) {
        if self.uvs_lack {
            let what = "faces without texture coordinates beside others with";
            (work.notes).add(work.file, Place::Whole, what, "theirs are 0 0");
        }
    }

    /// The vertex of a corner.
    pub fn vertex(
        &mut self,
        index: u32,
        uv: Option<&[f64; 2]>,
        color: [f32; 4],
        content: &mut Content,
    ) -> u32 {
        let at = index as usize;
        let says_any = self.says_uvs || self.says_colors;
        let Some(is_taken) = self.is_taken.get_mut(at).filter(|_| says_any) else {
            return index;
        };
        self.uvs_lack |= self.says_uvs && uv.is_none();
        let uv = match self.says_uvs {
            true => uv.map_or([0.0; 2], |&[u, v]| [u as f32, 1.0 - v as f32]),
            false => content.uvs.get(at).copied().unwrap_or_default(),
        };
        let color = match self.says_colors {
            true => color,
            false => content.colors.get(at).copied().unwrap_or([1.0; 4]),
        };
        let key = (index, uv.map(f32::to_bits), color.map(f32::to_bits));
        let next = match *is_taken {
            true => content.positions.len() as u32,
            false => index,
        };
        let known = *self.numbers.entry(key).or_insert(next);
        if known != next {
            return known;
        }
        if *is_taken {
            content.positions.push(content.positions[at]);
            content.normals.extend(content.normals.get(at).copied());
            content.uvs.extend(content.uvs.get(at).copied());
            content.colors.extend(content.colors.get(at).copied());
        }
        *is_taken = true;
        let at = known as usize;
        if self.has_uvs {
            content.uvs[at] = uv;
        }
        if self.has_colors {
            content.colors[at] = color;
        }
        known
    }
}

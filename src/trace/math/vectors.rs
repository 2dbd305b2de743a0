//! Columns of vectors.

use glam::Vec3;
use std::ops::Range;

/// Vectors as three columns of numbers, so that loops over them vectorise.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct Vectors {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
}

impl Vectors {
    pub fn resize(&mut self, count: usize) {
        self.x.resize(count, 0.0);
        self.y.resize(count, 0.0);
        self.z.resize(count, 0.0);
    }

    pub fn get(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    pub fn set(&mut self, i: usize, vector: Vec3) {
        [self.x[i], self.y[i], self.z[i]] = vector.to_array();
    }

    /// Puts the same vector into each place of a range.
    pub fn fill(&mut self, range: Range<usize>, vector: Vec3) {
        for (column, value) in self.slices().into_iter().zip(vector.to_array()) {
            column[range.clone()].fill(value);
        }
    }

    /// Puts the first of other columns into a range.
    pub fn copy_from<const N: usize>(&mut self, range: Range<usize>, columns: &[[f32; N]; 3]) {
        for (to, from) in self.slices().into_iter().zip(columns) {
            let to = &mut to[range.clone()];
            // Of a known length a copy is a move or two.
            match <&mut [f32; N]>::try_from(&mut *to) {
                Ok(to) => *to = *from,
                Err(_) => to.copy_from_slice(&from[..range.len()]),
            }
        }
    }

    pub fn columns(&self) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z]
    }

    pub fn slices(&mut self) -> [&mut [f32]; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }
}

/// A vector of columns of some length.
#[inline(always)]
pub(in crate::trace) fn column_vector<const N: usize>(columns: &[[f32; N]; 3], i: usize) -> Vec3 {
    Vec3::new(columns[0][i], columns[1][i], columns[2][i])
}

/// Puts a vector into columns of some length.
#[inline(always)]
pub(in crate::trace) fn set_column<const N: usize>(
    columns: &mut [[f32; N]; 3],
    i: usize,
    vector: Vec3,
) {
    columns[0][i] = vector.x;
    columns[1][i] = vector.y;
    columns[2][i] = vector.z;
}

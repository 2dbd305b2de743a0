//! Columns of vectors.

use glam::Vec3;

/// Vectors as three columns of numbers, so that loops over them vectorise.
#[derive(Clone, Debug, Default)]
pub(super) struct Vectors {
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

    pub fn slices(&mut self) -> [&mut [f32]; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }
}

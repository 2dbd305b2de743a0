//! Models that lie far from the origin, as those of surveyors do: what 32 bits cannot tell there they can near it.

use super::error::Place;
use super::notes::Notes;
use std::path::Path;

/// Where the first vertex of a model may lie without being far off, in its units: below this, floats tell 0.001 apart.
const NEAR: f64 = 8192.0;
/// A model is far off where it lies at more than so many times its size: of its 24 bits, 10 say the same everywhere.
const SIZES: f64 = 1000.0;

/// What positions lose as floats, kept while a model is read whose first vertex is far from the origin. Others pay
/// nothing.
#[derive(Default)]
pub(crate) struct FarOff {
    /// What is to be added to each position; empty where nothing is kept.
    rests: Vec<[f32; 3]>,
    is_near: bool,
}

impl FarOff {
    /// Whether the next position has to be told, if this is where it lies: the first decides.
    pub fn wants(&mut self, position: [f32; 3]) -> bool {
        let is_finite = position.iter().all(|value| value.is_finite());
        if self.rests.is_empty() && !self.is_near && is_finite {
            self.is_near = position.iter().all(|&value| f64::from(value).abs() < NEAR);
        }
        !self.is_near && is_finite
    }

    /// What the position at `index` is exactly.
    pub fn tell(&mut self, index: usize, exact: [f64; 3], position: [f32; 3]) {
        self.rests.resize(index, [0.0; 3]);
        let rest = |axis: usize| (exact[axis] - f64::from(position[axis])) as f32;
        self.rests.push([0, 1, 2].map(rest));
    }

    /// Moves a model that is far off to the origin, and says so.
    pub fn settle(mut self, positions: &mut [[f32; 3]], file: &Path, notes: &mut Notes) {
        if self.rests.is_empty() {
            return;
        }
        self.rests.resize(positions.len(), [0.0; 3]);
        let (mut least, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for position in positions.iter().filter(|p| p.iter().all(|v| v.is_finite())) {
            for axis in 0..3 {
                least[axis] = least[axis].min(position[axis].into());
                most[axis] = most[axis].max(position[axis].into());
            }
        }
        let middle = [0, 1, 2].map(|axis| f64::midpoint(least[axis], most[axis]).round());
        let size = (0..3).map(|axis| most[axis] - least[axis]);
        let size = size.fold(0.0, f64::max);
        let distance = middle
            .iter()
            .fold(0.0_f64, |far, value| far.max(value.abs()));
        if distance < NEAR || distance < SIZES * size {
            return;
        }
        for (position, rest) in positions.iter_mut().zip(&self.rests) {
            *position = [0, 1, 2].map(|axis| {
                let exact = f64::from(position[axis]) + f64::from(rest[axis]);
                (exact - middle[axis]) as f32
            });
        }
        let [x, y, z] = middle;
        let what = format!("a model that lies far off, around {x} {y} {z}");
        let instead = "moved to the origin, so that no digits are lost";
        notes.add(file, Place::Whole, what, instead);
    }
}

//! Models that lie far from the origin, as those of surveyors do: what 32 bits cannot tell there they can near it.

use super::error::Place;
use super::notes::Notes;
use bevy::math::{DVec3, Vec3};
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
    /// `None` before the first position.
    is_far: Option<bool>,
}

impl FarOff {
    /// Whether all digits of the next position may be needed.
    pub fn may_want(&self) -> bool {
        self.is_far != Some(false)
    }

    /// Whether the next position has to be told, if this is where it lies: the first decides.
    pub fn wants(&mut self, position: [f32; 3]) -> bool {
        let is_far = |value: &f32| f64::from(*value).abs() >= NEAR;
        let is_finite = position.iter().all(|value| value.is_finite());
        is_finite && *(self.is_far).get_or_insert_with(|| position.iter().any(is_far))
    }

    /// What a position lacks.
    pub fn rest(exact: [f64; 3], position: [f32; 3]) -> [f32; 3] {
        [0, 1, 2].map(|axis| (exact[axis] - f64::from(position[axis])) as f32)
    }

    /// What the position at `index` is exactly.
    pub fn tell(&mut self, index: usize, exact: [f64; 3], position: [f32; 3]) {
        self.rests.resize(index, [0.0; 3]);
        self.rests.push(Self::rest(exact, position));
    }

    /// Moves a model that is far off to the origin, and says so. Its positions are those of its parts, one part after
    /// another.
    pub fn settle(mut self, parts: &mut [&mut [[f32; 3]]], file: &Path, notes: &mut Notes) {
        if self.rests.is_empty() {
            return;
        }
        let count = parts.iter().map(|part| part.len()).sum();
        self.rests.resize(count, [0.0; 3]);
        let places = || {
            parts
                .iter()
                .flat_map(|part| part.iter().copied().map(Vec3::from))
        };
        let finite = || places().filter(|place| place.is_finite());
        let bounds = finite().reduce(Vec3::min).zip(finite().reduce(Vec3::max));
        let Some((least, most)) = bounds else {
            return;
        };
        let (least, most) = (least.as_dvec3(), most.as_dvec3());
        let middle = least.midpoint(most).round();
        let (size, distance) = ((most - least).max_element(), middle.abs().max_element());
        if distance < NEAR || distance < SIZES * size {
            return;
        }
        let positions = parts.iter_mut().flat_map(|part| part.iter_mut());
        for (position, &rest) in positions.zip(&self.rests) {
            let exact = Vec3::from(*position).as_dvec3() + Vec3::from(rest).as_dvec3();
            *position = (exact - middle).as_vec3().to_array();
        }
        let DVec3 { x, y, z } = middle;
        let what = format!("a model that lies far off, around {x} {y} {z}");
        let instead = "moved to the origin, so that no digits are lost";
        notes.add(file, Place::Whole, what, instead);
    }
}

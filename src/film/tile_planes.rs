//! A tile's light kept apart: the sums of each plane, and the picture that they are with their tints.

use super::Sum;
use super::tile_state::{Pixels, TILE_PIXELS, half_of};
use super::tiles::FilmPixel;
use crate::trace::PlaneSet;
use crate::trace::planes::OWN;
use glam::Vec3;

/// The planes of a tile.
pub(super) struct TilePlanes(Vec<Plane>);

/// What one plane has.
#[derive(Clone)]
struct Plane {
    /// None before its first samples, so that its memory is written before it is read.
    sums: Box<[Sum]>,
    /// How far each pixel's mean moved when its samples doubled last; none before they did.
    moved: Box<[[f32; 3]]>,
    /// Samples of each pixel of each half.
    counts: [u32; 2],
}

/// What a pixel of a plane takes.
pub(super) const PLANE_BYTES: usize = size_of::<Sum>() + size_of::<[f32; 3]>();

impl Plane {
    fn empty() -> Self {
        Self {
            sums: Box::default(),
            moved: Box::default(),
            counts: [0; 2],
        }
    }

    fn sum(&self, at: usize) -> Sum {
        self.sums.get(at).copied().unwrap_or_default()
    }

    /// Adds `count` samples to these pixels.
    fn add(&mut self, pixels: Pixels, sums: &[Sum], count: u32) {
        let doubles = |half: usize| self.counts[half] == count;
        if doubles(0) || doubles(1) {
            if self.moved.is_empty() {
                self.moved = vec![[0.0; 3]; TILE_PIXELS].into();
            }
            let places = (0..TILE_PIXELS).filter(|at| pixels.has(*at) && doubles(half_of(*at)));
            for at in places {
                let moved = self.sums[at].half_difference(&sums[at], count);
                self.moved[at] = moved.map(|moved| moved as f32);
            }
        }
        if self.sums.is_empty() {
            let each = sums.iter().enumerate();
            let sum = |(at, sum): (usize, &Sum)| {
                if pixels.has(at) { *sum } else { Sum::default() }
            };
            self.sums = each.map(sum).collect();
        } else {
            for at in (0..TILE_PIXELS).filter(|at| pixels.has(*at)) {
                self.sums[at].merge(&sums[at]);
            }
        }
        for half in (0..2).filter(|half| pixels.has_half(*half)) {
            self.counts[half] += count;
        }
    }
}

impl TilePlanes {
    pub fn new(count: usize) -> Self {
        Self(vec![Plane::empty(); count])
    }

    /// Adds `count` samples to these planes of these pixels. `sums` has `TILE_PIXELS` for each plane of the film.
    pub fn add(&mut self, pixels: Pixels, planes: PlaneSet, sums: &[Sum], count: u32) {
        let each = self.0.iter_mut().zip(sums.chunks_exact(TILE_PIXELS));
        for (number, (plane, sums)) in each.enumerate() {
            if planes.has(number) {
                plane.add(pixels, sums, count);
            }
        }
    }

    /// The pixel's sum as if every plane had the samples of its own light, and how far its mean moved when they doubled
    /// last: squared, averaged over the channels.
    pub fn fold(&self, at: usize, tints: &[Vec3]) -> (Sum, f32) {
        let half = half_of(at);
        let count = self.0[OWN].counts[half];
        let mut sum = Sum::default();
        let mut moved = Vec3::ZERO;
        for (plane, tint) in self.0.iter().zip(tints) {
            let stretch = f64::from(count) / f64::from(plane.counts[half].max(1));
            sum.merge_scaled(&plane.sum(at), tint.as_dvec3() * stretch);
            moved += plane
                .moved
                .get(at)
                .map_or(Vec3::ZERO, |moved| *tint * Vec3::from_array(*moved));
        }
        (sum, moved.length_squared() / 3.0)
    }

    /// The mean of a pixel's samples in one plane, without its tint.
    pub fn mean(&self, plane: usize, at: usize) -> Vec3 {
        let plane = &self.0[plane];
        plane.sum(at).mean(plane.counts[half_of(at)])
    }

    /// Writes the picture that the planes are with these tints into all pixels that have samples. The moves before the
    /// last are scaled as the last one is: no more is known of them.
    pub fn retint(&self, pixels: &mut [FilmPixel], tints: &[Vec3]) {
        for (at, pixel) in pixels.iter_mut().enumerate() {
            if pixel.count == 0 {
                continue;
            }
            let (sum, moved) = self.fold(at, tints);
            pixel.sum = sum;
            let [last, ..] = pixel.moved;
            if last.is_finite() && last > 0.0 {
                let scale = moved / last;
                pixel.moved = pixel.moved.map(|before| before * scale);
            }
            if last.is_finite() {
                pixel.moved[0] = moved;
            }
        }
    }

    /// The planes of an edited scene: of each the one of this number before, or none yet.
    pub fn rearrange(&mut self, from: &[Option<usize>]) {
        let mut before: Vec<Option<Plane>> = self.0.drain(..).map(Some).collect();
        self.0 = from
            .iter()
            .map(|plane| plane.and_then(|plane| before[plane].take()))
            .map(|plane| plane.unwrap_or_else(Plane::empty))
            .collect();
    }

    /// Whether some plane has no sample yet of pixels of which its own light has.
    pub fn lacks_light(&self) -> bool {
        (0..2).any(|half| {
            let own = self.0[OWN].counts[half];
            own > 0 && self.0.iter().any(|plane| plane.counts[half] == 0)
        })
    }

    /// Planes of a half that have fewer samples than its own light: those that have fewest, and how many, and how many they
    /// should have.
    pub fn behind(&self, half: usize) -> Option<(PlaneSet, u32, u32)> {
        let goal = self.0[OWN].counts[half];
        let fewest = self.0.iter().map(|plane| plane.counts[half]).min()?;
        if fewest == goal {
            return None;
        }
        let planes = self.0.iter().enumerate();
        let last = planes.filter(|(_, plane)| plane.counts[half] == fewest);
        let set = last.fold(PlaneSet::NONE, |set, (number, _)| set.with(number));
        Some((set, fewest, goal))
    }
}

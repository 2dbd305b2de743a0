//! The first pictures: sample 0 of every d-th pixel of every d-th row, then of every d/2-th, and so
//! on. The pixels of a coarser picture are among those of a finer one, and all of them are samples
//! that the film will want, so a coarse start costs no ray.

use super::sample_chunk::{BatchSize, Subject, with_scratch};
use crate::trace::{RayCounts, SampleId};
use glam::{UVec2, Vec2, Vec3};
use std::time::{Duration, Instant};

/// The first picture should be there after this long, in seconds.
const FIRST_PICTURE: f64 = 1.0 / 30.0;
/// The coarsest picture, as long as its long side keeps `LEAST_SIDE` pixels.
const COARSEST: u32 = 32;
const LEAST_SIDE: u32 = 64;
/// Samples that are timed to choose the first divider, unless fewer take long enough.
const TIMED: usize = 64;
const BATCH: usize = 8;
const LONG_ENOUGH: Duration = Duration::from_millis(4);

/// Sample 0 of the pixels where it is known.
pub(super) struct Preview {
    size: UVec2,
    values: Vec<Option<Vec3>>,
}

impl Preview {
    pub fn new(size: UVec2) -> Self {
        Self {
            size,
            values: vec![None; size.x as usize * size.y as usize],
        }
    }

    fn place(&self, pixel: UVec2) -> usize {
        pixel.y as usize * self.size.x as usize + pixel.x as usize
    }

    pub fn get(&self, pixel: UVec2) -> Option<Vec3> {
        self.values[self.place(pixel)]
    }

    pub fn set(&mut self, pixel: UVec2, value: Vec3) {
        let place = self.place(pixel);
        self.values[place] = Some(value);
    }

    /// What the pixel shows: its own sample 0, or the nearest on the finest lattice that has one there.
    pub fn shown(&self, pixel: UVec2) -> Option<Vec3> {
        let mut divider = 1;
        while divider <= COARSEST {
            let nearest = (pixel + divider / 2) / divider * divider;
            let last = (self.size - 1) / divider * divider;
            if let Some(value) = self.get(nearest.min(last)) {
                return Some(value);
            }
            divider *= 2;
        }
        None
    }
}

/// The coarsest divider for a picture of this size: a power of two.
pub(super) fn coarsest_divider(size: UVec2) -> u32 {
    let mut divider = 1;
    while divider < COARSEST && size.max_element() / (2 * divider) >= LEAST_SIDE {
        divider *= 2;
    }
    divider
}

/// The divider with which the first picture takes at most [`FIRST_PICTURE`] where a sample takes
/// `seconds`, all threads together.
pub(super) fn first_divider(size: UVec2, seconds: f64) -> u32 {
    let mut divider = 1;
    while divider < coarsest_divider(size) {
        let samples = size
            .map(|n| n.div_ceil(divider))
            .as_dvec2()
            .element_product();
        if samples * seconds <= FIRST_PICTURE {
            break;
        }
        divider *= 2;
    }
    divider
}

/// The pixels of the lattice of `divider` in a square of `side · divider` pixels.
pub(super) fn lattice(
    size: UVec2,
    square: UVec2,
    side: u32,
    divider: u32,
) -> impl Iterator<Item = UVec2> {
    let origin = square * side;
    let count = (size.map(|n| n.div_ceil(divider)) - origin).min(UVec2::splat(side));
    (0..count.y)
        .flat_map(move |y| (0..count.x).map(move |x| origin + UVec2::new(x, y)))
        .map(move |at| at * divider)
}

/// Seconds that a sample takes on one thread, from some of the coarsest lattice's near `focus`,
/// which are kept, and the rays that they took.
pub(super) fn time_samples(
    subject: &Subject,
    preview: &mut Preview,
    focus: Vec2,
    batch: &BatchSize,
) -> (f64, RayCounts) {
    let size = preview.size;
    let divider = coarsest_divider(size);
    let mut pixels: Vec<_> = lattice(size, UVec2::ZERO, u32::MAX, divider).collect();
    pixels.sort_by_key(|pixel| pixel.as_vec2().distance_squared(focus).to_bits());
    let start = Instant::now();
    let mut rays = RayCounts::default();
    let mut timed = 0;
    with_scratch(|scratch| {
        for some in pixels[..pixels.len().min(TIMED)].chunks(BATCH) {
            let ids = some.iter().map(|&pixel| SampleId { pixel, index: 0 });
            rays += scratch.evaluate(subject, ids, batch);
            for (pixel, value) in some.iter().zip(scratch.values()) {
                preview.set(*pixel, *value);
            }
            timed += some.len();
            if start.elapsed() > LONG_ENOUGH {
                break;
            }
        }
    });
    (start.elapsed().as_secs_f64() / timed.max(1) as f64, rays)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn a_lattices_squares_hold_each_of_its_pixels_once_and_finer_ones_hold_the_coarser() {
        for size in [UVec2::new(130, 70), UVec2::new(1, 1), UVec2::new(64, 3)] {
            let mut coarser = HashSet::new();
            for divider in [8, 4, 2, 1] {
                let mut pixels = HashSet::new();
                let squares = size.map(|n| n.div_ceil(divider).div_ceil(16));
                for y in 0..squares.y {
                    for x in 0..squares.x {
                        for pixel in lattice(size, UVec2::new(x, y), 16, divider) {
                            assert!(pixel.x < size.x && pixel.y < size.y);
                            assert!(pixels.insert(pixel), "{pixel} twice");
                        }
                    }
                }
                assert!(coarser.is_subset(&pixels), "{size} / {divider}");
                let expected = size.map(|n| n.div_ceil(divider)).element_product();
                assert_eq!(pixels.len() as u32, expected);
                coarser = pixels;
            }
        }
    }

    #[test]
    fn a_pixel_shows_the_nearest_that_is_known() {
        let size = UVec2::new(70, 40);
        let mut preview = Preview::new(size);
        assert_eq!(preview.shown(UVec2::new(3, 3)), None);
        for pixel in lattice(size, UVec2::ZERO, 100, 8) {
            preview.set(pixel, pixel.as_vec2().extend(0.0));
        }
        for (pixel, shown) in [((3, 3), (0, 0)), ((4, 11), (8, 8)), ((69, 39), (64, 32))] {
            let shown = UVec2::from(shown).as_vec2().extend(0.0);
            assert_eq!(preview.shown(UVec2::from(pixel)), Some(shown), "{pixel:?}");
        }
        preview.set(UVec2::new(3, 3), Vec3::ONE);
        assert_eq!(preview.shown(UVec2::new(3, 3)), Some(Vec3::ONE));
    }

    #[test]
    fn the_first_picture_is_as_fine_as_its_time_allows() {
        let size = UVec2::new(800, 800);
        assert_eq!(first_divider(size, 1e-9), 1);
        // 640,000 samples of a microsecond take 0.64 s; a 25th of them fits, 1/16 takes 40 ms.
        assert_eq!(first_divider(size, 1e-6), 8);
        assert_eq!(first_divider(size, 0.4e-6), 4);
        assert_eq!(first_divider(size, 1.0), coarsest_divider(size));
        assert_eq!(coarsest_divider(size), 8);
        assert_eq!(coarsest_divider(UVec2::new(4096, 100)), 32);
        assert_eq!(coarsest_divider(UVec2::new(9, 9)), 1);
    }
}

//! The first pictures: sample 0 of every d-th pixel of every d-th row, then of every d/2-th, and so
//! on. The pixels of a coarser picture are among those of a finer one, so those down to every fourth cost a fifteenth of a
//! sample of all. The film takes them again: it keeps lights apart, and sums each sample exactly.

use crate::film::TILE;
use crate::film::samples::sample_chunk::{BatchSize, with_scratch};
use crate::film::subject::Subject;
use crate::film::sums::tiles::Tile;
use crate::trace::{PlaneSet, SampleId};
use glam::{UVec2, Vec2, Vec3};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::{Duration, Instant};

/// Tracing the first picture should take this long, in seconds: two frames of a screen, 33 ms, have
/// to hold besides what is done before and after it.
const FIRST_PICTURE: f64 = 0.008;
/// The coarsest picture, as long as its long side keeps `LEAST_SIDE` pixels.
const COARSEST: u32 = 32;
const LEAST_SIDE: u32 = 64;
/// Samples that are timed to choose the first divider, unless fewer take long enough.
const TIMED: usize = 64;
const BATCH: usize = 8;
const LONG_ENOUGH: Duration = Duration::from_millis(4);

/// Sample 0 of the pixels where it is known. Threads write and read it without waiting for one another: who
/// draws the first picture would wait for a tracing thread's time slice each time that it met one.
pub(super) struct Preview {
    area: Tile,
    /// Those that have begun; every 2^i-th pixel of every 2^i-th row is in number i.
    lattices: [OnceLock<Lattice>; COARSEST.ilog2() as usize + 1],
    /// The finest lattice that has begun.
    divider: AtomicU32,
    /// Counts how often it has changed.
    version: AtomicU32,
}

/// Its pixels row by row, but for those that were known before it began: they are in a coarser one.
type Lattice = Box<[OnceLock<Vec3>]>;

impl Preview {
    /// Of the pixels of this rectangle. The coarsest lattice begins.
    pub fn new(area: Tile) -> Self {
        let preview = Self {
            area,
            lattices: Default::default(),
            divider: AtomicU32::new(1),
            version: AtomicU32::new(0),
        };
        preview.begin(coarsest_divider(area.extent));
        preview
    }

    /// What comes from now on is of this lattice.
    pub fn begin(&self, divider: u32) {
        let pixels = self.size(divider).element_product() as usize;
        let unknown = || (0..pixels).map(|_| OnceLock::new()).collect();
        self.lattices[divider.ilog2() as usize].get_or_init(unknown);
        self.divider.store(divider, Ordering::Release);
    }

    /// Columns and rows of a lattice.
    fn size(&self, divider: u32) -> UVec2 {
        self.area.extent.map(|n| n.div_ceil(divider))
    }

    /// Where a lattice that has begun keeps this one of its pixels.
    fn cell(&self, divider: u32, place: UVec2) -> Option<&OnceLock<Vec3>> {
        let UVec2 { x, y } = place / divider;
        let lattice = self.lattices[divider.ilog2() as usize].get()?;
        lattice.get((y * self.size(divider).x + x) as usize)
    }

    pub fn get(&self, pixel: UVec2) -> Option<Vec3> {
        let place = pixel - self.area.origin;
        let first = self.divider.load(Ordering::Acquire);
        // A pixel is on every lattice that is coarser, up to its last.
        let has = |d: &u32| *d <= COARSEST && (place.x | place.y).is_multiple_of(*d);
        std::iter::successors(Some(first), |divider| Some(2 * divider))
            .take_while(has)
            .find_map(|divider| self.cell(divider, place)?.get().copied())
    }

    /// Takes the values of pixels of the finest lattice.
    pub fn take(&self, pixels: &[UVec2], values: &[Vec3]) {
        let divider = self.divider.load(Ordering::Acquire);
        for (pixel, value) in pixels.iter().zip(values) {
            if let Some(cell) = self.cell(divider, pixel - self.area.origin) {
                // Who computes one again has the same.
                let _ = cell.set(*value);
            }
        }
        self.version.fetch_add(1, Ordering::Release);
    }

    /// Is another one after every change, and 0 before the first.
    pub fn version(&self) -> u32 {
        self.version.load(Ordering::Acquire)
    }

    /// Squares of so many pixels, from a tile's corner on, show one and the same: half a lattice's
    /// distance, because a lattice's pixel stands in the middle of those that show it.
    pub fn side(&self) -> u32 {
        (self.divider.load(Ordering::Acquire) / 2).clamp(1, TILE)
    }

    /// Pixels from one of the finest lattice to the next.
    pub fn step(&self) -> u32 {
        self.divider.load(Ordering::Acquire)
    }

    /// The pixel of the finest lattice, left of a pixel and above it, and what is shown there, one to the right, one below,
    /// and at both. `None` where not all of them are known.
    pub fn corners(&self, pixel: UVec2) -> Option<(UVec2, [Vec3; 4])> {
        let step = self.step();
        let within = (pixel - self.area.origin) & UVec2::splat(step - 1);
        let corner = pixel - within;
        let [right, below] = [UVec2::new(step, 0), UVec2::new(0, step)];
        let at = |offset| self.shown(corner + offset);
        let all = [at(UVec2::ZERO)?, at(right)?, at(below)?, at(right + below)?];
        Some((corner, all))
    }

    /// What the pixel shows: the nearest on the finest lattice that has one there.
    pub fn shown(&self, pixel: UVec2) -> Option<Vec3> {
        let place = pixel - self.area.origin;
        let mut divider = self.divider.load(Ordering::Acquire);
        while divider <= COARSEST {
            // The divider is a power of two.
            let on_lattice = |n: UVec2| n & UVec2::splat(!(divider - 1));
            let nearest = on_lattice(place + divider / 2);
            let last = on_lattice(self.area.extent - 1);
            let value = self.get(self.area.origin + nearest.min(last));
            if value.is_some() {
                return value;
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

/// The pixels of the area's lattice of `divider` in a square of `side · divider` pixels.
pub(super) fn lattice(
    area: Tile,
    square: UVec2,
    side: u32,
    divider: u32,
) -> impl Iterator<Item = UVec2> {
    let origin = square * side;
    let count = (area.extent.map(|n| n.div_ceil(divider)) - origin).min(UVec2::splat(side));
    (0..count.y)
        .flat_map(move |y| (0..count.x).map(move |x| origin + UVec2::new(x, y)))
        .map(move |at| area.origin + at * divider)
}

/// The squares of 16 × 16 pixels of a lattice over an area of this size.
pub(super) fn lattice_squares(size: UVec2, divider: u32) -> Vec<UVec2> {
    let count = size.map(|n| n.div_ceil(divider).div_ceil(TILE));
    (0..count.y)
        .flat_map(|y| (0..count.x).map(move |x| UVec2::new(x, y)))
        .collect()
}

/// Seconds that a sample takes on one thread, from some of the coarsest lattice's near `focus`, which are kept; fewer of them
/// where it is stopped.
pub(super) fn time_samples(
    subject: &Subject,
    preview: &Preview,
    focus: Vec2,
    batch: &BatchSize,
    stopped: &dyn Fn() -> bool,
) -> f64 {
    let area = preview.area;
    let divider = coarsest_divider(area.extent);
    let mut pixels: Vec<_> = lattice(area, UVec2::ZERO, u32::MAX, divider).collect();
    if pixels.len() > TIMED {
        let from_focus = |pixel: &UVec2| pixel.as_vec2().distance_squared(focus).to_bits();
        pixels.select_nth_unstable_by_key(TIMED, from_focus);
        pixels.truncate(TIMED);
    }
    let start = Instant::now();
    let mut timed = 0;
    with_scratch(|scratch| {
        for some in pixels.chunks(BATCH) {
            let ids = some.iter().map(|&pixel| SampleId { pixel, index: 0 });
            let taken = scratch.evaluate(subject, PlaneSet::ALL, ids, batch, stopped);
            if taken.is_none() {
                break;
            }
            preview.take(some, scratch.folded());
            timed += some.len();
            if start.elapsed() > LONG_ENOUGH {
                break;
            }
        }
    });
    start.elapsed().as_secs_f64() / timed.max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    fn area(x: u32, y: u32, width: u32, height: u32) -> Tile {
        Tile {
            origin: UVec2::new(x, y),
            extent: UVec2::new(width, height),
        }
    }

    #[test]
    fn a_lattices_squares_hold_each_of_its_pixels_once_and_finer_ones_hold_the_coarser() {
        for area in [
            area(0, 0, 130, 70),
            area(0, 0, 1, 1),
            area(0, 0, 64, 3),
            area(16, 48, 33, 70),
        ] {
            let size = area.extent;
            let mut coarser = HashSet::new();
            for divider in [8, 4, 2, 1] {
                let mut pixels = HashSet::new();
                for square in lattice_squares(size, divider) {
                    for pixel in lattice(area, square, 16, divider) {
                        assert!(pixel.cmpge(area.origin).all(), "{pixel}");
                        assert!(pixel.cmplt(area.origin + size).all(), "{pixel}");
                        assert!(pixels.insert(pixel), "{pixel} twice");
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
        for origin in [UVec2::ZERO, UVec2::new(32, 16)] {
            let area = area(origin.x, origin.y, 70, 40);
            let preview = Preview::new(area);
            assert_eq!(preview.shown(origin + 3), None);
            let value = |pixel: UVec2| pixel.as_vec2().extend(0.0);
            for divider in [16, 8] {
                preview.begin(divider);
                for pixel in lattice(area, UVec2::ZERO, 100, divider) {
                    preview.take(&[pixel], &[value(pixel)]);
                }
            }
            for (pixel, shown) in [((3, 3), (0, 0)), ((4, 11), (8, 8)), ((69, 39), (64, 32))] {
                let shown = value(origin + UVec2::from(shown));
                let pixel = origin + UVec2::from(pixel);
                assert_eq!(preview.shown(pixel), Some(shown), "{pixel:?}");
            }
            // A finer lattice has begun, and has only this one yet.
            preview.begin(4);
            preview.take(&[origin + 4], &[Vec3::ONE]);
            assert_eq!(preview.shown(origin + 3), Some(Vec3::ONE));
            assert_eq!(preview.shown(origin + 1), Some(value(origin)));
            assert_eq!(preview.shown(origin + 9), Some(value(origin + 8)));
        }
    }

    #[test]
    fn whoever_looks_while_others_write_sees_values_of_the_pixels_that_have_one() {
        let area = area(16, 32, 130, 70);
        let preview = Preview::new(area);
        preview.begin(4);
        let value = |pixel: UVec2| pixel.as_vec2().extend(1.0);
        let squares = lattice_squares(area.extent, 4);
        let written = AtomicU32::new(0);
        std::thread::scope(|threads| {
            for half in 0..2 {
                let (preview, squares, written) = (&preview, &squares, &written);
                threads.spawn(move || {
                    for square in squares.iter().skip(half).step_by(2) {
                        for pixel in lattice(area, *square, TILE, 4) {
                            preview.take(&[pixel], &[value(pixel)]);
                        }
                    }
                    written.fetch_add(1, Ordering::Release);
                });
            }
            while written.load(Ordering::Acquire) < 2 {
                for pixel in lattice(area, UVec2::ZERO, u32::MAX, 3) {
                    let shown = preview.shown(pixel);
                    let near =
                        |v: Vec3| v.z == 1.0 && v.truncate().distance(pixel.as_vec2()) < 46.0;
                    assert!(shown.is_none_or(near), "{pixel} shows {shown:?}");
                }
            }
        });
        let all: Vec<_> = lattice(area, UVec2::ZERO, u32::MAX, 4).collect();
        assert!(all.iter().all(|&at| preview.get(at) == Some(value(at))));
        assert_eq!(preview.version() as usize, all.len());
    }

    #[test]
    fn the_first_picture_is_as_fine_as_its_time_allows() {
        let size = UVec2::new(800, 800);
        assert_eq!(first_divider(size, 1e-9), 1);
        // 640,000 samples of a microsecond take 640 ms: 1/64 of them takes 10 ms, 1/16 takes 40 ms; 8 are given.
        assert_eq!(first_divider(size, 0.79e-6), 8);
        assert_eq!(first_divider(size, 0.19e-6), 4);
        assert_eq!(first_divider(size, 1.0), coarsest_divider(size));
        assert_eq!(coarsest_divider(size), 8);
        assert_eq!(coarsest_divider(UVec2::new(4096, 100)), 32);
        assert_eq!(coarsest_divider(UVec2::new(9, 9)), 1);
    }
}

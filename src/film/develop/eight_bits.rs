//! What a screen gets: 8 bits a channel, many times a second, so the curves are read from tables.
//!
//! Both tables are indexed by the upper half of a number's bits: 128 places between a power of two and
//! the next, so they are finest where numbers are small, as the curves ask for.

use super::agx::{INSET, LARGEST, OUTSET, STOPS, curve};
use super::bloom::with_bloom;
use crate::film::Picture;
use crate::scene::{Output, ViewTransform};
use crate::trace::srgb;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// The picture as [`develop`](super::view_transform::develop()) makes it, each value rounded to the nearest of 256:
/// red, green, blue and an opaque alpha, row by row from the top, on the current rayon pool.
///
/// What rounding `develop`'s values gives for `Raw` and `Srgb`; for `AgX` a value that lies between two
/// steps may take the other one.
pub fn develop_rgba8(picture: &Picture, output: &Output) -> Vec<u8> {
    let bloomed;
    let picture = if output.bloom.enabled {
        bloomed = with_bloom(picture, &output.bloom);
        &bloomed
    } else {
        picture
    };
    let gain = output.exposure.exp2();
    match output.view_transform {
        ViewTransform::Raw => rgba(picture, |row, shown| Steps::raw().row(row, gain, shown)),
        ViewTransform::Srgb => rgba(picture, |row, shown| Steps::srgb().row(row, gain, shown)),
        ViewTransform::AgX => rgba(picture, |row, shown| Curve::agx().row(row, gain, shown)),
    }
}

/// Rows that one thread develops in one go.
const ROWS: usize = 8;

/// Develops a picture row by row.
fn rgba(picture: &Picture, develop: impl Fn(&[Vec3], &mut [[u8; 4]]) + Sync) -> Vec<u8> {
    let mut bytes = vec![0; 4 * picture.pixels.len()];
    let width = picture.width.max(1) as usize;
    let shown = bytes.as_chunks_mut::<4>().0;
    (shown.par_chunks_mut(ROWS * width))
        .zip(picture.pixels.par_chunks(ROWS * width))
        .for_each(|(shown, pixels)| {
            let mut above: Option<(&[Vec3], &mut [[u8; 4]])> = None;
            for (row, shown) in pixels.chunks(width).zip(shown.chunks_mut(width)) {
                match above {
                    // A coarse picture has the same row many times over.
                    Some((same, shown_same)) if same == row => shown.copy_from_slice(shown_same),
                    _ => develop(row, shown),
                }
                above = Some((row, shown));
            }
        });
    bytes
}

/// The nearest of 256; what is out of range saturates, and not a number becomes 0.
fn rounded(value: f32) -> u8 {
    (value * 255.0 + 0.5) as u8
}

/// A rising curve over [0, 1], rounded to 256 steps, exactly.
struct Steps {
    /// By the upper half of a number's bits, from [`LOWEST`] on: in the upper half of an entry the step of
    /// the smallest number with this half; in the lower one what it takes, added to a number's lower half,
    /// for the sum to carry over into the next step where the number is of that one. A
    /// half's numbers are of two steps at most.
    table: Box<[u32; PLACES]>,
}

const ONE: u32 = 1.0_f32.to_bits();
/// The bits of 2^-13, below which all numbers are of the first step: the table fits the first-level cache.
const LOWEST: u32 = (1.0_f32 / 8192.0).to_bits();
/// A power of two, so that no place has to be compared with the table's length.
const PLACES: usize = (((ONE - LOWEST) >> 16) as usize + 1).next_power_of_two();

impl Steps {
    fn raw() -> &'static Self {
        static STEPS: OnceLock<Steps> = OnceLock::new();
        STEPS.get_or_init(|| Self::new(|x| x))
    }

    fn srgb() -> &'static Self {
        static STEPS: OnceLock<Steps> = OnceLock::new();
        STEPS.get_or_init(|| Self::new(srgb::encode))
    }

    fn new(curve: impl Fn(f32) -> f32) -> Self {
        let first = first_of_steps(curve);
        let mut table = Box::new([0; PLACES]);
        for (half, entry) in (LOWEST >> 16..=ONE >> 16).zip(table.iter_mut()) {
            let step = first.partition_point(|&first| first <= half << 16) - 1;
            let next = first
                .get(step + 1)
                .map_or(1 << 16, |&next| (next - (half << 16)).min(1 << 16));
            *entry = ((step as u32) << 16) + (1 << 16) - next;
        }
        Self { table }
    }

    /// Several pixels at once, and one thing after the other, so that the compiler computes in SIMD all that
    /// is not a look into the table: two thirds of the time.
    fn row(&self, row: &[Vec3], gain: f32, shown: &mut [[u8; 4]]) {
        let (groups, rest) = row.as_chunks::<LANES>();
        let (shown_groups, shown_rest) = shown.as_chunks_mut::<LANES>();
        for (pixels, shown) in groups.iter().zip(shown_groups) {
            let places = pixels.map(|linear| (linear * gain).to_array().map(place));
            let steps = places.map(|places| places.map(|place| self.at(place)));
            *shown = steps.map(opaque);
        }
        for (linear, shown) in rest.iter().zip(shown_rest) {
            *shown = opaque((linear * gain).to_array().map(|x| self.at(place(x))));
        }
    }

    #[inline(always)]
    fn at(&self, place: u32) -> u32 {
        (self.table[(place >> 16) as usize % PLACES] + (place & 0xffff)) >> 16
    }
}

/// Where a number stands in the table of [`Steps`], in its upper half; not a number stands where 0 does.
#[inline(always)]
fn place(x: f32) -> u32 {
    x.max(f32::from_bits(LOWEST)).min(1.0).to_bits() - LOWEST
}

/// A pixel of these three steps.
#[inline(always)]
fn opaque([red, green, blue]: [u32; 3]) -> [u8; 4] {
    (red | green << 8 | blue << 16 | 255 << 24).to_le_bytes()
}

/// The bits of the smallest number in [0, 1] of each step of a rising curve.
fn first_of_steps(curve: impl Fn(f32) -> f32) -> [u32; 256] {
    std::array::from_fn(|step| {
        // The bits of numbers that are not negative are ordered as they are.
        let (mut low, mut high) = (0, ONE);
        while low < high {
            let middle = low + (high - low) / 2;
            if usize::from(rounded(curve(f32::from_bits(middle)))) < step {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        low
    })
}

/// AgX's curve over the light that it tells apart, linear between the places of its table: its
/// error, below 1e-5, is far below a step.
struct Curve {
    /// Upper half of the bits of the first place.
    first: u32,
    values: Vec<f32>,
}

impl Curve {
    fn agx() -> &'static Self {
        static CURVE: OnceLock<Curve> = OnceLock::new();
        CURVE.get_or_init(|| {
            let [first, last] = STOPS.map(|stop| stop.exp2().to_bits() >> 16);
            Self {
                first,
                // One beyond the number after the last.
                values: (first..=last + 2)
                    .map(|half| curve(f32::from_bits(half << 16)))
                    .collect(),
            }
        })
    }

    /// As [`agx`](super::agx::agx()) has it, but several pixels at once and channel by channel, so that
    /// the compiler computes in SIMD all that is not a look into the table: four times as fast.
    fn row(&self, row: &[Vec3], gain: f32, shown: &mut [[u8; 4]]) {
        let [inset, outset] = [INSET, OUTSET].map(|matrix| matrix.to_cols_array_2d());
        for (pixels, shown) in row.chunks(LANES).zip(shown.chunks_mut(LANES)) {
            let mut channels = [[0.0; LANES]; 3];
            for (i, pixel) in pixels.iter().enumerate() {
                for (channel, value) in channels.iter_mut().zip(pixel.to_array()) {
                    channel[i] = value;
                }
            }
            for value in channels.as_flattened_mut() {
                let light = *value * gain;
                *value = if light > 0.0 { light.min(LARGEST) } else { 0.0 };
            }
            channels = mixed(&inset, &channels).map(|light| self.values_at(light));
            let mut rgba = [u32::from_le_bytes([0, 0, 0, 255]); LANES];
            for (channel, shift) in mixed(&outset, &channels).iter().zip([0, 8, 16]) {
                for (rgba, value) in rgba.iter_mut().zip(channel) {
                    // The nearest of 256: beyond 2^23 the numbers' last bits are whole numbers.
                    let step = value.clamp(0.0, 1.0) * 255.0 + (1 << 23) as f32;
                    *rgba |= (step.to_bits() & 0xff) << shift;
                }
            }
            for (shown, rgba) in shown.iter_mut().zip(rgba) {
                *shown = rgba.to_le_bytes();
            }
        }
    }

    /// What the curve has at each of these.
    #[inline(always)]
    fn values_at(&self, mut light: [f32; LANES]) -> [f32; LANES] {
        let low = self.first << 16;
        let high = (self.first + self.values.len() as u32 - 2) << 16;
        let [least, most] = [low, high].map(f32::from_bits);
        let mut places = [0; LANES];
        for (place, light) in places.iter_mut().zip(light) {
            *place = light.max(least).min(most).to_bits() - low;
        }
        let mut after = [0.0; LANES];
        for (i, place) in places.iter().enumerate() {
            let place = (place >> 16) as usize;
            [light[i], after[i]] = [self.values[place], self.values[place + 1]];
        }
        for (i, place) in places.iter().enumerate() {
            let between = (place & 0xffff) as i32 as f32 * (1.0 / 65536.0);
            light[i] += (after[i] - light[i]) * between;
        }
        light
    }
}

/// Pixels that are computed at once.
const LANES: usize = 16;

/// A matrix, given by its columns, times each of these vectors.
#[inline(always)]
fn mixed(columns: &[[f32; 3]; 3], channels: &[[f32; LANES]; 3]) -> [[f32; LANES]; 3] {
    let mut mixed = [[0.0; LANES]; 3];
    for (row, mixed) in mixed.iter_mut().enumerate() {
        for (i, mixed) in mixed.iter_mut().enumerate() {
            let terms = [0, 1, 2].map(|column: usize| columns[column][row] * channels[column][i]);
            *mixed = terms[0] + terms[1] + terms[2];
        }
    }
    mixed
}

#[cfg(test)]
mod tests {
    use super::super::view_transform::develop;
    use super::*;
    use crate::scene::Bloom;
    use glam::UVec2;
    use proptest::prelude::*;

    /// What `develop` gives, rounded.
    fn expected(picture: &Picture, output: &Output) -> Vec<u8> {
        let shown = develop(picture, output).into_iter();
        shown
            .flat_map(|[r, g, b]| [rounded(r), rounded(g), rounded(b), 255])
            .collect()
    }

    /// Every number between 2^-20 and 2 whose lower bits are one of a few, what lies beside every
    /// step, and what is out of range.
    fn numbers() -> Vec<f32> {
        let steps = [first_of_steps(|x| x), first_of_steps(srgb::encode)];
        let beside = steps
            .iter()
            .flat_map(|steps| &steps[1..])
            .flat_map(|&first| [first - 9, first - 1, first, first + 1, first + 9]);
        let halves = (1e-6_f32.to_bits() >> 16)..(2.0_f32.to_bits() >> 16);
        let all = halves.flat_map(|half| [0, 1, 0x7fff, 0xffff].map(|low| half << 16 | low));
        let odd = [0.0, -0.0, -1.0, 1e-45, 1e30, f32::NAN, f32::INFINITY];
        (beside.chain(all).map(f32::from_bits)).chain(odd).collect()
    }

    fn picture(numbers: &[f32]) -> Picture {
        let mut picture = Picture::black(UVec2::new(61, (numbers.len() / 61 + 1) as u32));
        for (pixel, number) in picture.pixels.iter_mut().zip(numbers) {
            *pixel = Vec3::splat(*number);
        }
        picture
    }

    #[test]
    fn raw_and_srgb_are_what_rounding_the_developed_picture_gives() {
        let picture = picture(&numbers());
        for view_transform in [ViewTransform::Raw, ViewTransform::Srgb] {
            for exposure in [0.0, 1.3, -2.0] {
                let output = Output {
                    exposure,
                    view_transform,
                    ..Output::default()
                };
                let shown = develop_rgba8(&picture, &output);
                assert!(
                    shown == expected(&picture, &output),
                    "{view_transform:?}, exposure {exposure}"
                );
            }
        }
    }

    #[test]
    fn agx_is_within_a_step_and_hardly_ever_another_one() {
        let output = Output {
            view_transform: ViewTransform::AgX,
            ..Output::default()
        };
        let mut picture = picture(&numbers());
        // Colours, not greys alone, from deep shadow to far beyond white.
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            *pixel *= Vec3::new(1.0, (i % 7) as f32, 0.1 * (i % 31) as f32);
        }
        let (shown, expected) = (
            develop_rgba8(&picture, &output),
            expected(&picture, &output),
        );
        let (mut others, mut colors) = (0, std::collections::HashSet::new());
        for (a, b) in shown.iter().zip(&expected) {
            assert!(a.abs_diff(*b) <= 1, "{a} instead of {b}");
            others += u32::from(a != b);
            colors.insert(*a);
        }
        assert!(colors.len() > 250, "only {} values occur", colors.len());
        let part = f64::from(others) / shown.len() as f64;
        assert!(part < 0.002, "{part} of the values are another step");
    }

    #[test]
    fn bloom_is_part_of_it() {
        let mut light = Picture::black(UVec2::new(9, 9));
        light.pixels[40] = Vec3::splat(5.0);
        let output = Output {
            bloom: Bloom {
                enabled: true,
                threshold: 0.5,
                intensity: 1.0,
                sigma: 1.0,
            },
            ..Output::default()
        };
        let shown = develop_rgba8(&light, &output);
        assert_eq!(shown, expected(&light, &output));
        assert!(shown[4 * 31] > 100, "the neighbour is {}", shown[4 * 31]);
    }

    proptest! {
        #[test]
        fn any_number_gets_the_step_that_it_is_nearest_to(bits: u32) {
            let x = f32::from_bits(bits);
            let clamped = if x > 0.0 { x.min(1.0) } else { 0.0 };
            let step = |steps: &Steps| steps.at(place(x)) as u8;
            prop_assert_eq!(step(Steps::raw()), rounded(clamped));
            prop_assert_eq!(step(Steps::srgb()), rounded(srgb::encode(clamped)));
        }
    }
}

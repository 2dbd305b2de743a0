//! What a screen gets: 8 bits a channel, many times a second, so the curves are read from tables.
//!
//! Both tables are indexed by the upper half of a number's bits: 128 places between a power of two and
//! the next, so they are finest where numbers are small, as the curves ask for.

use super::Picture;
use super::agx::{STOPS, agx_by, curve};
use super::bloom::with_bloom;
use crate::scene::{Output, ViewTransform};
use crate::trace::srgb;
use glam::Vec3;
use rayon::prelude::*;
use std::sync::OnceLock;

/// The picture as [`develop`](super::develop()) makes it, each value rounded to the nearest of 256:
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
        ViewTransform::Raw => {
            let steps = Steps::raw();
            rgba(picture, |p| (p * gain).to_array().map(|x| steps.of(x)))
        }
        ViewTransform::Srgb => {
            let steps = Steps::srgb();
            rgba(picture, |p| (p * gain).to_array().map(|x| steps.of(x)))
        }
        ViewTransform::AgX => {
            let curve = Curve::agx();
            rgba(picture, |p| {
                let shown = agx_by(p * gain, |x| curve.at(x));
                shown.to_array().map(rounded)
            })
        }
    }
}

fn rgba(picture: &Picture, shown: impl Fn(Vec3) -> [u8; 3] + Sync) -> Vec<u8> {
    let mut bytes = vec![255; 4 * picture.pixels.len()];
    let width = picture.width.max(1) as usize;
    (bytes.par_chunks_mut(4 * width))
        .zip(picture.pixels.par_chunks(width))
        .for_each(|(bytes, pixels)| {
            // A coarse picture has the same pixel many times over.
            let (mut last, mut shown_last) = (Vec3::ZERO, shown(Vec3::ZERO));
            for (bytes, &pixel) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(pixels) {
                if pixel != last {
                    (last, shown_last) = (pixel, shown(pixel));
                }
                let [r, g, b] = shown_last;
                *bytes = [r, g, b, 255];
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
    /// By the upper half of a number's bits: in the lowest 8 bits the step of the smallest number with
    /// this half; above them from which lower half on it is the next one. It is never a second one.
    table: Vec<u32>,
}

const ONE: u32 = 1.0_f32.to_bits();

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
        let entry = |half: u32| {
            let step = first.partition_point(|&first| first <= half << 16) - 1;
            let next = first
                .get(step + 1)
                .map_or(1 << 16, |&next| next - (half << 16));
            step as u32 | next.min(1 << 16) << 8
        };
        Self {
            table: (0..=ONE >> 16).map(entry).collect(),
        }
    }

    #[inline(always)]
    fn of(&self, x: f32) -> u8 {
        // In this form not a number becomes 0.
        let x = if x > 0.0 { x } else { 0.0 };
        let bits = (if x < 1.0 { x } else { 1.0 }).to_bits();
        let entry = self.table[(bits >> 16) as usize];
        entry as u8 + u8::from(bits & 0xffff >= entry >> 8)
    }
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

    fn at(&self, x: f32) -> f32 {
        let low = f32::from_bits(self.first << 16);
        let high = f32::from_bits((self.first + self.values.len() as u32 - 2) << 16);
        let bits = x.max(low).min(high).to_bits();
        let place = ((bits >> 16) - self.first) as usize;
        let between = (bits & 0xffff) as f32 * (1.0 / 65536.0);
        let [before, after] = [self.values[place], self.values[place + 1]];
        before + (after - before) * between
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::develop;
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
            prop_assert_eq!(Steps::raw().of(x), rounded(clamped));
            prop_assert_eq!(Steps::srgb().of(x), rounded(srgb::encode(clamped)));
        }
    }
}

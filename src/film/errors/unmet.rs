//! What no sample has met: how much it may change a picture, at most.
//!
//! Samples that all agree show no error, and still a feature may be there that none of them met: nothing
//! found is not nothing there. Of features that n_i samples of pixel i miss with a probability of 5 % or
//! more, Σ n_i q_i ≤ 3, with q_i the part of the pixel that they cover ("rule of three": (1-q)^n ≈ e^-nq,
//! ln 0.05 = -3). With a brightness V they add x = q_i V to the pixel's value b; its relative squared error
//! x² / ((b+x)² + floor) is at most x·g(b), g(b) = 1 / (2(b + √(b² + floor))), and as much for x = √(b² + floor).
//! So the picture's is at most 3V · max_i(g(b_i)/n_i) / pixels, for features that lie where they do most harm.
//! (The sequence of sample points is stratified, so a feature is met sooner than so.)
//!
//! V is known where a feature shines by itself ([`emitters`]): the brightest of those as bright as which
//! no sample was. Of others, full white is reckoned with, so that of features which reflect a lamp more brightly
//! nothing is foreseen before a sample has met them and the picture moves.
//!
//! The bound is told where samples do not differ at all; and a render that stops by its error waits for what
//! shines by itself.
//!
//! A scene in which nothing is random, an even background alone, is no exception: what its samples say is all
//! that a picture knows.

use crate::film::lock;
use crate::film::subject::Subject;
use crate::film::sums::tiles::TILE_PIXELS;
use crate::instruction_sets::vectorized;
use crate::trace::emitters;
use glam::Vec3;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// -ln 0.05.
const MISSED: f64 = 3.0;
/// The brightness of a feature of which nothing is known: full white.
const WHITE: f64 = 1.0;

/// Samples of each octave of brightness.
pub(in crate::film) type Octaves = [u32; OCTAVES];

/// No sample.
pub(in crate::film) const NO_OCTAVES: Octaves = [0; OCTAVES];

const OCTAVES: usize = 64;
/// Counts that go on at once.
const PARTS: usize = 4;

/// The octave of the brightest channel: that of 1 is number 32, and what is darker or brighter than all
/// counts as the first or the last.
#[inline(always)]
fn octave(value: Vec3) -> i32 {
    let exponent = (value.max_element().to_bits() >> 23) & 0xff;
    (exponent as i32 - 127 + 32).clamp(0, OCTAVES as i32 - 1)
}

/// Values that are looked at together.
const LANES: usize = 64;

vectorized! {
    fn find_octaves(values: &[Vec3; LANES], octaves: &mut [i32; LANES]) {
        for i in 0..LANES {
            octaves[i] = octave(values[i]);
        }
    }
}

/// Adds that of so many samples of one value.
pub(in crate::film) fn count_octave(value: Vec3, samples: u64, counts: &mut Octaves) {
    let count = &mut counts[octave(value) as usize % OCTAVES];
    *count = count.saturating_add(samples.try_into().unwrap_or(u32::MAX));
}

/// Adds the octaves of samples of these values.
pub(in crate::film) fn count_octaves(values: &[Vec3], counts: &mut Octaves) {
    let mut octaves = [0; LANES];
    let mut last = [Vec3::ZERO; LANES];
    // Neighbours are often as bright as each other: counts that wait for one another are several.
    let mut parts = [NO_OCTAVES; PARTS];
    for some in values.chunks(LANES) {
        if let Ok(some) = some.try_into() {
            find_octaves(some, &mut octaves);
        } else {
            last[..some.len()].copy_from_slice(some);
            find_octaves(&last, &mut octaves);
        }
        for (i, &octave) in octaves[..some.len()].iter().enumerate() {
            parts[i % PARTS][octave as usize % OCTAVES] += 1;
        }
    }
    for part in &parts {
        for (count, part) in counts.iter_mut().zip(part) {
            *count += part;
        }
    }
}

/// How often a feature is met at least before a render may end by its error. It decides by the samples that
/// it keeps, and is the sooner done the more often they met the feature; so it adds too much on average.
/// A render that ends with the k-th meeting leaves one k-th too much, and one that goes on to the next
/// doubling less: below a hundredth.
pub(in crate::film) const OFTEN: u64 = 100;

/// Which brightnesses a render has met.
pub(in crate::film) struct Unmet {
    met: [AtomicU64; OCTAVES],
    /// Of each octave that has an emitter the largest mean over the channels; looked for when first
    /// asked for.
    emitters: Mutex<Option<Vec<(usize, f64)>>>,
}

impl Default for Unmet {
    fn default() -> Self {
        Self {
            met: [const { AtomicU64::new(0) }; OCTAVES],
            emitters: Mutex::default(),
        }
    }
}

impl Unmet {
    /// Samples of these brightnesses have been met.
    pub fn met(&self, octaves: &Octaves) {
        for (met, &samples) in self.met.iter().zip(octaves) {
            if samples > 0 {
                met.fetch_add(u64::from(samples), Ordering::Relaxed);
            }
        }
    }

    /// What shines is another now.
    pub fn forget_emitters(&self) {
        *lock(&self.emitters) = None;
    }

    /// What the largest [`Reach`] of a sample is multiplied by for the sum over all pixels of the squared error
    /// that features may leave which fewer than `times` samples have met.
    pub fn hidden(&self, subject: &Subject, times: u64) -> f64 {
        MISSED * self.brightness(subject, times).max(WHITE)
    }

    /// The same of what shines by itself alone: what a render that stops by its error waits for.
    pub fn hidden_by_emitters(&self, subject: &Subject, times: u64) -> f64 {
        MISSED * self.brightness(subject, times)
    }

    /// How bright emitters are at most that fewer samples have met, in the film's unit.
    fn brightness(&self, subject: &Subject, times: u64) -> f64 {
        let mut kept = lock(&self.emitters);
        let found = kept.get_or_insert_with(|| {
            let found = emitters(&subject.world, &subject.camera, &subject.settings);
            let of = |radiance: Vec3| {
                (
                    octave(radiance) as usize,
                    f64::from(radiance.element_sum()) / 3.0,
                )
            };
            let mut found: Vec<_> = found.into_iter().map(of).collect();
            found.sort_by(|a, b| b.1.total_cmp(&a.1));
            found.dedup_by_key(|(octave, _)| *octave);
            found
        });
        // With what it reflects besides, an emitter may look brighter by an octave.
        let met = |octave: usize| -> u64 {
            let octaves = self.met.iter().skip(octave).take(2);
            octaves.map(|met| met.load(Ordering::Relaxed)).sum()
        };
        let unmet = found.iter().filter(|(octave, _)| met(*octave) < times);
        unmet.fold(0.0, |most, (_, brightness)| most.max(*brightness))
    }
}

/// How much pixels err by unmet light where it does most harm, per unit of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::film) struct Reach {
    /// Squared error.
    pub absolute: f64,
    /// Squared error / (value² + [`RELATIVE_FLOOR`](super::error::RELATIVE_FLOOR)).
    pub relative: f64,
}

impl Reach {
    /// Of a pixel with this value.
    #[inline(always)]
    pub fn of(value: f64) -> Self {
        let value = value.max(0.0);
        let absolute = (value * value + super::error::RELATIVE_FLOOR).sqrt();
        Self {
            absolute,
            relative: 0.5 / (value + absolute),
        }
    }
}

/// The same of a tile's pixels, in columns.
pub(super) struct ReachColumns {
    pub absolute: [f64; TILE_PIXELS],
    pub relative: [f64; TILE_PIXELS],
}

impl ReachColumns {
    /// Of pixels with these values.
    pub fn of(values: &[f64; TILE_PIXELS]) -> Self {
        let mut columns = Self {
            absolute: [0.0; TILE_PIXELS],
            relative: [0.0; TILE_PIXELS],
        };
        reach(values, &mut columns);
        columns
    }
}

vectorized! {
    fn reach(values: &[f64; TILE_PIXELS], columns: &mut ReachColumns) {
        let ReachColumns { absolute, relative } = columns;
        let errors = absolute.iter_mut().zip(relative);
        for (value, (absolute, relative)) in values.iter().zip(errors) {
            let reach = Reach::of(*value);
            (*absolute, *relative) = (reach.absolute, reach.relative);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::test_scene::{camera, settings, world};
    use crate::film::{Ending, Progressive, Rendered, render};
    use crate::trace::{Environment, Lights, World};
    use glam::UVec2;
    use std::sync::Arc;

    const SIZE: UVec2 = UVec2::new(32, 24);

    fn even(background: f32) -> World {
        World {
            environment: Environment {
                background: Vec3::splat(background),
                ..Environment::default()
            },
            ..World::default()
        }
    }

    fn rendered(world: &World, spp: u32, error: f32) -> Rendered {
        let mut settings = settings(SIZE, spp);
        settings.sampling.error = error;
        render(world, &camera(), &settings, &|_, _| {})
    }

    #[test]
    fn equal_samples_tell_a_bound_that_falls_with_their_number() {
        let mut before = f64::INFINITY;
        for spp in [2, 16, 64] {
            let rendered = rendered(&even(0.0), spp, 0.0);
            let error = rendered.status.error().unwrap();
            // Features of full white where black pixels have them: 3 / 0.2 a sample.
            let samples = f64::from(spp * SIZE.element_product());
            let expected = (15.0 / samples).sqrt();
            assert!(error.is_bound && error.relative() < before, "{error}");
            assert!((error.relative() / expected - 1.0).abs() < 1e-6, "{error}");
            assert!(error.to_string().starts_with("at most "), "{error}");
            for pixel in rendered.film.relative_errors() {
                assert!((f64::from(pixel) / expected - 1.0).abs() < 1e-4, "{pixel}");
            }
            before = error.relative();
        }
    }

    #[test]
    fn a_bound_is_rounded_up() {
        let bound = super::super::error::ErrorEstimate {
            relative_mse: 1e-18,
            is_bound: true,
            ..Default::default()
        };
        assert_eq!(bound.to_string(), "at most 0.01 %");
    }

    #[test]
    fn equal_samples_end_a_render_only_once_nothing_can_hide_that_matters() {
        for adaptive in [false, true] {
            let mut settings = settings(SIZE, 1 << 12);
            settings.sampling.error = 0.02;
            settings.sampling.adaptive = adaptive;
            let rendered = render(&even(0.0), &camera(), &settings, &|_, _| {});
            assert_eq!(rendered.ending, Ending::Error);
            // 15 / (n · pixels) = 0.02² at n = 48.8.
            assert_eq!(rendered.status.samples, 64.0, "adaptive: {adaptive}");
        }
    }

    #[test]
    fn a_lamp_in_the_picture_counts_until_a_sample_meets_it() {
        let lamp = |brightness: f32, shift: f32| {
            let mut lights = Lights::clone(&world().lights);
            let light = &mut lights.parallelograms[0];
            light.colors = [Vec3::splat(brightness); 4];
            light.corner = Vec3::new(shift, 0.4, 0.0);
            light.edges = [Vec3::X, Vec3::Z].map(|edge| edge * 0.002);
            World {
                lights: Arc::new(lights),
                ..World::default()
            }
            .with_needs()
        };
        let error = |world: &World| rendered(world, 16, 0.0).status.error().unwrap();
        let dim = error(&even(0.0));
        let ahead = error(&lamp(400.0, 0.0));
        let factor = ahead.relative_mse / dim.relative_mse;
        assert!(
            (factor - 400.0).abs() < 0.01 || factor * dim.relative_mse == 1.0,
            "{factor}"
        );
        // Far to the side, where nothing mirrors.
        assert_eq!(error(&lamp(400.0, 50.0)), dim);
        // A background as bright is met by every sample.
        assert!(error(&even(400.0)).relative() < dim.relative());
    }

    #[test]
    fn a_pixel_says_that_its_error_is_a_bound() {
        let render = Progressive::start(even(0.5), camera(), settings(SIZE, 16)).unwrap();
        render.wait();
        let (samples, error) = render.pixel(UVec2::new(3, 4)).unwrap();
        assert!(
            samples == 16 && error.is_bound && error.relative > 0.0,
            "{error:?}"
        );
    }
}

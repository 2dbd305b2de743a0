//! The random numbers of a batch, a column at a time: what [`Sampler::block`] gives for each sample by itself.

use super::sampler::{Purpose, SampleId, Sampler, pixel_seed};
use super::sobol;
use crate::instruction_sets::vectorized;
use crate::scene::{RenderSettings, Sequence};

/// Who asks for numbers: of which pixel, on which path, for which point of the sequence. Columns of equal length.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct Asking {
    /// [`pixel_seed`]s.
    pixels: Vec<u32>,
    /// Names of paths.
    paths: Vec<u32>,
    indices: Vec<u64>,
}

impl Asking {
    pub fn clear(&mut self) {
        self.pixels.clear();
        self.paths.clear();
        self.indices.clear();
    }

    pub fn push(&mut self, pixel: u32, path: u32, index: u64) {
        self.pixels.push(pixel);
        self.paths.push(path);
        self.indices.push(index);
    }

    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Every sample of a batch, at the pixels (x, y), on the path from the camera.
    pub fn all(&mut self, samples: &[SampleId], x: &[u32], y: &[u32], settings: &RenderSettings) {
        self.indices.clear();
        self.indices.extend(samples.iter().map(|id| id.index));
        self.paths.clear();
        self.paths.resize(samples.len(), 0);
        self.pixels.resize(samples.len(), 0);
        pixel_seeds(settings.seed, x, y, &mut self.pixels);
    }

    pub fn pixels(&self) -> &[u32] {
        &self.pixels
    }
}

vectorized! {
    fn pixel_seeds(seed: u32, x: &[u32], y: &[u32], seeds: &mut [u32]) {
        let count = seeds.len();
        let (x, y) = (&x[..count], &y[..count]);
        for i in 0..count {
            seeds[i] = pixel_seed(seed, x[i], y[i]);
        }
    }
}

/// Fills two columns, for a purpose, from those of [`Asking`].
type OfSobol = fn(u32, &[u32], &[u32], &[u64], &mut [f32], &mut [f32]);

/// The first number of everyone's block for `purpose`.
pub(in crate::trace) fn draw_firsts(
    numbers: &mut Vec<f32>,
    asking: &Asking,
    purpose: Purpose,
    settings: &RenderSettings,
) {
    let Asking {
        pixels,
        paths,
        indices,
    } = asking;
    numbers.resize(asking.len(), 0.0);
    if settings.sequence == Sequence::Sobol {
        sobol::firsts(purpose.key(), pixels, paths, indices, numbers);
        return;
    }
    for (i, number) in numbers.iter_mut().enumerate() {
        let sampler = Sampler::of_pixel(pixels[i], settings.sequence, settings.jitter);
        [*number, ..] = sampler.block(indices[i], purpose, paths[i]);
    }
}

/// Two numbers in [0, 1) for each who asked.
#[derive(Clone, Debug, Default)]
pub(in crate::trace) struct Pairs {
    pub u: Vec<f32>,
    pub v: Vec<f32>,
}

impl Pairs {
    pub fn get(&self, i: usize) -> [f32; 2] {
        [self.u[i], self.v[i]]
    }

    /// The first two numbers of everyone's block for `purpose`.
    pub fn draw(&mut self, asking: &Asking, purpose: Purpose, settings: &RenderSettings) {
        self.of(asking, purpose, settings, sobol::pairs, |[u, v, ..]| [u, v]);
    }

    /// The last two.
    pub fn draw_last(&mut self, asking: &Asking, purpose: Purpose, settings: &RenderSettings) {
        self.of(
            asking,
            purpose,
            settings,
            sobol::last_pairs,
            |[.., u, v]| [u, v],
        );
    }

    /// The same two for each of `count`.
    pub fn fill(&mut self, count: usize, [u, v]: [f32; 2]) {
        self.u.clear();
        self.u.resize(count, u);
        self.v.clear();
        self.v.resize(count, v);
    }

    fn of(
        &mut self,
        asking: &Asking,
        purpose: Purpose,
        settings: &RenderSettings,
        sobol: OfSobol,
        of_block: fn([f32; 4]) -> [f32; 2],
    ) {
        let Asking {
            pixels,
            paths,
            indices,
        } = asking;
        self.u.resize(asking.len(), 0.0);
        self.v.resize(asking.len(), 0.0);
        if settings.sequence == Sequence::Sobol {
            sobol(
                purpose.key(),
                pixels,
                paths,
                indices,
                &mut self.u,
                &mut self.v,
            );
            return;
        }
        for i in 0..asking.len() {
            let sampler = Sampler::of_pixel(pixels[i], settings.sequence, settings.jitter);
            [self.u[i], self.v[i]] = of_block(sampler.block(indices[i], purpose, paths[i]));
        }
    }
}

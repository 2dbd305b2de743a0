//! Pictures of a scene for each way to choose samples, and how far they are from the truth.

use super::super::timing::median;
use super::super::{Options, Subject};
use crate::film::{Picture, RELATIVE_FLOOR, Rendered, render};
use crate::scene::{RenderSettings, Sampling, Sequence};
use glam::UVec2;

/// A way to choose samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Independent,
    Jittered,
    Sobol,
    Adaptive,
}

impl Way {
    pub const ALL: [Self; 4] = [
        Self::Independent,
        Self::Jittered,
        Self::Sobol,
        Self::Adaptive,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent random",
            Self::Jittered => "stratified jitter",
            Self::Sobol => "Owen-scrambled Sobol",
            Self::Adaptive => "Owen-scrambled Sobol, adaptive",
        }
    }
}

/// How much is rendered.
pub(super) struct Effort {
    /// Pixels of the longer side.
    pub side: u32,
    /// Samples of each pixel of the reference.
    pub reference: u32,
    /// Samples of each pixel; squares, for the jitter's grid.
    pub counts: &'static [u32],
    pub seeds: u32,
}

impl Effort {
    pub fn of(options: &Options) -> Self {
        if options.quick {
            Self {
                side: 48,
                reference: 1024,
                counts: &[4, 16, 64],
                seeds: 2,
            }
        } else {
            Self {
                side: 96,
                reference: 4096,
                counts: &[4, 16, 64, 256],
                seeds: 3,
            }
        }
    }
}

/// The most samples of a pixel that adaptive sampling may take, of those of the uniform picture that it is to equal.
const ADAPTIVE_MOST: u32 = 64;

/// The means over all seeds of pictures that were made alike.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub samples: f64,
    pub seconds: f64,
    pub rays: f64,
    pub rmse: f64,
    pub relative_mse: f64,
    /// The film's estimate of the root of `relative_mse`, where it has one.
    pub estimate: Option<f64>,
    /// The exponent s of the film's own trend, error ~ seconds^-s ([`Status::decline`](crate::film::Status::decline)).
    pub decline: Option<f64>,
}

impl Point {
    pub fn relative(&self) -> f64 {
        self.relative_mse.sqrt()
    }
}

pub(super) fn shrunk(subject: &Subject, effort: &Effort, options: &Options) -> RenderSettings {
    let size = subject.settings.size.as_dvec2();
    let size = (size * (f64::from(effort.side) / size.max_element())).round();
    RenderSettings {
        size: UVec2::new(size.x.max(1.0) as u32, size.y.max(1.0) as u32),
        jitter: 1,
        sequence: Sequence::Sobol,
        seed: options.seed,
        sampling: Sampling::default(),
        ..subject.settings.clone()
    }
}

fn rendered(subject: &Subject, settings: &RenderSettings) -> Rendered {
    render(&subject.world, &subject.camera, settings, &|_, _| {})
}

pub(super) fn reference(subject: &Subject, settings: &RenderSettings, effort: &Effort) -> Picture {
    let settings = RenderSettings {
        spp: effort.reference,
        seed: settings.seed.wrapping_add(0x5eed),
        ..settings.clone()
    };
    rendered(subject, &settings).picture
}

/// A point for each number of samples.
pub(super) fn curve(
    way: Way,
    subject: &Subject,
    settings: &RenderSettings,
    effort: &Effort,
    reference: &Picture,
    step: &mut impl FnMut(),
) -> Vec<Point> {
    let mut curve = Vec::new();
    for &count in effort.counts {
        // The film estimates nothing from few samples, so there is no goal.
        if way == Way::Adaptive && count < 16 {
            (0..effort.seeds).for_each(|_| step());
            continue;
        }
        let mut pictures = Vec::new();
        for seed in 0..effort.seeds {
            let mut settings = RenderSettings {
                spp: count,
                seed: settings.seed.wrapping_add(seed),
                ..settings.clone()
            };
            match way {
                Way::Independent => settings.sequence = Sequence::Independent,
                Way::Jittered => {
                    settings.sequence = Sequence::Jittered;
                    settings.jitter = count.isqrt();
                }
                Way::Sobol => {}
                Way::Adaptive => {
                    // What the uniform picture would have.
                    let Some(goal) = rendered(subject, &settings).status.error() else {
                        continue;
                    };
                    settings.spp = count * ADAPTIVE_MOST;
                    settings.sampling.error = goal.relative() as f32;
                    settings.sampling.adaptive = true;
                }
            }
            pictures.push(rendered(subject, &settings));
            step();
        }
        curve.extend(point(&pictures, reference));
    }
    curve
}

fn point(pictures: &[Rendered], reference: &Picture) -> Option<Point> {
    if pictures.is_empty() {
        return None;
    }
    let mean = |value: &dyn Fn(&Rendered) -> f64| {
        pictures.iter().map(value).sum::<f64>() / pictures.len() as f64
    };
    let estimates = (pictures.iter())
        .filter(|rendered| rendered.status.samples >= 16.0)
        .filter_map(|rendered| rendered.status.error());
    let estimate = mean_of(estimates.map(|error| error.relative_mse)).map(f64::sqrt);
    let square = |rendered: &Rendered| rendered.picture.rmse(reference).map_or(f64::NAN, |e| e * e);
    Some(Point {
        samples: mean(&|rendered| rendered.status.samples),
        seconds: median(
            pictures
                .iter()
                .map(|rendered| rendered.status.seconds)
                .collect(),
        ),
        rays: mean(&|rendered| rendered.status.rays.total() as f64),
        rmse: mean(&square).sqrt(),
        relative_mse: mean(&|rendered| relative_mse(&rendered.picture, reference)),
        estimate,
        decline: mean_of(
            pictures
                .iter()
                .filter_map(|rendered| rendered.status.decline()),
        ),
    })
}

/// `None` of nothing.
fn mean_of(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0.0, 0.0), |(n, s), value| (n + 1.0, s + value));
    (count > 0.0).then(|| sum / count)
}

/// The film's measure, against the reference: the mean over pixels of squared error / (value² + floor).
fn relative_mse(picture: &Picture, reference: &Picture) -> f64 {
    let pixels = picture.pixels.iter().zip(&reference.pixels);
    let sum: f64 = pixels
        .map(|(a, b)| {
            let square = (*a - *b).as_dvec3().length_squared() / 3.0;
            let value = b.as_dvec3().element_sum() / 3.0;
            square / (value * value + RELATIVE_FLOOR)
        })
        .sum();
    sum / picture.pixels.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn the_measure_is_the_films_own() {
        let mut reference = Picture::black(UVec2::new(2, 1));
        reference.pixels[1] = Vec3::splat(0.3);
        let mut picture = reference.clone();
        picture.pixels[0] = Vec3::splat(0.1);
        picture.pixels[1] = Vec3::splat(0.4);
        // 0.01 / 0.01 and 0.01 / (0.09 + 0.01), averaged.
        let error = relative_mse(&picture, &reference);
        assert!((error - 0.55).abs() < 1e-6, "{error}");
    }
}

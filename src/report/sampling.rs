//! How fast the picture's error falls, for each way to choose samples.

use super::fit::{power_law, reaches};
use super::table::digits;
use super::timing::median;
use super::{Axis, Cell, Dash, Marker, Options, Plot, Section, Series, Subject, Table, Watch};
use crate::film::{Picture, RELATIVE_FLOOR, Rendered, render};
use crate::scene::{RenderSettings, Sampling, Sequence};
use glam::UVec2;

/// A way to choose samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Independent,
    Jittered,
    Ours,
    Adaptive,
}

impl Way {
    const ALL: [Self; 4] = [
        Self::Independent,
        Self::Jittered,
        Self::Ours,
        Self::Adaptive,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent random",
            Self::Jittered => "stratified jitter",
            Self::Ours => "our sequence",
            Self::Adaptive => "our sequence, adaptive",
        }
    }
}

/// How much is rendered.
struct Effort {
    /// Pixels of the longer side.
    side: u32,
    /// Samples of each pixel of the reference.
    reference: u32,
    /// Samples of each pixel; squares, for the jitter's grid.
    counts: &'static [u32],
    seeds: u32,
}

impl Effort {
    fn of(options: &Options) -> Self {
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
/// The error whose time is told.
const GOAL: f64 = 0.01;

/// The means over all seeds of pictures that were made alike.
#[derive(Clone, Copy, Debug)]
struct Point {
    samples: f64,
    seconds: f64,
    rays: f64,
    rmse: f64,
    relative_mse: f64,
    /// The film's estimate of the root of `relative_mse`, where it has one.
    estimate: Option<f64>,
}

impl Point {
    fn relative(&self) -> f64 {
        self.relative_mse.sqrt()
    }
}

/// Measures all scenes.
pub fn measure(subjects: &[Subject], options: &Options, watch: Watch) -> Section {
    let effort = Effort::of(options);
    let mut points_table = Table::new(
        "sampling",
        "Error of the picture, against samples, seconds and rays",
        &[
            "scene",
            "samples chosen",
            "samples a pixel",
            "seconds",
            "Mrays",
            "RMSE",
            "relative MSE",
            "relative error",
            "film's estimate",
            "estimate / true",
        ],
    );
    let mut slopes_table = Table::new(
        "slopes",
        "How fast the relative error falls: error ~ x^slope; and when it reaches 1 %",
        &[
            "scene",
            "samples chosen",
            "slope over samples",
            "over rays",
            "over seconds",
            "seconds to 1 %",
            "Mrays to 1 %",
        ],
    );
    let mut section = Section {
        title: "Sampling: error against time".into(),
        method: method(&effort),
        ..Section::default()
    };
    let mut gains = Gains::default();
    for subject in subjects {
        let settings = shrunk(subject, &effort, options);
        let what = format!("sampling of {}", subject.name);
        let pictures =
            (effort.counts.len() as u64 * Way::ALL.len() as u64 + 1) * u64::from(effort.seeds);
        let mut done = 0;
        let mut step = || {
            done += 1;
            watch(&what, done, pictures);
        };
        watch(&what, 0, pictures);
        let reference = reference(subject, &settings, &effort);
        let curves =
            Way::ALL.map(|way| curve(way, subject, &settings, &effort, &reference, &mut step));
        for (way, curve) in Way::ALL.iter().zip(&curves) {
            for point in curve {
                points_table.push(point_cells(&subject.name, *way, point));
            }
            slopes_table.push(slope_cells(&subject.name, *way, curve));
        }
        gains.add(&curves);
        section
            .plots
            .push(plot(subject, &curves, "seconds", "seconds", |point| {
                point.seconds
            }));
        section
            .plots
            .push(plot(subject, &curves, "rays", "million rays", |point| {
                point.rays * 1e-6
            }));
    }
    section.findings = gains.findings();
    section.summary = Some(1);
    section.tables = vec![points_table, slopes_table];
    section
}

fn method(effort: &Effort) -> Vec<String> {
    vec![format!(
        "Pictures of {} pixels on the longer side, {} seeds each, against a reference of {} samples a pixel with another seed. \
         Squared errors are averaged over seeds; seconds are the median. `relative MSE` is the mean over pixels of squared \
         error / (value² + {RELATIVE_FLOOR}), each averaged over the channels, `relative error` its root. Jitter is on a grid \
         with as many cells as samples. Adaptive sampling gets as its goal what the film estimates for our sequence with the \
         same number of samples for every pixel. Slopes are least squares through logarithms; where 1 % lies beyond what was \
         measured (~), along the fitted line.",
        effort.side, effort.seeds, effort.reference
    )]
}

fn shrunk(subject: &Subject, effort: &Effort, options: &Options) -> RenderSettings {
    let size = subject.settings.size.as_dvec2();
    let size = (size * (f64::from(effort.side) / size.max_element())).round();
    RenderSettings {
        size: UVec2::new(size.x.max(1.0) as u32, size.y.max(1.0) as u32),
        jitter: 1,
        seed: options.seed,
        sampling: Sampling::default(),
        ..subject.settings.clone()
    }
}

fn rendered(subject: &Subject, settings: &RenderSettings) -> Rendered {
    render(&subject.world, &subject.camera, settings, &|_, _| {})
}

fn reference(subject: &Subject, settings: &RenderSettings, effort: &Effort) -> Picture {
    let settings = RenderSettings {
        spp: effort.reference,
        sequence: Sequence::Sobol,
        seed: settings.seed.wrapping_add(0x5eed),
        ..settings.clone()
    };
    rendered(subject, &settings).picture
}

/// A point for each number of samples.
fn curve(
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
                Way::Ours => {}
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
    let estimates: Vec<f64> = (pictures.iter())
        .filter(|rendered| rendered.status.samples >= 16.0)
        .filter_map(|rendered| rendered.status.error())
        .map(|error| error.relative_mse)
        .collect();
    let estimate = (!estimates.is_empty())
        .then(|| (estimates.iter().sum::<f64>() / estimates.len() as f64).sqrt());
    let square = |rendered: &Rendered| rendered.picture.rmse(reference).map_or(f64::NAN, |e| e * e);
    Some(Point {
        samples: mean(&|rendered| rendered.status.samples),
        seconds: median(pictures.iter().map(|rendered| rendered.seconds).collect()),
        rays: mean(&|rendered| rendered.rays.total() as f64),
        rmse: mean(&square).sqrt(),
        relative_mse: mean(&|rendered| relative_mse(&rendered.picture, reference)),
        estimate,
    })
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

fn point_cells(scene: &str, way: Way, point: &Point) -> [Cell; 10] {
    [
        scene.into(),
        way.name().into(),
        point.samples.into(),
        point.seconds.into(),
        (point.rays * 1e-6).into(),
        point.rmse.into(),
        point.relative_mse.into(),
        point.relative().into(),
        point.estimate.into(),
        point
            .estimate
            .map(|estimate| estimate / point.relative())
            .into(),
    ]
}

fn slope_cells(scene: &str, way: Way, curve: &[Point]) -> [Cell; 7] {
    let over = |x: fn(&Point) -> f64| -> Vec<(f64, f64)> {
        curve
            .iter()
            .map(|point| (x(point), point.relative()))
            .collect()
    };
    let slope = |x| power_law(&over(x)).map(|(slope, _)| slope);
    let reached = |x| match reaches(&over(x), GOAL) {
        Some((at, false)) => Cell::from(at),
        Some((at, true)) => Cell::Text(format!("~{}", digits(at, 2))),
        None => Cell::Empty,
    };
    [
        scene.into(),
        way.name().into(),
        slope(|point| point.samples).into(),
        slope(|point| point.rays).into(),
        slope(|point| point.seconds).into(),
        reached(|point| point.seconds),
        reached(|point| point.rays * 1e-6),
    ]
}

fn plot(
    subject: &Subject,
    curves: &[Vec<Point>; Way::ALL.len()],
    name: &str,
    label: &str,
    x: fn(&Point) -> f64,
) -> Plot {
    let dashes = [Dash::Dotted, Dash::Short, Dash::Solid, Dash::Long];
    let markers = [
        Marker::Cross,
        Marker::Triangle,
        Marker::Circle,
        Marker::Frame,
    ];
    let mut series: Vec<Series> = (Way::ALL.iter().zip(curves))
        .zip(dashes.into_iter().zip(markers))
        .map(|((way, curve), (dash, marker))| {
            let points = curve.iter().map(|point| (x(point), point.relative()));
            Series::new(way.name(), points.collect())
                .joined(dash)
                .marked(marker)
        })
        .collect();
    let estimates = (curves[2].iter()).filter_map(|point| Some((x(point), point.estimate?)));
    series
        .push(Series::new("the film's estimate of ours", estimates.collect()).marked(Marker::Ring));
    Plot {
        file: format!("sampling-{}-{name}", subject.file()),
        title: format!("{}: error against {label}", subject.name),
        x: Axis::logarithmic(label),
        y: Axis::logarithmic("relative error"),
        series,
    }
}

/// What the sequence and adaptive sampling gain, over all scenes.
#[derive(Default)]
struct Gains {
    /// ln of our error over that of independent numbers, at the most samples.
    against_independent: Vec<f64>,
    /// ln of our error over that of jitter.
    against_jitter: Vec<f64>,
    /// ln of the seconds to 1 % of ours over those of independent numbers.
    time: Vec<f64>,
    /// ln of rays that adaptive sampling takes, over those of the same samples for every pixel at the same true error.
    adaptive: Vec<f64>,
    /// The film's estimates over true errors.
    estimates: Vec<f64>,
}

impl Gains {
    fn add(&mut self, curves: &[Vec<Point>; Way::ALL.len()]) {
        let [independent, jittered, ours, adaptive] = curves;
        let last = |curve: &[Point]| curve.last().map_or(f64::NAN, Point::relative);
        self.against_independent
            .push((last(ours) / last(independent)).ln());
        self.against_jitter.push((last(ours) / last(jittered)).ln());
        let seconds = |curve: &[Point]| {
            let points: Vec<(f64, f64)> = curve.iter().map(|p| (p.seconds, p.relative())).collect();
            reaches(&points, GOAL).map_or(f64::NAN, |(at, _)| at)
        };
        self.time.push((seconds(ours) / seconds(independent)).ln());
        let rays: Vec<(f64, f64)> = ours.iter().map(|p| (p.rays, p.relative())).collect();
        if let Some(point) = adaptive.last()
            && let Some((uniform, _)) = reaches(&rays, point.relative())
        {
            self.adaptive.push((point.rays / uniform).ln());
        }
        let estimated = ours.iter().chain(adaptive);
        self.estimates
            .extend(estimated.filter_map(|p| Some(p.estimate? / p.relative())));
    }

    fn findings(&self) -> Vec<String> {
        let mean = |logs: &[f64]| {
            let known: Vec<f64> = logs.iter().copied().filter(|log| log.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            digits(mean.exp(), 2)
        };
        let least = self.estimates.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.estimates.iter().copied().fold(0.0, f64::max);
        vec![
            format!(
                "With as many samples our sequence leaves {} of the error of independent random numbers and {} of that of \
                 stratified jitter (means over the scenes), and reaches an error of 1 % in {} of the random numbers' time.",
                mean(&self.against_independent),
                mean(&self.against_jitter),
                mean(&self.time),
            ),
            format!(
                "For the same true error adaptive sampling takes {} times the rays of the same samples for every pixel.",
                mean(&self.adaptive),
            ),
            format!(
                "The film's own estimate was {} to {} times the true error.",
                digits(least, 2),
                digits(most, 2),
            ),
        ]
    }
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

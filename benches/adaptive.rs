//! Samples where the error is, against the same for every pixel: processor seconds to the same error.
//!
//! `cargo bench --no-default-features --bench adaptive [-- SCENE…]`: for each built-in scene with an
//! area light, a lens, gloss or motion a uniform picture of 64 samples a pixel, and the time after which
//! an adaptive one is as near to the truth: between the last of ever smaller goals that is farther
//! from it and the first that is nearer, along a power law. The truth is the mean of other seeds'
//! pictures; what that is off by is known from their spread and subtracted. For scenes of point lights
//! alone, what the rounds of adaptive sampling cost: the same 64 samples of every pixel with and
//! without them.
//!
//! One thread, its own time on a processor (Linux: `/proc/self/task`; elsewhere the clock's).

use glam::{DVec3, UVec2};
use glassbox::app::headless_app;
use glassbox::film::{Picture, RELATIVE_FLOOR, Rendered, render};
use glassbox::io::builtin;
use glassbox::scene::{RenderSettings, Sampling};
use glassbox::sync::{Traced, TracedCameras};
use glassbox::trace::{Camera, World};
use std::sync::Arc;
use std::time::Instant;

const SIZE: UVec2 = UVec2::new(128, 128);
const SAMPLES: u32 = 64;
/// Pictures of a reference, and samples of each.
const REFERENCES: u32 = 3;
const REFERENCE_SAMPLES: u32 = 256;
/// Seeds of what is measured.
const SEEDS: std::ops::Range<u32> = 10..12;
/// Pictures with and without adaptive rounds of which the medians are compared.
const ROUNDS: u32 = 15;
/// The first goal, in estimated errors of the uniform picture. Each is followed by one that is this much
/// nearer, down to a part of the first.
const FIRST: f64 = 1.4;
const NEARER: f64 = 0.88;
const NEAREST: f64 = 0.15;

fn main() {
    let named: Vec<String> = std::env::args()
        .skip(1)
        .filter(|argument| !argument.starts_with("--"))
        .collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| {
        let scenes = builtin::SCENES
            .iter()
            .filter(|scene| named.is_empty() || named.iter().any(|name| name == scene.name))
            .map(|scene| Scene::open(scene.name));
        let (noisy, quiet): (Vec<_>, Vec<_>) = scenes.partition(Scene::is_noisy);
        println!("| scene | error | uniform | adaptive | times sooner |");
        println!("|---|---:|---:|---:|---:|");
        for scene in noisy {
            to_the_same_error(&scene);
        }
        println!();
        println!("| scene | uniform | in adaptive rounds | lost |");
        println!("|---|---:|---:|---:|");
        for scene in quiet {
            same_samples(&scene);
        }
    });
}

struct Scene {
    name: &'static str,
    world: Arc<World>,
    camera: Camera,
    settings: RenderSettings,
}

impl Scene {
    fn open(name: &'static str) -> Self {
        let mut app = headless_app();
        (builtin::find(name).expect("a built-in scene").spawn)(app.world_mut());
        app.update();
        let world = app.world();
        Self {
            name,
            world: world.resource::<Traced>().world.clone(),
            camera: world.resource::<TracedCameras>().0[0].camera.clone(),
            settings: RenderSettings {
                size: SIZE,
                ..world.resource::<RenderSettings>().clone()
            },
        }
    }

    /// Whether it has an area light, a lens, gloss or motion.
    fn is_noisy(&self) -> bool {
        let lights = &self.world.lights;
        let areas = lights.segments.len() + lights.parallelograms.len();
        let sun = lights.directionals.iter().any(|light| light.disc.is_some());
        let moves = self.world.needs.motion_samples > 0;
        areas > 0 || sun || moves || self.camera.has_lens() || self.settings.features.glossy
    }

    fn render(&self, seed: u32, spp: u32, sampling: Sampling) -> Timed {
        let settings = RenderSettings {
            seed,
            spp,
            sampling,
            ..self.settings.clone()
        };
        let (clock, before) = (Instant::now(), processor_seconds());
        let rendered = render(&self.world, &self.camera, &settings, &|_, _| {});
        let seconds = match (before, processor_seconds()) {
            (Some(before), Some(after)) => after - before,
            _ => clock.elapsed().as_secs_f64(),
        };
        Timed { rendered, seconds }
    }
}

struct Timed {
    rendered: Rendered,
    seconds: f64,
}

/// Nanoseconds that each of the process' threads has spent on a processor, together.
fn processor_seconds() -> Option<f64> {
    let mut sum = 0.0;
    for task in std::fs::read_dir("/proc/self/task").ok()? {
        let text = std::fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        sum += text.split_whitespace().next()?.parse::<f64>().ok()?;
    }
    Some(sum * 1e-9)
}

/// The mean of several pictures, and each pixel's expected squared error.
struct Reference {
    means: Vec<DVec3>,
    squared_errors: Vec<f64>,
}

impl Reference {
    fn of(scene: &Scene) -> Self {
        let picture = |seed| {
            let rendered = scene
                .render(seed, REFERENCE_SAMPLES, Sampling::default())
                .rendered;
            rendered.picture
        };
        let pictures: Vec<Picture> = (0..REFERENCES).map(picture).collect();
        let n = f64::from(REFERENCES);
        let (mut means, mut squared_errors) = (Vec::new(), Vec::new());
        for i in 0..pictures[0].pixels.len() {
            let values = pictures.iter().map(|picture| picture.pixels[i].as_dvec3());
            let mean = values.clone().sum::<DVec3>() / n;
            let squares: f64 = values.map(|value| (value - mean).length_squared()).sum();
            means.push(mean);
            squared_errors.push(squares / 3.0 / (n - 1.0) / n);
        }
        Self {
            means,
            squared_errors,
        }
    }

    /// The true relative squared error of a picture.
    fn error_of(&self, picture: &Picture) -> f64 {
        let pixels = picture
            .pixels
            .iter()
            .zip(&self.means)
            .zip(&self.squared_errors);
        let squares = pixels.map(|((pixel, mean), own)| {
            let value = mean.element_sum() / 3.0;
            let square = (pixel.as_dvec3() - mean).length_squared() / 3.0 - own;
            square / (value * value + RELATIVE_FLOOR)
        });
        (squares.sum::<f64>() / self.means.len() as f64).max(0.0)
    }
}

fn adaptive(error: f64) -> Sampling {
    Sampling {
        adaptive: true,
        error: error as f32,
        time: 0.0,
    }
}

/// One line: seconds and error are means over the seeds.
fn to_the_same_error(scene: &Scene) {
    let reference = Reference::of(scene);
    let (mut squared, mut seconds) = (0.0, [0.0; 2]);
    let n = f64::from(SEEDS.end - SEEDS.start);
    for seed in SEEDS {
        let uniform = scene.render(seed, SAMPLES, Sampling::default());
        let wanted = reference.error_of(&uniform.rendered.picture);
        let estimate = uniform.rendered.status.error().expect("an estimate");
        // What it took to find the goal is not counted: a user names one and gets its picture.
        let mut goal = FIRST * estimate.relative();
        let nearest = NEAREST * goal;
        let mut before = None;
        let sooner = loop {
            let timed = scene.render(seed, 1 << 16, adaptive(goal));
            let now = (timed.seconds, reference.error_of(&timed.rendered.picture));
            if now.1 <= wanted || goal < nearest {
                break time_at(wanted, before, now);
            }
            before = Some(now);
            goal *= NEARER;
        };
        seconds[0] += uniform.seconds / n;
        seconds[1] += sooner / n;
        squared += wanted / n;
    }
    println!(
        "| {} | {:.2} % | {:.2} s | {:.2} s | {:.2} |",
        scene.name,
        100.0 * squared.sqrt(),
        seconds[0],
        seconds[1],
        seconds[0] / seconds[1]
    );
}

/// When the error was the wanted one, between (seconds, error) of two pictures; where there is one alone, or
/// more time did not lower the error, the second's time.
fn time_at(wanted: f64, before: Option<(f64, f64)>, (seconds, error): (f64, f64)) -> f64 {
    match before {
        Some((less, more)) if more > wanted && wanted > error && error > 0.0 && less < seconds => {
            let part = (more / wanted).ln() / (more / error).ln();
            less * (seconds / less).powf(part)
        }
        _ => seconds,
    }
}

/// One line: the medians of both ways, which take turns.
fn same_samples(scene: &Scene) {
    let mut seconds = [const { Vec::new() }; 2];
    for round in 0..ROUNDS {
        let seed = SEEDS.start + round;
        // A goal that is not reached. Who comes first in one round comes last in the next.
        let mut both = [(0, Sampling::default()), (1, adaptive(1e-9))];
        both.rotate_left(round as usize % 2);
        for (i, sampling) in both {
            let timed = scene.render(seed, SAMPLES, sampling);
            assert_eq!(timed.rendered.status.samples, f64::from(SAMPLES));
            seconds[i].push(timed.seconds);
        }
    }
    let [uniform, rounds] = seconds.map(|mut seconds| {
        seconds.sort_by(f64::total_cmp);
        seconds[seconds.len() / 2]
    });
    println!(
        "| {} | {uniform:.3} s | {rounds:.3} s | {:.1} % |",
        scene.name,
        100.0 * (rounds / uniform - 1.0)
    );
}

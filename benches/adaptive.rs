//! Samples where the error is, against the same for every pixel: processor seconds to the same error.
//!
//! `cargo bench --no-default-features --bench adaptive [-- SCENE…]`: for each built-in scene with an
//! area light, a dome, a lens, gloss or motion a uniform picture of 64 samples a pixel, and the time after which
//! an adaptive one is as near to the truth: between the last of ever smaller goals that is farther
//! from it and the first that is nearer, along a power law; none where no goal comes so near. The truth is the mean of other seeds'
//! pictures; what that is off by is known from their spread and subtracted. For scenes of point lights
//! alone, what the rounds of adaptive sampling cost: the same 64 samples of every pixel with and
//! without them.
//!
//! One thread, its own time on a processor (Linux: `/proc/self/task`; elsewhere the clock's).

#[path = "shared/scenes.rs"]
mod scenes;

use glam::UVec2;
use glassbox::scene::Sampling;
use glassbox::trace::Dome;
use scenes::{Reference, Scene, scenes};

const SIZE: UVec2 = UVec2::new(128, 128);
const SAMPLES: u32 = 64;
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
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| {
        let (noisy, quiet): (Vec<_>, Vec<_>) = scenes(SIZE).partition(is_noisy);
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

/// Whether a scene has an area light, a dome, a lens, gloss or motion.
fn is_noisy(scene: &Scene) -> bool {
    let lights = &scene.world.lights;
    let areas = lights.segments.len() + lights.parallelograms.len();
    let sun = lights.directionals.iter().any(|light| light.disc.is_some());
    let moves = scene.world.needs.motion_samples > 0;
    let dome = Dome::of(&scene.world.environment, &scene.settings).is_some();
    areas > 0 || sun || dome || moves || scene.camera.has_lens() || scene.settings.features.glossy
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
    let (mut squared, mut seconds) = (0.0, [Some(0.0); 2]);
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
            if now.1 <= wanted {
                break Some(time_at(wanted, before, now));
            }
            if goal < nearest {
                break None;
            }
            before = Some(now);
            goal *= NEARER;
        };
        for (seconds, now) in seconds.iter_mut().zip([Some(uniform.seconds), sooner]) {
            *seconds = seconds.zip(now).map(|(sum, now)| sum + now / n);
        }
        squared += wanted / n;
    }
    let [uniform, adaptive] = seconds;
    let text = |seconds: Option<f64>, unit: &str| {
        seconds.map_or("not reached".into(), |seconds| {
            format!("{seconds:.2}{unit}")
        })
    };
    let sooner = uniform
        .zip(adaptive)
        .map(|(uniform, adaptive)| uniform / adaptive);
    println!(
        "| {} | {:.2} % | {} | {} | {} |",
        scene.name,
        100.0 * squared.sqrt(),
        text(uniform, " s"),
        text(adaptive, " s"),
        text(sooner, "")
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

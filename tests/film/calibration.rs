//! The estimated error against the true one, and samples where the error is against the same for all.
//!
//! A reference of 16,384 samples would take hours here, and is not needed: the mean of other seeds'
//! pictures is as unbiased as it is, and how far that mean is from the truth, the spread between
//! those seeds tells. What it is off by, on average, is subtracted.

use super::Scene;
use glam::{DVec3, UVec2};
use glassbox::film::{Picture, RELATIVE_FLOOR, render, render_samples};
use glassbox::scene::{RenderSettings, Sampling};
use std::sync::LazyLock;

const SIZE: UVec2 = UVec2::new(64, 64);
const SEEDS: u32 = 4;
const LEVELS: [u64; 3] = [16, 32, 64];
/// Samples of each seed's picture in a reference.
const LAST: u64 = 128;

/// The mean of several pictures, and how far it is from the truth.
struct Reference {
    means: Vec<DVec3>,
    /// Expected squared error of each pixel, averaged over the channels.
    squared_errors: Vec<f64>,
}

impl Reference {
    fn of(pictures: &[&Picture]) -> Self {
        let n = pictures.len() as f64;
        let at = |i: usize| {
            pictures
                .iter()
                .map(move |picture| picture.pixels[i].as_dvec3())
        };
        let pixels = 0..pictures[0].pixels.len();
        let means: Vec<DVec3> = pixels.map(|i| at(i).sum::<DVec3>() / n).collect();
        let spread = |(i, mean): (usize, &DVec3)| {
            let squares: f64 = at(i).map(|value| (value - mean).length_squared()).sum();
            squares / 3.0 / (n - 1.0) / n
        };
        let squared_errors = means.iter().enumerate().map(spread).collect();
        Self {
            means,
            squared_errors,
        }
    }

    /// The relative error and the RMSE of a picture that is none of the reference's.
    fn errors_of(&self, picture: &Picture) -> [f64; 2] {
        let (mut relative, mut absolute) = (0.0, 0.0);
        for ((pixel, mean), own) in picture
            .pixels
            .iter()
            .zip(&self.means)
            .zip(&self.squared_errors)
        {
            let square = (pixel.as_dvec3() - mean).length_squared() / 3.0 - own;
            let value = mean.element_sum() / 3.0;
            absolute += square;
            relative += square / (value * value + RELATIVE_FLOOR);
        }
        [relative, absolute].map(|sum| (sum / self.means.len() as f64).max(0.0).sqrt())
    }
}

struct Measured {
    scene: Scene,
    /// Of each seed and level: estimated over true, of the relative error and of the RMSE.
    factors: Vec<[[f64; 2]; LEVELS.len()]>,
    reference: Reference,
}

static MEASURED: LazyLock<Vec<Measured>> =
    LazyLock::new(|| Scene::all(SIZE).into_iter().map(measure).collect());

/// A seed's pictures of 16, 32, 64 and 128 samples, and what those of [`LEVELS`] say of themselves.
fn run(scene: &Scene, seed: u32) -> (Vec<Picture>, Vec<[f64; 2]>) {
    let settings = RenderSettings {
        seed,
        ..scene.settings.clone()
    };
    let part = |samples| render_samples(&scene.world, &scene.camera, &settings, samples, &|_| {});
    let mut film = part(0..LEVELS[0]).film;
    let mut pictures = vec![film.picture()];
    for samples in LEVELS {
        assert!(film.merge(&part(samples..2 * samples).film));
        pictures.push(film.picture());
    }
    let trend = part(0..LEVELS[2]).status.trend;
    let said = LEVELS.iter().map(|&level| {
        let point = trend.iter().find(|point| point.samples == level as f64);
        let error = point.expect("an estimate after each pass").error;
        [error.relative(), error.rmse]
    });
    (pictures, said.collect())
}

fn measure(scene: Scene) -> Measured {
    assert_eq!(2 * LEVELS[2], LAST);
    let runs: Vec<_> = (0..SEEDS).map(|seed| run(&scene, seed)).collect();
    let last = |seed: usize| runs[seed].0.last().unwrap();
    let factors = runs.iter().enumerate().map(|(seed, (pictures, said))| {
        let others: Vec<_> = (0..runs.len()).filter(|s| *s != seed).map(last).collect();
        let reference = Reference::of(&others);
        std::array::from_fn(|level| {
            let truth = reference.errors_of(&pictures[level]);
            [0, 1].map(|i| said[level][i] / truth[i])
        })
    });
    let factors = factors.collect();
    let all: Vec<_> = (0..runs.len()).map(last).collect();
    let reference = Reference::of(&all);
    Measured {
        scene,
        factors,
        reference,
    }
}

fn geometric_mean(factors: &[f64]) -> f64 {
    (factors.iter().map(|f| f.ln()).sum::<f64>() / factors.len() as f64).exp()
}

#[test]
fn the_estimated_error_is_the_true_one_within_a_factor_of_one_and_a_half() {
    let mut table = String::new();
    let mut wrong = Vec::new();
    let mut outside = 0;
    for measured in MEASURED.iter() {
        let name = measured.scene.name;
        table += &format!("{name:32}");
        for (level, samples) in LEVELS.iter().enumerate() {
            let of = |i: usize| -> Vec<f64> {
                measured.factors.iter().map(|seed| seed[level][i]).collect()
            };
            let [relative, rmse] = [of(0), of(1)];
            let (least, most) = relative
                .iter()
                .fold((f64::MAX, 0.0_f64), |(a, b), &f| (a.min(f), b.max(f)));
            let mean = geometric_mean(&relative);
            table += &format!(
                " | {samples} spp: {mean:.2} ({least:.2} to {most:.2}), RMSE {:.2}",
                geometric_mean(&rmse)
            );
            let bounds = bounds(name);
            // One seed may be out by chance: few pixels make most of so small a picture's error.
            let single = bounds.start / 1.1..bounds.end * 1.1;
            outside += relative.iter().filter(|f| !bounds.contains(f)).count();
            if !bounds.contains(&mean) || !single.contains(&least) || !single.contains(&most) {
                wrong.push(format!("{name} at {samples} spp: {least:.2} to {most:.2}"));
            }
        }
        table += "\n";
    }
    let all = MEASURED.len() * LEVELS.len() * SEEDS as usize;
    table += &format!("{outside} of {all} single pictures outside of the bounds\n");
    println!("{table}");
    assert!(wrong.is_empty(), "{}\n{table}", wrong.join(", "));
    assert!(40 * outside <= all, "{table}");
}

/// One scene is apart: the ceiling light's edges run exactly along rows of pixels, and the upper one covers
/// each of its dark row for the same small part. Then what a doubling wins says little of what is left,
/// in every pixel alike, and that row holds 96 % of the picture's relative error (`film/error.rs` has the
/// formula). Measured with 16, 32 and 64 samples, means over four to eight seeds: 0.8, 1.5 and 2.0 times the
/// true error at 64 × 64 pixels, 0.7 to 2.1 at 48 × 48, 0.9 to 2.3 at 96 × 96, 1.2 to 4.1 at 112 × 112, and
/// 0.9 to 1.7 at 256 × 256, 0.9 to 1.4 at 400 × 400, 0.75 to 0.88 at 800 × 800, where a thousandth of the pixels
/// makes up to four fifths of the error. At 192 × 192 one pixel, at the light's corner, makes 64 % of the error, and the
/// true error itself differs between four seeds 2.8 to 4.8 times: there no estimate is near each of them.
fn bounds(scene: &str) -> std::ops::Range<f64> {
    if scene == "cornell-box-parallelogram-light" {
        0.7..3.6
    } else {
        0.8..1.5
    }
}

#[test]
fn adaptive_samples_reach_the_same_error_with_fewer_rays() {
    // How the relative error falls with the rays, over all scenes.
    const SLOPE: f64 = 0.65;
    let mut table = String::new();
    let mut wrong = Vec::new();
    let mut gains = Vec::new();
    let each = MEASURED
        .iter()
        .flat_map(|measured| [(measured, 16), (measured, 64)]);
    for (measured, level) in each {
        let scene = &measured.scene;
        let render = |sampling, spp| {
            let settings = RenderSettings {
                seed: SEEDS,
                spp,
                sampling,
                ..scene.settings.clone()
            };
            render(&scene.world, &scene.camera, &settings, &|_, _| {})
        };
        let uniform = render(Sampling::default(), level);
        let goal = uniform.status.error().unwrap().relative();
        let sampling = Sampling {
            adaptive: true,
            error: goal as f32,
            time: 0.0,
        };
        let adaptive = render(sampling, 4096);
        let counts = adaptive.film.counts();
        let [least, most] =
            [counts.iter().min(), counts.iter().max()].map(|n| n.copied().unwrap_or_default());
        let [before, after] =
            [&uniform, &adaptive].map(|r| measured.reference.errors_of(&r.picture)[0]);
        let rays = uniform.status.rays.total() as f64 / adaptive.status.rays.total() as f64;
        let gain = rays * (before / after).powf(1.0 / SLOPE);
        let estimated = adaptive.status.error().unwrap().relative();
        let factor = estimated / after;
        table += &format!(
            "{:32} | uniform {level} spp {before:.4} | adaptive {after:.4}, estimated {factor:.2} of it | rays {rays:.2} times fewer | {least} to {most} spp | gain {gain:.2}\n",
            scene.name
        );
        // Where the estimates that set the goal and judge by it are off, they compare nothing.
        let comparable = bounds(scene.name).start >= 0.8;
        if comparable {
            gains.push(gain);
        }
        // One seed of a picture of sixteen tiles: a few pixels decide on the gain of a single scene.
        if comparable && gain < 0.75 || estimated > goal {
            wrong.push(format!("{}: gain {gain:.2}", scene.name));
        }
        if !bounds(scene.name).contains(&factor) {
            wrong.push(format!("{}: estimate {factor:.2} of it", scene.name));
        }
    }
    let mean = geometric_mean(&gains);
    table += &format!("mean gain {mean:.2}\n");
    println!("{table}");
    assert!(wrong.is_empty(), "{}\n{table}", wrong.join(", "));
    assert!(mean > 1.05, "{table}");
}

#[test]
fn adaptive_samples_have_the_same_mean() {
    // A hundred small pictures of a noisy scene each way, and what they differ in on average.
    const SEEDS: u32 = 100;
    let mut scene = Scene::open("cornell-box-parallelogram-light", UVec2::new(32, 32));
    scene.settings.spp = 1024;
    let (mut difference, mut squares, mut level, mut samples) = (0.0, 0.0, 0.0, 0.0);
    for seed in 0..SEEDS {
        scene.settings.seed = seed;
        let mean = |picture: &Picture| {
            let sum: f64 = picture
                .pixels
                .iter()
                .map(|p| f64::from(p.element_sum()))
                .sum();
            sum / picture.pixels.len() as f64
        };
        scene.settings.sampling.error = 0.05;
        let adaptive = render(&scene.world, &scene.camera, &scene.settings, &|_, _| {});
        scene.settings.sampling.error = 0.0;
        let uniform = mean(&scene.film(1024..1040).picture());
        let d = mean(&adaptive.picture) - uniform;
        difference += d;
        squares += d * d;
        level += uniform;
        samples += adaptive.status.samples;
    }
    let n = f64::from(SEEDS);
    let (bias, level) = (difference / n, level / n);
    let deviation = ((squares / n - bias * bias) / (n - 1.0)).sqrt();
    let said = format!(
        "bias {:+.3} % ± {:.3} %, {:.0} samples a pixel",
        100.0 * bias / level,
        100.0 * deviation / level,
        samples / n
    );
    println!("{said}");
    assert!(
        samples / n > 20.0 && deviation / level < 0.01,
        "says nothing: {said}"
    );
    assert!(bias.abs() < 4.0 * deviation, "{said}");
}

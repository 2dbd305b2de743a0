//! The estimated error against the true one, and samples where the error is against the same for all.
//!
//! A reference of 16,384 samples would take hours here. Its own error is what a shorter one lacks:
//! M_N, M_R being the means of the first N and R samples, E|M_N - M_R|² = e²(N) - e²(R), and e²(R) is
//! e²(N) times 0.4 for each doubling, as measured. Pictures of other samples than the reference's are
//! e²(N) + e²(R) away from it.

use super::{Scene, relative_error};
use glam::UVec2;
use glassbox::film::{Film, Picture, render};
use glassbox::scene::{RenderSettings, Sampling};
use std::sync::LazyLock;

const SIZE: UVec2 = UVec2::new(128, 128);
const REFERENCE: u64 = 256;
const DECLINE: f64 = 0.4;

/// A scene's pictures of 16, 32 and 64 samples with what they say of themselves, and a reference.
struct Measured {
    scene: Scene,
    passes: Vec<Pass>,
    reference: Picture,
}

/// Relative error and RMSE, estimated and true.
struct Pass {
    samples: u64,
    estimated: [f64; 2],
    true_error: [f64; 2],
}

impl Measured {
    /// The relative error of a picture of other samples than the reference's.
    fn error_of(&self, picture: &Picture) -> f64 {
        let last = &self.passes[self.passes.len() - 1];
        let reference = last.true_error[0].powi(2) * decline(last.samples);
        (relative_error(picture, &self.reference).powi(2) - reference)
            .max(0.0)
            .sqrt()
    }
}

/// What is left of e² of so many samples at the reference's.
fn decline(samples: u64) -> f64 {
    DECLINE.powf((REFERENCE as f64 / samples as f64).log2())
}

static MEASURED: LazyLock<Vec<Measured>> =
    LazyLock::new(|| Scene::all(SIZE).into_iter().map(measure).collect());

fn measure(mut scene: Scene) -> Measured {
    scene.settings.spp = 64;
    let uniform = render(&scene.world, &scene.camera, &scene.settings, &|_, _| {});
    let mut films: Vec<Film> = vec![scene.film(0..16)];
    films.push(films[0].clone());
    assert!(films[1].merge(&scene.film(16..32)));
    films.push(uniform.film.clone());
    let mut reference = uniform.film.clone();
    assert!(reference.merge(&scene.film(64..REFERENCE)));
    let reference = reference.picture();
    let passes = [16, 32, 64]
        .into_iter()
        .zip(films)
        .map(|(samples, film)| {
            let lacking = (1.0 / (1.0 - decline(samples))).sqrt();
            let picture = film.picture();
            let distance = [
                relative_error(&picture, &reference),
                picture.rmse(&reference).unwrap(),
            ];
            let point = uniform
                .status
                .trend
                .iter()
                .find(|p| p.samples == samples as f64);
            let error = point.unwrap().error;
            Pass {
                samples,
                estimated: [error.relative(), error.rmse],
                true_error: distance.map(|distance| distance * lacking),
            }
        })
        .collect();
    Measured {
        scene,
        passes,
        reference,
    }
}

#[test]
fn the_estimated_error_is_the_true_one_within_a_factor_of_one_and_a_half() {
    let mut table = String::new();
    let mut wrong = Vec::new();
    for measured in MEASURED.iter() {
        let mut row = format!("{:32}", measured.scene.name);
        let mut logarithm = 0.0;
        for pass in &measured.passes {
            let [relative, rmse] = [0, 1].map(|i| pass.estimated[i] / pass.true_error[i]);
            row += &format!(
                " | {} spp: {:.4} is {relative:.2} of it, RMSE {rmse:.2}",
                pass.samples, pass.estimated[0]
            );
            logarithm += relative.ln() / measured.passes.len() as f64;
            // Of a picture as small as this one, a few bright pixels make most of the error.
            if !(0.65..2.0).contains(&relative) {
                wrong.push(format!(
                    "{} at {} spp: {relative:.2}",
                    measured.scene.name, pass.samples
                ));
            }
        }
        let mean = logarithm.exp();
        if !(0.8..1.5).contains(&mean) {
            wrong.push(format!("{}: {mean:.2}", measured.scene.name));
        }
        table += &format!("{row} | mean {mean:.2}\n");
    }
    println!("{table}");
    assert!(wrong.is_empty(), "{}\n{table}", wrong.join(", "));
}

#[test]
fn adaptive_samples_reach_the_same_error_with_fewer_rays() {
    // How the relative error falls with the rays, over all scenes.
    const SLOPE: f64 = 0.65;
    let mut table = String::new();
    let mut wrong = Vec::new();
    for measured in MEASURED.iter() {
        let scene = &measured.scene;
        let render = |sampling, spp| {
            let settings = RenderSettings {
                seed: 1,
                spp,
                sampling,
                ..scene.settings.clone()
            };
            render(&scene.world, &scene.camera, &settings, &|_, _| {})
        };
        let uniform = render(Sampling::default(), 64);
        let goal = uniform.status.error().unwrap().relative();
        let sampling = Sampling {
            adaptive: true,
            error: goal as f32,
            time: 0.0,
        };
        let adaptive = render(sampling, 4096);
        let counts = adaptive.film.counts();
        let most = counts.iter().max().copied().unwrap_or_default();
        let [before, after] = [&uniform, &adaptive].map(|r| measured.error_of(&r.picture));
        let rays = uniform.rays.total() as f64 / adaptive.rays.total() as f64;
        let gain = rays * (before / after).powf(1.0 / SLOPE);
        let estimated = adaptive.status.error().unwrap().relative();
        table += &format!(
            "{:32} | uniform {before:.4} | adaptive {after:.4}, estimated {estimated:.4} | rays {rays:.2} times fewer | 16 to {most} spp | gain {gain:.2}\n",
            scene.name
        );
        if gain < 0.97 || estimated > goal {
            wrong.push(format!("{}: gain {gain:.2}", scene.name));
        }
        if !(0.65..2.0).contains(&(estimated / after)) {
            wrong.push(format!(
                "{}: estimate {:.2} of it",
                scene.name,
                estimated / after
            ));
        }
    }
    println!("{table}");
    assert!(wrong.is_empty(), "{}\n{table}", wrong.join(", "));
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

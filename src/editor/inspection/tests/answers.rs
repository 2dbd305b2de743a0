//! Questions about pixels.

use super::super::Which;
use super::{Bench, SIZE};
use crate::inspect::{Names, Question, answer};
use crate::scene::{Features, RenderSettings};
use crate::sync::{Traced, TracedCameras};
use crate::trace::{Camera, RayTree, Samples, probe};
use bevy::math::UVec2;

#[test]
fn one_sentence_says_what_a_pixel_shows_and_agrees_with_its_value() {
    let mut found = [0; 3];
    let mut read = |scene: &str, pixels: &[[u32; 2]]| {
        let mut bench = Bench::open(scene);
        bench.ray().which = Which::First;
        for &pixel in pixels {
            bench.shoot(pixel);
            bench.wait();
            let rays = bench.ray().rays().unwrap().clone();
            let names = bench.app.world().resource::<Names>().things.clone();
            let text = answer(Question::Black, &rays, &names);
            let value = rays.samples[0].value;
            // Beside what the surface has of its own, ambient light included.
            let by_light = (value - rays.rays[0].added).max_element();
            let goes_on = text.contains("is transparent, and behind it");
            if text.contains("is a mirror that sees") {
                found[2] += 1;
            } else if text.contains(" is lit by ") && !text.contains("none of that") {
                found[1] += 1;
                assert!(by_light > 0.0, "{scene} {pixel:?}, {value}: {text}");
            } else if text.contains(" is in the shadow of ") && !goes_on {
                found[0] += 1;
                assert!(by_light < 1e-6, "{scene} {pixel:?}, {value}: {text}");
            }
            assert!(text.ends_with('.') && !text.contains('#'), "{text}");
        }
    };
    let pixel = |i: u32| [30 + 60 * (i % 10), 40 + 75 * (i / 10)];
    let pixels: Vec<[u32; 2]> = (0..60).map(pixel).collect();
    for scene in ["cornell-box", "spheres"] {
        read(scene, &pixels);
    }
    assert!(found.iter().all(|&count| count > 0), "{found:?}");
}

/// The sum over the channels of the samples' variances.
fn variance(rays: &RayTree) -> f64 {
    let mean = rays.mean();
    let squares = rays
        .samples
        .iter()
        .map(|sample| (sample.value - mean).length_squared());
    squares.map(f64::from).sum::<f64>() / rays.samples.len() as f64
}

#[test]
fn without_what_pixels_are_said_to_be_noisy_from_they_are_less_noisy() {
    type TakeAway = fn(&mut Features, &mut Camera);
    let causes: [(&str, TakeAway); 3] = [
        ("motion: ", |features, _| features.motion = false),
        ("the lens: ", |_, camera| {
            camera.optics.aperture_radius = 0.0
        }),
        ("the soft shadow of ", |features, _| {
            features.soft_shadows = false
        }),
    ];
    let mut sums = [(0, 0.0, 0.0, 0.0); 3];
    let mut edges = 0;
    for scene in ["showcase", "marbles", "cornell-box-parallelogram-light"] {
        let bench = Bench::open(scene);
        let world = bench.app.world();
        let names = &world.resource::<Names>().things;
        let camera = &world.resource::<TracedCameras>().0[0].camera;
        let traced = &world.resource::<Traced>().world;
        let settings = RenderSettings {
            size: SIZE,
            spp: 64,
            ..world.resource::<RenderSettings>().clone()
        };
        for i in 0..300 {
            let pixel = UVec2::new(12 + 29 * (i % 20), 14 + 31 * (i / 20));
            let probe = |settings: &RenderSettings, camera: &Camera| {
                probe(traced, camera, settings, pixel, &Samples::All).unwrap()
            };
            let rays = probe(&settings, camera);
            let text = answer(Question::Noisy, &rays, names);
            assert!(
                text.ends_with('.') && !text.contains('#') && !text.contains("NaN"),
                "{text}"
            );
            let Some((told, said)) = text.split_once(" % of the variance is ") else {
                continue;
            };
            edges += usize::from(said.starts_with("an edge"));
            let Some(which) = causes.iter().position(|(cause, _)| said.starts_with(cause)) else {
                continue;
            };
            let (mut without, mut camera) = (settings.clone(), camera.clone());
            causes[which].1(&mut without.features, &mut camera);
            let without = variance(&probe(&without, &camera));
            let share: f64 = told.rsplit(' ').next().unwrap().parse().unwrap();
            let (count, sum, sum_told, sum_without) = &mut sums[which];
            *count += 1;
            *sum += variance(&rays);
            *sum_told += 0.01 * share * variance(&rays);
            *sum_without += without;
        }
    }
    for ((cause, _), (count, with, told, without)) in causes.iter().zip(sums) {
        assert!(count >= 3, "{cause} {count} pixels");
        // Without its cause a pixel stands in one of the states that it was mixed of, which may have an edge of its own.
        let gone = (with - without) / with;
        let told = told / with;
        assert!(
            gone > 0.6 * told,
            "{cause} {count} pixels: {gone} is gone of a share of {told}"
        );
    }
    assert!(edges >= 5, "{edges} pixels on edges");
}

#[test]
fn one_sentence_says_what_a_colour_is_mixed_of_and_its_shares_are_all_of_it() {
    let mut bench = Bench::open("cornell-box");
    bench.ray().which = Which::All;
    let mut of_wall = String::new();
    for x in (10..600).step_by(29) {
        bench.shoot([x, 240]);
        bench.wait();
        let rays = bench.ray().rays().unwrap().clone();
        let names = &bench.app.world().resource::<Names>().things;
        let text = answer(Question::Color, &rays, names);
        if rays.mean().max_element() == 0.0 {
            assert!(text.starts_with("It is black: "), "{text}");
            continue;
        }
        let shares = text
            .split(" (")
            .filter_map(|part| part.split_once(" %)")?.0.parse::<f64>().ok());
        let sum: f64 = shares.sum();
        assert!((sum - 100.0).abs() < 4.0, "{sum} %: {text}");
        if text.contains(": Red wall, of the colour") {
            of_wall = text;
        }
    }
    let own = "Red wall, of the colour (0.";
    assert!(
        of_wall.contains(own) && of_wall.contains(" is lit by Lamp"),
        "{of_wall}"
    );
}

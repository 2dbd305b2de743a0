//! How fast the error falls with the number of samples, at a fixed place of a surface.

mod builtin;

use crate::analytic::{dark_before_light, object, quad, square_light, world};
use glam::{UVec2, Vec3};
use glassbox::scene::{PixelSampling, RenderSettings, Sequence};
use glassbox::trace::{Camera, Material, SampleId, Workspace, World, radiance};

/// Running means of one pixel's red channel after each of `counts` samples, for one seed.
fn means(world: &World, camera: &Camera, settings: &RenderSettings, counts: &[u64]) -> Vec<f64> {
    let all = *counts.last().unwrap();
    let samples: Vec<_> = (0..all)
        .map(|index| SampleId {
            pixel: UVec2::ZERO,
            index,
        })
        .collect();
    let mut values = vec![Vec3::ZERO; samples.len()];
    let mut workspace = Workspace::default();
    radiance(
        world,
        camera,
        settings,
        &samples,
        &mut values,
        &mut workspace,
    );
    let mut sum = 0.0;
    let mut means = Vec::new();
    for (i, value) in values.iter().enumerate() {
        sum += f64::from(value.x);
        if counts.contains(&(i as u64 + 1)) {
            means.push(sum / (i + 1) as f64);
        }
    }
    means
}

/// Slope of log RMSE over log N, N = 4 … 1024, over 64 seeds. What is compared with is `truth`, or the mean of eight other
/// seeds' 65,536 samples each.
fn slope(
    world: &World,
    camera: &Camera,
    pixel: PixelSampling,
    sequence: Sequence,
    truth: Option<f64>,
) -> f64 {
    let counts: Vec<u64> = (2..=10).map(|k| 1 << k).collect();
    let settings = |seed| RenderSettings {
        size: UVec2::ONE,
        pixel,
        seed,
        sequence,
        ..RenderSettings::default()
    };
    let truth = truth.unwrap_or_else(|| {
        let long = |seed| means(world, camera, &settings(seed), &[1 << 16])[0];
        (1000..1008).map(long).sum::<f64>() / 8.0
    });
    let runs: Vec<_> = (0..64)
        .map(|seed| means(world, camera, &settings(seed), &counts))
        .collect();
    let points: Vec<(f64, f64)> = counts
        .iter()
        .enumerate()
        .map(|(i, &n)| {
            let mse = runs.iter().map(|run| (run[i] - truth).powi(2)).sum::<f64>() / 64.0;
            ((n as f64).ln(), 0.5 * mse.ln())
        })
        .collect();
    let mean = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>() / points.len() as f64;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    let covariance: f64 = points.iter().map(|p| (p.0 - mx) * (p.1 - my)).sum();
    covariance / points.iter().map(|p| (p.0 - mx).powi(2)).sum::<f64>()
}

/// A floor under a square light; with a screen that hides part of the light.
fn under_a_light(screen: bool) -> (World, Camera) {
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    let hidden = quad(
        Vec3::new(-0.17, 1.0, -3.0),
        Vec3::new(0.3, 0.0, 6.0),
        Vec3::X * 4.0,
    );
    let mut objects = vec![object(1, &floor, 0)];
    if screen {
        objects.push(object(2, &hidden, 0));
    }
    let mut world = world(objects, vec![Material::default()]);
    world.lights = square_light(2.0, 1);
    let camera = Camera::looking_at(
        Vec3::new(-1.2, 0.4, 0.1),
        Vec3::new(0.0, 0.0, 0.05),
        Vec3::Y,
        0.01,
    );
    (world.with_needs(), camera)
}

#[test]
fn smooth_light_converges_with_slope_one_point_three_and_random_numbers_with_a_half() {
    let (world, camera) = under_a_light(false);
    let ours = slope(
        &world,
        &camera,
        PixelSampling::Center,
        Sequence::Sobol,
        None,
    );
    let random = slope(
        &world,
        &camera,
        PixelSampling::Center,
        Sequence::Independent,
        None,
    );
    assert!(ours <= -1.3, "slope {ours:.2}");
    let area = slope(&world, &camera, PixelSampling::Area, Sequence::Sobol, None);
    println!("smooth light at a point: N^{ours:.2}, over the pixel: N^{area:.2}");
    // The pixel's two numbers and the light's two are padded: four dimensions that are not one net.
    assert!(area <= -0.5, "slope {area:.2} over the pixel");
    assert!(
        (-0.6..-0.4).contains(&random),
        "slope of random numbers {random:.2}"
    );
}

#[test]
fn a_penumbra_converges_with_slope_zero_point_seven() {
    let (world, camera) = under_a_light(true);
    let ours = slope(
        &world,
        &camera,
        PixelSampling::Center,
        Sequence::Sobol,
        None,
    );
    assert!(ours <= -0.7, "slope {ours:.2}");
    let area = slope(&world, &camera, PixelSampling::Area, Sequence::Sobol, None);
    println!("penumbra at a point: N^{ours:.2}, over the pixel: N^{area:.2}");
    assert!(area <= -0.5, "slope {area:.2} over the pixel");
}

/// A dark half-plane before a bright background; its edge crosses the pixel. With its coverage.
fn half_plane(angle: f32, offset: f32) -> (World, Camera, f64) {
    let along = Vec3::new(angle.cos(), angle.sin(), 0.0);
    let inwards = Vec3::new(-angle.sin(), angle.cos(), 0.0);
    let corner = inwards * offset - along * 50.0;
    let plane = quad(corner, along * 100.0, inwards * 100.0);
    let world = dark_before_light(object(1, &plane, 0));
    // The pixel sees the square [-1, 1]² of the plane z = 0.
    let camera = Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, std::f32::consts::FRAC_PI_2);
    // The bright part is where inwards · p < offset: integrate along x, exactly but for the grid.
    let (nx, ny, c) = (
        f64::from(inwards.x),
        f64::from(inwards.y),
        f64::from(offset),
    );
    let n = 200_000;
    let bright: f64 = (0..n)
        .map(|i| {
            let x = -1.0 + 2.0 * (f64::from(i) + 0.5) / f64::from(n);
            let y = (c - nx * x) / ny;
            if ny > 0.0 {
                (y.clamp(-1.0, 1.0) + 1.0) / 2.0
            } else {
                (1.0 - y.clamp(-1.0, 1.0)) / 2.0
            }
        })
        .sum::<f64>()
        / f64::from(n);
    (world.with_needs(), camera, bright)
}

#[test]
fn an_edge_converges_with_slope_zero_point_seven() {
    let (world, camera, truth) = half_plane(0.37, 0.21);
    let ours = slope(
        &world,
        &camera,
        PixelSampling::Area,
        Sequence::Sobol,
        Some(truth),
    );
    assert!(ours <= -0.7, "slope {ours:.2}");
    // An edge has no width at a point; the pixel is all there is. Over edges of other angles and
    // places, whose slopes differ:
    let slopes: Vec<f64> = (0..6)
        .map(|i| {
            let (world, camera, truth) = half_plane(0.1 + 0.23 * i as f32, -0.5 + 0.17 * i as f32);
            let (pixel, sequence) = (PixelSampling::Area, Sequence::Sobol);
            slope(&world, &camera, pixel, sequence, Some(truth))
        })
        .collect();
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    println!("an edge over the pixel: N^{ours:.2}; six others: {slopes:.2?}, mean N^{mean:.2}");
    assert!(mean <= -0.7, "mean slope {mean:.2}");
}

#[test]
fn coverage_of_a_half_plane_stays_within_the_bound_of_a_net() {
    // A (0, m, 2)-net has one point in each cell of a √N × √N grid; a line cuts at most 2√N - 1 of
    // them, and only those can be wrong, by at most 1/N each.
    let settings = |seed| RenderSettings {
        size: UVec2::ONE,
        seed,
        ..RenderSettings::default()
    };
    for i in 0..40 {
        let (world, camera, truth) = half_plane(0.05 + i as f32 * 0.155, -0.6 + i as f32 * 0.03);
        for n in [16_u64, 64, 256, 1024] {
            let found = means(&world, &camera, &settings(i), &[n])[0];
            let bound = (2.0 * (n as f64).sqrt() - 1.0) / n as f64;
            let error = (found - truth).abs();
            assert!(
                error <= bound,
                "edge {i}, {n} samples: {error:.4} exceeds {bound:.4}"
            );
        }
    }
}

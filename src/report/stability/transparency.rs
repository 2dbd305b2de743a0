//! Cases of layers and mirrors.

use super::scenes::{central_radiance, flat, once, quad, world};
use super::{Effort, Outcome};
use crate::report::table::digits;
use crate::scene::RenderSettings;
use crate::trace::{Camera, Environment, Material, World};
use glam::Vec3;

fn pane(opacity: f32) -> Material {
    Material {
        diffuse: Vec3::ONE,
        opacity,
        ..Material::default()
    }
}

/// A square across the line of sight.
fn square(z: f32) -> [Vec3; 6] {
    quad(Vec3::new(-1.0, -1.0, z), Vec3::X * 2.0, Vec3::Y * 2.0)
}

fn before_one(mut world: World) -> World {
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    world
}

pub(super) fn shared_edge(effort: &Effort) -> Outcome {
    let scene = before_one(world(vec![flat(1, &square(0.0), 0)], vec![pane(0.5)]));
    let places = (effort.rays / 1000).clamp(19, 5_000);
    let mut wrong = 0;
    for i in 0..places {
        // The diagonal of the square passes under the central ray.
        let x = -0.95 + 1.9 * i as f32 / places as f32;
        let camera = Camera::looking_at(Vec3::new(x, x, 3.0), Vec3::new(x, x, 0.0), Vec3::Y, 0.1);
        let (value, counts) = central_radiance(&scene, &camera, &once());
        wrong += usize::from((value.x, counts.transmission) != (0.5, 1));
    }
    Outcome::new(
        places,
        format!("{wrong} rays cross another number of layers than 1"),
    )
    .require(
        wrong == 0,
        format!("{wrong} rays cross another number of layers"),
    )
}

pub(super) fn layers(_: &Effort) -> Outcome {
    let opacities: Vec<f32> = (0..64).map(|i| 0.002 + 0.0005 * i as f32).collect();
    let objects = (0..64u32).map(|i| flat(u64::from(i) + 1, &square(i as f32 * 1e-3), i));
    let materials = opacities.iter().map(|&opacity| pane(opacity)).collect();
    let scene = before_one(world(objects.collect(), materials));
    let from = Vec3::new(0.1, 0.2, 5.0);
    let camera = Camera::looking_at(from, Vec3::new(0.1, 0.2, 0.0), Vec3::Y, 0.1);
    let (value, counts) = central_radiance(&scene, &camera, &once());
    let expected: f64 = opacities.iter().map(|&d| 1.0 - f64::from(d)).product();
    let error = (f64::from(value.x) / expected - 1.0).abs();
    Outcome::new(
        64,
        format!(
            "{} layers crossed, relative error {}",
            counts.transmission,
            digits(error, 2)
        ),
    )
    .require(error < 1e-5, format!("relative error {error:e}"))
    .require(
        counts.transmission == 64,
        format!("{} layers", counts.transmission),
    )
}

pub(super) fn mirrors(_: &Effort) -> Outcome {
    // The camera sits between two mirrors that also emit: after k bounces each adds ks^k · ke.
    let wall = |y| quad(Vec3::new(-9.0, y, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
    let material = Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(0.9),
        // So narrow a highlight that none is seen: only what the mirror shows counts.
        shininess: 1e6,
        emission: Vec3::ONE,
        ..Material::default()
    };
    let scene = world(
        vec![flat(1, &wall(0.0), 0), flat(2, &wall(1.0), 0)],
        vec![material],
    );
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, Vec3::X, 0.1);
    let (mut worst, mut bounces, mut wrong) = (0.0_f64, 0, 0);
    for max_depth in 0..=50 {
        let settings = RenderSettings {
            max_depth,
            ..once()
        };
        let (value, counts) = central_radiance(&scene, &camera, &settings);
        let expected = (1.0 - 0.9_f64.powi(max_depth as i32 + 1)) / (1.0 - 0.9);
        worst = worst.max((f64::from(value.x) / expected - 1.0).abs());
        wrong += usize::from(counts.mirror != u64::from(max_depth));
        bounces += counts.mirror as usize;
    }
    Outcome::new(
        bounces,
        format!(
            "depths 0 to 50: relative error at most {}",
            digits(worst, 2)
        ),
    )
    .require(worst < 1e-5, format!("relative error {worst:e}"))
    .require(
        wrong == 0,
        format!("{wrong} depths with another number of bounces"),
    )
}

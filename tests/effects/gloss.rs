use crate::analytic::{Numbers, central_radiance, object, quad, world};
use glam::{DVec3, Vec3};
use glassbox::scene::{Features, RenderSettings};
use glassbox::trace::{Camera, Environment, Material, Texels, Texture, World};
use std::sync::Arc;

/// A map whose every direction has another value, and that value written again here.
fn environment() -> Environment {
    let (width, height) = (64, 32);
    let texels = (0..width * height)
        .map(|i| {
            let (x, y) = (
                (i % width) as f32 / width as f32,
                (i / width) as f32 / height as f32,
            );
            [2.0 + (6.0 * std::f32::consts::TAU * x).sin(), 4.0 * y, 1.0]
        })
        .collect();
    Environment {
        map: Some(Arc::new(
            Texture::new(width, height, Texels::Linear32(texels)).unwrap(),
        )),
        intensity: 1.0,
        ..Environment::default()
    }
}

fn surface(material: Material) -> World {
    let floor = quad(Vec3::new(-4.0, 0.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0);
    let mut world = world(vec![object(1, &floor, 0)], vec![material]);
    world.environment = environment();
    world
}

/// MODEL: the direction plus a uniform point of the disc of radius 1/s, where that leaves the
/// surface; by rejection in f64, with none of the tracer's code.
fn reference(axis: Vec3, normal: Vec3, shininess: f64, environment: &Environment) -> DVec3 {
    let axis = axis.as_dvec3();
    let helper = if axis.x.abs() < 0.5 {
        DVec3::X
    } else {
        DVec3::Y
    };
    let x = axis.cross(helper).normalize();
    let y = axis.cross(x);
    let mut numbers = Numbers(77);
    let (mut sum, mut count) = (DVec3::ZERO, 0);
    while count < 400_000 {
        let u = f64::from(numbers.between(-1.0, 1.0));
        let v = f64::from(numbers.between(-1.0, 1.0));
        let direction = axis + (x * u + y * v) / shininess;
        if u * u + v * v > 1.0 || direction.dot(normal.as_dvec3()) <= 0.0 {
            continue;
        }
        sum += environment.radiance(direction.as_vec3()).as_dvec3();
        count += 1;
    }
    sum / f64::from(count)
}

#[test]
fn glossy_reflections_converge_to_the_mean_over_the_disc_also_where_the_surface_cuts_it() {
    for (height, shininess) in [(2.0, 4.0), (0.6, 2.0), (0.15, 1.5)] {
        let material = Material {
            diffuse: Vec3::ZERO,
            specular: Vec3::ONE,
            mirror: Vec3::ONE,
            shininess,
            ..Material::default()
        };
        let world = surface(material);
        let from = Vec3::new(0.3, height, 1.0);
        let camera = Camera::looking_at(from, Vec3::ZERO, Vec3::Y, 0.1);
        let settings = RenderSettings {
            spp: 4096,
            features: Features {
                glossy: true,
                ..Features::default()
            },
            ..RenderSettings::default()
        };
        let (value, _) = central_radiance(&world, &camera, &settings);
        let mirrored = Vec3::new(-from.x, from.y, -from.z).normalize();
        let expected = reference(mirrored, Vec3::Y, f64::from(shininess), &world.environment);
        // The reference's own noise: σ/√400,000 with σ about 1.
        let error = (value.as_dvec3() - expected).abs().max_element();
        assert!(error < 8e-3, "height {height}: {value} for {expected}");
    }
}

#[test]
fn translucent_surfaces_converge_to_the_mean_over_the_disc_on_the_far_side() {
    let shininess = 2.0;
    let material = Material {
        diffuse: Vec3::ZERO,
        shininess,
        opacity: 0.25,
        ..Material::default()
    };
    let world = surface(material);
    for height in [2.0, 0.3] {
        let from = Vec3::new(0.3, height, 1.0);
        let camera = Camera::looking_at(from, Vec3::ZERO, Vec3::Y, 0.1);
        let settings = RenderSettings {
            spp: 4096,
            features: Features {
                translucency: true,
                ..Features::default()
            },
            ..RenderSettings::default()
        };
        let (value, _) = central_radiance(&world, &camera, &settings);
        let expected = 0.75
            * reference(
                -from.normalize(),
                Vec3::NEG_Y,
                f64::from(shininess),
                &world.environment,
            );
        let error = (value.as_dvec3() - expected).abs().max_element();
        assert!(error < 8e-3, "height {height}: {value} for {expected}");
    }
}

#[test]
fn more_gloss_samples_cost_more_rays_and_less_variance_and_never_multiply_each_other() {
    let material = Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(0.5),
        mirror: Vec3::splat(0.5),
        shininess: 2.0,
        opacity: 0.5,
        ..Material::default()
    };
    let world = surface(material);
    let camera = Camera::looking_at(Vec3::new(0.3, 1.0, 1.0), Vec3::ZERO, Vec3::Y, 0.1);
    let run = |gloss_samples, translucency_samples, seed| {
        let settings = RenderSettings {
            spp: 4,
            seed,
            gloss_samples,
            translucency_samples,
            features: Features {
                glossy: true,
                translucency: true,
                ..Features::default()
            },
            ..RenderSettings::default()
        };
        central_radiance(&world, &camera, &settings)
    };
    let variance = |gloss, translucency| {
        let values: Vec<f64> = (0..64)
            .map(|seed| f64::from(run(gloss, translucency, seed).0.x))
            .collect();
        let mean = values.iter().sum::<f64>() / 64.0;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 64.0
    };
    let (few, many) = (variance(1, 1), variance(16, 16));
    assert!(
        many < 0.25 * few,
        "variance {many:e} for 16 rays, {few:e} for one"
    );
    let counts = run(16, 8, 0).1;
    assert_eq!((counts.mirror, counts.transmission), (4 * 16, 4 * 8));
}

//! Mirrors against the scenes that they show.

use super::*;
use glassbox::film::render;
use glassbox::trace::{Environment, Lights, PointLight};

fn mirror(ks: f32) -> Material {
    Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(ks),
        mirror: Vec3::splat(ks),
        // So narrow a highlight that none is seen: only what the mirror shows counts.
        shininess: 1e6,
        ..Material::default()
    }
}

#[test]
fn a_mirror_in_a_constant_environment_shows_ks_times_it() {
    let corners = quad(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0);
    let mut world = world(vec![object(1, &corners, 0)], vec![mirror(0.75)]);
    world.environment = Environment {
        background: Vec3::new(2.0, 4.0, 8.0),
        ..Environment::default()
    };
    let camera = Camera::looking_at(Vec3::new(0.3, 1.0, 0.2), Vec3::ZERO, Vec3::X, 0.5);
    let (radiance, counts) = central_radiance(&world, &camera, &RenderSettings::default());
    assert_eq!(radiance, Vec3::new(1.5, 3.0, 6.0));
    assert_eq!(counts.mirror, counts.camera);
}

#[test]
fn two_parallel_mirrors_show_the_geometric_series_to_depth_fifty() {
    // The camera sits between two mirrors that also emit: after k bounces each adds ks^k · ke.
    let low = quad(Vec3::new(-9.0, 0.0, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
    let high = quad(Vec3::new(-9.0, 1.0, -9.0), Vec3::Z * 18.0, Vec3::X * 18.0);
    let material = Material {
        emission: Vec3::ONE,
        ..mirror(0.9)
    };
    let world = world(
        vec![object(1, &low, 0), object(2, &high, 0)],
        vec![material],
    );
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.0), Vec3::ZERO, Vec3::X, 0.1);
    for depth in [0_u32, 1, 7, 50] {
        let settings = RenderSettings {
            max_depth: depth,
            spp: 1,
            ..RenderSettings::default()
        };
        let (radiance, counts) = central_radiance(&world, &camera, &settings);
        let expected = (1.0 - 0.9_f64.powi(depth as i32 + 1)) / (1.0 - 0.9);
        let error = (f64::from(radiance.x) / expected - 1.0).abs();
        assert!(error < 1e-5, "depth {depth}: {} for {expected}", radiance.x);
        assert_eq!(counts.mirror, u64::from(depth));
    }
}

#[test]
fn a_mirrors_image_is_the_picture_of_the_virtual_scene() {
    let box_at = |z: f32| {
        let c = Vec3::new(-0.3, -0.2, z);
        let mut corners = quad(c, Vec3::X * 0.7, Vec3::Y * 0.6).to_vec();
        corners.extend(quad(
            c + Vec3::new(0.1, 0.3, 0.2),
            Vec3::X * 0.4,
            Vec3::new(0.1, 0.5, 0.1),
        ));
        corners
    };
    let flip = |p: &Vec3| Vec3::new(p.x, p.y, -p.z);
    let real: Vec<_> = box_at(1.5);
    let virtual_: Vec<_> = real.iter().map(flip).collect();
    let matt = Material {
        diffuse: Vec3::new(0.8, 0.5, 0.3),
        ..Material::default()
    };
    let glass = quad(Vec3::new(-5.0, -5.0, 0.0), Vec3::X * 10.0, Vec3::Y * 10.0);
    let light = |position| Lights {
        points: vec![PointLight {
            id: 9,
            position,
            color: Vec3::splat(5.0),
            cone: None,
        }],
        ..Lights::default()
    };
    // The mirror looks towards +z; the boxes stand behind the camera, lit from the mirror's side.
    let lamp = Vec3::new(1.0, 2.0, 0.5);
    let mut seen_in_mirror = world(
        vec![object(1, &real, 0), object(2, &glass, 1)],
        vec![matt.clone(), mirror(1.0)],
    );
    seen_in_mirror.lights = Arc::new(light(lamp));
    let mut seen_directly = world(vec![object(1, &virtual_, 0)], vec![matt]);
    seen_directly.lights = Arc::new(light(flip(&lamp)));
    let settings = RenderSettings {
        size: UVec2::new(64, 64),
        spp: 1,
        pixel: PixelSampling::Center,
        max_depth: 1,
        ..RenderSettings::default()
    };
    // From where the real boxes themselves are out of view: only what lies beyond the mirror counts.
    let camera = Camera::looking_at(
        Vec3::new(0.4, 0.3, 1.0),
        Vec3::new(0.0, 0.1, -1.5),
        Vec3::Y,
        0.6,
    );
    let a = render(&seen_in_mirror, &camera, &settings, &|_, _| {}).picture;
    let b = render(&seen_directly, &camera, &settings, &|_, _| {}).picture;
    let lit = b.pixels.iter().filter(|p| p.x > 0.0).count();
    assert!(lit > 300, "only {lit} lit pixels");
    let differing = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .filter(|(a, b)| (**a - **b).abs().max_element() > 1e-4 * (1.0 + b.max_element()))
        .count();
    // Only rays that pass within rounding of an edge may fall on either side of it.
    assert!(differing <= 4, "{differing} of 4096 pixels differ");
}

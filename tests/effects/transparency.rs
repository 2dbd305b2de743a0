use crate::analytic::{central_radiance, object, quad, world};
use glam::{UVec2, Vec3};
use glassbox::film::render;
use glassbox::scene::RenderSettings;
use glassbox::trace::{Camera, Environment, Lights, Material, PointLight, World};
use std::sync::Arc;

fn pane(opacity: f32, color: Vec3) -> Material {
    Material {
        diffuse: color,
        opacity,
        ..Material::default()
    }
}

/// Square panes across the line of sight, at the given depths.
fn panes(depths: &[f32]) -> Vec<Vec3> {
    depths
        .iter()
        .flat_map(|&z| quad(Vec3::new(-1.0, -1.0, z), Vec3::X * 2.0, Vec3::Y * 2.0))
        .collect()
}

fn ahead() -> Camera {
    Camera::looking_at(
        Vec3::new(0.1, 0.2, 5.0),
        Vec3::new(0.1, 0.2, 0.0),
        Vec3::Y,
        0.1,
    )
}

#[test]
fn sixty_four_layers_let_through_the_product_of_their_transmittances() {
    // Layers of different opacity: 64 materials, one pane each; unlit, before a background of one.
    let depths: Vec<f32> = (0..64).map(|i| i as f32 * 1e-3).collect();
    let opacities: Vec<f32> = (0..64).map(|i| 0.002 + 0.0005 * i as f32).collect();
    let objects = depths
        .iter()
        .zip(0u64..)
        .map(|(&z, i)| object(i + 1, &panes(&[z]), i as u32))
        .collect();
    let materials = opacities.iter().map(|&d| pane(d, Vec3::ONE)).collect();
    let mut world = world(objects, materials);
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    let settings = RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    };
    let (value, counts) = central_radiance(&world, &ahead(), &settings);
    let expected: f64 = opacities.iter().map(|&d| 1.0 - f64::from(d)).product();
    let error = (f64::from(value.x) / expected - 1.0).abs();
    assert!(error < 1e-5, "relative error {error:e}");
    assert_eq!(counts.transmission, 64);
}

/// So many panes that let half of the light through.
fn halving(count: usize, background: f32) -> World {
    let depths: Vec<f32> = (0..count).map(|i| i as f32 * -1e-3).collect();
    let mut world = world(
        vec![object(1, &panes(&depths), 0)],
        vec![pane(0.5, Vec3::ONE)],
    );
    world.environment = Environment {
        background: Vec3::splat(background),
        ..Environment::default()
    };
    world
}

#[test]
fn behind_ten_thousand_panes_nothing_is_looked_for() {
    let mut world = halving(10_000, 1.0);
    world.lights = Arc::new(Lights {
        points: vec![PointLight {
            id: 9,
            position: Vec3::new(0.0, 0.0, -20.0),
            color: Vec3::ONE,
            cone: None,
        }],
        ..Lights::default()
    });
    let settings = RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    };
    let (value, counts) = central_radiance(&world.with_needs(), &ahead(), &settings);
    assert!(value.max_element() < 1e-4, "{value}");
    // Twelve halvings to where chance begins, and two more on average.
    let (crossed, to_light) = (counts.transmission, counts.shadow);
    assert!((12..64).contains(&crossed), "{crossed} panes were crossed");
    assert!(to_light <= crossed + 1, "{to_light} rays to the light");
}

#[test]
fn what_goes_on_by_chance_is_what_arrives_on_average() {
    // Four halvings below where chance begins: one sample in sixteen arrives, with 16.
    let world = halving(16, 65_536.0);
    let settings = RenderSettings {
        spp: 4,
        size: UVec2::splat(64),
        ..RenderSettings::default()
    };
    let picture = render(&world, &ahead(), &settings, &|_, _| {}).picture;
    let pixels = &picture.pixels;
    let mean = pixels.iter().map(|p| f64::from(p.x)).sum::<f64>() / pixels.len() as f64;
    // The standard deviation of a sample is sqrt(15).
    let error = (15.0 / (4.0 * pixels.len() as f64)).sqrt();
    assert!(
        (mean - 1.0).abs() < 4.0 * error,
        "{mean} where 1 arrives, standard error {error}"
    );
    let some = pixels.iter().filter(|p| p.x > 0.0).count();
    assert!(some < pixels.len() / 2, "{some} pixels of {}", pixels.len());
}

#[test]
fn a_ray_along_the_shared_edge_of_two_triangles_crosses_one_layer() {
    // The diagonal of the quad passes under the central ray.
    let mut world = world(
        vec![object(1, &panes(&[0.0]), 0)],
        vec![pane(0.5, Vec3::ONE)],
    );
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    let settings = RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    };
    for i in -9..=9 {
        let x = i as f32 * 0.1;
        let camera = Camera::looking_at(Vec3::new(x, x, 3.0), Vec3::new(x, x, 0.0), Vec3::Y, 0.1);
        let (value, counts) = central_radiance(&world, &camera, &settings);
        assert_eq!((value.x, counts.transmission), (0.5, 1), "at {x}");
    }
}

#[test]
fn shadows_take_the_colour_of_what_the_light_crosses_and_an_opaque_surface_lets_nothing_through() {
    let floor = quad(Vec3::new(-4.0, 0.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0);
    let glass = quad(Vec3::new(-4.0, 1.0, -4.0), Vec3::Z * 8.0, Vec3::X * 8.0);
    let white = Material {
        diffuse: Vec3::ONE,
        ..Material::default()
    };
    let color = Vec3::new(0.2, 0.6, 1.0);
    let light = || Lights {
        points: vec![PointLight {
            id: 9,
            position: Vec3::new(0.0, 3.0, 0.0),
            color: Vec3::splat(9.0),
            cone: None,
        }],
        ..Lights::default()
    };
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.6), Vec3::ZERO, Vec3::Y, 0.1);
    let settings = RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    };
    let mut last = f32::INFINITY;
    for d in [0.0, 0.25, 0.5, 0.9, 0.99, 1.0] {
        let mut lit = world(
            vec![object(1, &floor, 0), object(2, &glass, 1)],
            vec![white.clone(), pane(d, color)],
        );
        lit.lights = Arc::new(light());
        let (value, _) = central_radiance(&lit, &camera, &settings);
        let expected = std::f32::consts::FRAC_1_PI * (1.0 - d) * Vec3::ONE.lerp(color, d);
        assert!(
            (value - expected).length() < 1e-6,
            "d = {d}: {value} for {expected}"
        );
        // No jump between almost opaque and opaque.
        assert!(value.x <= last);
        last = value.x;
    }
    assert_eq!(last, 0.0);
}

#[test]
fn a_hit_that_reflects_and_transmits_keeps_its_mean_however_deep_the_stack() {
    // Half-mirrors before a mirror world of background 1: whatever way light goes, it ends in 1,
    // so the value is that of a closed recursion; compare many samples with depth-first expansion.
    let depths = [0.0, 0.5, 1.0, 1.5];
    let material = Material {
        diffuse: Vec3::ZERO,
        specular: Vec3::splat(0.8),
        mirror: Vec3::splat(0.8),
        shininess: 1e6,
        opacity: 0.5,
        ..Material::default()
    };
    let mut world = world(vec![object(1, &panes(&depths), 0)], vec![material]);
    world.environment = Environment {
        background: Vec3::ONE,
        ..Environment::default()
    };
    let settings = RenderSettings {
        spp: 16_384,
        max_depth: 8,
        ..RenderSettings::default()
    };
    let (value, counts) = central_radiance(&world, &ahead(), &settings);
    // L(gap, direction, bounces): what arrives from there; panes at 0..4, the camera above pane 3.
    fn expected(pane: i32, down: bool, bounces: u32) -> f64 {
        if !(0..4).contains(&pane) {
            return 1.0;
        }
        let (on, back) = if down {
            (pane - 1, pane + 1)
        } else {
            (pane + 1, pane - 1)
        };
        let reflected = if bounces < 8 {
            0.5 * 0.8 * expected(back, !down, bounces + 1)
        } else {
            0.0
        };
        reflected + 0.5 * expected(on, down, bounces)
    }
    let expected = expected(3, true, 0);
    let error = (f64::from(value.x) / expected - 1.0).abs();
    assert!(
        error < 2e-3,
        "{} for {expected}: relative error {error:e}",
        value.x
    );
    // Not the 2^depth tree: a path splits only while it carries an eighth.
    let per_sample = counts.total() / 16_384;
    assert!(per_sample < 64, "{per_sample} rays a sample");
}

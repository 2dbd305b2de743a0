//! An environment that lights: against closed forms, against other lights, and against itself without light.

use super::*;
use glassbox::scene::Lighting;
use glassbox::trace::{DOME, DirectionalLight, Dome, SunDisc, Texels, Texture};
use std::f32::consts::{PI, TAU};

/// An environment of one colour that lights.
pub(super) fn even(radiance: f32) -> Environment {
    Environment {
        background: Vec3::splat(radiance),
        lights: true,
        samples: 1,
        ..Environment::default()
    }
}

/// One whose radiance at the texel (x, y) of a map is that.
pub(super) fn mapped(width: u32, height: u32, of: impl Fn(u32, u32) -> f32) -> Environment {
    let texels = (0..width * height).map(|i| [of(i % width, i / width); 3]);
    let map = Texture::new(width, height, Texels::Linear32(texels.collect())).unwrap();
    Environment {
        map: Some(Arc::new(map)),
        intensity: 1.0,
        ..even(0.0)
    }
}

/// A sky of radiance 1 with a sun of one texel; its direction, and what a surface that faces it gets from it alone.
pub(super) fn sunny(sun: f32) -> (Environment, Vec3, f32) {
    let (width, height, at) = (256, 128, (40, 30));
    let environment = mapped(width, height, |x, y| if (x, y) == at { sun } else { 1.0 });
    let [around, across] = [
        TAU * ((at.0 as f32 + 0.5) / width as f32 - 0.5),
        PI * (at.1 as f32 + 0.5) / height as f32,
    ];
    let direction = Vec3::new(
        across.sin() * around.sin(),
        across.cos(),
        -across.sin() * around.cos(),
    );
    // Bilinear, it is spread over the four texels around: as much as one of its own.
    let texel = TAU / width as f32 * (PI / height as f32) * across.sin();
    (environment, direction, (sun - 1.0) * texel)
}

/// A matt floor of 20 m with kd below `environment`, and a camera that sees its middle.
fn floor(environment: Environment, kd: f32) -> (World, Camera) {
    let corners = quad(
        Vec3::new(-10.0, 0.0, 10.0),
        Vec3::X * 20.0,
        Vec3::NEG_Z * 20.0,
    );
    let material = Material {
        diffuse: Vec3::splat(kd),
        ..Material::default()
    };
    let mut world = world(vec![object(1, &corners, 0)], vec![material]);
    world.environment = environment;
    let camera = Camera::looking_at(Vec3::new(0.0, 3.0, 0.001), Vec3::ZERO, Vec3::NEG_Z, 0.5);
    (world, camera)
}

fn settings(spp: u32) -> RenderSettings {
    RenderSettings {
        spp,
        ..RenderSettings::default()
    }
}

#[test]
fn below_a_white_dome_a_matt_floor_has_its_kd_in_every_sample() {
    for kd in [0.2_f32, 0.8] {
        let (world, camera) = floor(even(1.0), kd);
        for spp in [1, 16] {
            let (found, _) = central_radiance(&world, &camera, &settings(spp));
            assert!((found.x - kd).abs() < 1e-5, "{found} instead of {kd}");
        }
    }
    // A map of one colour is one colour; its intensity multiplies it.
    let map = Environment {
        intensity: 2.5,
        ..mapped(8, 4, |_, _| 0.4)
    };
    let (world, camera) = floor(map, 0.8);
    let (found, _) = central_radiance(&world, &camera, &settings(4));
    assert!((found.x - 0.8).abs() < 1e-5, "{found}");
}

#[test]
fn a_sun_in_a_map_casts_the_shadow_of_a_light_of_its_strength() {
    let (environment, direction, irradiance) = sunny(20_000.0);
    // A sheet over the floor.
    let shade = quad(Vec3::new(-1.0, 1.5, 1.0), Vec3::X * 2.0, Vec3::NEG_Z * 2.0);
    let (ground, camera) = floor(environment, 0.5);
    let picture = |environment: Environment, lights: Lights| {
        let shadow = object(2, &shade, 0);
        let corners = quad(
            Vec3::new(-10.0, 0.0, 10.0),
            Vec3::X * 20.0,
            Vec3::NEG_Z * 20.0,
        );
        let mut world = world(
            vec![object(1, &corners, 0), shadow],
            ground.materials.to_vec(),
        );
        world.environment = environment;
        world.lights = Arc::new(lights);
        let settings = RenderSettings {
            size: UVec2::splat(24),
            spp: 64,
            ..RenderSettings::default()
        };
        let wide = Camera::looking_at(camera.position * 2.0, Vec3::ZERO, Vec3::NEG_Z, 1.0);
        pixels(&world, &wide, &settings)
    };
    let map = picture(ground.environment.clone(), Lights::default());
    let sun = DirectionalLight {
        id: 3,
        to_light: direction,
        color: Vec3::splat(irradiance),
        disc: SunDisc::of_diameter(2.0 * TAU / 256.0),
        samples: 1,
    };
    let lamp = picture(
        even(1.0),
        Lights {
            directionals: vec![sun],
            ..Lights::default()
        },
    );
    let mean = |picture: &[(f64, f64)]| {
        let n = picture.len() as f64;
        let value = picture.iter().map(|(mean, _)| mean).sum::<f64>() / n;
        let error = picture
            .iter()
            .map(|(_, error)| error * error)
            .sum::<f64>()
            .sqrt()
            / n;
        (value, error)
    };
    let ((a, da), (b, db)) = (mean(&map), mean(&lamp));
    let z = (a - b) / da.hypot(db);
    assert!(z.abs() < 3.0, "{a} ± {da} and {b} ± {db}");
    // The shadow itself: as dark, where both say so.
    let dark = |picture: &[(f64, f64)]| picture.iter().filter(|(value, _)| *value < 0.6).count();
    let (a, b) = (dark(&map), dark(&lamp));
    assert!(a > 10 && a.abs_diff(b) <= 8, "{a} and {b} pixels in shadow");
}

/// Every pixel's mean and its standard error.
fn pixels(world: &World, camera: &Camera, settings: &RenderSettings) -> Vec<(f64, f64)> {
    let spp = u64::from(settings.spp);
    let pixels = (0..settings.size.y).flat_map(|y| (0..settings.size.x).map(move |x| (x, y)));
    let mut workspace = Workspace::default();
    pixels
        .map(|(x, y)| {
            let pixel = UVec2::new(x, y);
            let samples: Vec<_> = (0..spp).map(|index| SampleId { pixel, index }).collect();
            let mut values = vec![Vec3::ZERO; samples.len()];
            radiance(
                world,
                camera,
                settings,
                &samples,
                &mut values,
                &mut workspace,
            );
            let n = spp as f64;
            let mean = values.iter().map(|v| f64::from(v.x)).sum::<f64>() / n;
            let squares = values.iter().map(|v| (f64::from(v.x) - mean).powi(2));
            (mean, (squares.sum::<f64>() / n / (n - 1.0)).sqrt())
        })
        .collect()
}

#[test]
fn below_a_disc_a_place_gets_what_the_disc_leaves_of_the_sky() {
    let (height, radius) = (1.0_f32, 0.8_f32);
    let corner = |i: u32| {
        let angle = TAU * i as f32 / 256.0;
        Vec3::new(radius * angle.cos(), height, radius * angle.sin())
    };
    let disc: Vec<Vec3> = (0..256)
        .flat_map(|i| [Vec3::Y * height, corner(i), corner(i + 1)])
        .collect();
    // White above the horizon, black below: the floor does not see what is below.
    for environment in [even(1.0), mapped(64, 64, |_, y| f32::from(y < 32))] {
        let corners = quad(
            Vec3::new(-9.0, 0.0, 9.0),
            Vec3::X * 18.0,
            Vec3::NEG_Z * 18.0,
        );
        let material = Material {
            diffuse: Vec3::ONE,
            ..Material::default()
        };
        let mut world = world(
            vec![object(1, &corners, 0), object(2, &disc, 0)],
            vec![material],
        );
        world.environment = environment;
        let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.001), Vec3::ZERO, Vec3::NEG_Z, 0.5);
        let (found, counts) = central_radiance(&world, &camera, &settings(16_384));
        let expected = height * height / (height * height + radius * radius);
        // 128 of a map's texels blur the horizon, where the cosine is a hundredth; and 16,384 samples.
        assert!((found.x - expected).abs() < 3e-3, "{found}, {expected}");
        assert_eq!(counts.camera, 16_384);
        assert!(counts.shadow > 7_000);
    }
}

#[test]
fn mirrors_and_cameras_see_a_dome_as_if_it_did_not_light() {
    let (environment, ..) = sunny(50.0);
    let (mut world, camera) = floor(environment, 0.0);
    world.materials = Arc::new(vec![Material {
        diffuse: Vec3::ZERO,
        mirror: Vec3::splat(0.9),
        ..Material::default()
    }]);
    let pictures = [true, false].map(|lights| {
        world.environment.lights = lights;
        pixels(
            &world,
            &camera,
            &RenderSettings {
                size: UVec2::splat(8),
                spp: 4,
                ..RenderSettings::default()
            },
        )
    });
    assert!(pictures[0][9].0 > 0.5);
    assert_eq!(pictures[0], pictures[1]);
}

#[test]
fn classic_lighting_knows_no_dome_bit_for_bit() {
    let (environment, ..) = sunny(50.0);
    let (mut world, camera) = floor(environment, 0.7);
    world.lights = square_light(2.0, 2);
    let settings = RenderSettings {
        size: UVec2::splat(8),
        spp: 4,
        lighting: Lighting::Classic,
        ..RenderSettings::default()
    };
    let pictures = [true, false].map(|lights| {
        world.environment.lights = lights;
        pixels(&world, &camera, &settings)
    });
    assert_eq!(pictures[0], pictures[1]);
}

#[test]
fn where_maps_are_off_it_is_the_background_that_lights() {
    let (mut environment, ..) = sunny(50.0);
    environment.background = Vec3::splat(0.25);
    let (world, camera) = floor(environment, 0.8);
    let mut settings = settings(4);
    settings.features.environment = false;
    let (found, _) = central_radiance(&world, &camera, &settings);
    assert!((found.x - 0.2).abs() < 1e-5, "{found}");
}

#[test]
fn without_soft_shadows_a_dome_is_sampled_all_the_same() {
    let (world, camera) = floor(even(1.0), 0.8);
    let mut settings = settings(4);
    settings.features.soft_shadows = false;
    let (found, _) = central_radiance(&world, &camera, &settings);
    assert!((found.x - 0.8).abs() < 1e-5, "{found}");
}

#[test]
fn what_has_no_light_is_no_dome() {
    let settings = RenderSettings::default();
    for black in [
        even(0.0),
        mapped(4, 2, |_, _| 0.0),
        Environment {
            intensity: 0.0,
            ..mapped(4, 2, |_, _| 1.0)
        },
    ] {
        assert!(Dome::of(&black, &settings).is_none());
        let (world, camera) = floor(black, 0.8);
        let (found, counts) = central_radiance(&world, &camera, &settings);
        assert_eq!((found, counts.shadow), (Vec3::ZERO, 0));
        assert!(world.lamps(&settings).all(|lamp| lamp.id() != DOME));
    }
}

#[test]
fn a_samples_value_does_not_depend_on_what_else_is_in_the_batch() {
    let (environment, ..) = sunny(500.0);
    let (mut world, camera) = floor(environment, 0.7);
    world.environment.samples = 3;
    world.lights = square_light(2.0, 2);
    let settings = RenderSettings {
        size: UVec2::splat(8),
        ..settings(4)
    };
    let mut samples: Vec<_> = (0..8 * 8 * 4)
        .map(|i| SampleId {
            pixel: UVec2::new(i / 4 % 8, i / 32),
            index: u64::from(i % 4),
        })
        .collect();
    let mut workspace = Workspace::default();
    let mut together = vec![Vec3::ZERO; samples.len()];
    radiance(
        &world,
        &camera,
        &settings,
        &samples,
        &mut together,
        &mut workspace,
    );
    samples.reverse();
    for (sample, value) in samples.into_iter().zip(together.into_iter().rev()) {
        let mut alone = [Vec3::ZERO];
        radiance(
            &world,
            &camera,
            &settings,
            &[sample],
            &mut alone,
            &mut workspace,
        );
        assert_eq!(alone, [value], "{sample:?}");
    }
}

#[test]
fn a_dome_that_is_hidden_from_the_camera_lights_and_is_mirrored_all_the_same() {
    let hidden = Environment {
        backdrop: Some(Vec3::X),
        ..even(0.5)
    };
    let (world, camera) = floor(hidden.clone(), 0.8);
    let (found, _) = central_radiance(&world, &camera, &settings(4));
    assert!((found - 0.4).abs().max_element() < 1e-5, "lit: {found}");
    let away = Camera::looking_at(Vec3::Y, 2.0 * Vec3::Y, Vec3::Z, 0.5);
    let (found, _) = central_radiance(&world, &away, &settings(4));
    assert_eq!(found, Vec3::X, "beside it");
    let mirror = Material {
        diffuse: Vec3::ZERO,
        mirror: Vec3::splat(0.5),
        ..Material::default()
    };
    let pane = Material {
        diffuse: Vec3::ZERO,
        opacity: 0.25,
        ..Material::default()
    };
    for (material, scatters, expected) in [
        (mirror, true, Vec3::splat(0.25)),
        (pane.clone(), false, 0.75 * Vec3::X),
        (pane, true, 0.75 * Vec3::X),
    ] {
        let (mut world, _) = floor(hidden.clone(), 0.0);
        world.materials = Arc::new(vec![material]);
        let world = world.with_needs();
        let mut settings = settings(4);
        settings.features.translucency = scatters;
        let (found, _) = central_radiance(&world, &camera, &settings);
        let off = (found - expected).abs().max_element();
        assert!(off < 1e-5, "{expected}, not {found}");
    }
}

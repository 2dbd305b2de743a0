//! An environment that lights: against closed forms, against other lights, and against itself without light.

use super::*;
use glassbox::scene::Lighting;
use glassbox::trace::shading::reflected;
use glassbox::trace::{DOME, DirectionalLight, Dome, SunDisc, Surface, Texels, Texture};
use std::f32::consts::{PI, TAU};

/// An environment of one colour that lights.
fn even(radiance: f32) -> Environment {
    Environment {
        background: Vec3::splat(radiance),
        lights: true,
        samples: 1,
        ..Environment::default()
    }
}

/// One whose radiance at the texel (x, y) of a map is that.
fn mapped(width: u32, height: u32, of: impl Fn(u32, u32) -> f32) -> Environment {
    let texels = (0..width * height).map(|i| [of(i % width, i / width); 3]);
    let map = Texture::new(width, height, Texels::Linear32(texels.collect())).unwrap();
    Environment {
        map: Some(Arc::new(map)),
        intensity: 1.0,
        ..even(0.0)
    }
}

/// 1 + cos θ, θ from +Y.
fn gradient() -> Environment {
    mapped(4, 256, |_, y| 1.0 + (PI * (y as f32 + 0.5) / 256.0).cos())
}

/// A sky of radiance 1 with a sun of one texel; its direction, and what a surface that faces it gets from it alone.
fn sunny(sun: f32) -> (Environment, Vec3, f32) {
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

/// Two numbers of a sequence that fills the square evenly: Roberts' R2.
fn even_pair(i: u32) -> [f32; 2] {
    [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| {
        let number = (0.5 + step * f64::from(i)).fract() as f32;
        number.min(1.0_f32.next_down())
    })
}

/// What a surface sends back of all directions that are chosen for it, and of directions chosen evenly.
fn both_ways(environment: &Environment, surface: &Surface, n: u32) -> [f64; 2] {
    let settings = RenderSettings::default();
    let dome = Dome::of(environment, &settings).unwrap();
    let value = |point| f64::from(reflected(surface, &point, Lighting::Physical).x);
    let chosen: f64 = (0..n)
        .map(|i| dome.point_for(surface, even_pair(i)).map_or(0.0, value))
        .sum();
    let evenly: f64 = (0..n)
        .map(|i| {
            let [u, v] = even_pair(i);
            let (height, around) = (1.0 - 2.0 * v, TAU * u);
            let radius = (1.0 - height * height).sqrt();
            let direction = Vec3::new(radius * around.cos(), height, radius * around.sin());
            value(glassbox::trace::LightPoint {
                direction,
                distance: f32::INFINITY,
                arriving: dome.radiance(direction) * (4.0 * PI),
                place: [0.0; 2],
                density: 1.0,
            })
        })
        .sum();
    [chosen, evenly].map(|sum| sum / f64::from(n))
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
fn under_a_gradient_a_surface_gets_what_its_tilt_says() {
    let environment = gradient();
    for tilt in [0.0_f32, 0.5, 1.2, PI / 2.0, 2.0, PI] {
        let normal = Vec3::new(tilt.sin(), tilt.cos(), 0.0);
        let surface = Surface {
            diffuse: Vec3::ONE,
            ..Surface::flat(Vec3::ZERO, normal, normal)
        };
        let [chosen, _] = both_ways(&environment, &surface, 20_000);
        // ∫ (1 + ω·y) max(n·ω, 0) dω / π = 1 + 2/3 n·y.
        let expected = 1.0 + 2.0 / 3.0 * f64::from(normal.y);
        // 20,000 points of a lattice, and the map's own steps of 1/256.
        assert!(
            (chosen - expected).abs() < 2e-3,
            "{tilt}: {chosen}, {expected}"
        );
    }
}

#[test]
fn directions_that_are_chosen_for_a_surface_give_what_even_ones_give() {
    let sun = mapped(32, 16, |x, y| if (x, y) == (5, 4) { 60.0 } else { 1.0 });
    let turned = Environment {
        rotation: 2.0,
        ..sun.clone()
    };
    let noise = mapped(15, 9, |x, y| ((x * 7 + y * 13) % 11) as f32);
    let few = mapped(1, 2, |_, y| y as f32);
    let mut numbers = Numbers(5);
    for environment in [even(1.0), gradient(), sun, turned, noise, few] {
        for i in 0..8_u8 {
            let normal = numbers.direction();
            let specular = Vec3::splat(f32::from(i % 2) * 0.5);
            let surface = Surface {
                diffuse: Vec3::splat(f32::from(i % 4) / 3.0),
                specular,
                shininess: numbers.between(1.0, 60.0),
                ..Surface::flat(
                    Vec3::ZERO,
                    normal,
                    (normal + 0.8 * numbers.direction()).normalize(),
                )
            };
            let [chosen, evenly] = both_ways(&environment, &surface, 60_000);
            if i == 0 {
                assert_eq!(chosen, 0.0, "it reflects nothing");
                continue;
            }
            let apart = (chosen - evenly).abs() / evenly.max(1e-3);
            // What 60,000 even directions leave of a sun that is 60 times as bright as its sky: a few thousandths.
            assert!(apart < 0.01, "{i}: {chosen}, {evenly} of even directions");
        }
    }
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
        rows(&world, &wide, &settings)
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
fn rows(world: &World, camera: &Camera, settings: &RenderSettings) -> Vec<(f64, f64)> {
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
        rows(
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
        rows(&world, &camera, &settings)
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
fn a_back_side_and_what_is_turned_away_get_nothing_from_a_sun() {
    let (environment, direction, _) = sunny(1e6);
    let black_sky = Environment {
        map: {
            let map = environment.map.as_ref().unwrap();
            let texels = (0..256 * 128).map(|i| {
                let sun = map.texel(i % 256, i / 256, false).x > 1.0;
                [f32::from(u8::from(sun)) * 1e6; 3]
            });
            Some(Arc::new(
                Texture::new(256, 128, Texels::Linear32(texels.collect())).unwrap(),
            ))
        },
        ..environment
    };
    let settings = RenderSettings::default();
    let dome = Dome::of(&black_sky, &settings).unwrap();
    for (normal, geometric) in [(-direction, -direction), (direction, -direction)] {
        let surface = Surface {
            geometric_normal: geometric,
            specular: Vec3::splat(0.3),
            shininess: 20.0,
            ..Surface::flat(Vec3::ZERO, normal, normal)
        };
        for i in 0..1000 {
            let Some(point) = dome.point_for(&surface, even_pair(i)) else {
                continue;
            };
            let value = reflected(&surface, &point, Lighting::Physical);
            assert_eq!(value, Vec3::ZERO, "{point:?}");
        }
    }
}

#[test]
fn what_has_no_light_is_no_dome_and_what_has_too_much_stays_finite() {
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
        assert_eq!(world.light_samples(DOME, &settings), None);
    }
    let largest = (1_u128 << 64) as f32;
    for bright in [
        mapped(1, 1, |_, _| largest),
        mapped(4, 2, |x, _| if x == 1 { largest } else { 0.0 }),
        mapped(7, 5, |x, y| if (x, y) == (3, 0) { largest } else { 1e-30 }),
    ] {
        let dome = Dome::of(&bright, &settings).unwrap();
        for i in 0..2000 {
            let (up, shininess) = (i % 3 == 0, [1.0, 40.0, 1e8][i as usize % 3]);
            let normal = if up { Vec3::Y } else { Vec3::X };
            let surface = Surface {
                specular: Vec3::splat(0.5),
                shininess,
                ..Surface::flat(Vec3::ZERO, normal, Vec3::new(0.6, 0.8, 0.0))
            };
            if let Some(point) = dome.point_for(&surface, even_pair(i)) {
                let value = reflected(&surface, &point, Lighting::Physical);
                assert!(value.is_finite() && point.density > 0.0, "{point:?}");
            }
        }
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
fn a_shiny_surface_under_a_white_dome_gets_its_lobe_with_little_noise() {
    // Phong's lobe about the normal of a surface seen from straight above: ∫ = ks.
    let settings = RenderSettings::default();
    let environment = even(1.0);
    let dome = Dome::of(&environment, &settings).unwrap();
    for shininess in [1.0, 50.0, 1000.0] {
        let surface = Surface {
            diffuse: Vec3::splat(0.3),
            specular: Vec3::splat(0.5),
            shininess,
            ..Surface::flat(Vec3::ZERO, Vec3::Y, Vec3::Y)
        };
        let n = 10_000;
        let values: Vec<f64> = (0..n)
            .map(|i| {
                let point = dome.point_for(&surface, even_pair(i));
                point.map_or(0.0, |point| {
                    f64::from(reflected(&surface, &point, Lighting::Physical).x)
                })
            })
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        let spread = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / f64::from(n);
        assert!((mean - 0.8).abs() < 2e-3, "{shininess}: {mean}");
        // A wide lobe is chosen without the surface's cosine.
        assert!(
            spread.sqrt() < 0.25 * mean,
            "{shininess}: ± {}",
            spread.sqrt()
        );
    }
}

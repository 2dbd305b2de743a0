//! The directions of a dome that are chosen for a surface: unbiased, finite, and nearly free of noise.

use super::dome::{even, mapped, sunny};
use super::*;
use glassbox::scene::Lighting;
use glassbox::trace::shading::reflected;
use glassbox::trace::{Dome, Surface, Texels, Texture};
use std::f32::consts::{PI, TAU};

/// 1 + cos θ, θ from +Y.
fn gradient() -> Environment {
    mapped(4, 256, |_, y| 1.0 + (PI * (y as f32 + 0.5) / 256.0).cos())
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
fn what_has_too_much_light_stays_finite() {
    let settings = RenderSettings::default();
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

use crate::analytic::{object, quad, world};
use glam::{UVec2, Vec2, Vec3};
use glassbox::film::render;
use glassbox::scene::{PixelSampling, RenderSettings};
use glassbox::trace::{Camera, Environment, Material, Optics};

/// A tiny bright square (seen by its emission) at distance `d` before a black background.
fn spot(d: f32, half: f32) -> glassbox::trace::World {
    let z = -d;
    let corner = Vec3::new(-half, -half, z);
    let corners = quad(corner, Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half);
    let bright = Material {
        diffuse: Vec3::ZERO,
        emission: Vec3::ONE,
        ..Material::default()
    };
    let mut world = world(vec![object(1, &corners, 0)], vec![bright]);
    world.environment = Environment::default();
    world
}

#[test]
fn the_circle_of_confusion_has_the_diameter_of_the_thin_lens_formula() {
    let (a, f) = (0.15_f32, 4.0_f32);
    // Odd, so that the spot lies in the middle of a pixel.
    let size = UVec2::new(33, 33);
    // 40 pixels to a metre of the focus plane.
    let fov_y = 2.0 * (33.0 / 80.0 / f).atan();
    let pixels_per_metre = 40.0;
    for i in 0..20 {
        let d = 2.0 + 0.35 * i as f32;
        // 2.4 pixels of the picture: enough samples meet it.
        let half = 0.03 * d / f;
        let mut camera = Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, fov_y);
        camera.optics = Optics {
            aperture_radius: a,
            focus_distance: f,
            ..Optics::default()
        };
        let settings = RenderSettings {
            size,
            spp: 512,
            ..RenderSettings::default()
        };
        let picture = render(&spot(d, half), &camera, &settings, &|_, _| {}).picture;
        // A disc's second moment about its centre is D²/8 (both axes together), the spot's own
        // square and the pixel add theirs: (s² + 1)/6.
        let (mut sum, mut moment) = (0.0_f64, 0.0_f64);
        for y in 0..size.y {
            for x in 0..size.x {
                let value = f64::from(picture.pixel(x, y).x);
                let at = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - size.as_vec2() / 2.0;
                sum += value;
                moment += value * f64::from(at.length_squared());
            }
        }
        let spot = f64::from(2.0 * half * f / d * pixels_per_metre);
        let measured = (8.0 * (moment / sum - (spot * spot + 1.0) / 6.0))
            .max(0.0)
            .sqrt();
        let expected = f64::from(2.0 * a * (d - f).abs() / d * pixels_per_metre);
        assert!(
            (measured - expected).abs() < 1.0,
            "at {d} m: {measured:.2} pixels, expected {expected:.2}"
        );
    }
}

#[test]
fn an_aperture_of_zero_gives_the_pinholes_picture_bit_for_bit() {
    let pinhole = Camera::looking_at(Vec3::ZERO, Vec3::NEG_Z, Vec3::Y, 0.5);
    let mut closed = pinhole.clone();
    closed.optics.focus_distance = 7.0;
    let settings = RenderSettings {
        size: UVec2::new(32, 32),
        spp: 4,
        pixel: PixelSampling::Area,
        ..RenderSettings::default()
    };
    let world = spot(2.0, 0.2);
    let a = render(&world, &pinhole, &settings, &|_, _| {}).picture;
    let b = render(&world, &closed, &settings, &|_, _| {}).picture;
    assert_eq!(a, b);
}

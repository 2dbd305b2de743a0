//! What each "samples" setting does: more of them, less variance of that effect and more rays.

use crate::analytic::{central_radiance, dark_before_light, object, quad, square_light, world};
use glam::{UVec2, Vec3};
use glassbox::film::render;
use glassbox::scene::{PixelSampling, RenderSettings};
use glassbox::trace::{
    Camera, Lights, Material, ParallelogramLight, RayCounts, SegmentLight, World,
};
use std::sync::Arc;

/// Mean squared deviation of one pixel's value over 64 seeds, and the rays of one of them.
fn spread(world: &World, camera: &Camera, settings: &RenderSettings) -> (f64, RayCounts) {
    let run = |seed| {
        let settings = RenderSettings {
            size: UVec2::ONE,
            seed,
            ..settings.clone()
        };
        let rendered = render(world, camera, &settings, &|_, _| {});
        (
            f64::from(rendered.picture.pixels[0].x),
            rendered.status.rays,
        )
    };
    let values: Vec<f64> = (0..64).map(|seed| run(seed).0).collect();
    let mean = values.iter().sum::<f64>() / 64.0;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 64.0;
    (variance, run(0).1)
}

fn once() -> RenderSettings {
    RenderSettings {
        spp: 1,
        ..RenderSettings::default()
    }
}

/// A dark square whose left edge lies in the middle of the view, before a background of one.
fn edge(velocity: Vec3) -> World {
    let corners = quad(Vec3::new(0.013, -5.0, 0.0), Vec3::X * 10.0, Vec3::Y * 10.0);
    let (instance, object) = object(1, &corners, 0);
    dark_before_light((instance.moving(velocity).unwrap(), object))
}

fn ahead() -> Camera {
    Camera::looking_at(Vec3::Z * 3.0, Vec3::ZERO, Vec3::Y, 0.4)
}

#[test]
fn light_samples_are_shadow_rays_at_the_first_hit() {
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    let screen = quad(Vec3::new(0.1, 1.0, -3.0), Vec3::Z * 6.0, Vec3::X * 4.0);
    let objects = vec![object(1, &floor, 0), object(2, &screen, 0)];
    let mut scene = world(objects, vec![Material::default()]);
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.4), Vec3::ZERO, Vec3::Y, 0.01);
    let mut run = |samples| {
        scene.lights = square_light(2.0, samples);
        spread(&scene, &camera, &once())
    };
    let ((few, few_rays), (many, many_rays)) = (run(1), run(16));
    assert!(
        many < 0.1 * few,
        "variance {many:e} of 16 rays, {few:e} of one"
    );
    assert_eq!((few_rays.shadow, many_rays.shadow), (1, 16));
    assert_eq!((few_rays.camera, many_rays.camera), (1, 1));
}

#[test]
fn samples_that_go_by_the_size_of_a_light_are_as_many_as_it_has_metres() {
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    let mut scene = world(vec![object(1, &floor, 0)], vec![Material::default()]);
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.4), Vec3::ZERO, Vec3::Y, 0.01);
    let tube = |samples| SegmentLight {
        id: 9,
        ends: [Vec3::new(-2.0, 1.0, 0.0), Vec3::new(2.0, 1.0, 0.0)],
        colors: [Vec3::ONE; 2],
        samples,
    };
    let panel = |edge: f32, samples| ParallelogramLight {
        id: 9,
        corner: Vec3::new(-0.5 * edge, 1.0, -0.5 * edge),
        edges: [Vec3::X * edge, Vec3::Z * edge],
        colors: [Vec3::ONE; 4],
        two_sided: true,
        visible: false,
        samples,
    };
    let mut run = |lights: &Arc<Lights>, scale_light_samples| {
        scene.lights = lights.clone();
        let mut settings = once();
        settings.features.scale_light_samples = scale_light_samples;
        settings.size = UVec2::splat(4);
        let rendered = render(&scene, &camera, &settings, &|_, _| {});
        (rendered.picture.pixels, rendered.status.rays.shadow)
    };
    // 4 m, 4 m² and a quarter of a square metre.
    for (size, parts, whole) in [(None, 3, 12), (Some(2.0), 3, 12), (Some(0.5), 16, 4)] {
        let lights = |samples| match size {
            Some(edge) => Arc::new(Lights {
                parallelograms: vec![panel(edge, samples)],
                ..Lights::default()
            }),
            None => Arc::new(Lights {
                segments: vec![tube(samples)],
                ..Lights::default()
            }),
        };
        let scaled = run(&lights(parts), true);
        assert_eq!(scaled.1, 16 * u64::from(whole), "{size:?}");
        assert!(scaled == run(&lights(whole), false), "{size:?}");
        assert!(scaled != run(&lights(parts), false), "{size:?}");
    }
}

#[test]
fn light_samples_of_one_point_make_one_stratified_set_with_the_pixels_samples() {
    // 4 samples with 16 light rays each are as good as 64 samples with one: 64 points of one net.
    let floor = quad(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0);
    let mut scene = world(vec![object(1, &floor, 0)], vec![Material::default()]);
    let camera = Camera::looking_at(Vec3::new(0.0, 0.5, 0.4), Vec3::ZERO, Vec3::Y, 0.01);
    let mut value = |spp, samples| {
        scene.lights = square_light(1.0, samples);
        let settings = RenderSettings { spp, ..once() };
        central_radiance(&scene, &camera, &settings).0.x
    };
    let (a, b) = (value(4, 16), value(64, 1));
    assert!((a / b - 1.0).abs() < 1e-6, "{a} and {b}");
}

#[test]
fn jittering_n_by_n_takes_n_squared_camera_rays() {
    let (scene, camera) = (edge(Vec3::ZERO), ahead());
    let run = |jitter| spread(&scene, &camera, &RenderSettings { jitter, ..once() });
    let ((one, one_ray), (many, many_rays)) = (run(1), run(5));
    assert!(
        many < 0.1 * one,
        "variance {many:e} of 5 x 5 rays, {one:e} of one"
    );
    assert_eq!((one_ray.camera, many_rays.camera), (1, 25));
}

#[test]
fn lens_samples_are_camera_rays_and_cost_nothing_where_the_lens_is_closed() {
    let scene = edge(Vec3::ZERO);
    let run = |lens_samples, aperture_radius| {
        let mut camera = ahead();
        camera.optics.aperture_radius = aperture_radius;
        camera.optics.focus_distance = 1.0;
        camera.optics.lens_samples = lens_samples;
        let settings = RenderSettings {
            pixel: PixelSampling::Center,
            ..once()
        };
        spread(&scene, &camera, &settings)
    };
    let ((one, one_ray), (many, many_rays)) = (run(1, 0.2), run(16, 0.2));
    assert!(
        many < 0.1 * one,
        "variance {many:e} of 16 rays, {one:e} of one"
    );
    assert_eq!((one_ray.camera, many_rays.camera), (1, 16));
    assert_eq!(run(16, 0.0).1.camera, 1);
}

#[test]
fn motion_samples_are_camera_rays_and_cost_nothing_where_all_stands_still() {
    let run = |samples, velocity| {
        let mut scene = edge(velocity);
        scene.needs.motion_samples = samples;
        let settings = RenderSettings {
            pixel: PixelSampling::Center,
            ..once()
        };
        spread(&scene, &ahead(), &settings)
    };
    let speed = Vec3::X * -0.05;
    let ((one, one_ray), (many, many_rays)) = (run(1, speed), run(16, speed));
    assert!(
        many < 0.1 * one,
        "variance {many:e} of 16 rays, {one:e} of one"
    );
    assert_eq!((one_ray.camera, many_rays.camera), (1, 16));
    assert_eq!(run(0, Vec3::ZERO).1.camera, 1);
}

#[test]
fn effects_share_their_samples_instead_of_multiplying_them() {
    let mut camera = ahead();
    camera.optics.aperture_radius = 0.1;
    camera.optics.lens_samples = 9;
    let mut scene = edge(Vec3::X);
    scene.needs.motion_samples = 12;
    let settings = RenderSettings {
        jitter: 4,
        ..once()
    };
    assert_eq!(spread(&scene, &camera, &settings).1.camera, 16);
}

use crate::analytic::{Numbers, central_radiance, dark_before_light, object, quad};
use glam::{UVec2, Vec2, Vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Builder, Levels, Ray};
use glassbox::film::render;
use glassbox::scene::{Features, PixelSampling, RenderSettings};
use glassbox::trace::{Camera, Material, World};

/// A dark square of edge 1, its left edge at x = 0, moving by `velocity`, before a background of 1.
fn moving_square(velocity: Vec3) -> World {
    let corners = quad(Vec3::new(0.0, -0.5, 0.0), Vec3::X, Vec3::Y);
    let (instance, mut object) = object(1, &corners, 0);
    object.motion_samples = 1;
    dark_before_light((instance.moving(velocity).unwrap(), object))
}

fn camera_at(x: f32) -> Camera {
    Camera::looking_at(Vec3::new(x, 0.0, 3.0), Vec3::new(x, 0.0, 0.0), Vec3::Y, 0.6)
}

#[test]
fn an_object_that_crosses_the_view_covers_a_place_for_the_time_that_it_is_there() {
    // At speed 4 it stands over x while x - 1 < 4t < x: a trapezoid in x.
    let world = moving_square(Vec3::X * 4.0);
    for spp in [16_u32, 64, 256] {
        let settings = RenderSettings {
            spp,
            ..RenderSettings::default()
        };
        for i in 0..60 {
            let x = -0.4 + 0.1 * i as f32 + 0.013;
            let bright = central_radiance(&world, &camera_at(x), &settings).0.x;
            let (enters, leaves) = ((x - 1.0) / 4.0, x / 4.0);
            let covered = leaves.clamp(0.0, 1.0) - enters.clamp(0.0, 1.0);
            let error = (1.0 - bright - covered).abs();
            let bound = 2.0 / spp as f32 + 1e-6;
            assert!(
                error <= bound,
                "x = {x}, {spp} samples: off by {error}, bound {bound}"
            );
        }
    }
}

#[test]
fn a_closed_shutter_shows_everything_as_it_stands_then() {
    let world = moving_square(Vec3::X * 4.0);
    let settings = RenderSettings {
        size: UVec2::splat(40),
        spp: 4,
        ..RenderSettings::default()
    };
    for time in [0.0_f32, 0.25, 1.0] {
        let mut camera = camera_at(0.7);
        camera.optics.shutter = [time, time];
        let moving = render(&world, &camera, &settings, &|_, _| {}).picture;
        // 4 · time is exact, so the still square stands at the very same place.
        let mut still = moving_square(Vec3::ZERO);
        let at = quad(Vec3::new(4.0 * time, -0.5, 0.0), Vec3::X, Vec3::Y);
        still.aggregate =
            crate::analytic::world(vec![object(1, &at, 0)], vec![Material::default()]).aggregate;
        let expected = render(&still, &camera_at(0.7), &settings, &|_, _| {}).picture;
        let differing = moving
            .pixels
            .iter()
            .zip(&expected.pixels)
            .filter(|(a, b)| a != b)
            .count();
        assert_eq!(differing, 0, "at time {time}: {differing} pixels differ");
    }
}

#[test]
fn motion_switched_off_leaves_everything_where_it_is_at_time_zero() {
    let settings = RenderSettings {
        size: UVec2::splat(24),
        spp: 4,
        pixel: PixelSampling::Center,
        features: Features {
            motion: false,
            ..Features::default()
        },
        ..RenderSettings::default()
    };
    let camera = camera_at(0.3);
    let moving = render(
        &moving_square(Vec3::X * 4.0),
        &camera,
        &settings,
        &|_, _| {},
    )
    .picture;
    let still = render(&moving_square(Vec3::ZERO), &camera, &settings, &|_, _| {}).picture;
    assert_eq!(moving, still);
}

#[test]
fn a_moving_camera_sees_what_a_still_one_sees_of_a_world_that_moves_the_other_way() {
    let mut camera = camera_at(0.3);
    camera.optics.velocity = Vec3::new(1.0, 0.5, 0.0);
    camera.optics.motion_samples = 1;
    let settings = RenderSettings {
        size: UVec2::splat(32),
        spp: 64,
        ..RenderSettings::default()
    };
    let a = render(&moving_square(Vec3::ZERO), &camera, &settings, &|_, _| {}).picture;
    let world = moving_square(Vec3::new(-1.0, -0.5, 0.0));
    let b = render(&world, &camera_at(0.3), &settings, &|_, _| {}).picture;
    // The same samples; only rays within rounding of the square's edge may differ, one of 64 each.
    let worst = a
        .pixels
        .iter()
        .zip(&b.pixels)
        .map(|(a, b)| (*a - *b).abs().max_element());
    let (mut differing, mut largest) = (0, 0.0_f32);
    for difference in worst {
        differing += usize::from(difference > 0.0);
        largest = largest.max(difference);
    }
    assert!(
        differing <= 4 && largest <= 1.5 / 64.0,
        "{differing} pixels by up to {largest}"
    );
}

#[test]
fn moving_instances_are_hit_alike_through_any_tree() {
    let mut numbers = Numbers(5);
    let mut instances = Vec::new();
    for i in 0..40 {
        let corner = numbers.point(-3.0, 3.0);
        let (a, b) = (numbers.direction(), numbers.direction());
        let (instance, _) = object(i, &quad(corner, a, b), 0);
        let velocity = if i % 3 == 0 {
            Vec3::ZERO
        } else {
            numbers.point(-2.0, 2.0)
        };
        instances.push(instance.moving(velocity).unwrap());
    }
    let build = |builder, levels| {
        let options = BuildOptions {
            builder,
            levels,
            ..BuildOptions::default()
        };
        Aggregate::build(instances.clone(), &options)
    };
    let brute = build(Builder::None, Levels::Two);
    let others: Vec<_> = [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc]
        .into_iter()
        .flat_map(|builder| [Levels::One, Levels::Two].map(|levels| (builder, levels)))
        .map(|(builder, levels)| (builder, levels, build(builder, levels)))
        .collect();
    let mut hits = 0;
    for _ in 0..5000 {
        let (origin, target) = (numbers.point(-5.0, 5.0), numbers.point(-3.0, 3.0));
        let ray = Ray {
            time: numbers.unit(),
            ..Ray::new(origin, target - origin)
        };
        let expected = brute.closest_hit(&ray);
        hits += usize::from(expected.is_some());
        for (builder, levels, aggregate) in &others {
            assert_eq!(
                aggregate.closest_hit(&ray),
                expected,
                "{builder:?}, {levels:?}, {ray:?}"
            );
        }
    }
    assert!(hits > 500, "only {hits} hits");
}

#[test]
fn the_pictures_place_of_a_pixel_does_not_depend_on_time() {
    let camera = camera_at(0.0);
    let at = |time| {
        camera
            .ray(Vec2::new(3.0, 4.0), UVec2::splat(9), [0.0; 2], time)
            .direction
    };
    assert_eq!(at(0.0), at(0.9));
}

//! Lamps of entities as lights of the world.

use super::*;
use crate::scene::{Cone, DirectionalLamp, ParallelogramLamp, SegmentLamp};
use bevy::math::Vec3;
use std::f32::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn lights_of_every_kind_are_in_world_space_and_a_mirror_keeps_a_lamps_front() {
    let mut app = app();
    let turned = Transform::from_xyz(1.0, 2.0, 3.0)
        .with_rotation(bevy::math::Quat::from_rotation_y(FRAC_PI_2))
        .with_scale(Vec3::splat(2.0));
    app.world_mut().spawn((
        PointLamp {
            intensity: 3.0,
            cone: Some(Cone::default()),
            ..PointLamp::default()
        },
        turned,
    ));
    app.world_mut().spawn((DirectionalLamp::default(), turned));
    app.world_mut().spawn((SegmentLamp::default(), turned));
    let lamp = ParallelogramLamp {
        corner: Vec3::ZERO,
        edges: [Vec3::X, Vec3::Z],
        colors: [0.1, 0.2, 0.3, 0.4].map(|v| LinearRgba::rgb(v, v, v)),
        ..ParallelogramLamp::default()
    };
    app.world_mut()
        .spawn((lamp, Transform::from_scale(Vec3::new(-1.0, 1.0, 1.0))));
    app.update();
    let lights = world(&app).lights.clone();
    let near = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-5, "{a} instead of {b}");

    let point = &lights.points[0];
    assert_eq!(point.color, Vec3::splat(3.0));
    near(point.position, Vec3::new(1.0, 2.0, 3.0));
    near(point.cone.unwrap().axis, Vec3::NEG_X);
    near(lights.directionals[0].to_light, Vec3::X);
    near(lights.segments[0].ends[0], Vec3::new(1.0, 2.0, 4.0));
    near(lights.segments[0].ends[1], Vec3::new(1.0, 2.0, 2.0));

    // X × Z points down; mirrored in x the lamp still shines down, each colour at its corner.
    let mirrored = &lights.parallelograms[0];
    assert!(
        mirrored.area_normal().y < 0.0,
        "front turned: {}",
        mirrored.area_normal()
    );
    let at = |x: f32, z: f32| {
        let (u, v) = (
            (Vec3::new(x, 0.0, z)).dot(mirrored.edges[0]),
            (Vec3::new(x, 0.0, z)).dot(mirrored.edges[1]),
        );
        mirrored.color(u, v).x
    };
    assert_eq!(
        [at(-1.0, 0.0), at(0.0, 1.0), at(-1.0, 1.0)],
        [0.2, 0.3, 0.4]
    );
}

#[test]
fn a_sun_may_fill_any_angle_up_to_half_the_sky_and_what_is_beyond_is_told() {
    let mut app = app();
    let diameters = [0.0, 0.0093, 180_f32.to_radians(), PI, 4.0, -0.1, f32::NAN];
    for diameter in diameters {
        app.world_mut().spawn(DirectionalLamp {
            angular_diameter: diameter,
            ..DirectionalLamp::default()
        });
    }
    app.update();
    let lights = world(&app).lights.clone();
    let angles: Vec<f32> = (lights.directionals.iter())
        .map(|light| light.solid_angle())
        .collect();
    let sun = PI * 0.00465 * 0.00465;
    let expected = [0.0, sun, TAU, TAU, TAU, 0.0];
    assert_eq!(angles.len(), expected.len(), "{angles:?}");
    for (found, expected) in angles.iter().zip(expected) {
        assert!((found - expected).abs() <= 1e-4 * expected, "{angles:?}");
    }
    let told = problems(&app);
    assert_eq!(told.len(), 3, "{told:#?}");
    assert!(told[0].contains("angular diameter is 4, out of range; 3.14159"));
    assert!(told[1].contains("angular diameter is -0.1, out of range; 0 is used"));
    assert!(told[2].contains("angular diameter is not a finite number"));
}

#[test]
fn a_light_whose_extent_is_nothing_to_f32_is_left_out_with_a_word_and_one_of_more_is_traced() {
    let segment = |length: f32| SegmentLamp {
        ends: [Vec3::ZERO, Vec3::X * length],
        intensity: 1.0 / length.max(1e-20),
        ..SegmentLamp::default()
    };
    let panel = |edge: f32| ParallelogramLamp {
        corner: Vec3::ZERO,
        edges: [Vec3::X * edge, Vec3::Z * edge],
        intensity: 1.0 / (edge * edge).max(1e-24),
        ..ParallelogramLamp::default()
    };
    let mut app = app();
    for length in [0.0, 1e-37, 1e-30, 1e-24] {
        app.world_mut().spawn(segment(length));
    }
    for edge in [0.0, 1e-30, 1e-20, 1e-13] {
        app.world_mut().spawn(panel(edge));
    }
    app.update();
    let told = problems(&app);
    assert_eq!(told.len(), 8, "{told:#?}");
    let says = |text: &str| told.iter().filter(|told| told.contains(text)).count();
    assert_eq!(says("its length is nothing; left out"), 4, "{told:#?}");
    assert_eq!(says("its area is nothing; left out"), 4, "{told:#?}");
    // The least that is lit with (`report/stability/light.rs` has what arrives from it).
    let mut app = self::app();
    for length in [1e-22, 1e-18, 1e-12] {
        app.world_mut().spawn(segment(length));
    }
    for edge in [8e-12, 1e-8] {
        app.world_mut().spawn(panel(edge));
    }
    app.update();
    assert!(problems(&app).is_empty(), "{:#?}", problems(&app));
    let lights = world(&app).lights.clone();
    assert_eq!((lights.segments.len(), lights.parallelograms.len()), (3, 2));
}

#[test]
fn a_light_too_large_to_compute_with_is_told_how_large_it_may_be() {
    let mut app = app();
    app.world_mut().spawn(SegmentLamp {
        ends: [Vec3::X * -2e38, Vec3::X * 2e38],
        ..SegmentLamp::default()
    });
    app.world_mut().spawn(ParallelogramLamp {
        edges: [Vec3::X * 1e20, Vec3::Z * 1e20],
        ..ParallelogramLamp::default()
    });
    app.update();
    let told = problems(&app);
    assert_eq!(told.len(), 2, "{told:#?}");
    for (told, what) in told.iter().zip(["length", "area"]) {
        let expected = format!("its {what} is more than 1.8e19; left out");
        assert!(told.contains(&expected), "{told}");
    }
}

#[test]
fn a_spot_too_narrow_for_directions_is_traced_and_told() {
    let mut app = app();
    for outer in [1e-30, 1e-20, 1e-10, 1e-8, 1e-6, 1e-4] {
        app.world_mut().spawn(PointLamp {
            cone: Some(Cone { inner: 0.0, outer }),
            ..PointLamp::default()
        });
    }
    app.update();
    assert_eq!(world(&app).lights.points.len(), 6);
    let told = problems(&app);
    assert_eq!(told.len(), 4, "{told:#?}");
    for (told, angle) in told.iter().zip(["1e-30", "1e-20", "1e-10", "1e-8"]) {
        let expected = format!("cone's outer angle is {angle} rad, less than what directions");
        assert!(told.contains(&expected), "{told}");
    }
}

#[test]
fn a_spot_of_no_angle_is_left_out_and_one_of_too_much_is_a_half_space() {
    let mut app = app();
    let outers = [0.0, 1e-4, FRAC_PI_2, 2.0, f32::NAN];
    for outer in outers {
        app.world_mut().spawn(PointLamp {
            cone: Some(Cone { inner: 0.0, outer }),
            ..PointLamp::default()
        });
    }
    app.update();
    let lights = world(&app).lights.clone();
    let cones: Vec<_> = (lights.points.iter())
        .map(|light| light.cone.unwrap().versine_outer)
        .collect();
    // 1 - cos of 1e-4 is half of its square.
    assert_eq!(cones.len(), 3, "{cones:?}");
    assert!((cones[0] / 5e-9 - 1.0).abs() < 1e-5, "{cones:?}");
    assert!(
        cones[1..]
            .iter()
            .all(|versine| (versine - 1.0).abs() < 1e-6)
    );
    let told = problems(&app);
    assert_eq!(told.len(), 3, "{told:#?}");
    assert!(told[0].contains("cone's outer angle is nothing; left out"));
    assert!(told[1].contains("cone's outer angle is 2, out of range"));
    assert!(told[2].contains("cone's outer angle is not a finite number"));
}

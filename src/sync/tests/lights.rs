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

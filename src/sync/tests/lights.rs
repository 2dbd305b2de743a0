//! Lamps of entities as lights of the world.

use super::*;
use crate::scene::{Cone, DirectionalLamp, ParallelogramLamp, SegmentLamp};
use bevy::math::Vec3;
use std::f32::consts::FRAC_PI_2;

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

//! One mesh each: head, teapot, knot.

use super::stage::{FLOOR, Stage, glossy, matte, pictured, plain_background, sky};
use crate::scene::{PointLamp, Shape};
use bevy::color::LinearRgba;
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;

pub(super) fn head(world: &mut World) {
    let mut stage = Stage::new(world, 16, plain_background(0.025, 0.03, 0.04));
    let shape = Shape::Head {
        segments: 24,
        rings: 22,
    };
    let clay = matte(0.72, 0.52, 0.42);
    let turned = Transform::from_rotation(Quat::from_rotation_y(-0.35));
    stage.object("Head", shape, clay, turned);
    let lamps = [
        ("Key lamp", [1.0, 0.93, 0.84], 28.0, [-1.6, 1.1, 3.2]),
        ("Fill lamp", [0.55, 0.7, 1.0], 10.0, [2.8, 0.0, 2.6]),
        ("Rim lamp", [1.0, 0.8, 0.6], 16.0, [1.8, 1.6, -2.2]),
    ];
    for (name, [r, g, b], intensity, at) in lamps {
        let lamp = PointLamp {
            color: LinearRgba::rgb(r, g, b),
            intensity,
            cone: None,
        };
        stage.add(name, (lamp, Transform::from_translation(at.into())));
    }
    stage.camera("Camera", Vec3::new(0.0, 0.1, 4.4), Vec3::ZERO, 32.0);
}

pub(super) fn teapot(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    let checkered = pictured("builtin:checker");
    stage.object("Floor", FLOOR, checkered, Transform::default());
    let glaze = glossy([0.55, 0.10, 0.06], [0.07; 3], 300.0);
    let turned = Transform::from_rotation(Quat::from_rotation_y(0.35));
    stage.object("Teapot", Shape::Teapot { divisions: 16 }, glaze, turned);
    stage.sun_and_sky(2.6);
    stage.camera(
        "Camera",
        Vec3::new(1.3, 2.9, 6.8),
        Vec3::new(0.1, 0.85, 0.0),
        36.0,
    );
}

pub(super) fn knot(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    let stone = matte(0.50, 0.48, 0.45);
    stage.object("Floor", FLOOR, stone, Transform::default());
    let shape = Shape::Knot {
        p: 2,
        q: 3,
        tube_radius: 0.2,
        displacement: 0.12,
        segments: 1088,
        sides: 40,
    };
    let gold = glossy([0.42, 0.24, 0.06], [0.55, 0.40, 0.16], 60.0);
    let upright = Transform::from_xyz(0.0, 1.62, 0.0)
        .with_rotation(Quat::from_rotation_y(0.3) * Quat::from_rotation_x(1.35));
    stage.object("Knot", shape, gold, upright);
    stage.sun_and_sky(2.4);
    stage.camera(
        "Camera",
        Vec3::new(0.6, 2.0, 6.2),
        Vec3::new(0.0, 1.5, 0.0),
        36.0,
    );
}

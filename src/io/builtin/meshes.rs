//! One mesh each: head, teapot, knot.

use super::stage::{Stage, floor, glossy, matte, pictured, plain_background, sky};
use crate::scene::{ParallelogramLamp, Phong, PointLamp, Shape};
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
        ("Key lamp", [1.0, 0.93, 0.84], 26.0, [-1.8, 1.8, 2.8]),
        ("Fill lamp", [0.55, 0.7, 1.0], 6.0, [2.8, 0.2, 2.2]),
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
    let checkered = Transform::from_scale(Vec3::splat(16.0));
    stage.object("Floor", floor(1.0), pictured("builtin:checker"), checkered);
    let glaze = glossy([0.62, 0.20, 0.13], [0.12, 0.12, 0.12], 90.0);
    let turned = Transform::from_rotation(Quat::from_rotation_y(0.35));
    stage.object("Teapot", Shape::Teapot { divisions: 16 }, glaze, turned);
    let lamp = ParallelogramLamp {
        corner: Vec3::new(-1.0, 0.0, -1.0),
        edges: [Vec3::X * 2.0, Vec3::Z * 2.0],
        colors: [LinearRgba::rgb(1.0, 0.96, 0.9); 4],
        intensity: 9.0,
        visible: false,
        samples: 4,
        ..ParallelogramLamp::default()
    };
    let hung = Transform::from_xyz(-2.0, 4.2, 2.0)
        .with_rotation(Quat::from_rotation_z(0.4) * Quat::from_rotation_x(0.4));
    stage.add("Softbox", (lamp, hung));
    let fill = PointLamp {
        color: LinearRgba::rgb(0.75, 0.87, 1.0),
        intensity: 14.0,
        cone: None,
    };
    stage.add("Fill lamp", (fill, Transform::from_xyz(4.0, 3.0, 3.0)));
    stage.camera(
        "Camera",
        Vec3::new(1.2, 2.9, 5.8),
        Vec3::new(0.12, 0.85, 0.0),
        36.0,
    );
}

pub(super) fn knot(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    let stone = matte(0.42, 0.40, 0.38);
    stage.object("Floor", floor(24.0), stone, Transform::default());
    let shape = Shape::Knot {
        p: 2,
        q: 3,
        tube_radius: 0.2,
        displacement: 0.15,
        segments: 1088,
        sides: 40,
    };
    let gold = Phong {
        diffuse: LinearRgba::rgb(0.42, 0.24, 0.06),
        specular: LinearRgba::rgb(0.55, 0.40, 0.16),
        shininess: 60.0,
        ..Phong::default()
    };
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

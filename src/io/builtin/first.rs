//! One triangle, and cubes.

use super::stage::{FLOOR, Stage, matte, pictured, plain_background, sky};
use crate::scene::{Environment, ParallelogramLamp, PointLamp, SegmentLamp, Shape};
use bevy::color::LinearRgba;
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec2, Vec3};
use bevy::transform::components::Transform;

const UNIT_CUBE: Shape = Shape::Cuboid { size: Vec3::ONE };

pub(super) fn new_scene(world: &mut World) {
    // Shines faintly from all around, so that what the lamp does not reach is dark and not black.
    let around = Environment {
        lights: true,
        samples: 2,
        ..plain_background(0.13, 0.14, 0.16)
    };
    let mut stage = Stage::new(world, 16, around);
    let floor = Shape::Ground {
        size: Vec2::splat(8.0),
        tile: Vec2::ONE,
    };
    stage.object("Floor", floor, matte(0.7, 0.7, 0.7), Transform::default());
    let on_floor = Transform::from_xyz(0.0, 0.5, 0.0);
    stage.object("Cube", UNIT_CUBE, matte(0.75, 0.75, 0.75), on_floor);
    let lamp = ParallelogramLamp {
        intensity: 18.0,
        samples: 4,
        ..ParallelogramLamp::default()
    };
    stage.add("Lamp", (lamp, Transform::from_xyz(-1.2, 2.6, 1.2)));
    let target = Vec3::new(0.0, 0.9, 0.0);
    stage.camera("Camera", Vec3::new(2.4, 2.2, 4.4), target, 45.0);
}

pub(super) fn triangle(world: &mut World) {
    let mut stage = Stage::new(world, 16, plain_background(0.02, 0.025, 0.035));
    let shape = Shape::Triangle {
        corners: [
            Vec3::new(-1.0, -0.8, 0.0),
            Vec3::new(1.0, -0.8, 0.0),
            Vec3::new(0.0, 0.9, 0.0),
        ],
    };
    stage.object(
        "Triangle",
        shape,
        matte(0.85, 0.42, 0.12),
        Transform::default(),
    );
    let lamp = PointLamp {
        intensity: 7.0,
        ..PointLamp::default()
    };
    stage.add("Lamp", (lamp, Transform::from_xyz(-0.6, 0.7, 1.3)));
    stage.camera("Camera", Vec3::new(0.0, 0.0, 3.2), Vec3::ZERO, 45.0);
}

pub(super) fn cube_segment_light(world: &mut World) {
    let mut stage = Stage::new(world, 16, plain_background(0.01, 0.01, 0.015));
    stage.object("Floor", FLOOR, matte(0.7, 0.7, 0.7), Transform::default());
    let turned = Transform::from_xyz(0.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(0.5));
    stage.object("Cube", UNIT_CUBE, matte(0.8, 0.78, 0.74), turned);
    let lamp = SegmentLamp {
        ends: [Vec3::NEG_X * 1.8, Vec3::X * 1.8],
        colors: [
            LinearRgba::rgb(1.0, 0.42, 0.10),
            LinearRgba::rgb(0.12, 0.40, 1.0),
        ],
        intensity: 4.2,
        samples: 4,
    };
    stage.add("Segment light", (lamp, Transform::from_xyz(0.0, 1.5, 0.9)));
    stage.camera(
        "Camera",
        Vec3::new(1.3, 2.3, 4.0),
        Vec3::new(0.0, 0.45, 0.0),
        36.0,
    );
}

pub(super) fn textured_cube(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    let checkered = pictured("builtin:checker");
    stage.object("Floor", FLOOR, checkered, Transform::default());
    let turned = Transform::from_xyz(0.0, 0.5, 0.0).with_rotation(Quat::from_rotation_y(-0.5));
    stage.object("Cube", UNIT_CUBE, pictured("builtin:uv"), turned);
    stage.sun_and_sky(2.6);
    stage.camera(
        "Camera",
        Vec3::new(-0.6, 1.5, 3.4),
        Vec3::new(0.0, 0.42, 0.0),
        40.0,
    );
}

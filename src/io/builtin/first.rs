//! One triangle, and cubes.

use super::stage::{Stage, floor, matte, pictured, plain_background};
use crate::scene::{PointLamp, SegmentLamp, Shape};
use bevy::color::LinearRgba;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::transform::components::Transform;

const UNIT_CUBE: Shape = Shape::Cuboid { size: Vec3::ONE };

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
        intensity: 6.0,
        ..PointLamp::default()
    };
    stage.add("Lamp", (lamp, Transform::from_xyz(-0.6, 0.7, 1.3)));
    stage.camera("Camera", Vec3::new(0.0, 0.0, 3.2), Vec3::ZERO, 45.0);
}

pub(super) fn cube_segment_light(world: &mut World) {
    let mut stage = Stage::new(world, 16, plain_background(0.01, 0.01, 0.015));
    stage.object(
        "Floor",
        floor(12.0),
        matte(0.7, 0.7, 0.7),
        Transform::default(),
    );
    let turned =
        Transform::from_xyz(0.0, 0.5, 0.0).with_rotation(bevy::math::Quat::from_rotation_y(0.5));
    stage.object("Cube", UNIT_CUBE, matte(0.8, 0.78, 0.74), turned);
    let lamp = SegmentLamp {
        ends: [Vec3::new(-1.6, 0.0, 0.0), Vec3::new(1.6, 0.0, 0.0)],
        colors: [
            LinearRgba::rgb(1.0, 0.55, 0.18),
            LinearRgba::rgb(0.25, 0.5, 1.0),
        ],
        intensity: 4.0,
        samples: 4,
    };
    stage.add("Segment light", (lamp, Transform::from_xyz(0.0, 1.9, 1.0)));
    stage.camera(
        "Camera",
        Vec3::new(1.6, 2.2, 4.2),
        Vec3::new(0.0, 0.45, 0.0),
        40.0,
    );
}

pub(super) fn textured_cube(world: &mut World) {
    let mut stage = Stage::new(world, 16, plain_background(0.30, 0.36, 0.45));
    let checkered = Transform::from_scale(Vec3::splat(8.0));
    stage.object("Floor", floor(1.0), pictured("builtin:checker"), checkered);
    let turned =
        Transform::from_xyz(0.0, 0.5, 0.0).with_rotation(bevy::math::Quat::from_rotation_y(0.6));
    stage.object("Cube", UNIT_CUBE, pictured("builtin:uv"), turned);
    let key = PointLamp {
        color: LinearRgba::rgb(1.0, 0.95, 0.88),
        intensity: 30.0,
        cone: None,
    };
    stage.add("Key lamp", (key, Transform::from_xyz(-1.2, 3.2, 2.4)));
    let fill = PointLamp {
        color: LinearRgba::rgb(0.7, 0.82, 1.0),
        intensity: 12.0,
        cone: None,
    };
    stage.add("Fill lamp", (fill, Transform::from_xyz(3.5, 2.0, 1.0)));
    stage.camera(
        "Camera",
        Vec3::new(1.0, 1.7, 3.0),
        Vec3::new(0.0, 0.42, 0.0),
        40.0,
    );
}

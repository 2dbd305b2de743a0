//! Everything at once: what a newcomer may take apart.

use super::stage::{FLOOR, Stage, from_to, glossy, matte, pictured, sky};
use crate::io::shapes::SUN;
use crate::scene::{Cone, DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp, Shape};
use bevy::color::LinearRgba;
use bevy::ecs::world::World;
use bevy::math::{Quat, Vec3};
use bevy::transform::components::Transform;

pub(super) fn showcase(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    add_objects(&mut stage);
    add_lights(&mut stage);
    stage.camera(
        "Camera",
        Vec3::new(0.2, 2.5, 8.0),
        Vec3::new(-0.02, 0.95, 0.0),
        36.0,
    );
    stage.camera(
        "Close-up",
        Vec3::new(1.4, 1.25, 5.2),
        Vec3::new(0.35, 0.5, 0.6),
        34.0,
    );
}

fn add_objects(stage: &mut Stage) {
    let checkered = pictured("builtin:checker");
    stage.object("Floor", FLOOR, checkered, Transform::default());
    let turned = |angle| Quat::from_rotation_y(angle);
    let glaze = glossy([0.74, 0.71, 0.64], [0.08; 3], 300.0);
    let scale = Vec3::splat(0.6);
    let pot = Transform::from_xyz(-0.35, 0.0, 1.15).with_scale(scale);
    let shape = Shape::Teapot { divisions: 16 };
    stage.object("Teapot", shape, glaze, pot.with_rotation(turned(0.4)));
    let mirror = glossy([0.02; 3], [0.88; 3], 300.0);
    let shape = Shape::Sphere {
        radius: 0.85,
        segments: 96,
        rings: 64,
    };
    stage.object(
        "Mirror sphere",
        shape,
        mirror,
        Transform::from_xyz(0.9, 0.85, -0.9),
    );
    let shape = Shape::Cuboid {
        size: Vec3::splat(0.9),
    };
    let cube = Transform::from_xyz(1.8, 0.45, 0.6).with_rotation(turned(0.5));
    stage.object("Textured cube", shape, pictured("builtin:uv"), cube);
    let shape = Shape::Knot {
        p: 3,
        q: 5,
        tube_radius: 0.14,
        displacement: 0.12,
        segments: 720,
        sides: 24,
    };
    let gold = glossy([0.42, 0.24, 0.06], [0.55, 0.40, 0.16], 60.0);
    let knot = Transform::from_xyz(-1.45, 1.55, -1.3)
        .with_rotation(turned(0.5) * Quat::from_rotation_x(1.3))
        .with_scale(Vec3::splat(0.75));
    stage.object("Knot", shape, gold, knot);
    let shape = Shape::Cylinder {
        radius: 0.5,
        height: 0.6,
        segments: 96,
    };
    let plinth = matte(0.55, 0.53, 0.50);
    stage.object(
        "Plinth",
        shape,
        plinth,
        Transform::from_xyz(-1.45, 0.3, -1.3),
    );
    let shape = Shape::Torus {
        major_radius: 0.42,
        minor_radius: 0.15,
        segments: 96,
        sides: 40,
    };
    let enamel = glossy([0.06, 0.30, 0.36], [0.10; 3], 60.0);
    stage.object("Ring", shape, enamel, Transform::from_xyz(0.95, 0.15, 1.75));
    let shape = Shape::Head {
        segments: 96,
        rings: 88,
    };
    let marble = matte(0.74, 0.72, 0.69);
    let head = Transform::from_xyz(-2.0, 0.75, 0.5)
        .with_rotation(turned(0.1))
        .with_scale(Vec3::splat(0.75));
    stage.object("Head", shape, marble, head);
}

fn add_lights(stage: &mut Stage) {
    let sun = DirectionalLamp {
        color: LinearRgba::rgb(1.0, 0.92, 0.8),
        intensity: 2.1,
        angular_diameter: 0.02,
        samples: 1,
    };
    let downwards = Transform::default().looking_to(-SUN.as_vec3(), Vec3::Y);
    stage.add("Sun", (sun, downwards));
    let spot = PointLamp {
        color: LinearRgba::rgb(1.0, 0.75, 0.5),
        intensity: 45.0,
        cone: Some(Cone {
            inner: 0.20,
            outer: 0.30,
        }),
    };
    let at = from_to(Vec3::new(2.6, 4.0, 2.2), Vec3::new(0.8, 0.0, 1.4));
    stage.add("Spot", (spot, at));
    let tube = SegmentLamp {
        ends: [Vec3::NEG_X * 0.8, Vec3::X * 0.8],
        colors: [
            LinearRgba::rgb(1.0, 0.25, 0.55),
            LinearRgba::rgb(0.2, 0.55, 1.0),
        ],
        intensity: 1.4,
        samples: 2,
    };
    // Clear of the mirror sphere: where a light touches a surface, its light there has no bound.
    stage.add("Neon tube", (tube, Transform::from_xyz(-0.6, 0.2, -0.6)));
    let softbox = ParallelogramLamp {
        corner: Vec3::new(-0.5, 7.0, 1.0),
        edges: [Vec3::X * 2.5, Vec3::Z * 2.5],
        colors: [
            LinearRgba::rgb(0.75, 0.87, 1.0),
            LinearRgba::rgb(0.85, 0.9, 1.0),
            LinearRgba::rgb(0.75, 0.87, 1.0),
            LinearRgba::rgb(1.0, 0.92, 0.85),
        ],
        intensity: 4.5,
        visible: false,
        samples: 2,
        ..ParallelogramLamp::default()
    };
    stage.add("Softbox", (softbox, Transform::default()));
}

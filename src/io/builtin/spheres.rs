//! Spheres with different materials.

use super::stage::{FLOOR, Stage, glossy, matte, pictured, sky};
use crate::scene::Shape;
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::transform::components::Transform;

pub(super) fn spheres(world: &mut World) {
    let mut stage = Stage::new(world, 16, sky());
    let checkered = pictured("builtin:checker");
    stage.object("Floor", FLOOR, checkered, Transform::default());
    let balls = [
        (
            "Mirror",
            glossy([0.02; 3], [0.9; 3], 300.0),
            1.0,
            [0.0, -0.6],
        ),
        (
            "Gold",
            glossy([0.30, 0.16, 0.03], [0.75, 0.52, 0.18], 80.0),
            0.6,
            [-1.55, 0.1],
        ),
        (
            "Copper",
            glossy([0.28, 0.10, 0.05], [0.70, 0.34, 0.22], 60.0),
            0.6,
            [1.55, 0.1],
        ),
        (
            "Red glaze",
            glossy([0.62, 0.06, 0.05], [0.10; 3], 120.0),
            0.4,
            [-0.75, 0.95],
        ),
        (
            "Blue glaze",
            glossy([0.06, 0.16, 0.55], [0.10; 3], 40.0),
            0.4,
            [0.75, 0.95],
        ),
        ("Chalk", matte(0.82, 0.80, 0.76), 0.25, [0.0, 1.25]),
        ("Globe", pictured("builtin:uv"), 0.75, [-2.35, -1.4]),
        (
            "Jade",
            glossy([0.10, 0.42, 0.24], [0.06; 3], 15.0),
            0.75,
            [2.35, -1.4],
        ),
    ];
    for (name, phong, radius, [x, z]) in balls {
        let shape = Shape::Sphere {
            radius,
            segments: 96,
            rings: 64,
        };
        stage.object(name, shape, phong, Transform::from_xyz(x, radius, z));
    }
    stage.sun_and_sky(2.6);
    stage.camera(
        "Camera",
        Vec3::new(0.0, 2.3, 7.4),
        Vec3::new(0.0, 0.65, 0.0),
        40.0,
    );
}

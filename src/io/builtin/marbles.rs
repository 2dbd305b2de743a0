//! What a camera does: a lens, and a shutter that is open while something moves.

use super::stage::{FLOOR, Stage, from_to, glossy, matte, pictured, sky};
use crate::scene::{
    Lens, MeshSource, Motion, Phong, Projection, RenderSettings, SceneCamera, Shape,
};
use bevy::ecs::world::World;
use bevy::math::Vec3;
use bevy::transform::components::Transform;

const RADIUS: f32 = 0.28;

pub(super) fn marbles(world: &mut World) {
    let mut stage = Stage::new(world, 32, sky());
    let checkered = pictured("builtin:checker");
    stage.object("Floor", FLOOR, checkered, Transform::default());
    let shape = Shape::Sphere {
        radius: RADIUS,
        segments: 64,
        rings: 32,
    };
    let at = |x, z| Transform::from_xyz(x, RADIUS, z);
    let glass = Phong {
        opacity: 0.4,
        ..glossy([0.15, 0.55, 0.40], [0.08; 3], 300.0)
    };
    let gold = glossy([0.30, 0.16, 0.03], [0.75, 0.52, 0.18], 80.0);
    let steel = glossy([0.08, 0.08, 0.09], [0.62, 0.63, 0.66], 25.0);
    let still = [
        ("Tinted glass", glass, -0.45, 1.5),
        ("Brushed steel", steel, -0.12, 0.0),
        ("Globe", pictured("builtin:uv"), -0.75, -1.6),
        ("Gold", gold, 0.55, -3.0),
        ("Chalk", matte(0.82, 0.80, 0.76), -1.3, -4.5),
    ];
    for (name, phong, x, z) in still {
        stage.object(name, shape.clone(), phong, at(x, z));
    }
    let enamel = glossy([0.62, 0.06, 0.05], [0.10; 3], 120.0);
    let rolling = Motion {
        velocity: Vec3::X * 0.45,
        ..Motion::default()
    };
    let source = MeshSource::Shape(shape);
    stage.add("Rolling", (source, enamel, at(0.45, 0.1), rolling));
    stage.sun_and_sky(2.6);
    // Sharp in the middle of the steel marble.
    let (eye, target) = (Vec3::new(0.0, 0.9, 4.0), Vec3::new(0.0, 0.3, 0.0));
    let sharp = Vec3::new(-0.12, RADIUS, 0.0);
    let lens = Lens {
        aperture_radius: 0.06,
        focus_distance: (sharp - eye).dot((target - eye).normalize()),
        ..Lens::default()
    };
    let camera = SceneCamera {
        projection: Projection::Perspective {
            fov_y: 34_f32.to_radians(),
        },
        ..SceneCamera::default()
    };
    stage.add("Camera", (camera, lens, from_to(eye, target)));
    world.resource_mut::<RenderSettings>().features.glossy = true;
}

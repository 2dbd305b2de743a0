//! Cornell's box, from the measurements that the Cornell University Program of Computer Graphics
//! publishes ("Cornell Box Data"). They are in millimetres with the camera looking along +Z; here
//! they are in metres, turned half around the vertical and centred over the origin, so that the
//! camera looks along -Z. The tall block is a mirror.

use super::stage::{Stage, matte, sky};
use crate::scene::{Environment, MeshSource, ParallelogramLamp, Phong, PointLamp, Shape};
use bevy::color::LinearRgba;
use bevy::ecs::world::World;
use bevy::math::{Vec2, Vec3};
use bevy::transform::components::Transform;

/// Linear RGB of the published reflectance spectra, as the box's usual OBJ file has them
/// (M. McGuire, Computer Graphics Archive, 2017).
const WHITE: [f32; 3] = [0.725, 0.71, 0.68];
const RED: [f32; 3] = [0.63, 0.065, 0.05];
const GREEN: [f32; 3] = [0.14, 0.45, 0.091];

/// Height of the ceiling in published units.
const CEILING: f32 = 548.8;
/// How far under the ceiling the light hangs, in published units: the published ceiling has a hole
/// there instead.
const DROP: f32 = 0.5;

/// Name, paint, glow and corners in the published order, which goes counter-clockwise as seen from inside.
type Wall = (&'static str, [f32; 3], f32, [[f32; 3]; 4]);

/// The walls as published.
const WALLS: [Wall; 5] = [
    (
        "Floor",
        WHITE,
        0.03,
        [
            [552.8, 0.0, 0.0],
            [0.0, 0.0, 0.0],
            [0.0, 0.0, 559.2],
            [549.6, 0.0, 559.2],
        ],
    ),
    (
        "Ceiling",
        WHITE,
        0.10,
        [
            [556.0, 548.8, 0.0],
            [556.0, 548.8, 559.2],
            [0.0, 548.8, 559.2],
            [0.0, 548.8, 0.0],
        ],
    ),
    (
        "Back wall",
        WHITE,
        0.06,
        [
            [549.6, 0.0, 559.2],
            [0.0, 0.0, 559.2],
            [0.0, 548.8, 559.2],
            [556.0, 548.8, 559.2],
        ],
    ),
    (
        "Green wall",
        GREEN,
        0.06,
        [
            [0.0, 0.0, 559.2],
            [0.0, 0.0, 0.0],
            [0.0, 548.8, 0.0],
            [0.0, 548.8, 559.2],
        ],
    ),
    (
        "Red wall",
        RED,
        0.06,
        [
            [552.8, 0.0, 0.0],
            [549.6, 0.0, 559.2],
            [556.0, 548.8, 559.2],
            [556.0, 548.8, 0.0],
        ],
    ),
];

/// Published coordinates to ours.
fn place([x, y, z]: [f32; 3]) -> Vec3 {
    Vec3::new(278.0 - x, y, 279.6 - z) / 1000.0
}

pub(super) fn with_point_light(world: &mut World) {
    let mut stage = room(world);
    let panel = Phong {
        emission: LinearRgba::WHITE,
        ..matte(0.78, 0.78, 0.78)
    };
    let [corner, along, across] = light();
    let shape = Shape::Quad {
        corner,
        edges: [along, across],
    };
    stage.add("Light panel", (MeshSource::Shape(shape), panel));
    let lamp = PointLamp {
        color: LinearRgba::rgb(1.0, 0.94, 0.84),
        intensity: 0.26,
        cone: None,
    };
    let below = place([278.0, CEILING - 40.0, 279.6]);
    stage.add("Lamp", (lamp, Transform::from_translation(below)));
}

pub(super) fn with_parallelogram_light(world: &mut World) {
    let mut stage = room(world);
    let [corner, along, across] = light();
    let lamp = ParallelogramLamp {
        corner,
        edges: [along, across],
        colors: [LinearRgba::rgb(1.0, 0.90, 0.74); 4],
        intensity: 38.0,
        samples: 4,
        ..ParallelogramLamp::default()
    };
    stage.add("Ceiling light", (lamp, Transform::default()));
}

/// A corner and the two edges of the published light; its front is below.
fn light() -> [Vec3; 3] {
    let [corner, along, across] = [[343.0, 227.0], [343.0, 332.0], [213.0, 227.0]]
        .map(|[x, z]| place([x, CEILING - DROP, z]));
    [corner, along - corner, across - corner]
}

/// What a wall is painted with. Light that walls pass on to each other is not traced; `glow`, a
/// little even radiance (white's own, tinted by the paint), stands in for it.
fn paint([r, g, b]: [f32; 3], glow: f32) -> Phong {
    Phong {
        emission: LinearRgba::rgb(r, g, b) * glow,
        ..matte(r, g, b)
    }
}

/// Walls, blocks and camera.
fn room(world: &mut World) -> Stage<'_> {
    let mut stage = Stage::new(
        world,
        16,
        Environment {
            intensity: 0.5,
            ..sky()
        },
    );
    for (name, color, glow, corners) in WALLS {
        let shape = Shape::Quadrilateral {
            corners: corners.map(place),
        };
        stage.add(name, (MeshSource::Shape(shape), paint(color, glow)));
    }
    let block = |corners: [[f32; 2]; 4], height: f32| Shape::Prism {
        base: corners
            .map(|[x, z]| place([x, 0.0, z]))
            .map(|p| Vec2::new(p.x, p.z))
            .to_vec(),
        height: height / 1000.0,
    };
    let short = [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]];
    let short = MeshSource::Shape(block(short, 165.0));
    stage.add("Short block", (short, paint(WHITE, 0.05)));
    let mirror = Phong {
        specular: LinearRgba::rgb(0.9, 0.9, 0.9),
        mirror: LinearRgba::rgb(0.9, 0.9, 0.9),
        shininess: 400.0,
        ..matte(0.02, 0.02, 0.02)
    };
    let tall = [
        [423.0, 247.0],
        [265.0, 296.0],
        [314.0, 456.0],
        [472.0, 406.0],
    ];
    let tall = MeshSource::Shape(block(tall, 330.0));
    stage.add("Mirror block", (tall, mirror));
    // Published: a lens of 35 mm before a sensor of 25 mm.
    let fov_y = 2.0 * (12.5_f32 / 35.0).atan();
    let eye = place([278.0, 273.0, -800.0]);
    stage.camera("Camera", eye, eye + Vec3::NEG_Z, fov_y.to_degrees());
    stage
}

//! Spawning things with a name and the next number.

use crate::io::shapes::SUN;
use crate::scene::{
    DirectionalLamp, Environment, MeshSource, ParallelogramLamp, Phong, Projection, RenderSettings,
    SceneCamera, SceneId, Shape, TextureSource,
};
use bevy::color::LinearRgba;
use bevy::ecs::{bundle::Bundle, name::Name, world::World};
use bevy::math::{UVec2, Vec2, Vec3};
use bevy::transform::components::Transform;

/// A scene that is being spawned.
pub(super) struct Stage<'w> {
    world: &'w mut World,
    last_id: u64,
}

impl<'w> Stage<'w> {
    /// Begins a scene of square pictures with `spp` samples a pixel.
    pub fn new(world: &'w mut World, spp: u32, environment: Environment) -> Self {
        world.insert_resource(environment);
        world.insert_resource(RenderSettings {
            size: UVec2::splat(800),
            spp,
            ..RenderSettings::default()
        });
        Self { world, last_id: 0 }
    }

    /// Spawns an entity with its name and the next number.
    pub fn add(&mut self, name: &'static str, bundle: impl Bundle) {
        self.last_id += 1;
        let id = SceneId(self.last_id);
        self.world.spawn((Name::new(name), id, bundle));
    }

    /// Spawns an object.
    pub fn object(&mut self, name: &'static str, shape: Shape, phong: Phong, transform: Transform) {
        self.add(name, (MeshSource::Shape(shape), phong, transform));
    }

    /// Spawns a camera at `eye` that looks at `target`.
    pub fn camera(&mut self, name: &'static str, eye: Vec3, target: Vec3, fov_y_degrees: f32) {
        let camera = SceneCamera {
            projection: Projection::Perspective {
                fov_y: fov_y_degrees.to_radians(),
            },
            ..SceneCamera::default()
        };
        self.add(name, (camera, from_to(eye, target)));
    }

    /// Spawns the sun of `builtin:sky`, `intensity` in W/m², and a dimmer light overhead in place of
    /// the light that the rest of the sky would send: the environment itself lights nothing. It is
    /// no larger than it is because a mirror shows a light's highlight, and few samples of a larger
    /// light would fall into it.
    pub fn sun_and_sky(&mut self, intensity: f32) {
        let sun = DirectionalLamp {
            color: LinearRgba::rgb(1.0, 0.93, 0.82),
            intensity,
            angular_diameter: 0.02,
            samples: 1,
        };
        let downwards = Transform::default().looking_to(-SUN.as_vec3(), Vec3::Y);
        self.add("Sun", (sun, downwards));
        let sky = ParallelogramLamp {
            corner: Vec3::new(-0.5, 9.0, -0.5),
            edges: [Vec3::X * 3.0, Vec3::Z * 3.0],
            colors: [LinearRgba::rgb(0.75, 0.87, 1.0); 4],
            intensity: 2.2 * intensity,
            visible: false,
            samples: 2,
            ..ParallelogramLamp::default()
        };
        self.add("Skylight", (sky, Transform::default()));
    }
}

/// At `eye`, the local -Z towards `target`, upright.
pub(super) fn from_to(eye: Vec3, target: Vec3) -> Transform {
    Transform::from_translation(eye).looking_at(target, Vec3::Y)
}

/// A material that only scatters.
pub(super) fn matte(r: f32, g: f32, b: f32) -> Phong {
    Phong {
        diffuse: LinearRgba::rgb(r, g, b),
        ..Phong::default()
    }
}

/// A material that scatters and mirrors: it shows its surroundings in the colour of its highlight.
pub(super) fn glossy(diffuse: [f32; 3], specular: [f32; 3], shininess: f32) -> Phong {
    let rgb = |[r, g, b]: [f32; 3]| LinearRgba::rgb(r, g, b);
    Phong {
        diffuse: rgb(diffuse),
        specular: rgb(specular),
        mirror: rgb(specular),
        shininess,
        ..Phong::default()
    }
}

/// A matte material that wears a generated picture.
pub(super) fn pictured(name: &'static str) -> Phong {
    Phong {
        diffuse: LinearRgba::WHITE,
        diffuse_map: Some(TextureSource::new(name)),
        ..Phong::default()
    }
}

/// A floor that reaches to the horizon; a checkered one has squares of half a metre.
pub(super) const FLOOR: Shape = Shape::Ground {
    size: Vec2::splat(200.0),
    tile: Vec2::splat(4.0),
};

/// No map, one colour all around.
pub(super) fn plain_background(r: f32, g: f32, b: f32) -> Environment {
    Environment {
        background: LinearRgba::rgb(r, g, b),
        ..Environment::default()
    }
}

/// The generated sky.
pub(super) fn sky() -> Environment {
    Environment {
        background: LinearRgba::rgb(0.45, 0.60, 0.85),
        map: Some(TextureSource::new("builtin:sky")),
        ..Environment::default()
    }
}

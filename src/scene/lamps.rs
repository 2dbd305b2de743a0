//! The four kinds of light. Colour times `intensity` is the strength; its unit is that of the kind.

use super::SceneId;
use bevy::camera::visibility::Visibility;
use bevy::color::LinearRgba;
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::Vec3;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

/// A light at the entity's position. Strength: radiant intensity, W/sr.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, Visibility, SceneId)]
pub struct PointLamp {
    /// Linear RGB.
    pub color: LinearRgba,
    /// Multiplies the colour.
    pub intensity: f32,
    /// Limits the light to a cone around the entity's local -Z: a spot.
    pub cone: Option<Cone>,
}

impl Default for PointLamp {
    fn default() -> Self {
        Self {
            color: LinearRgba::WHITE,
            intensity: 1.0,
            cone: None,
        }
    }
}

/// Where a spot fades: full strength inside the inner half-angle, none outside the outer one.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub struct Cone {
    /// Half-angle in radians, 0 ≤ inner ≤ outer.
    pub inner: f32,
    /// Half-angle in radians, at most π/2.
    pub outer: f32,
}

impl Default for Cone {
    fn default() -> Self {
        Self {
            inner: 0.4,
            outer: 0.5,
        }
    }
}

/// Light from infinitely far, along the entity's local -Z. Strength: irradiance on a facing surface, W/m².
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, Visibility, SceneId)]
pub struct DirectionalLamp {
    /// Linear RGB.
    pub color: LinearRgba,
    /// Multiplies the colour.
    pub intensity: f32,
    /// Angle under which the source is seen, in radians, 0 to π: a disc of directions, all equally bright. 0 gives hard
    /// shadows, the sun has 0.0093; π is half of the sky.
    pub angular_diameter: f32,
    /// Shadow rays at the first hit, 1–1000; used where `angular_diameter` > 0.
    pub samples: u32,
}

impl Default for DirectionalLamp {
    fn default() -> Self {
        Self {
            color: LinearRgba::WHITE,
            intensity: 1.0,
            angular_diameter: 0.0,
            samples: 1,
        }
    }
}

/// A glowing line. Strength: radiant intensity per length, W/(sr·m), the same in all directions.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, Visibility, SceneId)]
pub struct SegmentLamp {
    /// Both ends in the entity's space.
    pub ends: [Vec3; 2],
    /// Linear RGB at each end, linear between.
    pub colors: [LinearRgba; 2],
    /// Multiplies the colours.
    pub intensity: f32,
    /// Shadow rays at the first hit, 1–1000.
    pub samples: u32,
}

impl Default for SegmentLamp {
    fn default() -> Self {
        Self {
            ends: [Vec3::NEG_X * 0.5, Vec3::X * 0.5],
            colors: [LinearRgba::WHITE; 2],
            intensity: 1.0,
            samples: 1,
        }
    }
}

/// A glowing parallelogram. Strength: radiance, W/(sr·m²), with the emitter's cosine.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, Visibility, SceneId)]
pub struct ParallelogramLamp {
    /// One corner in the entity's space.
    pub corner: Vec3,
    /// The two edges that leave it. The front, which shines, is where `edges[0] × edges[1]` points.
    pub edges: [Vec3; 2],
    /// Linear RGB at `corner`, `corner + edges[0]`, `corner + edges[1]` and the corner opposite, bilinear between.
    pub colors: [LinearRgba; 4],
    /// Multiplies the colours.
    pub intensity: f32,
    /// Whether the back shines too.
    pub two_sided: bool,
    /// Whether camera and mirror rays see it.
    pub visible: bool,
    /// Shadow rays at the first hit, 1–1000.
    pub samples: u32,
}

impl Default for ParallelogramLamp {
    fn default() -> Self {
        Self {
            corner: Vec3::new(-0.5, 0.0, -0.5),
            edges: [Vec3::X, Vec3::Z],
            colors: [LinearRgba::WHITE; 4],
            intensity: 1.0,
            two_sided: false,
            visible: true,
            samples: 1,
        }
    }
}

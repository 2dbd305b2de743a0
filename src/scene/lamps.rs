//! The four kinds of light. Colour times `intensity` is the strength; its unit is that of the kind.

use super::SceneId;
use super::schema::{Label, NotAbove, Quantity, documented};
use bevy::camera::visibility::Visibility;
use bevy::color::LinearRgba;
use bevy::ecs::query::{Or, With};
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::Vec3;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

/// What any light has, as a query's filter.
pub type AnyLamp = Or<(
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
)>;

documented! {
    /// A light at the entity's position. Strength: radiant intensity, W/sr.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    #[require(Transform, Visibility, SceneId)]
    pub struct PointLamp {
        /// The light's colour, in linear RGB; the intensity multiplies it.
        #[reflect(@Quantity::FACTOR, @Label("Colour"))]
        pub color: LinearRgba,
        /// Radiant intensity: what reaches a surface falls with the distance squared.
        #[reflect(@Quantity::at_least_0("W/sr"))]
        pub intensity: f32,
        /// Only within a cone around the light's -Z axis.
        #[reflect(@Label("Spot"))]
        pub cone: Option<Cone>,
    }
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

documented! {
    /// Where a spot fades: full strength inside the inner half-angle, none outside the outer one.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct Cone {
        /// Half-angle of the cone that has full strength, in radians.
        #[reflect(@Quantity::degrees(0.0, 90.0), @NotAbove("outer"), @Label("Full within"))]
        pub inner: f32,
        /// Half-angle outside of which there is no light, in radians; between the two it fades.
        #[reflect(@Quantity::degrees(0.0, 90.0), @Label("None outside"))]
        pub outer: f32,
    }
}

impl Default for Cone {
    fn default() -> Self {
        Self {
            inner: 0.4,
            outer: 0.5,
        }
    }
}

documented! {
    /// Light from infinitely far, along the entity's local -Z. Strength: irradiance on a facing surface, W/m².
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    #[require(Transform, Visibility, SceneId)]
    pub struct DirectionalLamp {
        /// The light's colour, in linear RGB; the intensity multiplies it.
        #[reflect(@Quantity::FACTOR, @Label("Colour"))]
        pub color: LinearRgba,
        /// Irradiance on a surface that faces it, the same at every distance.
        #[reflect(@Quantity::at_least_0("W/m²"))]
        pub intensity: f32,
        /// Angle under which the source is seen: 0 gives hard shadows, the sun has 0.53°, 180° is half of the sky.
        ///
        /// In radians: a disc of directions, all equally bright.
        #[reflect(@Quantity::degrees(0.0, 180.0))]
        pub angular_diameter: f32,
        /// Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its soft shadows less
        /// noisy.
        #[reflect(@Quantity::SAMPLES)]
        pub samples: u32,
    }
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

documented! {
    /// A glowing line. Strength: radiant intensity per length, W/(sr·m), the same in all directions.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    #[require(Transform, Visibility, SceneId)]
    pub struct SegmentLamp {
        /// Metres, in the light's own space; its ends have handles in the view too.
        #[reflect(@Quantity::COORDINATE, @Label("End"))]
        pub ends: [Vec3; 2],
        /// The colour at this end, linear between.
        #[reflect(@Quantity::FACTOR, @Label("Colour"))]
        pub colors: [LinearRgba; 2],
        /// Radiant intensity of each metre, the same in all directions.
        #[reflect(@Quantity::at_least_0("W/(sr·m)"))]
        pub intensity: f32,
        /// Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its soft shadows less
        /// noisy.
        #[reflect(@Quantity::SAMPLES)]
        pub samples: u32,
    }
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

documented! {
    /// A glowing parallelogram. Strength: radiance, W/(sr·m²), with the emitter's cosine.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    #[require(Transform, Visibility, SceneId)]
    pub struct ParallelogramLamp {
        /// Metres, in the light's own space; its corners have handles in the view too.
        #[reflect(@Quantity::COORDINATE)]
        pub corner: Vec3,
        /// From the corner to its neighbour; it shines to where A × B points.
        #[reflect(@Quantity::COORDINATE, @Label("Edge"))]
        pub edges: [Vec3; 2],
        /// The colours at the corner, at the ends of edges A and B, and at the corner opposite, bilinear between.
        #[reflect(@Quantity::FACTOR, @Label("Colour"))]
        pub colors: [LinearRgba; 4],
        /// Radiance: a larger light of the same radiance gives more light.
        #[reflect(@Quantity::at_least_0("W/(sr·m²)"))]
        pub intensity: f32,
        /// Whether the back shines too.
        #[reflect(@Label("Two-sided"))]
        pub two_sided: bool,
        /// Whether the camera and mirrors see the light itself.
        #[reflect(@Label("Visible to camera"))]
        pub visible: bool,
        /// Shadow rays to it at the first hit of each pixel, shared by the pixel's samples: more makes its soft shadows less
        /// noisy.
        #[reflect(@Quantity::SAMPLES)]
        pub samples: u32,
    }
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

use super::SceneId;
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::Vec3;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;

/// A camera of the scene, at the entity's position, looking down its local -Z, its local +Y up.
///
/// Not Bevy's `Camera`, which draws to a window as soon as it exists: a scene may hold many.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
#[require(Transform, SceneId)]
pub struct SceneCamera {
    /// How directions become places in the picture.
    pub projection: Projection,
    /// When the shutter opens, in [0, `shutter_close`].
    pub shutter_open: f32,
    /// When the shutter closes, in [`shutter_open`, 1].
    pub shutter_close: f32,
}

impl Default for SceneCamera {
    fn default() -> Self {
        Self {
            projection: Projection::default(),
            shutter_open: 0.0,
            shutter_close: 1.0,
        }
    }
}

/// How directions become places in the picture.
#[derive(Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Default, Clone, PartialEq, Debug)]
pub enum Projection {
    /// Far things are small.
    Perspective {
        /// Vertical field of view in radians, between 0 and π.
        fov_y: f32,
    },
    /// Far things keep their size.
    Orthographic {
        /// Height of the picture in metres.
        height: f32,
    },
}

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective {
            fov_y: 50_f32.to_radians(),
        }
    }
}

/// A thin lens on a camera: what is not at the focus distance is blurred.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct Lens {
    /// Radius of the aperture in metres; 0 is a pinhole.
    pub aperture_radius: f32,
    /// Distance to the focus plane along the view axis, in metres; may be infinite.
    pub focus_distance: f32,
    /// Samples of a pixel that the lens asks for, 1–1000.
    pub samples: u32,
}

impl Default for Lens {
    fn default() -> Self {
        Self {
            aperture_radius: 0.0,
            focus_distance: 1.0,
            samples: 1,
        }
    }
}

/// Moves an entity while the shutter is open, and all that hangs below it: at time t it stands `velocity · t` farther.
///
/// An object, a camera and a point, segment or parallelogram lamp move by the sum of their own way and of those of
/// all their ancestors, each carried from its parent's space into the world. A spot's cone keeps its direction, and a
/// directional lamp shines from infinitely far, whatever moves it.
#[derive(Component, Reflect, Clone, Debug, PartialEq)]
#[reflect(Component, Default, Clone, PartialEq, Debug)]
#[type_path = "glassbox::scene"]
pub struct Motion {
    /// Metres per unit of shutter time, in the parent's space.
    pub velocity: Vec3,
    /// Samples of a pixel that the motion asks for, 1–1000.
    pub samples: u32,
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            samples: 1,
        }
    }
}

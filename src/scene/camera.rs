use super::SceneId;
use super::schema::{FARTHEST, Label, NotAbove, Quantity, documented};
use bevy::ecs::{component::Component, reflect::ReflectComponent};
use bevy::math::Vec3;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::transform::components::Transform;
use std::f64::consts::PI;

documented! {
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
        /// When the shutter opens, as a part of the time from 0 to 1: what moves is smeared while it is open.
        #[reflect(@Quantity::PART, @NotAbove("shutter_close"), @Label("Shutter opens"))]
        pub shutter_open: f32,
        /// When the shutter closes, as a part of the time from 0 to 1: what moves is smeared while it is open.
        #[reflect(@Quantity::PART, @Label("Shutter closes"))]
        pub shutter_close: f32,
    }
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

/// The ends of the field of view's slider, in radians.
const FOV: [f64; 2] = [1.0 * PI / 180.0, 170.0 * PI / 180.0];

documented! {
    /// How directions become places in the picture.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub enum Projection {
        /// Far things are small.
        Perspective {
            /// The angle from the picture's lower to its upper edge, in radians.
            #[reflect(@Quantity::degrees(0.0, 180.0).open().shown(FOV[0], FOV[1]), @Label("Field of view"))]
            fov_y: f32,
        },
        /// Far things keep their size.
        Orthographic {
            /// What the picture's height shows, in metres.
            #[reflect(@Quantity::within(0.0, FARTHEST as f64, "m").open())]
            height: f32,
        },
    }
}

impl Default for Projection {
    fn default() -> Self {
        Self::Perspective {
            fov_y: 50_f32.to_radians(),
        }
    }
}

documented! {
    /// Depth of field: a thin lens on a camera; what is not at the focus distance is blurred.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    pub struct Lens {
        /// Radius of the opening in metres: larger blurs more; 0 is a pinhole, all sharp.
        #[reflect(@Quantity::LENGTH.step(0.001), @Label("Aperture"))]
        pub aperture_radius: f32,
        /// Metres along the view axis to the plane that is sharp; inf is infinitely far.
        #[reflect(@Quantity::within(0.0, f64::INFINITY, "m").open(), @Label("Focus"))]
        pub focus_distance: f32,
        /// Samples of each pixel that the lens asks for: more makes the blur less noisy.
        #[reflect(@Quantity::SAMPLES)]
        pub samples: u32,
    }
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

documented! {
    /// It moves while the shutter is open with all that hangs below it, and is smeared along its way.
    ///
    /// At time t an entity stands `velocity · t` farther.
    ///
    /// An object, a camera and a point, segment or parallelogram lamp move by the sum of their own way and of those of
    /// all their ancestors, each carried from its parent's space into the world. A spot's cone keeps its direction, and a
    /// directional lamp shines from infinitely far, whatever moves it.
    #[derive(Component, Reflect, Clone, Debug, PartialEq)]
    #[reflect(Component, Default, Clone, PartialEq, Debug)]
    #[type_path = "glassbox::scene"]
    pub struct Motion {
        /// Metres that it covers from time 0 to 1, in its parent's space.
        #[reflect(@Quantity::COORDINATE)]
        pub velocity: Vec3,
        /// Samples of each pixel that the motion asks for: more makes the smear less noisy.
        #[reflect(@Quantity::SAMPLES)]
        pub samples: u32,
    }
}

impl Default for Motion {
    fn default() -> Self {
        Self {
            velocity: Vec3::ZERO,
            samples: 1,
        }
    }
}

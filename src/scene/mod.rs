//! What a scene is made of: plain, reflected data, and no systems.
//!
//! An entity is one thing of the scene. Which components it carries says what it is:
//!
//! | it is | it carries | where it stands |
//! |---|---|---|
//! | an object | `Mesh3d` (usually through [`MeshSource`]) and [`Phong`] or [`UsesMaterial`], optionally [`Motion`] | `Transform` |
//! | a shared material | [`Phong`] and no mesh | nowhere |
//! | a light | [`PointLamp`], [`DirectionalLamp`], [`SegmentLamp`] or [`ParallelogramLamp`], optionally [`Motion`] | `Transform` |
//! | a camera | [`SceneCamera`], optionally [`Lens`] and [`Motion`] | `Transform`, looking down its local -Z |
//!
//! What belongs to the scene as a whole are the resources [`Environment`] and [`RenderSettings`].
//!
//! Components that end in `Source` are what files keep; the room `io` resolves them into the
//! handles (`Mesh3d`, [`PhongMaps`]) that the room `sync` reads. A Bevy app that has its own
//! handles spawns those directly.
//!
//! Units: metres, radians, seconds; colours are linear RGB, scene-referred; alpha is not read.

mod camera;
mod identity;
mod lamps;
mod material;
mod mesh_source;
pub mod schema;
mod setting_table;
mod settings;
mod tree_settings;

pub use camera::{Lens, Motion, Projection, SceneCamera};
pub use identity::{NotTraced, SceneId};
pub use lamps::{AnyLamp, Cone, DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
pub use material::{
    Alpha, MapFilter, Phong, PhongMap, PhongMaps, SRGB_16_BITS, TextureSource, UsesMaterial, Wrap,
};
pub use mesh_source::{MeshSource, Shape};
pub use schema::{Property, Quantity, RangeProblem, range_problems};
pub use setting_table::SETTINGS;
pub use settings::{
    Bloom, Environment, EnvironmentMap, Features, Lighting, Output, PixelSampling, RenderSettings,
    Sampling, Sequence, TextureFilter, ViewTransform,
};
pub use tree_settings::{Builder, Levels, Preset, TreeSettings};

use bevy::app::{App, Plugin};

/// Registers every type of this room and inserts its resources.
pub struct ScenePlugin;

impl Plugin for ScenePlugin {
    fn build(&self, app: &mut App) {
        app.register_type::<SceneId>()
            .register_type::<NotTraced>()
            .register_type::<MeshSource>()
            .register_type::<Shape>()
            .register_type::<Phong>()
            .register_type::<PhongMaps>()
            .register_type::<UsesMaterial>()
            .register_type::<PointLamp>()
            .register_type::<DirectionalLamp>()
            .register_type::<SegmentLamp>()
            .register_type::<ParallelogramLamp>()
            .register_type::<SceneCamera>()
            .register_type::<Lens>()
            .register_type::<Motion>()
            .register_type::<Environment>()
            .register_type::<EnvironmentMap>()
            .register_type::<RenderSettings>()
            .init_resource::<Environment>()
            .init_resource::<EnvironmentMap>()
            .init_resource::<RenderSettings>();
    }
}

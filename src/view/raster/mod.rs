//! The scene as Bevy's renderer can show it: quick, and an approximation.
//!
//! | ours | Bevy's |
//! |---|---|
//! | [`Phong`] | `StandardMaterial` on the same entity: kd is the base colour, ke the emission; a highlight of exponent s has about the roughness (2/(s+2))^¼ (Beckmann's, Walter et al. 2007, eq. 8, and Bevy's square); a mirror is metal |
//! | [`PointLamp`] | `PointLight` of 4π·I/E lumens, or `SpotLight` |
//! | [`DirectionalLamp`] | `DirectionalLight` of I/E lux |
//! | [`SegmentLamp`] | `PointLight` in its middle, of all its strength |
//! | [`ParallelogramLamp`] | `SpotLight` in its middle along the normal, or `PointLight` where it has two sides |
//! | [`Environment`] of one colour that lights | `AmbientLight` of its cameras |
//!
//! There are no shadows, no reflections and no background picture. A camera shows it right where
//! its `Exposure` is [`exposure`], which multiplies light by E. It is Bevy's own, so that an app's
//! lights can stand beside ours.
//!
//! Everything that is drawn so lies in one layer, which a camera can leave out. `materials`, `lights` and `ambient` have a
//! kind of it each.
//!
//! [`Phong`]: crate::scene::Phong
//! [`PointLamp`]: crate::scene::PointLamp
//! [`DirectionalLamp`]: crate::scene::DirectionalLamp
//! [`SegmentLamp`]: crate::scene::SegmentLamp
//! [`ParallelogramLamp`]: crate::scene::ParallelogramLamp
//! [`Environment`]: crate::scene::Environment

mod ambient;
mod lights;
mod materials;

pub use lights::RasterTwin;
pub use materials::standard_material;

pub(super) use ambient::ambient;

use bevy::camera::Exposure;
use bevy::pbr::MaterialPlugin;
use bevy::prelude::{App, IntoScheduleConfigs, Plugin, PostUpdate};
use bevy::transform::TransformSystems;

/// The layer of what Bevy's renderer shows of the scene.
pub const RASTER_LAYER: usize = 1;

/// Shows a scene of our components in Bevy's renderer. Not for scenes of Bevy's own materials,
/// which it shows anyway.
pub struct RasterPlugin;

impl Plugin for RasterPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(MaterialPlugin::<materials::RasterMaterial>::default());
        app.init_resource::<materials::RasterMaterials>()
            .add_systems(
                PostUpdate,
                (
                    materials::give_materials,
                    lights::give_lights,
                    lights::move_lights,
                    ambient::give_ambient,
                )
                    .chain()
                    .after(TransformSystems::Propagate)
                    .after(crate::sync::SyncSystems),
            );
    }
}

/// The exposure at which the raster view is as bright as the traced one.
pub fn exposure() -> Exposure {
    Exposure::default()
}

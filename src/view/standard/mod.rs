//! A scene of Bevy's own materials and lights, traced.
//!
//! Each component that Bevy knows gets ours beside it, and they are kept in step. What has nothing
//! that it could become is named in [`Traced::problems`](crate::sync::Traced::problems).
//!
//! With base colour `b`, metalness `m`, roughness `r`, `F0 = 0.16 · reflectance² · specular tint` and
//! gloss `g = (1 - r)²`, as the glTF reader maps the same material:
//!
//! | `StandardMaterial` | [`Phong`](crate::scene::Phong), [`PhongMaps`](crate::scene::PhongMaps) |
//! |---|---|
//! | base colour, metalness, roughness (by Lambert's law: where light grazes something rough Bevy's, Burley's, is up to 1.4 times as bright; of one light on a rough metal it has half) | `diffuse` = `b · (1 - m·g)`; `specular` and `mirror` = `lerp(F0, b, m) · g`, so that what is rough is no mirror; `shininess` = `2/r⁴ - 2`, 1 to 10,000 (Beckmann's, Walter et al. 2007, with α = r²) |
//! | its map of metalness and roughness | counts with its mean; named |
//! | base colour's map | multiplies `diffuse`, and `specular` and `mirror` of what is metal by more than half |
//! | alpha and alpha mode | `opacity`, its map the base colour's alpha; `Opaque`, `Mask`, `Blend` as they are, what else there is blends; premultiplied, additive and multiplied are named |
//! | emissive and its map | `emission`; with `emissive_exposure_weight` as far as that says times E |
//! | unlit | `emission` of the base colour, and nothing else |
//! | normal map | the normals; flipped ones are named |
//! | specular transmission | `opacity`, light goes straight through; named |
//! | vertex colours | multiply `diffuse`, of what is unlit `emission`; their alpha `opacity` |
//! | double-sidedness, culling | both sides are seen and lit; a view that sees a back which Bevy culls is named |
//! | `uv_transform`, second texture coordinates, occlusion, depth, clearcoat, anisotropy, diffuse transmission | named |
//! | **another material** | what [`add_traced_material`](AddTracedMaterial::add_traced_material) says: ours, with pictures, or the row above of the `StandardMaterial` that it extends; else named |
//!
//! | Bevy's lights | ours |
//! |---|---|
//! | `PointLight` | [`PointLamp`](crate::scene::PointLamp) of lumens / 4π · E |
//! | `SpotLight` | the same, with its cone, which fades smoothly at both ends (Bevy's as a square) |
//! | `DirectionalLight` | [`DirectionalLamp`](crate::scene::DirectionalLamp) of lux · E |
//! | `RectLight` | [`ParallelogramLamp`](crate::scene::ParallelogramLamp) of lumens / (π · area) · E, unseen by the camera. Bevy draws it with its feature `area_light_luts` alone, which this crate leaves off, and never with shadows, which is named |
//! | no shadows; a range at which light would still be seen | named: everything casts shadows, and light has no end |
//!
//! E = 1 / (1.2 · 2^ev100) is what a camera multiplies light by: that of the first view's `Exposure`. A
//! picture is as bright as Bevy's, as long as Bevy's is not tone-mapped. Another view's other exposure
//! is named.
//!
//! | else | becomes |
//! |---|---|
//! | `ClearColor`, or the first view's own | the background, where the app has set no other |
//! | a view's `Skybox` | the map of [`Environment`](crate::scene::Environment), of brightness · E, where the app has set no other |
//! | a view's `EnvironmentMapLight` (its specular map) or `GeneratedEnvironmentMapLight` | its light, with shadows; without a skybox mirrors show it, and the camera sees the background; one that is another than the skybox is named |
//! | skies turned otherwise than about the vertical axis, or of another view than the first | named |
//! | `GlobalAmbientLight`, a camera's `AmbientLight`, light probes, fog, atmospheres | named |
//! | `NotShadowCaster`, `NotShadowReceiver`, `RenderLayers`, `Lightmap` of objects | named |
//! | skinned and morphed meshes | as they stand in this frame, in every frame in which a view traces them |
//! | meshes and textures of `RenderAssetUsages::RENDER_WORLD` alone, materials that are not loaded | named |

mod add_material;
mod backs;
mod derived;
mod lights;
mod material;
mod objects;
mod pose;
mod poses;
mod returned;
mod sky;
mod surroundings;
mod unknown;

#[cfg(test)]
mod tests;

pub use add_material::{AddTracedMaterial, TracedAs};

use add_material::map_materials;
use bevy::asset::{AssetApp, AssetEventSystems, Assets};
use bevy::ecs::schedule::SystemSet;
use bevy::pbr::StandardMaterial;
use bevy::prelude::{App, Component, IntoScheduleConfigs, Plugin, PostUpdate};
use bevy::transform::TransformSystems;

/// Keeps ours beside Bevy's. The tables are in the module's documentation.
pub struct StandardMappingPlugin;

/// What maps, before [`SyncSystems`](crate::sync::SyncSystems).
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct MappingSystems;

impl Plugin for StandardMappingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<derived::DerivedPictures>()
            .init_resource::<lights::ViewExposure>()
            .init_resource::<crate::sync::LeftOut>()
            .configure_sets(PostUpdate, MappingSystems.before(crate::sync::SyncSystems))
            .add_systems(
                PostUpdate,
                (
                    derived::forget_edited,
                    lights::read_exposure,
                    map_materials::<StandardMaterial>,
                    lights::systems(),
                    surroundings::map_background,
                    sky::map_sky,
                    surroundings::name_surroundings,
                    surroundings::name_probes,
                    surroundings::name_incomplete,
                    objects::name_flags,
                    backs::name_backs,
                    unknown::name_unknown,
                )
                    .chain()
                    .in_set(MappingSystems),
            )
            .add_systems(
                PostUpdate,
                (poses::straighten, poses::pose_meshes)
                    .chain()
                    .after(TransformSystems::Propagate)
                    // So that a pose is traced in its own frame.
                    .before(AssetEventSystems)
                    .before(MappingSystems),
            );
        add_material::register(app, |material: &StandardMaterial, pictures| {
            material::surface(material, pictures)
        });
    }

    /// An app without a renderer has no such materials of its own.
    fn finish(&self, app: &mut App) {
        if !app.world().contains_resource::<Assets<StandardMaterial>>() {
            app.init_asset::<StandardMaterial>();
        }
    }
}

/// What was mapped last. Ours is set only where that becomes another: an edit of ours stays until
/// Bevy's is edited too.
#[derive(Component, Clone)]
struct Mapped<T: Clone + Send + Sync + 'static>(T);

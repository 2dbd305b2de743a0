//! A scene of Bevy's own materials and lights, traced.
//!
//! Each component that Bevy knows gets ours beside it, and they are kept in step:
//!
//! | Bevy's | ours |
//! |---|---|
//! | `StandardMaterial` | [`Phong`] and [`PhongMaps`]: kd = base colour · (1 - metallic); ks = base colour · metallic + 0.16 · reflectance² · (1 - metallic); km = ks · (1 - roughness)², as a mirror is sharp; s = 2/α² - 2 with α = roughness² (Beckmann's, Walter et al. 2007), 1 to 10,000; d = the base colour's alpha; the alpha mode as it is, all that is not opaque or a mask blends; ke = emissive; the base colour's texture multiplies kd, and ks and km of what is metal by more than half; the emissive texture multiplies ke; normal maps; each texture with its sampler's wrap and filter, where it has one. Other textures, alphas of textures and second texture coordinates are left out |
//! | `PointLight` | [`PointLamp`] of lumens / 4π · E |
//! | `SpotLight` | the same, with its cone |
//! | `DirectionalLight` | [`DirectionalLamp`] of lux · E |
//! | `RectLight` | [`ParallelogramLamp`] of lumens / (π · area) · E, unseen by the camera |
//!
//! E = 1 / (1.2 · 2^ev100) is what Bevy's cameras multiply light by, at their default exposure
//! ([`Exposure`]'s, ev100 9.7): a picture is as bright as Bevy's. Light from the surroundings
//! (ambient light, light probes), fog, decals and post-processing have nothing that they could
//! become. Textures have to be in the main world (`RenderAssetUsages::MAIN_WORLD`), as Bevy's
//! loaders keep them by default.

use super::raster::RasterTwin;
use crate::scene::{
    Alpha, Cone, DirectionalLamp, NotTraced, ParallelogramLamp, Phong, PhongMaps, PointLamp,
};
use bevy::asset::{AssetEvent, Assets};
use bevy::camera::Exposure;
use bevy::color::{ColorToComponents, LinearRgba};
use bevy::ecs::query::QueryFilter;
use bevy::light::{DirectionalLight, PointLight, RectLight, SpotLight};
use bevy::math::Vec3;
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::platform::collections::HashSet;
use bevy::prelude::{
    AlphaMode, App, Changed, Commands, Component, Entity, IntoScheduleConfigs, MessageReader, Or,
    Plugin, PostUpdate, Query, RemovedComponents, Res, With, Without,
};
use std::f32::consts::PI;

/// Keeps ours beside Bevy's. The table is in the module's documentation.
pub struct StandardMappingPlugin;

impl Plugin for StandardMappingPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            PostUpdate,
            (
                map_materials,
                map_lights::<PointLight, PointLamp>,
                map_lights::<SpotLight, PointLamp>,
                map_lights::<DirectionalLight, DirectionalLamp>,
                map_lights::<RectLight, ParallelogramLamp>,
            )
                .before(crate::sync::SyncSystems),
        );
    }
}

/// What was mapped last. Ours is set only where that becomes another: an edit of ours stays until
/// Bevy's is edited too.
#[derive(Component)]
struct Mapped<T: Send + Sync + 'static>(T);

/// The narrowest highlight that is told from a mirror.
const MOST_SHININESS: f32 = 10_000.0;

/// A material of Bevy's as ours.
pub fn phong(material: &StandardMaterial) -> (Phong, PhongMaps) {
    let base = LinearRgba::from(material.base_color);
    let metallic = material.metallic.clamp(0.0, 1.0);
    let dielectric = 0.16 * material.reflectance * material.reflectance * (1.0 - metallic);
    let alpha = material.perceptual_roughness * material.perceptual_roughness;
    let shininess = 2.0 / (alpha * alpha).max(1e-8) - 2.0;
    let color = |v: Vec3| LinearRgba::rgb(v.x, v.y, v.z);
    let kd = base.to_vec3() * (1.0 - metallic);
    let ks = base.to_vec3() * metallic + Vec3::splat(dielectric);
    let gloss = (1.0 - material.perceptual_roughness)
        .clamp(0.0, 1.0)
        .powi(2);
    let phong = Phong {
        diffuse: color(kd.clamp(Vec3::ZERO, Vec3::ONE)),
        specular: color(ks.clamp(Vec3::ZERO, Vec3::ONE)),
        mirror: color((gloss * ks).clamp(Vec3::ZERO, Vec3::ONE)),
        shininess: shininess.clamp(1.0, MOST_SHININESS),
        opacity: base.alpha.clamp(0.0, 1.0),
        alpha: match material.alpha_mode {
            AlphaMode::Opaque => Alpha::Opaque,
            AlphaMode::Mask(cutoff) => Alpha::Mask { cutoff },
            _ => Alpha::Blend,
        },
        emission: material.emissive,
        ..Phong::default()
    };
    let metal = (material.base_color_texture.as_ref()).filter(|_| metallic > 0.5);
    let maps = PhongMaps {
        diffuse: material.base_color_texture.clone(),
        specular: metal.cloned(),
        mirror: metal.cloned(),
        emission: material.emissive_texture.clone(),
        normal: material.normal_map_texture.clone(),
        ..PhongMaps::default()
    };
    (phong, maps)
}

fn map_materials(
    mut commands: Commands,
    assets: Res<Assets<StandardMaterial>>,
    mut events: MessageReader<AssetEvent<StandardMaterial>>,
    edited: Query<Entity, Changed<MeshMaterial3d<StandardMaterial>>>,
    objects: Query<
        (
            Entity,
            &MeshMaterial3d<StandardMaterial>,
            Option<&Mapped<(Phong, PhongMaps)>>,
        ),
        Without<NotTraced>,
    >,
    mut gone: RemovedComponents<MeshMaterial3d<StandardMaterial>>,
) {
    for entity in gone.read() {
        // What was taken away and given back is there.
        if !objects.contains(entity)
            && let Ok(mut entity) = commands.get_entity(entity)
        {
            entity.try_remove::<(Phong, PhongMaps, Mapped<(Phong, PhongMaps)>)>();
        }
    }
    let changed: HashSet<_> = events
        .read()
        .filter_map(|event| match event {
            AssetEvent::Added { id } | AssetEvent::Modified { id } => Some(*id),
            _ => None,
        })
        .collect();
    let mut map = |entity| {
        let Ok((entity, handle, mapped)) = objects.get(entity) else {
            return;
        };
        let Some(material) = assets.get(&handle.0) else {
            return;
        };
        let ours = phong(material);
        if mapped.is_none_or(|mapped| mapped.0 != ours) {
            commands.entity(entity).insert((ours.clone(), Mapped(ours)));
        }
    };
    if changed.is_empty() {
        edited.iter().for_each(&mut map);
    } else {
        let worn = objects
            .iter()
            .filter(|(_, worn, ..)| changed.contains(&worn.0.id()));
        let worn: Vec<Entity> = worn.map(|(entity, ..)| entity).collect();
        worn.into_iter().chain(&edited).for_each(&mut map);
    }
}

/// A light of Bevy's that one of ours can stand for.
trait Maps<Ours>: Component {
    /// Who has one of those that ours stands for.
    type Kept: QueryFilter + 'static;

    fn map(&self) -> Ours;
}

/// What Bevy's cameras multiply light by, unless told otherwise.
fn exposure() -> f32 {
    Exposure::default().exposure()
}

/// W/sr for the lumens of a light that shines all around.
fn intensity(lumens: f32) -> f32 {
    lumens / (4.0 * PI) * exposure()
}

type PointOrSpot = Or<(With<PointLight>, With<SpotLight>)>;

impl Maps<PointLamp> for PointLight {
    type Kept = PointOrSpot;

    fn map(&self) -> PointLamp {
        PointLamp {
            color: self.color.into(),
            intensity: intensity(self.intensity),
            cone: None,
        }
    }
}

impl Maps<PointLamp> for SpotLight {
    type Kept = PointOrSpot;

    fn map(&self) -> PointLamp {
        PointLamp {
            color: self.color.into(),
            intensity: intensity(self.intensity),
            cone: Some(Cone {
                inner: self.inner_angle,
                outer: self.outer_angle,
            }),
        }
    }
}

impl Maps<DirectionalLamp> for DirectionalLight {
    type Kept = With<Self>;

    fn map(&self) -> DirectionalLamp {
        DirectionalLamp {
            color: self.color.into(),
            intensity: self.illuminance * exposure(),
            ..DirectionalLamp::default()
        }
    }
}

impl Maps<ParallelogramLamp> for RectLight {
    type Kept = With<Self>;

    fn map(&self) -> ParallelogramLamp {
        let area = (self.width * self.height).max(f32::MIN_POSITIVE);
        // It faces -Z, and ours faces where the product of its edges points.
        ParallelogramLamp {
            corner: Vec3::new(0.5 * self.width, -0.5 * self.height, 0.0),
            edges: [Vec3::NEG_X * self.width, Vec3::Y * self.height],
            colors: [self.color.into(); 4],
            intensity: self.intensity / (PI * area) * exposure(),
            visible: false,
            ..ParallelogramLamp::default()
        }
    }
}

fn map_lights<Theirs: Maps<Ours>, Ours: Component + Clone + PartialEq>(
    mut commands: Commands,
    edited: Query<
        (Entity, &Theirs, Option<&Mapped<Ours>>),
        (Changed<Theirs>, Without<RasterTwin>, Without<NotTraced>),
    >,
    mut gone: RemovedComponents<Theirs>,
    kept: Query<(), Or<(With<RasterTwin>, Theirs::Kept)>>,
) {
    for entity in gone.read() {
        if !kept.contains(entity)
            && let Ok(mut entity) = commands.get_entity(entity)
        {
            entity.try_remove::<(Ours, Mapped<Ours>)>();
        }
    }
    for (entity, theirs, mapped) in &edited {
        let ours = theirs.map();
        if mapped.is_none_or(|mapped| mapped.0 != ours) {
            commands.entity(entity).insert((ours.clone(), Mapped(ours)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::color::Color;

    #[test]
    fn a_matte_material_is_matte_and_a_metal_mirrors_in_its_colour() {
        let red = Color::LinearRgba(LinearRgba::rgb(0.8, 0.1, 0.1));
        let (matte, _) = phong(&StandardMaterial {
            base_color: red,
            perceptual_roughness: 1.0,
            reflectance: 0.0,
            ..StandardMaterial::default()
        });
        assert_eq!(matte.diffuse, LinearRgba::rgb(0.8, 0.1, 0.1));
        assert_eq!(matte.specular.to_vec3(), Vec3::ZERO);
        assert_eq!(matte.mirror.to_vec3(), Vec3::ZERO);
        assert_eq!(matte.shininess, 1.0);
        let (metal, _) = phong(&StandardMaterial {
            base_color: red,
            metallic: 1.0,
            perceptual_roughness: 0.1,
            ..StandardMaterial::default()
        });
        assert_eq!(metal.diffuse.to_vec3(), Vec3::ZERO);
        assert_eq!(metal.specular, LinearRgba::rgb(0.8, 0.1, 0.1));
        let mirrored = metal.mirror.to_vec3() / metal.specular.to_vec3();
        assert!((mirrored - 0.81).abs().max_element() < 1e-6, "{mirrored}");
        let (rough, _) = phong(&StandardMaterial {
            perceptual_roughness: 1.0,
            metallic: 1.0,
            ..StandardMaterial::default()
        });
        assert_eq!(rough.mirror.to_vec3(), Vec3::ZERO, "it is no mirror");
        assert_eq!(metal.shininess, MOST_SHININESS);
    }

    #[test]
    fn a_rectangle_faces_where_bevys_does_and_sends_out_all_its_lumens() {
        let light = RectLight {
            width: 2.0,
            height: 3.0,
            intensity: 600.0,
            ..RectLight::default()
        };
        let lamp = light.map();
        let normal = lamp.edges[0].cross(lamp.edges[1]).normalize();
        assert_eq!(normal, Vec3::NEG_Z);
        let middle = lamp.corner + 0.5 * (lamp.edges[0] + lamp.edges[1]);
        assert_eq!(middle, Vec3::ZERO);
        // A cosine emitter's flux is π · radiance · area.
        let flux = PI * lamp.intensity * 6.0 / exposure();
        assert!((flux - 600.0).abs() < 1e-3, "{flux} lumens");
    }

    #[test]
    fn an_opaque_material_is_opaque_whatever_its_alpha() {
        let see_through = StandardMaterial {
            base_color: Color::LinearRgba(LinearRgba::new(1.0, 1.0, 1.0, 0.25)),
            ..StandardMaterial::default()
        };
        assert_eq!(phong(&see_through).0.alpha, Alpha::Opaque);
        let masked = StandardMaterial {
            alpha_mode: AlphaMode::Mask(0.3),
            ..see_through.clone()
        };
        assert_eq!(phong(&masked).0.alpha, Alpha::Mask { cutoff: 0.3 });
        let blended = StandardMaterial {
            alpha_mode: AlphaMode::Blend,
            ..see_through
        };
        let blended = phong(&blended).0;
        assert_eq!((blended.opacity, blended.alpha), (0.25, Alpha::Blend));
    }

    #[test]
    fn an_edit_of_ours_stays_until_bevys_is_edited_too() {
        let mut app = App::new();
        app.add_plugins((bevy::asset::AssetPlugin::default(), StandardMappingPlugin));
        bevy::asset::AssetApp::init_asset::<StandardMaterial>(&mut app);
        let light = PointLight::default();
        let lamp = app.world_mut().spawn(light).id();
        app.update();
        app.world_mut()
            .get_mut::<PointLamp>(lamp)
            .unwrap()
            .intensity = 7.0;
        // What the lamp does not depend on.
        let mut light = app.world_mut().get_mut::<PointLight>(lamp).unwrap();
        light.shadow_maps_enabled = true;
        app.update();
        let now = |app: &App| app.world().get::<PointLamp>(lamp).unwrap().intensity;
        assert_eq!(now(&app), 7.0);
        let mut light = app.world_mut().get_mut::<PointLight>(lamp).unwrap();
        light.intensity = 4.0 * PI / exposure();
        app.update();
        assert!((now(&app) - 1.0).abs() < 1e-5, "{} W/sr", now(&app));
    }
}

//! Phong's materials as Bevy's standard ones, on the same entities.

use super::RASTER_LAYER;
use crate::scene::{Alpha, Phong, PhongMap, PhongMaps, UsesMaterial};
use bevy::asset::{Asset, Assets, Handle};
use bevy::camera::visibility::RenderLayers;
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::math::Vec3;
use bevy::mesh::Mesh3d;
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MeshMaterial3d, StandardMaterial};
use bevy::platform::collections::HashMap;
use bevy::prelude::{
    AlphaMode, Changed, Commands, Entity, Or, Query, RemovedComponents, ResMut, Resource, With,
    Without,
};
use bevy::reflect::TypePath;
use bevy::render::render_resource::AsBindGroup;

/// What Bevy's renderer draws of a material of ours.
pub(super) type RasterMaterial = ExtendedMaterial<StandardMaterial, OfPhong>;

/// Tells our materials from an app's own, and leaves out what they have no part in.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
pub(super) struct OfPhong {}

impl MaterialExtension for OfPhong {
    fn enable_prepass() -> bool {
        false
    }

    fn enable_shadows() -> bool {
        false
    }
}

/// The approximations, by the entity that has the material.
#[derive(Resource, Default)]
pub(super) struct RasterMaterials(HashMap<Entity, Handle<RasterMaterial>>);

/// Ours to Bevy's.
pub fn standard_material(phong: &Phong, maps: Option<&PhongMaps>) -> StandardMaterial {
    let map = |of: PhongMap| maps.and_then(|maps| of.loaded(maps).cloned());
    let mirror = luminance(phong.mirror).clamp(0.0, 1.0);
    let base = LinearRgba {
        alpha: phong.opacity.clamp(0.0, 1.0),
        ..phong.diffuse
    };
    let roughness = (2.0 / (phong.shininess.max(1.0) + 2.0)).powf(0.25);
    StandardMaterial {
        base_color: Color::LinearRgba(base),
        base_color_texture: map(PhongMap::Diffuse),
        emissive: phong.emission,
        emissive_texture: map(PhongMap::Emission),
        perceptual_roughness: roughness.clamp(0.089, 1.0),
        metallic: if mirror > 0.5 { mirror } else { 0.0 },
        reflectance: 0.5 * luminance(phong.specular).clamp(0.0, 1.0),
        alpha_mode: match phong.alpha {
            Alpha::Mask { cutoff } => AlphaMode::Mask(cutoff),
            Alpha::Blend if phong.opacity < 1.0 => AlphaMode::Blend,
            Alpha::Blend | Alpha::Opaque => AlphaMode::Opaque,
        },
        double_sided: true,
        cull_mode: None,
        ..StandardMaterial::default()
    }
}

fn luminance(color: LinearRgba) -> f32 {
    color.to_vec3().dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

type EditedMaterial = Or<(Changed<Phong>, Changed<PhongMaps>)>;
type EditedObject = Or<(Changed<Mesh3d>, Changed<UsesMaterial>, Changed<Phong>)>;
/// What has a material of Bevy's own keeps it.
type Ours = (With<Mesh3d>, Without<MeshMaterial3d<StandardMaterial>>);

/// Materials that changed, and objects that have another.
pub(super) fn give_materials(
    mut commands: Commands,
    mut materials: ResMut<RasterMaterials>,
    mut assets: ResMut<Assets<RasterMaterial>>,
    edited: Query<(Entity, &Phong, Option<&PhongMaps>), EditedMaterial>,
    mut gone: RemovedComponents<Phong>,
    mut unshared: RemovedComponents<UsesMaterial>,
    objects: Query<
        (
            Entity,
            Option<&UsesMaterial>,
            Option<&MeshMaterial3d<RasterMaterial>>,
        ),
        Ours,
    >,
    edited_objects: Query<Entity, (Ours, EditedObject)>,
) {
    let mut lost = false;
    for entity in gone.read() {
        lost |= materials.0.remove(&entity).is_some();
    }
    let mut added = false;
    for (entity, phong, maps) in &edited {
        let material = standard_material(phong, maps);
        if let Some(known) = materials.0.get(&entity)
            && let Some(mut asset) = assets.get_mut(known)
        {
            asset.base = material;
            continue;
        }
        let material = RasterMaterial {
            base: material,
            extension: OfPhong {},
        };
        materials.0.insert(entity, assets.add(material));
        added = true;
    }
    let mut dress = |entity, shared: Option<&UsesMaterial>, worn: Option<&MeshMaterial3d<_>>| {
        let shared = shared.and_then(|shared| materials.0.get(&shared.0));
        let Some(handle) = shared.or_else(|| materials.0.get(&entity)) else {
            return;
        };
        if worn.is_none_or(|worn| worn.0 != *handle) {
            commands.entity(entity).insert((
                MeshMaterial3d(handle.clone()),
                RenderLayers::layer(RASTER_LAYER),
            ));
        }
    };
    if added || lost {
        // A material may be somebody else's.
        for (entity, shared, worn) in &objects {
            dress(entity, shared, worn);
        }
    } else {
        for entity in edited_objects.iter().chain(unshared.read()) {
            if let Ok((entity, shared, worn)) = objects.get(entity) {
                dress(entity, shared, worn);
            }
        }
    }
    unshared.clear();
}

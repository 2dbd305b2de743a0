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
//! Everything that is drawn so lies in one layer, which a camera can leave out.

use crate::scene::{
    Alpha, DirectionalLamp, Environment, ParallelogramLamp, Phong, PhongMap, PhongMaps, PointLamp,
    SegmentLamp, UsesMaterial,
};
use bevy::asset::{Asset, Assets, Handle};
use bevy::camera::Exposure;
use bevy::camera::visibility::{InheritedVisibility, RenderLayers, Visibility};
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::ecs::entity_disabling::Disabled;
use bevy::light::{AmbientLight, DirectionalLight, PointLight, RectLight, SpotLight};
use bevy::math::{Quat, Vec3};
use bevy::mesh::Mesh3d;
use bevy::pbr::{
    ExtendedMaterial, MaterialExtension, MaterialPlugin, MeshMaterial3d, StandardMaterial,
};
use bevy::platform::collections::HashMap;
use bevy::prelude::{
    Added, AlphaMode, App, Bundle, Changed, Commands, Component, DetectChanges, DetectChangesMut,
    Entity, IntoScheduleConfigs, Or, Plugin, PostUpdate, Query, Ref, RemovedComponents, Res,
    ResMut, Resource, With, Without,
};
use bevy::reflect::TypePath;
use bevy::render::render_resource::AsBindGroup;
use bevy::transform::TransformSystems;
use bevy::transform::components::{GlobalTransform, Transform};
use std::f32::consts::{FRAC_PI_2, PI};

/// The layer of what Bevy's renderer shows of the scene.
pub const RASTER_LAYER: usize = 1;
/// Lights reach as far as this; Bevy cuts them off there. Metres.
const REACH: f32 = 1.0e4;

/// What a white surface shows where no light reaches it. The tracer shows black there; a little more
/// keeps an unlit scene in sight.
const AMBIENT: f32 = 0.1;

/// Shows a scene of our components in Bevy's renderer. Not for scenes of Bevy's own materials,
/// which it shows anyway.
pub struct RasterPlugin;

impl Plugin for RasterPlugin {
    fn build(&self, app: &mut App) {
        app.add_plugins(MaterialPlugin::<RasterMaterial>::default());
        app.init_resource::<RasterMaterials>().add_systems(
            PostUpdate,
            (give_materials, give_lights, move_lights, give_ambient)
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

/// The light that is everywhere in the raster view, for its camera: the scene's dome from now on.
pub(super) fn ambient() -> impl Bundle {
    (HasSceneAmbient, ambient_of(&Environment::default()))
}

/// On cameras whose ambient light is the scene's.
#[derive(Component, Clone)]
struct HasSceneAmbient;

fn ambient_of(environment: &Environment) -> AmbientLight {
    let is_dome = environment.lights && environment.map.is_none();
    let dome = match is_dome {
        true => environment.background,
        false => LinearRgba::BLACK,
    };
    let [red, green, blue] = dome.to_f32_array_no_alpha().map(|c| c.max(AMBIENT));
    AmbientLight {
        color: Color::linear_rgb(red, green, blue),
        brightness: exposure().exposure().recip(),
        ..AmbientLight::default()
    }
}

/// What is the same from all around lights the raster view too, if without shadows.
fn give_ambient(
    environment: Option<Res<Environment>>,
    mut cameras: Query<(Ref<HasSceneAmbient>, &mut AmbientLight)>,
) {
    let Some(environment) = environment else {
        return;
    };
    for (has, mut ambient) in &mut cameras {
        if environment.is_changed() || has.is_added() {
            *ambient = ambient_of(&environment);
        }
    }
}

/// What Bevy's renderer draws of a material of ours.
type RasterMaterial = ExtendedMaterial<StandardMaterial, OfPhong>;

/// Tells our materials from an app's own, and leaves out what they have no part in.
#[derive(Asset, AsBindGroup, TypePath, Clone, Debug)]
struct OfPhong {}

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
struct RasterMaterials(HashMap<Entity, Handle<RasterMaterial>>);

/// A light of Bevy's that stands for one of ours.
#[derive(Component, Clone)]
pub struct RasterTwin(Entity);

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
fn give_materials(
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

type LampQuery<'w, 's> = Query<
    'w,
    's,
    (
        Entity,
        Option<&'static PointLamp>,
        Option<&'static DirectionalLamp>,
        Option<&'static SegmentLamp>,
        Option<&'static ParallelogramLamp>,
        Ref<'static, InheritedVisibility>,
    ),
    (AnyLamp, WithoutOwnLight),
>;
/// What has a light of Bevy's own keeps it.
type WithoutOwnLight = (
    Without<PointLight>,
    Without<SpotLight>,
    Without<DirectionalLight>,
    Without<RectLight>,
);
type AnyLamp = Or<(
    With<PointLamp>,
    With<DirectionalLamp>,
    With<SegmentLamp>,
    With<ParallelogramLamp>,
)>;
type EditedLamp = Or<(
    Changed<PointLamp>,
    Changed<DirectionalLamp>,
    Changed<SegmentLamp>,
    Changed<ParallelogramLamp>,
    Changed<InheritedVisibility>,
)>;

/// The lights are few: a change of one makes all twins again.
fn give_lights(
    mut commands: Commands,
    edited: Query<(), (AnyLamp, EditedLamp)>,
    disabled: Query<(), (AnyLamp, Added<Disabled>)>,
    mut enabled: RemovedComponents<Disabled>,
    mut no_point: RemovedComponents<PointLamp>,
    mut no_directional: RemovedComponents<DirectionalLamp>,
    mut no_segment: RemovedComponents<SegmentLamp>,
    mut no_parallelogram: RemovedComponents<ParallelogramLamp>,
    lamps: LampQuery,
    twins: Query<Entity, With<RasterTwin>>,
) {
    // Not `||`: every reader has to be emptied.
    let gone = no_point.read().count()
        + no_directional.read().count()
        + no_segment.read().count()
        + no_parallelogram.read().count()
        + enabled.read().count();
    if gone == 0 && edited.is_empty() && disabled.is_empty() {
        return;
    }
    for twin in &twins {
        commands.entity(twin).despawn();
    }
    for (entity, point, directional, segment, parallelogram, visible) in &lamps {
        if !visible.get() {
            continue;
        }
        let lit = (RasterTwin(entity), RenderLayers::layer(RASTER_LAYER));
        if let Some(lamp) = point {
            match lamp.cone {
                None => commands.spawn((lit.clone(), point_light(lamp.color, lamp.intensity))),
                Some(cone) => {
                    let angles = [cone.inner, cone.outer];
                    commands.spawn((lit.clone(), spot_light(lamp.color, lamp.intensity, angles)))
                }
            };
        }
        if let Some(lamp) = directional {
            commands.spawn((
                lit.clone(),
                DirectionalLight {
                    color: Color::LinearRgba(lamp.color),
                    illuminance: lamp.intensity / exposure().exposure(),
                    shadow_maps_enabled: false,
                    ..DirectionalLight::default()
                },
            ));
        }
        if let Some(lamp) = segment {
            let length = lamp.ends[0].distance(lamp.ends[1]);
            let color = mean(&lamp.colors);
            commands.spawn((lit.clone(), point_light(color, lamp.intensity * length)));
        }
        if let Some(lamp) = parallelogram {
            let area = lamp.edges[0].cross(lamp.edges[1]).length();
            let color = mean(&lamp.colors);
            let intensity = lamp.intensity * area;
            if lamp.two_sided {
                commands.spawn((lit, point_light(color, intensity)));
            } else {
                let light = spot_light(color, intensity, [0.0, FRAC_PI_2]);
                commands.spawn((lit, light));
            }
        }
    }
}

fn mean(colors: &[LinearRgba]) -> LinearRgba {
    let sum: Vec3 = colors.iter().map(|color| color.to_vec3()).sum();
    let mean = sum / colors.len() as f32;
    LinearRgba::rgb(mean.x, mean.y, mean.z)
}

/// Of a light that shines all around with so many W/sr.
fn lumens(intensity: f32) -> f32 {
    4.0 * PI * intensity / exposure().exposure()
}

/// `intensity` in W/sr.
fn point_light(color: LinearRgba, intensity: f32) -> PointLight {
    PointLight {
        color: Color::LinearRgba(color),
        intensity: lumens(intensity),
        range: REACH,
        shadow_maps_enabled: false,
        ..PointLight::default()
    }
}

/// The same for a spot, with its half-angles. Bevy too gives a spot's strength as if it shone all
/// around.
fn spot_light(color: LinearRgba, intensity: f32, [inner, outer]: [f32; 2]) -> SpotLight {
    SpotLight {
        color: Color::LinearRgba(color),
        intensity: lumens(intensity),
        range: REACH,
        inner_angle: inner.min(1.5),
        outer_angle: outer.min(1.57),
        shadow_maps_enabled: false,
        ..SpotLight::default()
    }
}

/// Twins stand where theirs stand: segments and parallelograms in their middle.
fn move_lights(
    mut twins: Query<(
        Ref<RasterTwin>,
        &mut Transform,
        &mut GlobalTransform,
        &mut Visibility,
    )>,
    lamps: Query<
        (
            Ref<GlobalTransform>,
            Option<&SegmentLamp>,
            Option<&ParallelogramLamp>,
        ),
        Without<RasterTwin>,
    >,
) {
    for (twin, mut transform, mut global, mut visibility) in &mut twins {
        let Ok((place, segment, parallelogram)) = lamps.get(twin.0) else {
            *visibility = Visibility::Hidden;
            continue;
        };
        if !place.is_changed() && !twin.is_added() {
            continue;
        }
        let affine = place.affine();
        let mut rotation = place.rotation();
        let position = if let Some(segment) = segment {
            affine.transform_point3(segment.ends[0].midpoint(segment.ends[1]))
        } else if let Some(lamp) = parallelogram {
            let edges = lamp.edges.map(|edge| affine.transform_vector3(edge));
            let normal = edges[0].cross(edges[1]).try_normalize();
            rotation = normal.map_or(rotation, |n| Quat::from_rotation_arc(Vec3::NEG_Z, n));
            affine.transform_point3(lamp.corner + 0.5 * (lamp.edges[0] + lamp.edges[1]))
        } else {
            affine.translation.into()
        };
        let moved = Transform::from_translation(position).with_rotation(rotation);
        if transform.set_if_neq(moved) {
            *global = GlobalTransform::from(moved);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dome_of_one_colour_is_the_ambient_light_of_the_scenes_cameras_alone() {
        let mut app = App::new();
        app.insert_resource(Environment {
            background: LinearRgba::rgb(0.5, 0.25, 0.0),
            ..Environment::default()
        })
        .add_systems(PostUpdate, give_ambient);
        let world = app.world_mut();
        let [ours, other] = [
            world.spawn(ambient()).id(),
            world.spawn(AmbientLight::default()).id(),
        ];
        let color = |app: &App, camera| {
            let ambient = app.world().get::<AmbientLight>(camera).unwrap();
            LinearRgba::from(ambient.color).to_f32_array_no_alpha()
        };
        app.update();
        assert_eq!(color(&app, ours), [AMBIENT; 3], "it does not light");
        app.world_mut().resource_mut::<Environment>().lights = true;
        app.update();
        assert_eq!(color(&app, ours), [0.5, 0.25, AMBIENT]);
        assert_eq!(color(&app, other), [1.0; 3], "an app's own");
    }
}

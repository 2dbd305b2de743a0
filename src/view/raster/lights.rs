//! Lights of ours as Bevy's: twins that stand where theirs stand.

use super::{RASTER_LAYER, exposure};
use crate::scene::{AnyLamp, DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
use bevy::camera::visibility::{InheritedVisibility, RenderLayers, Visibility};
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::ecs::entity_disabling::Disabled;
use bevy::light::{DirectionalLight, PointLight, RectLight, SpotLight};
use bevy::math::{Quat, Vec3};
use bevy::prelude::{
    Added, Changed, Commands, Component, DetectChanges, DetectChangesMut, Entity, Or, Query, Ref,
    RemovedComponents, With, Without,
};
use bevy::transform::components::{GlobalTransform, Transform};
use std::f32::consts::{FRAC_PI_2, PI};

/// Lights reach as far as this; Bevy cuts them off there. Metres.
const REACH: f32 = 1.0e4;

/// A light of Bevy's that stands for one of ours.
#[derive(Component, Clone)]
pub struct RasterTwin(Entity);

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
type EditedLamp = Or<(
    Changed<PointLamp>,
    Changed<DirectionalLamp>,
    Changed<SegmentLamp>,
    Changed<ParallelogramLamp>,
    Changed<InheritedVisibility>,
)>;

/// The lights are few: a change of one makes all twins again.
pub(super) fn give_lights(
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
pub(super) fn move_lights(
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

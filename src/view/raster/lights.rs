//! Lights of ours as Bevy's: twins that stand where theirs stand.

use super::{RASTER_LAYER, exposure};
use crate::scene::{AnyLamp, DirectionalLamp, ParallelogramLamp, PointLamp, SegmentLamp};
use bevy::camera::visibility::{InheritedVisibility, RenderLayers, Visibility};
use bevy::color::{Color, ColorToComponents, LinearRgba};
use bevy::ecs::entity_disabling::Disabled;
use bevy::light::{DirectionalLight, PointLight, RectLight, SpotLight};
use bevy::math::{Quat, Vec3};
use bevy::platform::collections::hash_map::Entry;
use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::{
    Added, Changed, Commands, Component, DetectChanges, DetectChangesMut, Entity, Has, Or, Query,
    Ref, RemovedComponents, Without,
};
use bevy::transform::components::{GlobalTransform, Transform};
use std::f32::consts::{FRAC_PI_2, PI};

/// Lights reach as far as this; Bevy cuts them off there. Metres.
const REACH: f32 = 1.0e4;

/// A light of Bevy's that stands for one of ours.
#[derive(Component, Clone)]
pub struct RasterTwin {
    of: Entity,
    kind: Kind,
}

/// Which of an entity's components it stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Kind {
    Point,
    Directional,
    Segment,
    Parallelogram,
}

/// As what a light of ours is drawn.
enum Drawn {
    Point(PointLight),
    Spot(SpotLight),
    Directional(DirectionalLight),
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
type EditedLamp = Or<(
    Changed<PointLamp>,
    Changed<DirectionalLamp>,
    Changed<SegmentLamp>,
    Changed<ParallelogramLamp>,
    Changed<InheritedVisibility>,
)>;

/// Whose twins have to be others, or none: those of others stay as they are, and a light that shines on in the same way
/// keeps its twin.
pub(super) fn give_lights(
    mut commands: Commands,
    edited: Query<Entity, (AnyLamp, EditedLamp)>,
    disabled: Query<Entity, (AnyLamp, Added<Disabled>)>,
    mut enabled: RemovedComponents<Disabled>,
    mut no_point: RemovedComponents<PointLamp>,
    mut no_directional: RemovedComponents<DirectionalLamp>,
    mut no_segment: RemovedComponents<SegmentLamp>,
    mut no_parallelogram: RemovedComponents<ParallelogramLamp>,
    lamps: LampQuery,
    twins: Query<(Entity, &RasterTwin, Shines)>,
) {
    let gone = (no_point.read().chain(no_directional.read()))
        .chain(no_segment.read().chain(no_parallelogram.read()))
        .chain(enabled.read());
    let others: HashSet<Entity> = edited.iter().chain(&disabled).chain(gone).collect();
    if others.is_empty() {
        return;
    }
    let mut held: HashMap<(Entity, Kind), (Entity, Shining)> = twins
        .iter()
        .filter(|(_, twin, _)| others.contains(&twin.of))
        .map(|(entity, twin, shines)| ((twin.of, twin.kind), (entity, shines)))
        .collect();
    for (of, point, directional, segment, parallelogram, visible) in lamps.iter_many(&others) {
        if !visible.get() {
            continue;
        }
        let drawn = [
            point.map(|lamp| (Kind::Point, of_point(lamp))),
            directional.map(|lamp| (Kind::Directional, of_directional(lamp))),
            segment.map(|lamp| (Kind::Segment, of_segment(lamp))),
            parallelogram.map(|lamp| (Kind::Parallelogram, of_parallelogram(lamp))),
        ];
        for (kind, drawn) in drawn.into_iter().flatten() {
            let known = match held.entry((of, kind)) {
                Entry::Occupied(known) if drawn.is(known.get().1) => Some(known.remove().0),
                _ => None,
            };
            let mut twin = match known {
                Some(twin) => commands.entity(twin),
                None => commands.spawn(RenderLayers::layer(RASTER_LAYER)),
            };
            // Told anew whose it is, it is put where that stands.
            twin.insert(RasterTwin { of, kind });
            match drawn {
                Drawn::Point(light) => twin.insert(light),
                Drawn::Spot(light) => twin.insert(light),
                Drawn::Directional(light) => twin.insert(light),
            };
        }
    }
    for (twin, _) in held.into_values() {
        commands.entity(twin).despawn();
    }
}

/// As what a twin shines: a point, a spot, from infinitely far.
type Shines = (Has<PointLight>, Has<SpotLight>, Has<DirectionalLight>);
type Shining = (bool, bool, bool);

impl Drawn {
    /// Whether a twin shines as one of this kind.
    fn is(&self, (point, spot, directional): Shining) -> bool {
        match self {
            Self::Point(_) => point,
            Self::Spot(_) => spot,
            Self::Directional(_) => directional,
        }
    }
}

fn of_point(lamp: &PointLamp) -> Drawn {
    match lamp.cone {
        None => Drawn::Point(point_light(lamp.color, lamp.intensity)),
        Some(cone) => {
            let angles = [cone.inner, cone.outer];
            Drawn::Spot(spot_light(lamp.color, lamp.intensity, angles))
        }
    }
}

fn of_directional(lamp: &DirectionalLamp) -> Drawn {
    Drawn::Directional(DirectionalLight {
        color: Color::LinearRgba(lamp.color),
        illuminance: lamp.intensity / exposure().exposure(),
        shadow_maps_enabled: false,
        ..DirectionalLight::default()
    })
}

fn of_segment(lamp: &SegmentLamp) -> Drawn {
    let length = lamp.ends[0].distance(lamp.ends[1]);
    Drawn::Point(point_light(mean(&lamp.colors), lamp.intensity * length))
}

fn of_parallelogram(lamp: &ParallelogramLamp) -> Drawn {
    let area = lamp.edges[0].cross(lamp.edges[1]).length();
    let (color, intensity) = (mean(&lamp.colors), lamp.intensity * area);
    match lamp.two_sided {
        true => Drawn::Point(point_light(color, intensity)),
        false => Drawn::Spot(spot_light(color, intensity, [0.0, FRAC_PI_2])),
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
        let Ok((place, segment, parallelogram)) = lamps.get(twin.of) else {
            *visibility = Visibility::Hidden;
            continue;
        };
        if !place.is_changed() && !twin.is_changed() {
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
    use bevy::app::{App, Update};
    use bevy::ecs::schedule::IntoScheduleConfigs;

    /// A twin, its lumens where it is a point, and where it stands.
    type Twin = (Entity, Option<f32>, Vec3);

    /// The twins, by whose they are.
    fn twins(app: &mut App) -> HashMap<Entity, Twin> {
        app.update();
        app.update();
        let mut all = (app.world_mut())
            .query::<(Entity, &RasterTwin, Option<&PointLight>, &GlobalTransform)>();
        let all = all.iter(app.world()).map(|(entity, twin, light, place)| {
            let lumens = light.map(|light| light.intensity);
            (twin.of, (entity, lumens, place.translation()))
        });
        all.collect()
    }

    #[test]
    fn an_edited_light_keeps_its_twin_and_leaves_those_of_others_alone() {
        let mut app = App::new();
        app.add_systems(Update, (give_lights, move_lights).chain());
        let seen = (GlobalTransform::IDENTITY, InheritedVisibility::VISIBLE);
        let world = app.world_mut();
        let point = world.spawn((PointLamp::default(), seen)).id();
        let segment = world.spawn((SegmentLamp::default(), seen)).id();
        let before = twins(&mut app);
        assert_eq!(before.len(), 2);
        // Brighter, or longer, so that its middle is elsewhere.
        let world = app.world_mut();
        world.get_mut::<PointLamp>(point).unwrap().intensity *= 2.0;
        let mut line = world.get_mut::<SegmentLamp>(segment).unwrap();
        line.ends[1] = line.ends[0] + Vec3::X * 8.0;
        let middle = line.ends[0] + Vec3::X * 4.0;
        let after = twins(&mut app);
        for of in [point, segment] {
            assert_eq!(before[&of].0, after[&of].0);
        }
        let lumens = |twins: &HashMap<Entity, Twin>| twins[&point].1.unwrap();
        assert_eq!(lumens(&after), 2.0 * lumens(&before));
        assert_eq!(after[&segment].2, middle);
        // As a spot it is another light of Bevy's, and the segment's stays.
        let mut lamp = app.world_mut().get_mut::<PointLamp>(point).unwrap();
        lamp.cone = Some(Default::default());
        let spot = twins(&mut app);
        assert_eq!((spot.len(), spot[&point].1), (2, None));
        assert_eq!(spot[&segment], after[&segment]);
        for hide in [true, false] {
            let visible = match hide {
                true => InheritedVisibility::HIDDEN,
                false => InheritedVisibility::VISIBLE,
            };
            app.world_mut().entity_mut(point).insert(visible);
            let now = twins(&mut app);
            assert_eq!(now.len(), if hide { 1 } else { 2 });
            assert_eq!(now[&segment], after[&segment]);
        }
        app.world_mut().entity_mut(segment).remove::<SegmentLamp>();
        app.world_mut().despawn(point);
        assert_eq!(twins(&mut app).len(), 0);
    }
}

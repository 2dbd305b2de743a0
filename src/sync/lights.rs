use super::motions::WorldMotions;
use super::problem::Fault;
use super::reading::{Reader, Switched};
use super::traced::Draft;
use crate::scene::schema::quantity_of;
use crate::scene::{
    Cone, DirectionalLamp, NotTraced, ParallelogramLamp, PointLamp, Quantity, SceneId, SegmentLamp,
};
use crate::trace::{
    DirectionalLight, Lights, MovingLight, ParallelogramLight, PointLight, SegmentLight, SpotCone,
    SunDisc,
};
use bevy::camera::visibility::InheritedVisibility;
use bevy::color::LinearRgba;
use bevy::ecs::component::Component;
use bevy::ecs::entity::Entity;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Added, Changed, Or, With, Without};
use bevy::ecs::system::{Query, Res, ResMut, SystemParam};
use bevy::math::Vec3;
use bevy::transform::components::GlobalTransform;
use std::sync::Arc;

type LampQuery<'w, 's, L> = Query<
    'w,
    's,
    (
        Entity,
        &'static SceneId,
        &'static L,
        &'static GlobalTransform,
        Option<&'static InheritedVisibility>,
        Option<&'static Name>,
    ),
    Without<NotTraced>,
>;

type Edited<L> = Or<(
    Changed<L>,
    Changed<GlobalTransform>,
    Changed<InheritedVisibility>,
    Changed<SceneId>,
    Changed<Name>,
    Added<NotTraced>,
)>;

/// The lamps of one kind, and whether any of them changed or went.
#[derive(SystemParam)]
pub(super) struct Lamps<'w, 's, L: Component> {
    lamps: LampQuery<'w, 's, L>,
    edited: Query<'w, 's, (), (With<L>, Edited<L>)>,
    gone: RemovedComponents<'w, 's, L>,
    no_name: RemovedComponents<'w, 's, Name>,
    traced_again: RemovedComponents<'w, 's, NotTraced>,
    no_place: RemovedComponents<'w, 's, GlobalTransform>,
    no_visibility: RemovedComponents<'w, 's, InheritedVisibility>,
    all: Query<'w, 's, (), With<L>>,
}

impl<L: Component> Lamps<'_, '_, L> {
    fn changed(&mut self) -> bool {
        // Of who is no lamp neither means anything.
        let mut others = self.no_name.read().chain(self.traced_again.read());
        let other = others.any(|entity| self.lamps.contains(entity));
        self.no_name.clear();
        self.traced_again.clear();
        let mut bare = self.no_place.read().chain(self.no_visibility.read());
        let bare = bare.any(|entity| self.all.contains(entity));
        self.no_place.clear();
        self.no_visibility.clear();
        other | bare | (self.gone.read().count() > 0) | !self.edited.is_empty()
    }

    /// The lights of the visible lamps, sorted by id, without those that `light` makes nothing of. Of
    /// these `moving` gets those that `motions` knows.
    fn read<T>(
        &self,
        problems: &mut Vec<super::SyncProblem>,
        motions: &WorldMotions,
        moving: &mut Vec<MovingLight>,
        light: impl Fn(&L, &GlobalTransform, &mut Reader) -> Option<T>,
    ) -> Vec<T> {
        let mut visible: Vec<_> = self
            .lamps
            .iter()
            .filter(|(.., visibility, _)| visibility.is_none_or(|v| v.get()))
            .collect();
        visible.sort_unstable_by_key(|(_, id, ..)| **id);
        visible
            .into_iter()
            .filter_map(|(entity, &id, lamp, transform, _, name)| {
                let mut reader = Reader {
                    kind: "light",
                    id,
                    name,
                    problems,
                };
                if !transform.affine().is_finite() {
                    reader.note(Fault::NotFinite { field: "transform" });
                    return None;
                }
                let motion = match motions.of(entity) {
                    Some(motion) => Some(reader.motion(motion)?),
                    None => None,
                };
                let light = light(lamp, transform, &mut reader)?;
                moving.extend(motion.map(|motion| MovingLight {
                    id: id.0,
                    velocity: motion.velocity,
                    samples: motion.samples,
                }));
                Some(light)
            })
            .collect()
    }
}

/// Makes the lights again, in world space, where a lamp changed, moved, appeared or went.
pub(super) fn sync_lights(
    mut points: Lamps<PointLamp>,
    mut directionals: Lamps<DirectionalLamp>,
    mut segments: Lamps<SegmentLamp>,
    mut parallelograms: Lamps<ParallelogramLamp>,
    mut switched: Switched,
    motions: Res<WorldMotions>,
    draft: ResMut<Draft>,
) {
    // An array, not `||`: every reader has to be emptied.
    let edited = [
        points.changed(),
        directionals.changed(),
        segments.changed(),
        parallelograms.changed(),
        switched.any(),
        draft.anew,
    ]
    .contains(&true);
    if !edited && !motions.changed() {
        return;
    }
    let draft = draft.into_inner();
    let problems = &mut draft.problems.lights;
    problems.clear();
    draft.reread = true;
    let mut moving = Vec::new();
    let lights = Lights {
        points: points.read(problems, &motions, &mut moving, point),
        // From infinitely far it shines as before, however it moves.
        directionals: directionals.read(
            problems,
            &WorldMotions::default(),
            &mut moving,
            directional,
        ),
        segments: segments.read(problems, &motions, &mut moving, segment),
        parallelograms: parallelograms.read(problems, &motions, &mut moving, parallelogram),
        moving: Vec::new(),
    };
    // An entity may be lamps of several kinds.
    moving.sort_unstable_by_key(|light| light.id);
    moving.dedup_by_key(|light| light.id);
    let lights = Lights { moving, ..lights };
    // What changed is mostly something else: a motion another thing's, a visibility that of one that stays out.
    if lights != *draft.world.lights {
        draft.world.lights = Arc::new(lights);
        draft.changes.lights = true;
    }
}

fn point(lamp: &PointLamp, transform: &GlobalTransform, reader: &mut Reader) -> Option<PointLight> {
    let cone = match lamp.cone {
        None => None,
        Some(cone) => {
            let outer = quantity_of::<Cone>("outer");
            let outer = reader.number("cone's outer angle", cone.outer, outer)?;
            let inner = Quantity {
                most: outer.into(),
                ..quantity_of::<Cone>("inner")
            };
            let inner = reader.number("cone's inner angle", cone.inner, inner)?;
            if outer == 0.0 {
                reader.note(Fault::Degenerate {
                    field: "cone's outer angle",
                });
                return None;
            }
            if outer < NARROWEST {
                reader.note(Fault::Narrow {
                    field: "cone's outer angle",
                    angle: outer,
                });
            }
            Some(SpotCone::new(-backward(transform, reader)?, inner, outer))
        }
    };
    Some(PointLight {
        id: reader.id.0,
        position: transform.translation(),
        color: reader.strength("colour times intensity", lamp.color, lamp.intensity)?,
        cone,
    })
}

fn directional(
    lamp: &DirectionalLamp,
    transform: &GlobalTransform,
    reader: &mut Reader,
) -> Option<DirectionalLight> {
    let diameter = quantity_of::<DirectionalLamp>("angular_diameter");
    let diameter = reader.number("angular diameter", lamp.angular_diameter, diameter)?;
    Some(DirectionalLight {
        id: reader.id.0,
        to_light: backward(transform, reader)?,
        color: reader.strength("colour times intensity", lamp.color, lamp.intensity)?,
        disc: SunDisc::of_diameter(diameter),
        samples: reader.samples(lamp.samples),
    })
}

fn segment(
    lamp: &SegmentLamp,
    transform: &GlobalTransform,
    reader: &mut Reader,
) -> Option<SegmentLight> {
    let ends = lamp.ends.map(|end| transform.transform_point(end));
    if !ends.iter().all(|end| end.is_finite()) {
        reader.note(Fault::NotFinite { field: "ends" });
        return None;
    }
    let [from, to] = ends.map(Vec3::as_dvec3);
    extent("length", (to - from).length(), reader)?;
    Some(SegmentLight {
        id: reader.id.0,
        ends,
        colors: strengths(lamp.colors, lamp.intensity, reader)?,
        samples: reader.samples(lamp.samples),
    })
}

fn parallelogram(
    lamp: &ParallelogramLamp,
    transform: &GlobalTransform,
    reader: &mut Reader,
) -> Option<ParallelogramLight> {
    let linear = transform.affine().matrix3;
    let corner = transform.transform_point(lamp.corner);
    let mut edges = lamp.edges.map(|edge| linear * edge);
    if !(corner.is_finite() && edges[0].is_finite() && edges[1].is_finite()) {
        reader.note(Fault::NotFinite { field: "corners" });
        return None;
    }
    let [a, b] = edges.map(Vec3::as_dvec3);
    extent("area", a.cross(b).length(), reader)?;
    let mut colors = strengths(lamp.colors, lamp.intensity, reader)?;
    // A mirroring transform turns the cross product of the edges around, but not the light's front.
    if linear.determinant() < 0.0 {
        edges.swap(0, 1);
        colors.swap(1, 2);
    }
    Some(ParallelogramLight {
        id: reader.id.0,
        corner,
        edges,
        colors,
        two_sided: lamp.two_sided,
        visible: lamp.visible,
        samples: reader.samples(lamp.samples),
    })
}

/// Directions, unit vectors of f32, are told apart by about this, in radians.
const NARROWEST: f32 = f32::EPSILON;

/// The length or area of a light, as it is reckoned with: what is so small that squares of it are nothing would light nothing.
fn extent(field: &'static str, extent: f64, reader: &mut Reader) -> Option<f64> {
    let fault = if extent > MOST_EXTENT {
        Fault::TooLarge {
            field,
            most: MOST_EXTENT,
        }
    } else if (extent as f32).powi(2) == 0.0 {
        Fault::Degenerate { field }
    } else {
        return Some(extent);
    };
    reader.note(fault);
    None
}

/// In m or m²: its square is still a number of f32.
const MOST_EXTENT: f64 = 1.8e19;

/// Unit vector along the entity's local +Z, in the world.
fn backward(transform: &GlobalTransform, reader: &mut Reader) -> Option<Vec3> {
    let direction = Vec3::from(transform.affine().matrix3.z_axis).try_normalize();
    if direction.is_none() {
        reader.note(Fault::Degenerate { field: "direction" });
    }
    direction
}

fn strengths<const N: usize>(
    colors: [LinearRgba; N],
    intensity: f32,
    reader: &mut Reader,
) -> Option<[Vec3; N]> {
    let mut strengths = [Vec3::ZERO; N];
    for (strength, color) in strengths.iter_mut().zip(colors) {
        *strength = reader.strength("colour times intensity", color, intensity)?;
    }
    Some(strengths)
}

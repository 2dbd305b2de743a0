//! What the reading systems share: noticing that entities were switched off or on, velocities in
//! the world, and taking numbers that may be out of range.

use super::problem::{Fault, SyncProblem};
use super::texture_data::Replaced;
use crate::scene::{Motion, RenderSettings, SceneId};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::hierarchy::ChildOf;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::{Added, Changed, Or, With};
use bevy::ecs::system::{Local, Query, Res, SystemParam};
use bevy::math::Vec3;
use bevy::transform::components::GlobalTransform;

/// Notices entities that vanish from queries, or come back, without losing a component.
#[derive(SystemParam)]
pub(super) struct Switched<'w, 's> {
    disabled: Query<'w, 's, (), Added<Disabled>>,
    enabled: RemovedComponents<'w, 's, Disabled>,
}

impl Switched<'_, '_> {
    /// True where an entity was disabled or enabled since this was asked last.
    pub fn any(&mut self) -> bool {
        let enabled = self.enabled.read().count() > 0;
        enabled || !self.disabled.is_empty()
    }
}

type MotionEdited = Or<(Changed<Motion>, (With<Motion>, Changed<ChildOf>))>;

/// Who moves while the shutter is open, and how fast in the world: a velocity is in the space of
/// the entity's parent.
#[derive(SystemParam)]
pub(super) struct Motions<'w, 's> {
    motions: Query<'w, 's, (&'static Motion, Option<&'static ChildOf>)>,
    parents: Query<'w, 's, &'static GlobalTransform>,
    edited: Query<'w, 's, (), MotionEdited>,
    no_motion: RemovedComponents<'w, 's, Motion>,
    no_parent: RemovedComponents<'w, 's, ChildOf>,
    settings: Res<'w, RenderSettings>,
    /// What the switch was when this was asked last.
    was_on: Local<'s, bool>,
}

impl Motions<'_, '_> {
    /// True where a motion may be another than when this was asked last.
    pub fn changed(&mut self) -> bool {
        let gone = self.no_motion.read().count() + self.no_parent.read().count();
        let on = self.settings.features.motion;
        let switched = std::mem::replace(&mut *self.was_on, on) != on;
        gone > 0 || switched || !self.edited.is_empty()
    }

    /// Velocity in the world and the samples it asks for; `None` for what stands still, and for
    /// all where the settings switch motion off.
    pub fn of(&self, entity: Entity) -> Option<(Vec3, u32)> {
        if !self.settings.features.motion {
            return None;
        }
        let (motion, parent) = self.motions.get(entity).ok()?;
        let parent = parent.and_then(|parent| self.parents.get(parent.parent()).ok());
        let velocity = match parent {
            Some(parent) => parent.affine().transform_vector3(motion.velocity),
            None => motion.velocity,
        };
        (velocity != Vec3::ZERO).then_some((velocity, motion.samples))
    }
}

/// Takes the numbers of one entity's component, and notes what is wrong with them.
pub(super) struct Reader<'a> {
    /// What the entity is, for example "light".
    pub kind: &'static str,
    pub id: SceneId,
    pub name: Option<&'a Name>,
    pub problems: &'a mut Vec<SyncProblem>,
}

impl Reader<'_> {
    /// Notes a problem.
    pub fn note(&mut self, fault: Fault) {
        self.problems
            .push(SyncProblem::new(self.kind, self.id, self.name, fault));
    }

    /// Notes texels of a map that could not be taken as they were, if there are any.
    pub fn note_texels(&mut self, field: &'static str, replaced: Replaced) {
        let Replaced { count, largest } = replaced;
        if count > 0 {
            self.note(Fault::Texels {
                field,
                count,
                largest,
            });
        }
    }

    /// The number, moved into [least, most]; `None` where it is NaN.
    pub fn number(
        &mut self,
        field: &'static str,
        value: f32,
        range: std::ops::RangeInclusive<f32>,
    ) -> Option<f32> {
        if value.is_nan() {
            self.note(Fault::NotFinite { field });
            return None;
        }
        let used = value.clamp(*range.start(), *range.end());
        if used != value {
            self.note(Fault::OutOfRange { field, value, used });
        }
        Some(used)
    }

    /// A colour times a strength: finite, and nowhere below 0.
    pub fn strength(
        &mut self,
        field: &'static str,
        color: LinearRgba,
        intensity: f32,
    ) -> Option<Vec3> {
        let strength = Vec3::new(color.red, color.green, color.blue) * intensity;
        if !strength.is_finite() {
            self.note(Fault::NotFinite { field });
            return None;
        }
        if strength.min_element() < 0.0 {
            self.note(Fault::OutOfRange {
                field,
                value: strength.min_element(),
                used: 0.0,
            });
        }
        Some(strength.max(Vec3::ZERO))
    }

    /// A colour whose channels are moved into [0, most]; black where it is not finite.
    pub fn color(&mut self, field: &'static str, color: LinearRgba, most: f32) -> Vec3 {
        let color = Vec3::new(color.red, color.green, color.blue);
        if !color.is_finite() {
            self.note(Fault::NotFinite { field });
            return Vec3::ZERO;
        }
        let used = color.clamp(Vec3::ZERO, Vec3::splat(most));
        if let Some(axis) = (0..3).find(|&axis| used[axis] != color[axis]) {
            self.note(Fault::OutOfRange {
                field,
                value: color[axis],
                used: used[axis],
            });
        }
        used
    }

    /// A number of samples, 1 to 1000.
    pub fn samples(&mut self, samples: u32) -> u32 {
        let used = samples.clamp(1, 1000);
        if used != samples {
            self.note(Fault::OutOfRange {
                field: "samples",
                value: samples as f32,
                used: used as f32,
            });
        }
        used
    }
}

//! What the reading systems share: noticing that entities were switched off or on, and taking numbers
//! that may be out of range.

use super::motions::WorldMotion;
use super::problem::{Fault, SyncProblem};
use super::texture_data::Replaced;
use crate::bvh::REACH;
use crate::scene::{Quantity, SceneId};
use bevy::color::LinearRgba;
use bevy::ecs::entity::Entity;
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::lifecycle::RemovedComponents;
use bevy::ecs::name::Name;
use bevy::ecs::query::Added;
use bevy::ecs::system::{Query, SystemParam};
use bevy::math::Vec3;

/// Notices entities that vanish from queries, or come back, without losing a component.
#[derive(SystemParam)]
pub(super) struct Switched<'w, 's> {
    disabled: Query<'w, 's, Entity, Added<Disabled>>,
    enabled: RemovedComponents<'w, 's, Disabled>,
}

impl Switched<'_, '_> {
    /// Who was disabled or enabled since this was asked last.
    pub fn read(&mut self) -> impl Iterator<Item = Entity> + '_ {
        self.disabled.iter().chain(self.enabled.read())
    }

    /// True where an entity was disabled or enabled since this was asked last.
    pub fn any(&mut self) -> bool {
        self.read().count() > 0
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

    /// The number, moved into its range; `None` where it is NaN.
    pub fn number(&mut self, field: &'static str, value: f32, range: Quantity) -> Option<f32> {
        if value.is_nan() {
            self.note(Fault::NotFinite { field });
            return None;
        }
        let used = range.nearest(f64::from(value)) as f32;
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

    /// A colour whose channels are moved into their range; black where it is not finite.
    pub fn color(&mut self, field: &'static str, color: LinearRgba, range: Quantity) -> Vec3 {
        let color = Vec3::new(color.red, color.green, color.blue);
        if !color.is_finite() {
            self.note(Fault::NotFinite { field });
            return Vec3::ZERO;
        }
        let used = color.map(|channel| range.nearest(channel.into()) as f32);
        if let Some(axis) = (0..3).find(|&axis| used[axis] != color[axis]) {
            self.note(Fault::OutOfRange {
                field,
                value: color[axis],
                used: used[axis],
            });
        }
        used
    }

    /// A motion whose velocity reaches no farther than what can be traced, and whose samples are in
    /// their range; `None` where there is no such velocity.
    pub fn motion(&mut self, motion: WorldMotion) -> Option<WorldMotion> {
        let velocity = motion.velocity;
        // Asked so that NaN is refused too.
        if !velocity.abs().to_array().iter().all(|v| *v <= REACH) {
            self.note(Fault::Velocity { velocity });
            return None;
        }
        let samples = self.samples(motion.samples);
        Some(WorldMotion { velocity, samples })
    }

    /// A number of samples, moved into the range that all of them have.
    pub fn samples(&mut self, samples: u32) -> u32 {
        let used = Quantity::SAMPLES.nearest(samples.into()) as u32;
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

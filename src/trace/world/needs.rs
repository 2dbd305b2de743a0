use super::arrays::{Object, World};
use super::material::MaterialSet;
use crate::scene::{Alpha, RenderSettings};
use crate::trace::Camera;
use crate::trace::light_sampling::faint::faint;
use glam::Vec3;
use std::sync::Arc;

/// What of the model a world uses at all. What it does not use is not computed, drawn or asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Needs {
    /// Some object lets light through: shadow rays must look at what they cross.
    pub transparency: bool,
    /// Some light is to be seen itself.
    pub visible_lights: bool,
    /// Some material shines by itself.
    pub emission: bool,
    /// Samples of a pixel that moving objects and lights ask for; 0 where none moves.
    pub motion_samples: u32,
    /// What a point of a light has to add so that it is asked for in any case, linear, the mean of its channels: where there
    /// are more than [`FEW_LIGHTS`](crate::trace::FEW_LIGHTS) lights, fainter ones are asked for by chance. 0 where there are no
    /// more.
    pub faint: f32,
}

impl Needs {
    /// Looks through a world's objects, materials and lights; through those that it shares with the one `before` where that
    /// is quick.
    pub fn of(world: &World, before: Option<&World>) -> Self {
        // All that it hangs on.
        let same = before.filter(|before| {
            Arc::ptr_eq(&world.lights, &before.lights)
                && Arc::ptr_eq(&world.aggregate, &before.aggregate)
        });
        let objects = world.objects.iter().map(|object| object.motion_samples);
        let lights = world.lights.moving.iter().map(|light| light.samples);
        Self {
            transparency: world.objects.iter().any(|o| world.lets_light_through(o)),
            visible_lights: world.lights.parallelograms.iter().any(|l| l.visible),
            emission: (world.materials.iter()).any(|material| material.emission != Vec3::ZERO),
            motion_samples: objects.chain(lights).max().unwrap_or(0),
            faint: same.map_or_else(|| faint(world), |before| before.needs.faint),
        }
    }
}

impl World {
    /// Of the same objects with other materials, which of those differ. `None` where one of them lets light through, or did:
    /// then it matters to what lies in its shadow.
    pub fn changed_materials(&self, now: &Self) -> Option<MaterialSet> {
        let (before, after) = (&self.materials, &now.materials);
        if Arc::ptr_eq(before, after) {
            return Some(MaterialSet::NONE);
        }
        if before.len() != after.len() {
            return None;
        }
        let differs = |object: &&Object| {
            let material = object.material as usize;
            before[material] != after[material]
        };
        let mut changed = MaterialSet::NONE;
        for object in self.objects.iter().filter(differs) {
            if self.lets_light_through(object) || now.lets_light_through(object) {
                return None;
            }
            changed = changed.with(object.material);
        }
        Some(changed)
    }

    /// Whether an object may be transparent anywhere.
    pub(in crate::trace) fn lets_light_through(&self, object: &Object) -> bool {
        let material = &self.materials[object.material as usize];
        let vertices_fade = !object.mesh.alphas.is_empty() && material.alpha != Alpha::Opaque;
        vertices_fade || material.is_transparent()
    }
}

/// Samples of each pixel: the largest number that `spp`, n × n jittering, the lens and motion ask
/// for, of those in use. Effects share their samples; none multiplies another's.
pub fn samples_per_pixel(world: &World, camera: &Camera, settings: &RenderSettings) -> u32 {
    let features = &settings.features;
    let mut samples = settings.spp.max(settings.jitter * settings.jitter).max(1);
    if features.lens && camera.has_lens() {
        samples = samples.max(camera.optics.lens_samples);
    }
    if features.motion {
        samples = samples
            .max(camera.optics.motion_samples)
            .max(world.needs.motion_samples);
    }
    samples
}

//! What a surface lets through of a light behind it.

use super::{Surface, World};
use crate::bvh::{Hit, Ray};
use crate::scene::RenderSettings;
use glam::Vec3;

/// The part of a light that passes a shadow ray's crossing.
pub(super) fn through(world: &World, settings: &RenderSettings, ray: &Ray, hit: &Hit) -> Vec3 {
    if !world.lets_light_through(&world.objects[hit.instance as usize]) {
        return Vec3::ZERO;
    }
    // The finest level: a shadow ray's own width is not known.
    Surface::at(world, settings, ray, 0.0, hit).lets_through()
}

/// What a shadow ray crosses, nearest first, to where nothing of the light is left.
pub(super) fn crossings(
    world: &World,
    settings: &RenderSettings,
    ray: &Ray,
) -> Vec<(Hit, Surface)> {
    let mut hits = Vec::new();
    world.aggregate.all_crossings(ray, &mut hits);
    let mut crossings = Vec::new();
    let mut left = Vec3::ONE;
    for hit in hits {
        let surface = Surface::at(world, settings, ray, 0.0, &hit);
        left *= surface.lets_through();
        crossings.push((hit, surface));
        if left.max_element() < f32::MIN_POSITIVE {
            break;
        }
    }
    crossings
}

impl Surface {
    /// `(1-d) · lerp(1, kd, d)`.
    fn lets_through(&self) -> Vec3 {
        let d = self.opacity;
        (1.0 - d) * Vec3::ONE.lerp(self.diffuse, d)
    }
}

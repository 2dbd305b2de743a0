//! What a surface lets through of a light behind it.

use super::surface::Surface;
use crate::bvh::{Hit, Ray};
use crate::scene::RenderSettings;
use crate::trace::World;
use glam::Vec3;

/// The part of a light that passes a shadow ray's crossing.
pub(in crate::trace) fn through(world: &World, settings: &RenderSettings, hit: &Hit) -> Vec3 {
    if !world.lets_light_through(&world.objects[hit.instance as usize]) {
        return Vec3::ZERO;
    }
    // The finest level: a shadow ray's own width is not known.
    let (diffuse, opacity) = Surface::diffuse_and_opacity(world, settings, hit);
    lets_through(diffuse, opacity)
}

/// What a shadow ray crosses, nearest first, to where nothing of the light is left.
pub(in crate::trace) fn crossings(
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
        left *= lets_through(surface.diffuse, surface.opacity);
        crossings.push((hit, surface));
        if left.max_element() < f32::MIN_POSITIVE {
            break;
        }
    }
    crossings
}

/// `(1-d) · lerp(1, kd, d)`.
fn lets_through(kd: Vec3, d: f32) -> Vec3 {
    (1.0 - d) * Vec3::ONE.lerp(kd, d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::TextureFilter;
    use crate::trace::test_scene;

    #[test]
    fn what_a_crossing_lets_through_is_that_of_the_whole_surface_to_the_bit() {
        let world = test_scene::world();
        let (rays, hits) = test_scene::rays(&world);
        let mut varied = 0;
        for filter in [TextureFilter::Bilinear, TextureFilter::Mipmap] {
            let settings = RenderSettings {
                texture_filter: filter,
                ..RenderSettings::default()
            };
            for (ray, hit) in rays.iter().zip(&hits) {
                let whole = Surface::at(&world, &settings, ray, 0.0, hit);
                let (diffuse, opacity) = Surface::diffuse_and_opacity(&world, &settings, hit);
                let bits = |kd: Vec3, d: f32| [kd.x, kd.y, kd.z, d].map(f32::to_bits);
                assert_eq!(bits(diffuse, opacity), bits(whole.diffuse, whole.opacity));
                let object = &world.objects[hit.instance as usize];
                let material = &world.materials[object.material as usize];
                varied += u32::from(object.varies(material, &settings));
            }
        }
        assert!(varied > 100, "{varied}");
    }
}

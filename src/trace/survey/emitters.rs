//! What a ray may meet that shines by itself: an error estimate has to reckon with those that no sample met.

use crate::scene::{Lighting, PhongMap, RenderSettings};
use crate::trace::{Camera, Material, ParallelogramLight, World};
use glam::{UVec2, Vec3};

/// The largest radiance of everything that shines by itself and may be in the picture, in no order: visible
/// lights, glowing objects, the background; with shading off what objects are painted with.
///
/// What lies beside the picture, or behind the camera, counts as what mirrors there are show of it, unless
/// something moves.
pub fn emitters(world: &World, camera: &Camera, settings: &RenderSettings) -> Vec<Vec3> {
    let features = &settings.features;
    let physical = settings.lighting == Lighting::Physical;
    let mut mirror = Vec3::ZERO;
    // The most that a map makes of a number, on a mesh that can wear it.
    let brightest = |material: &Material, of: PhongMap| match material.map(of) {
        Some(map) if features.textures => world.textures[map.texture as usize].brightest(),
        _ => Vec3::ONE,
    };
    if settings.max_depth > 0 {
        let mirrors = (world.materials.iter())
            .map(|material| material.mirror * brightest(material, PhongMap::Mirror).max(Vec3::ONE));
        mirror = mirrors.fold(mirror, Vec3::max);
    }
    let moves =
        features.motion && (world.needs.motion_samples > 0 || camera.optics.velocity != Vec3::ZERO);
    let seen_as = |radiance: Vec3, corners: &[Vec3]| {
        if moves || touches_picture(corners, camera, settings.size) {
            radiance
        } else {
            radiance * mirror
        }
    };
    let around = world.environment.brightest(features.environment);
    let mut found = match world.environment.backdrop {
        Some(backdrop) => vec![backdrop, around * mirror],
        None => vec![around],
    };
    if physical && world.needs.visible_lights {
        let visible = world.lights.parallelograms.iter().filter(|l| l.visible);
        found.extend(visible.map(|light| seen_as(light.brightest(), &light.corners())));
    }
    if features.shading && !physical {
        return found;
    }
    for (object, instance) in world.objects.iter().zip(world.aggregate.instances()) {
        let Some(material) = world.materials.get(object.material as usize) else {
            continue;
        };
        let of_object = |of| match object.mesh.uvs.is_empty() {
            true => Vec3::ONE,
            false => brightest(material, of),
        };
        let radiance = if features.shading {
            material.emission * of_object(PhongMap::Emission)
        } else {
            material.diffuse * of_object(PhongMap::Diffuse)
        };
        if radiance == Vec3::ZERO {
            continue;
        }
        let corners = instance.world_bounds().map(|b| {
            let (min, max) = (Vec3::from(b.min), Vec3::from(b.max));
            std::array::from_fn::<_, 8, _>(|i| {
                Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), max, min)
            })
        });
        found.extend(corners.map(|corners| seen_as(radiance, &corners)));
    }
    found
}

/// Whether the hull of some points may be seen: false only where all of them lie behind the camera, or
/// beyond the same border of the picture by more than half of it, which leaves room for a lens' blur.
fn touches_picture(corners: &[Vec3], camera: &Camera, size: UVec2) -> bool {
    let places: Vec<_> = corners
        .iter()
        .map(|corner| camera.project(*corner, size, 0.0))
        .collect();
    if places.iter().any(Option::is_none) {
        return places.iter().any(Option::is_some);
    }
    let places = || places.iter().flatten().map(|(place, _)| *place);
    let margin = 0.5 * size.as_vec2();
    let end = size.as_vec2() + margin;
    let beyond = places().all(|p| p.x < -margin.x)
        || places().all(|p| p.y < -margin.y)
        || places().all(|p| p.x > end.x)
        || places().all(|p| p.y > end.y);
    !beyond
}

impl ParallelogramLight {
    pub(in crate::trace) fn corners(&self) -> [Vec3; 4] {
        let [a, b] = self.edges;
        [Vec3::ZERO, a, b, a + b].map(|edge| self.corner + edge)
    }

    /// Of its corners, between which the radiance is bilinear.
    fn brightest(&self) -> Vec3 {
        self.colors.into_iter().fold(Vec3::ZERO, Vec3::max)
    }
}

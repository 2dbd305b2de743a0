//! Renderings of the cases that can be seen: were they to fail, it would show here.

use super::environment::map;
use super::light::{coarse_sphere, grazed_plane, slab_over_floor};
use crate::film::views::Shown;
use crate::film::{develop, render};
use crate::scene::RenderSettings;
use crate::trace::{Camera, World};
use glam::{Quat, UVec2, Vec3};

/// Name, caption, picture.
pub(super) fn all() -> Vec<(String, String, Shown)> {
    let (plane, above) = grazed_plane(Quat::from_rotation_y(0.3), Vec3::ZERO);
    let slab = slab_over_floor(2e-4, Vec3::ZERO);
    let beside = Camera::looking_at(Vec3::new(2.4, 1.0, 2.6), Vec3::ZERO, Vec3::Y, 0.8);
    let (sphere, towards, _) = coarse_sphere();
    let seam = World {
        environment: map(),
        ..World::default()
    };
    let back = Camera::looking_at(Vec3::ZERO, Vec3::new(0.0, 0.6, 1.0), Vec3::Y, 2.0);
    [
        ("acne", "18: a light 0.01° above a plane leaves no dark pixel", &plane, &above, 4.0),
        ("contact", "19: a slab 0.2 mm above a floor of 4 m; no light leaks under it", &slab, &beside, 3.0),
        ("terminator", "27: 128 triangles with smooth normals; facets that turn from the light cut the terminator", &sphere, &towards, 0.0),
        ("seam", "32: the seam of a map runs up the middle, its pole is above it; neither shows", &seam, &back, -2.5),
    ]
    .map(|(name, caption, world, camera, exposure)| {
        (
            format!("stability-{name}"),
            caption.to_owned(),
            shown(world, camera, exposure),
        )
    })
    .into()
}

fn shown(world: &World, camera: &Camera, exposure: f32) -> Shown {
    let mut settings = RenderSettings {
        size: UVec2::new(480, 320),
        spp: 16,
        ..RenderSettings::default()
    };
    settings.output.exposure = exposure;
    let picture = render(world, camera, &settings, &|_, _| {}).picture;
    Shown {
        has_unknown: false,
        width: picture.width,
        height: picture.height,
        pixels: develop(&picture, &settings.output),
        scale: None,
    }
}

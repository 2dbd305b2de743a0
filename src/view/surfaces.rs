//! What a view sees whatever light there is: how far away surfaces are, and whose backs they are.

use super::darkroom::Subject;
use super::pick::side_of;
use crate::film::depths;
use crate::scene::SceneId;
use crate::trace::first_surface;
use bevy::math::UVec2;
use std::collections::BTreeSet;

/// Pixels of the depth that gizmos are hidden by, at most: it is traced besides the picture.
const MOST_DEPTHS: f32 = 120_000.0;
/// Rays across and down a view that look for backs: a few that are seen through a gap are no matter.
const GRID: UVec2 = UVec2::new(48, 27);

/// All that changes with camera and geometry alone, and with what is cut out of it.
#[derive(Clone)]
pub(super) struct Surfaces {
    /// Pixels.
    pub size: UVec2,
    /// Metres along the view axis, finite.
    pub depths: Vec<f32>,
    /// Objects that are seen from behind: their triangles go round clockwise.
    pub backs: Vec<SceneId>,
}

impl Surfaces {
    /// For a picture that is small enough to be traced besides.
    pub fn of(subject: &Subject) -> Self {
        let Subject {
            world,
            camera,
            settings,
            ..
        } = subject;
        let pixels = settings.size.as_vec2().element_product();
        let scale = (MOST_DEPTHS / pixels).sqrt().min(1.0);
        let size = (settings.size.as_vec2() * scale).as_uvec2().max(UVec2::ONE);
        let depths = depths(world, camera, settings, size);
        Self {
            size,
            // Finite, so that the shader's arithmetic is.
            depths: depths.into_iter().map(|d| d.min(1e30)).collect(),
            backs: backs(subject),
        }
    }
}

fn backs(subject: &Subject) -> Vec<SceneId> {
    let (world, size) = (&subject.world, subject.settings.size);
    let places = (0..GRID.y).flat_map(|y| (0..GRID.x).map(move |x| UVec2::new(x, y)));
    let rays: Vec<_> = places
        .map(|place| {
            let place = (place.as_vec2() + 0.5) / GRID.as_vec2() * size.as_vec2();
            let middle_of_lens = [0.5; 2];
            subject.camera.ray(place, size, middle_of_lens, 0.0)
        })
        .collect();
    let mut hits = Vec::new();
    world.aggregate.closest_hits(&rays, &mut hits);
    let seen = rays.iter().zip(&hits).filter_map(|(ray, hit)| {
        let hit = first_surface(world, &subject.settings, ray, (*hit)?)?;
        let (object, normal) = side_of(world, &hit)?;
        (normal.dot(ray.direction) > 0.0).then_some(object)
    });
    seen.collect::<BTreeSet<_>>().into_iter().collect()
}

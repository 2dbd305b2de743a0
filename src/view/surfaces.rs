//! What a view sees whatever light there is: how far away surfaces are, and whose backs they are.

use super::darkroom::Subject;
use super::pick::side_of;
use crate::bvh::Aggregate;
use crate::film::depths;
use crate::scene::{SceneId, TextureFilter};
use crate::trace::{self, first_surface};
use bevy::math::UVec2;
use std::collections::BTreeSet;
use std::sync::Arc;

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

/// All that surfaces depend on.
#[derive(PartialEq)]
pub(super) struct SurfacesOf {
    /// Kept, lest another is made at its address.
    trees: Same<Aggregate>,
    /// Where some let light through.
    cut_outs: Option<CutOuts>,
    camera: trace::Camera,
    size: UVec2,
    /// Whether anything moves while the shutter is open.
    motion: bool,
}

/// What decides where surfaces are cut out.
#[derive(PartialEq)]
struct CutOuts {
    materials: Same<Vec<trace::Material>>,
    textures: Same<Vec<Arc<trace::Texture>>>,
    transparency: bool,
    in_use: bool,
    filter: TextureFilter,
}

impl SurfacesOf {
    pub fn new(subject: &Subject) -> Self {
        let Subject {
            world,
            camera,
            settings,
            ..
        } = subject;
        let features = &settings.features;
        Self {
            trees: Same(world.aggregate.clone()),
            cut_outs: (world.needs.transparency).then(|| CutOuts {
                materials: Same(world.materials.clone()),
                textures: Same(world.textures.clone()),
                transparency: features.transparency,
                in_use: features.textures,
                filter: settings.texture_filter,
            }),
            camera: camera.clone(),
            size: settings.size,
            motion: features.motion,
        }
    }
}

struct Same<T>(Arc<T>);

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::RenderSettings;
    use crate::trace::World;
    use bevy::math::Vec3;

    #[test]
    fn what_cuts_surfaces_out_makes_them_others_where_anything_lets_light_through() {
        let camera = trace::Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
        let mut of = Subject {
            world: Arc::default(),
            camera,
            settings: RenderSettings::default(),
            region: None,
        };
        let with = |change: fn(&mut Subject), of: &Subject| {
            let mut other = of.clone();
            change(&mut other);
            SurfacesOf::new(&other) == SurfacesOf::new(of)
        };
        let changes: [fn(&mut Subject); 4] = [
            |of| of.settings.features.transparency = !of.settings.features.transparency,
            |of| of.settings.features.textures = !of.settings.features.textures,
            |of| of.settings.texture_filter = TextureFilter::Nearest,
            |of| Arc::make_mut(&mut of.world).textures = Arc::default(),
        ];
        for change in changes {
            assert!(with(change, &of), "nothing is cut out of an opaque scene");
        }
        of.world = Arc::new(World {
            needs: trace::Needs {
                transparency: true,
                ..trace::Needs::default()
            },
            ..World::default()
        });
        for (number, change) in changes.into_iter().enumerate() {
            assert!(!with(change, &of), "change {number}");
        }
        let light: fn(&mut Subject) = |of| of.settings.output.exposure += 1.0;
        assert!(with(light, &of));
    }
}

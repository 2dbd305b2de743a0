//! What camera rays meet first, and what finding it cost: no shading, no further ray.

use crate::bvh::{Counters, Hit, Ray, Visitor};
use crate::scene::{PixelSampling, RenderSettings, SceneId};
use crate::trace::stages::camera_rays::CameraRays;
use crate::trace::{Camera, Cone, SampleId, Surface, World};
use glam::{UVec2, Vec2, Vec3};

/// What one camera ray meets first. Surfaces only: lights have none, and a surface counts however
/// transparent it is, unless its opacity is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// kd, texture included; black for a miss.
    pub albedo: Vec3,
    /// Unit normal for shading, in world space; zero for a miss.
    pub normal: Vec3,
    /// Metres from the ray's start; infinite for a miss.
    pub depth: f32,
    /// The object; `None` for a miss.
    pub object: Option<SceneId>,
    /// What the walk of this ray cost, without packets.
    pub cost: Counters,
}

impl FirstHit {
    /// A ray that meets nothing, at no cost.
    pub const MISS: Self = Self {
        albedo: Vec3::ZERO,
        normal: Vec3::ZERO,
        depth: f32::INFINITY,
        object: None,
        cost: Counters {
            boxes: 0,
            nodes: 0,
            triangles: 0,
        },
    };
}

/// What the camera rays of samples meet: the very rays that [`radiance`](crate::trace::radiance()) begins
/// with, lens, shutter and place in the pixel included. `hits[i]` becomes that of `samples[i]`.
///
/// # Panics
/// If there is not exactly one hit for each sample.
pub fn first_hits(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    samples: &[SampleId],
    hits: &mut [FirstHit],
) {
    assert_eq!(samples.len(), hits.len(), "one hit for each sample");
    let cone = Cone::of_pixel(camera, settings.size);
    let plane = camera.image_plane(settings.size);
    let mut rays = Vec::new();
    CameraRays::default().of(world, &plane, settings, samples, &mut rays);
    for (hit, ray) in hits.iter_mut().zip(&rays) {
        *hit = first_hit(world, settings, cone, ray);
    }
}

/// What the central rays of pixels meet. `hits[i]` becomes that of `pixels[i]`.
///
/// # Panics
/// If there is not exactly one hit for each pixel.
pub fn central_hits(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    pixels: &[UVec2],
    hits: &mut [FirstHit],
) {
    assert_eq!(pixels.len(), hits.len(), "one hit for each pixel");
    let cone = Cone::of_pixel(camera, settings.size);
    for (hit, &pixel) in hits.iter_mut().zip(pixels) {
        *hit = first_hit(world, settings, cone, &central_ray(camera, settings, pixel));
    }
}

/// The ray through the middle of a pixel (through its corner where all samples lie there) and the
/// middle of the lens, when the shutter opens (with motion off: at t = 0).
pub fn central_ray(camera: &Camera, settings: &RenderSettings, pixel: UVec2) -> Ray {
    let place = match settings.pixel {
        PixelSampling::Area | PixelSampling::Center => Vec2::splat(0.5),
        PixelSampling::Corner => Vec2::new(0.0, 1.0),
    };
    let middle_of_lens = [0.5; 2];
    let time = if settings.features.motion {
        camera.optics.shutter[0]
    } else {
        0.0
    };
    camera.ray(pixel.as_vec2() + place, settings.size, middle_of_lens, time)
}

/// Of a ray that meets `hit` first, the first surface that is there at all: `hit`, or what shows where that and others are cut
/// out, a crossing of opacity 0 being none. By the finest texels.
pub fn first_surface(world: &World, settings: &RenderSettings, ray: &Ray, hit: Hit) -> Option<Hit> {
    // What most rays meet is there without a look at it.
    if !world.lets_light_through(&world.objects[hit.instance as usize]) {
        return Some(hit);
    }
    let opacity = |hit: &Hit| Surface::diffuse_and_opacity(world, settings, hit).1;
    first_there(world, ray, hit, &mut (), opacity, |opacity| *opacity).map(|(hit, _)| hit)
}

/// Of what is there, what `look` says of it.
fn first_there<T>(
    world: &World,
    ray: &Ray,
    hit: Hit,
    visitor: &mut impl Visitor,
    look: impl Fn(&Hit) -> T,
    opacity: impl Fn(&T) -> f32,
) -> Option<(Hit, T)> {
    let mut next = Some(hit);
    while let Some(hit) = next {
        let looked = look(&hit);
        if opacity(&looked) > 0.0 {
            return Some((hit, looked));
        }
        next = world.aggregate.next_crossing_with(ray, &hit, visitor);
    }
    None
}

fn first_hit(world: &World, settings: &RenderSettings, cone: Cone, ray: &Ray) -> FirstHit {
    let mut cost = Counters::default();
    let hit = world.aggregate.closest_hit_with(ray, &mut cost);
    let look = |hit: &Hit| {
        let depth = hit.t * ray.direction.length();
        Surface::at(world, settings, ray, cone.width_at(depth), hit)
    };
    let opacity = |surface: &Surface| surface.opacity;
    let found = hit.and_then(|hit| first_there(world, ray, hit, &mut cost, look, opacity));
    match found {
        Some((hit, surface)) => FirstHit {
            albedo: surface.diffuse,
            normal: surface.normal,
            depth: hit.t * ray.direction.length(),
            object: Some(SceneId(world.objects[hit.instance as usize].id)),
            cost,
        },
        None => FirstHit {
            cost,
            ..FirstHit::MISS
        },
    }
}

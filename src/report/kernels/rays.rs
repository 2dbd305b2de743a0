//! Rays as a tracer shoots them: from the camera, and on from what those hit.

use super::ours;
use crate::bvh::hard_cases::random::Random;
use crate::bvh::{Aggregate, BuildOptions, Ray};
use crate::report::{Options, Subject};
use crate::trace::Lights;
use glam::{UVec2, Vec2, Vec3};

/// Kinds of rays, in the order of a row.
pub(super) const CLASSES: [&str; 4] = ["primary", "mirror", "diffuse", "shadow"];

/// About so many rays of each kind.
pub(super) fn count(options: &Options) -> usize {
    if options.quick { 1 << 15 } else { 1 << 18 }
}

/// Where on its way to a light a shadow ray ends.
const BEFORE_THE_LIGHT: f32 = 0.9999;

/// The rays of a scene.
pub(super) struct RaySets {
    /// Those of whose hits the nearest is asked for.
    pub closest: [Vec<Ray>; 3],
    /// Those of which only is asked whether they hit anything.
    pub shadow: Vec<Ray>,
}

impl RaySets {
    /// Primary rays, and from each of their hits one of every other kind.
    pub fn of(subject: &Subject, triangles: &[[Vec3; 3]], options: &Options) -> Self {
        let aggregate = ours::aggregate(triangles, &BuildOptions::default());
        let size = size(subject.settings.size, count(options));
        let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
        let primary: Vec<Ray> = pixels
            .map(|pixel| {
                let middle = pixel.as_vec2() + Vec2::splat(0.5);
                subject.camera.ray(middle, size, [0.5; 2], 0.0)
            })
            .collect();
        let mut random = Random::new(u64::from(options.seed) + 1);
        let mut sets = Self {
            closest: [primary, Vec::new(), Vec::new()],
            shadow: Vec::new(),
        };
        sets.follow(&aggregate, &subject.world.lights, &mut random);
        sets
    }

    fn follow(&mut self, aggregate: &Aggregate, lights: &Lights, random: &mut Random) {
        let places = light_places(lights, aggregate);
        let [primary, mirror, diffuse] = &mut self.closest;
        for ray in &*primary {
            let Some(hit) = aggregate.closest_hit(ray) else {
                continue;
            };
            let instance = &aggregate.instances()[hit.instance as usize];
            let point = instance.surface_point(&hit, 0.0);
            let towards = ray.direction.dot(point.normal);
            let normal = if towards > 0.0 {
                -point.normal
            } else {
                point.normal
            };
            let reflected = ray.direction - 2.0 * ray.direction.dot(normal) * normal;
            mirror.push(aggregate.leaving(&point, reflected));
            // A point of the sphere that touches the surface: Lambert's cosine.
            let scattered = (normal + 0.999 * random.direction()).normalize();
            diffuse.push(aggregate.leaving(&point, scattered));
            let (to_light, t_max) = match random.of(&places) {
                Place::At(place) => (place - point.position, BEFORE_THE_LIGHT),
                Place::Along(direction) => (direction, f32::INFINITY),
            };
            if to_light != Vec3::ZERO {
                self.shadow.push(Ray {
                    t_max,
                    ..aggregate.leaving(&point, to_light)
                });
            }
        }
    }
}

#[derive(Clone, Copy)]
enum Place {
    At(Vec3),
    Along(Vec3),
}

/// The middles of all lights; a point above the scene where there are none.
fn light_places(lights: &Lights, aggregate: &Aggregate) -> Vec<Place> {
    let mut places = Vec::new();
    places.extend(lights.points.iter().map(|light| Place::At(light.position)));
    places.extend((lights.directionals.iter()).map(|light| Place::Along(light.to_light)));
    let middles = (lights.segments.iter()).map(|l| Place::At(0.5 * (l.ends[0] + l.ends[1])));
    places.extend(middles);
    let middles = (lights.parallelograms.iter())
        .map(|l| Place::At(l.corner + 0.5 * (l.edges[0] + l.edges[1])));
    places.extend(middles);
    if places.is_empty() {
        let bounds = aggregate.instances().iter().find_map(|i| i.world_bounds());
        let (min, max) = bounds.map_or((Vec3::ZERO, Vec3::ONE), |b| (b.min.into(), b.max.into()));
        places.push(Place::At(
            0.5 * (min + max) + 2.0 * (max.y - min.y).max(1.0) * Vec3::Y,
        ));
    }
    places
}

/// A picture of that shape with about so many pixels.
fn size(shape: UVec2, pixels: usize) -> UVec2 {
    let aspect = f64::from(shape.x) / f64::from(shape.y.max(1));
    let height = (pixels as f64 / aspect).sqrt().round().max(1.0);
    UVec2::new((height * aspect).round().max(1.0) as u32, height as u32)
}

//! Direct light, one light after another: points of it for all vertices of a batch, shadow rays there, and what arrives.

use super::chosen_places::ChosenPlaces;
use super::lamp::Lamp;
use super::light_frames::Frame;
use super::lights::{LightPoint, sample_count};
use super::numbers::{Asking, Pairs};
use super::radiance::{Batch, Vertex};
use super::recorder::{Adding, LitPoint, Recorder};
use super::sampler::Purpose;
use super::shading::reflected;
use super::transmittance::through;
use super::{DOME, Dome, Lights, SampleId, Surface, World};
use crate::bvh::{Aggregate, Hit, Order, Ray, Transmittances};
use crate::scene::{Lighting, RenderSettings};
use glam::Vec3;

/// A shadow ray ends this much before its light, as a fraction of the distance: a light that lies
/// in a surface is not hidden by it. 64 units of rounding; t itself is good to a few.
const SHORT_OF_THE_LIGHT: f32 = 1.0 - 64.0 * f32::EPSILON;

/// The arrays of one light's points, and of the shadow rays to them.
#[derive(Default)]
pub(super) struct ShadowRays {
    /// The vertex of each question for a point, which numbers choose it, those numbers, and what they choose where
    /// points of the light are not all alike.
    askers: Vec<u32>,
    asking: Asking,
    numbers: Pairs,
    chosen: ChosenPlaces,
    /// Points of lights so far at this bounce, those that nothing comes from included: what tells them apart.
    points: u32,
    rays: Vec<Ray>,
    /// What each ray adds to which sample, if the light arrives, and the number of its point.
    shadows: Vec<Shadow>,
    occluded: Vec<bool>,
    /// How much of the light passes what lies on each ray, where anything lets light through.
    passing: Transmittances,
}

/// What a shadow ray adds to which sample, if the light arrives.
#[derive(Clone, Copy)]
struct Shadow {
    sample: u32,
    value: Vec3,
    /// The number of the light's point.
    point: u32,
}

impl<R: Recorder> Batch<'_, R> {
    /// Adds what arrives at the vertices from the lights.
    pub(super) fn add_direct_light(&mut self, vertices: &[Vertex], shadow_rays: &mut ShadowRays) {
        shadow_rays.points = 0;
        if vertices.is_empty() {
            return;
        }
        let is_even =
            self.settings.lighting == Lighting::Classic || !self.settings.features.soft_shadows;
        let lights = &*self.world.lights;
        let dome = Dome::of(&self.world.environment, self.settings).map(Lamp::Dome);
        for (i, lamp) in lights.all().chain(dome).enumerate() {
            let plane = self.planes.of_light(i);
            if !self.wanted.has(plane) {
                continue;
            }
            let frame = if is_even { None } else { lamp.frame() };
            self.gather(lamp, plane, frame.as_ref(), vertices, shadow_rays);
            self.add_arriving_light(plane, shadow_rays);
        }
    }

    /// Points of a light for every vertex, and a shadow ray to each that can add something: `samples` of them at a first
    /// hit, stratified together over all samples of the pixel; one at later hits, and its middle where there are no soft
    /// shadows.
    fn gather(
        &mut self,
        lamp: Lamp,
        plane: usize,
        frame: Option<&Frame>,
        vertices: &[Vertex],
        shadow_rays: &mut ShadowRays,
    ) {
        shadow_rays.rays.clear();
        shadow_rays.shadows.clear();
        let world = self.world;
        let lights = &*world.lights;
        let lighting = self.settings.lighting;
        let features = &self.settings.features;
        let samples = lamp.samples(features.soft_shadows);
        let at_first_hits = samples
            .map(|(samples, size)| sample_count(samples, size, features.scale_light_samples));
        let count_at = |vertex: &Vertex| match at_first_hits {
            Some(count) if vertex.path.first => count,
            _ => 1,
        };
        let from = |vertex: &Vertex| {
            lights.in_rest_frame(lamp.id(), vertex.surface.point.position, vertex.ray.time)
        };
        if samples.is_some() {
            shadow_rays.ask(vertices, count_at, self.samples, self.pixels);
            let ShadowRays {
                askers,
                asking,
                numbers,
                chosen,
                ..
            } = shadow_rays;
            numbers.draw(asking, Purpose::Light(lamp.id()), self.settings);
            if let Some(frame) = frame {
                chosen.choose(frame, vertices, askers, numbers, from);
            }
        }
        let mut asked = 0;
        for vertex in vertices {
            let surface = &vertex.surface;
            let weight = vertex.weight(lights, lighting);
            let count = count_at(vertex);
            if weight == Vec3::ZERO {
                asked += count as usize;
                continue;
            }
            let from = from(vertex);
            for _ in 0..count {
                let point = match (samples, frame) {
                    (None, _) => lamp.middle(surface, from, lighting),
                    (Some(_), None) => {
                        let numbers = shadow_rays.numbers.get(asked);
                        lamp.point(surface, from, numbers, lighting)
                    }
                    (Some(_), Some(_)) => lamp.chosen(from, shadow_rays.chosen.get(asked)),
                };
                asked += 1;
                let number = shadow_rays.points;
                shadow_rays.points += 1;
                let Some(point) = point else { continue };
                self.recorder.light_sample(
                    number,
                    &LitPoint {
                        path: vertex.number,
                        kind: lamp.kind(),
                        id: lamp.id(),
                        count: samples.map(|_| count),
                        surface,
                        point,
                    },
                );
                let value = weight / count as f32 * reflected(surface, &point, lighting);
                if value == Vec3::ZERO {
                    continue;
                }
                if !features.shadows {
                    self.add(vertex.path.sample, plane, Adding::Light(number), value);
                    continue;
                }
                let ray = shadow_ray(&world.aggregate, surface, &point, vertex.ray.time);
                self.recorder.shadow_ray(number, &ray);
                shadow_rays.rays.push(ray);
                shadow_rays.shadows.push(Shadow {
                    sample: vertex.path.sample,
                    value,
                    point: number,
                });
            }
        }
    }

    /// Traces the shadow rays and adds what arrives.
    fn add_arriving_light(&mut self, plane: usize, shadow_rays: &mut ShadowRays) {
        let ShadowRays {
            rays,
            shadows,
            occluded,
            passing,
            ..
        } = shadow_rays;
        self.counts.shadow += rays.len() as u64;
        if self.settings.features.transparency && self.world.needs.transparency {
            let (world, settings) = (self.world, self.settings);
            let through = |ray: usize, hit: &Hit| through(world, settings, &rays[ray], hit);
            (world.aggregate).transmittances_in(Order::Light, rays, through, passing);
            for (shadow, &transmittance) in shadows.iter().zip(passing.get()) {
                self.recorder.arrived(shadow.point, transmittance);
                let value = shadow.value * transmittance;
                self.add(shadow.sample, plane, Adding::Light(shadow.point), value);
            }
            return;
        }
        self.world
            .aggregate
            .occlusions_in(Order::Light, rays, occluded);
        for (shadow, occluded) in shadows.iter().zip(occluded) {
            if !*occluded {
                self.recorder.arrived(shadow.point, Vec3::ONE);
                self.add(
                    shadow.sample,
                    plane,
                    Adding::Light(shadow.point),
                    shadow.value,
                );
            }
        }
    }
}

impl Vertex {
    /// What a light's reflected radiance is multiplied by: the path's throughput times the surface's opacity, shared by
    /// all lights where the lighting is Classic.
    fn weight(&self, lights: &Lights, lighting: Lighting) -> Vec3 {
        let opaque = self.path.throughput * self.surface.opacity;
        match lighting {
            Lighting::Physical => opaque,
            Lighting::Classic => opaque / lights.count().max(1) as f32,
        }
    }
}

impl ShadowRays {
    /// Every vertex asks for so many points: their numbers go on from sample to sample of the pixel.
    fn ask(
        &mut self,
        vertices: &[Vertex],
        count_at: impl Fn(&Vertex) -> u32,
        samples: &[SampleId],
        pixels: &[u32],
    ) {
        self.asking.clear();
        self.askers.clear();
        for (asker, vertex) in vertices.iter().enumerate() {
            let sample = vertex.path.sample as usize;
            let count = u64::from(count_at(vertex));
            let first = samples[sample].index * count;
            for index in first..first + count {
                self.askers.push(asker as u32);
                self.asking.push(pixels[sample], vertex.path.name, index);
            }
        }
    }
}

/// From a surface to a light point, ending just before it.
fn shadow_ray(aggregate: &Aggregate, surface: &Surface, point: &LightPoint, time: f32) -> Ray {
    let origin = aggregate.leave(&surface.point, point.direction);
    if point.distance == f32::INFINITY {
        return Ray {
            origin,
            direction: point.direction,
            t_max: f32::INFINITY,
            time,
        };
    }
    // From the moved origin to the light itself, so that the ray still ends there.
    let to_light = point.distance * point.direction - (origin - surface.point.position);
    Ray {
        origin,
        direction: to_light,
        t_max: SHORT_OF_THE_LIGHT,
        time,
    }
}

impl World {
    /// How many shadow rays the area light with this `SceneId`, or the [`DOME`], gets at a first hit; `None` where there
    /// is no such light.
    pub fn light_samples(&self, id: u64, settings: &RenderSettings) -> Option<u32> {
        if id == DOME {
            let dome = Dome::of(&self.environment, settings)?;
            return Some(dome.sample_count(settings));
        }
        let lights = &self.lights;
        let directional = (lights.directionals.iter())
            .map(|light| (light.id, light.samples, light.solid_angle()));
        let segments = lights.segments.iter().map(|light| {
            let length = (light.ends[1] - light.ends[0]).length();
            (light.id, light.samples, length)
        });
        let parallelograms = lights.parallelograms.iter().map(|light| {
            let area = light.area_normal().length();
            (light.id, light.samples, area)
        });
        let mut all = directional.chain(segments).chain(parallelograms);
        let (_, samples, size) = all.find(|(of, ..)| *of == id)?;
        Some(sample_count(
            samples,
            size,
            settings.features.scale_light_samples,
        ))
    }
}

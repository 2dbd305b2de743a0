//! Direct light, one light after another: points of it for all vertices of a batch, shadow rays there, and what arrives.

use super::lamp::Lamp;
use super::light_columns::{LANES, Questions, Replies, Source};
use super::light_frames::Frame;
use super::lights::{LightPoint, MIDDLE, sample_count};
use super::numbers::{Asking, Pairs};
use super::radiance::Batch;
use super::recorder::{Adding, LitPoint, Recorder};
use super::sampler::Purpose;
use super::shading::reflected;
use super::transmittance::through;
use super::vectors::{Vectors, column_vector};
use super::vertices::Vertices;
use super::{Dome, SampleId, Surface};
use crate::bvh::{Aggregate, Hit, Order, Ray, Transmittances};
use crate::scene::Lighting;
use glam::Vec3;

/// A shadow ray ends this much before its light, as a fraction of the distance: a light that lies
/// in a surface is not hidden by it. 64 units of rounding; t itself is good to a few.
const SHORT_OF_THE_LIGHT: f32 = 1.0 - 64.0 * f32::EPSILON;

/// The arrays of one light's points, and of the shadow rays to them.
#[derive(Default)]
pub(super) struct ShadowRays {
    /// What each vertex's reflected radiance is multiplied by.
    weights: Vectors,
    /// How many points of the light each vertex asks for, which share what it reflects, and the first of its questions.
    counts: Vec<u32>,
    firsts: Vec<u32>,
    /// The vertex of each question, which numbers choose its point, and those numbers.
    askers: Vec<u32>,
    asking: Asking,
    numbers: Pairs,
    /// The vertices whose questions are answered in columns, matt ones and those with a highlight, and the questions that
    /// are answered one by one.
    matt: Vec<u32>,
    glossy: Vec<u32>,
    others: Vec<u32>,
    /// The answers to all.
    replies: Vec<Reply>,
    /// Points of lights so far at this bounce, those that nothing comes from included: what tells them apart.
    points: u32,
    rays: Vec<Ray>,
    /// What each ray adds to which sample, if the light arrives, and the number of its point.
    shadows: Vec<Shadow>,
    occluded: Vec<bool>,
    /// How much of the light passes what lies on each ray, where anything lets light through.
    passing: Transmittances,
}

/// What a point of a light adds if nothing is in the way, and the ray that finds out.
#[derive(Clone, Copy)]
struct Reply {
    /// Zero where nothing comes from there.
    value: Vec3,
    ray: Ray,
}

/// What a shadow ray adds to which sample, if the light arrives.
#[derive(Clone, Copy)]
struct Shadow {
    sample: u32,
    value: Vec3,
    /// The number of the light's point.
    point: u32,
}

/// A light as it is asked for points.
struct Asked<'a> {
    lamp: Lamp<'a>,
    /// What choosing its points for a surface takes, where they are not all alike.
    frame: Option<&'a Frame>,
    /// Whether more than its middle is asked for.
    has_extent: bool,
}

impl<R: Recorder> Batch<'_, R> {
    /// Adds what arrives at the vertices from the lights.
    pub(super) fn add_direct_light(&mut self, vertices: &Vertices, shadow_rays: &mut ShadowRays) {
        shadow_rays.points = 0;
        if vertices.len() == 0 {
            return;
        }
        let is_even =
            self.settings.lighting == Lighting::Classic || !self.settings.features.soft_shadows;
        let lights = &*self.world.lights;
        let dome = Dome::of(&self.world.environment, self.settings).map(Lamp::Dome);
        self.weigh(vertices, &mut shadow_rays.weights);
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

    /// What a light's reflected radiance is multiplied by: the path's throughput times the surface's opacity, shared by
    /// all lights where the lighting is Classic.
    fn weigh(&self, vertices: &Vertices, weights: &mut Vectors) {
        weights.resize(vertices.len());
        if vertices.are_from_camera() && self.settings.lighting == Lighting::Physical {
            for column in weights.slices() {
                column.copy_from_slice(&vertices.opacity);
            }
            return;
        }
        let lights = self.world.lights.count().max(1) as f32;
        for i in 0..vertices.len() {
            let opaque = vertices.path(i).throughput * vertices.opacity[i];
            let weight = match self.settings.lighting {
                Lighting::Physical => opaque,
                Lighting::Classic => opaque / lights,
            };
            weights.set(i, weight);
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
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let features = &self.settings.features;
        let samples = lamp.samples(features.soft_shadows);
        let at_first_hits = samples.map_or(1, |(samples, size)| {
            sample_count(samples, size, features.scale_light_samples)
        });
        let has_extent = samples.is_some();
        let asked = Asked {
            lamp,
            frame,
            has_extent,
        };
        shadow_rays.ask(vertices, at_first_hits, self.samples, self.pixels);
        if has_extent {
            let ShadowRays {
                asking, numbers, ..
            } = &mut *shadow_rays;
            numbers.draw(asking, Purpose::Light(lamp.id()), self.settings);
        }
        self.answer(&asked, vertices, shadow_rays);
        self.collect(&asked, plane, vertices, shadow_rays);
    }

    /// Answers all questions for points of a light.
    fn answer(&self, asked: &Asked, vertices: &Vertices, shadow_rays: &mut ShadowRays) {
        let Asked { lamp, frame, .. } = *asked;
        let is_physical = self.settings.lighting == Lighting::Physical;
        let source = is_physical
            .then(|| Source::of(lamp, frame, self.settings.features.soft_shadows))
            .flatten();
        shadow_rays.begin_replies();
        match source {
            Some(source) => {
                shadow_rays.sort(vertices);
                for is_glossy in [false, true] {
                    self.answer_in_columns(asked, &source, is_glossy, vertices, shadow_rays);
                }
            }
            None => {
                let all = 0..shadow_rays.askers.len() as u32;
                shadow_rays.others.extend(all);
            }
        }
        self.answer_alone(asked, vertices, shadow_rays);
    }

    /// Answers the questions of matt or of glossy vertices, together. Those with an answer out of the ordinary go to the
    /// others.
    fn answer_in_columns(
        &self,
        asked: &Asked,
        source: &Source,
        is_glossy: bool,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let ShadowRays {
            weights,
            counts,
            firsts,
            numbers,
            matt,
            glossy,
            others,
            replies,
            ..
        } = shadow_rays;
        let t_max = if source.is_far() {
            f32::INFINITY
        } else {
            SHORT_OF_THE_LIGHT
        };
        let from = |vertex: usize| self.seen_from(asked.lamp, vertices, vertex);
        let mut questions = Questions::nothing(is_glossy);
        for some in (if is_glossy { glossy } else { matt }).chunks(LANES) {
            questions.ask(some, counts, weights, vertices, from);
            let prepared = source.prepare(&questions);
            let most = some.iter().map(|&i| counts[i as usize]).max().unwrap_or(0);
            for k in 0..most {
                // Those that ask for fewer points ask for their last one again.
                let question = |&vertex: &u32| {
                    let vertex = vertex as usize;
                    (firsts[vertex] + k.min(counts[vertex] - 1)) as usize
                };
                if asked.has_extent {
                    questions.draw(numbers, some.iter().map(question));
                }
                let Replies {
                    value,
                    origin,
                    along,
                    is_rare,
                } = source.answer(&prepared, &questions);
                for (lane, vertex) in some.iter().enumerate() {
                    let (question, vertex) = (question(vertex), *vertex as usize);
                    if is_rare[lane] != 0 {
                        others.push(question as u32);
                        continue;
                    }
                    replies[question] = Reply {
                        value: column_vector(&value, lane),
                        ray: Ray {
                            origin: column_vector(&origin, lane),
                            direction: column_vector(&along, lane),
                            t_max,
                            time: vertices.times[vertex],
                        },
                    };
                }
            }
        }
    }

    /// Answers the other questions, one by one.
    fn answer_alone(&self, asked: &Asked, vertices: &Vertices, shadow_rays: &mut ShadowRays) {
        let ShadowRays {
            weights,
            counts,
            askers,
            numbers,
            others,
            replies,
            ..
        } = shadow_rays;
        let lighting = self.settings.lighting;
        for &question in &*others {
            let question = question as usize;
            let vertex = askers[question] as usize;
            let surface = vertices.surface(vertex);
            let from = self.seen_from(asked.lamp, vertices, vertex);
            let numbers = numbers_of(asked, numbers, question);
            if let Some(point) = asked.point(&surface, from, numbers, lighting) {
                let reflected = reflected(&surface, &point, lighting);
                let time = vertices.times[vertex];
                replies[question] = Reply {
                    value: weights.get(vertex) / counts[vertex] as f32 * reflected,
                    ray: shadow_ray(&self.world.aggregate, &surface, &point, time),
                };
            }
        }
    }

    /// Where a vertex lies in the frame that moves with a light.
    #[inline(always)]
    fn seen_from(&self, lamp: Lamp, vertices: &Vertices, vertex: usize) -> Vec3 {
        let position = vertices.position.get(vertex);
        (self.world.lights).in_rest_frame(lamp.id(), position, vertices.times[vertex])
    }

    /// Takes the shadow rays that can add something, in the order of the questions.
    fn collect(
        &mut self,
        asked: &Asked,
        plane: usize,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let ShadowRays {
            askers,
            counts,
            numbers,
            replies,
            points,
            rays,
            shadows,
            ..
        } = shadow_rays;
        rays.clear();
        shadows.clear();
        for (question, (asker, reply)) in askers.iter().zip(&*replies).enumerate() {
            let vertex = *asker as usize;
            let number = *points;
            *points += 1;
            if R::LISTENS {
                let Asked {
                    lamp, has_extent, ..
                } = *asked;
                let surface = &vertices.surface(vertex);
                let numbers = numbers_of(asked, numbers, question);
                let from = self.seen_from(lamp, vertices, vertex);
                if let Some(point) = asked.point(surface, from, numbers, self.settings.lighting) {
                    let lit = LitPoint {
                        path: vertices.numbers[vertex],
                        kind: lamp.kind(),
                        id: lamp.id(),
                        count: has_extent.then_some(counts[vertex]),
                        surface,
                        point,
                    };
                    self.recorder.light_sample(number, &lit);
                }
            }
            let Reply { value, ray } = *reply;
            if value == Vec3::ZERO {
                continue;
            }
            let sample = vertices.path(vertex).sample;
            if !self.settings.features.shadows {
                self.add(sample, plane, Adding::Light(number), value);
                continue;
            }
            self.recorder.shadow_ray(number, &ray);
            rays.push(ray);
            shadows.push(Shadow {
                sample,
                value,
                point: number,
            });
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

impl Reply {
    const NOTHING: Self = Self {
        value: Vec3::ZERO,
        ray: Ray {
            origin: Vec3::ZERO,
            direction: Vec3::ZERO,
            t_max: 0.0,
            time: 0.0,
        },
    };
}

impl Asked<'_> {
    /// The point that numbers choose for a surface at `from`, by itself.
    fn point(
        &self,
        surface: &Surface,
        from: Vec3,
        numbers: [f32; 2],
        lighting: Lighting,
    ) -> Option<LightPoint> {
        match self.frame {
            _ if !self.has_extent => self.lamp.middle(surface, from, lighting),
            None => self.lamp.point(surface, from, numbers, lighting),
            Some(frame) => self.lamp.point_for(frame, surface, from, numbers),
        }
    }
}

/// The numbers that choose the point of a question, where any do.
fn numbers_of(asked: &Asked, numbers: &Pairs, question: usize) -> [f32; 2] {
    if asked.has_extent {
        numbers.get(question)
    } else {
        MIDDLE
    }
}

impl ShadowRays {
    /// No question has an answer yet.
    fn begin_replies(&mut self) {
        self.replies.clear();
        self.replies.resize(self.askers.len(), Reply::NOTHING);
        self.matt.clear();
        self.glossy.clear();
        self.others.clear();
    }

    /// Which vertices are answered in columns, and which questions one by one.
    fn sort(&mut self, vertices: &Vertices) {
        for (vertex, (&count, &first)) in self.counts.iter().zip(&self.firsts).enumerate() {
            if count == 0 {
                continue;
            }
            if vertices.is_near_edge[vertex] {
                self.others.extend(first..first + count);
            } else if vertices.has_highlight(vertex) {
                self.glossy.push(vertex as u32);
            } else {
                self.matt.push(vertex as u32);
            }
        }
    }

    /// Every vertex that light can add something to asks for so many points at a first hit, and for one later: their numbers
    /// go on from sample to sample of the pixel.
    fn ask(
        &mut self,
        vertices: &Vertices,
        at_first_hits: u32,
        samples: &[SampleId],
        pixels: &[u32],
    ) {
        self.asking.clear();
        self.askers.clear();
        self.counts.clear();
        self.firsts.clear();
        for vertex in 0..vertices.len() {
            let path = vertices.path(vertex);
            let count = if self.weights.get(vertex) == Vec3::ZERO {
                0
            } else if path.first {
                at_first_hits
            } else {
                1
            };
            self.counts.push(count);
            self.firsts.push(self.askers.len() as u32);
            let sample = path.sample as usize;
            let first = samples[sample].index * u64::from(count);
            for index in first..first + u64::from(count) {
                self.askers.push(vertex as u32);
                self.asking.push(pixels[sample], path.name, index);
            }
        }
    }
}

/// From a surface to a light point, ending just before it.
pub(super) fn shadow_ray(
    aggregate: &Aggregate,
    surface: &Surface,
    point: &LightPoint,
    time: f32,
) -> Ray {
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

//! Direct light, one light after another: points of it for all vertices of a batch, shadow rays there, and what arrives.

mod asked;

use super::light_columns::Source;
use super::radiance::Batch;
use super::recorder::{Adding, LitPoint, Recorder};
use super::replies::Replies;
use super::shadow_rays::{SHORT_OF_THE_LIGHT, Shadow, ShadowRays, shadow_ray};
use super::vertices::Vertices;
use super::visibility::{Chooser, bit};
use crate::bvh::{Hit, Order, Ray};
use crate::scene::Lighting;
use crate::trace::light_sampling::lamp::Lamp;
use crate::trace::math::vectors::{Vectors, column_vector};
use crate::trace::random::numbers::draw_firsts;
use crate::trace::random::sampler::Purpose;
use crate::trace::surfaces::shading::reflected;
use crate::trace::surfaces::transmittance::through;
use asked::{Asked, numbers_of};
use glam::Vec3;

/// So many lights are asked before somebody looks whether to go on: some tenths of a millisecond.
const LIGHTS_AT_ONCE: usize = 128;

impl<R: Recorder> Batch<'_, R> {
    /// Adds what arrives at the vertices from the lights. False where it was stopped.
    pub(super) fn add_direct_light(
        &mut self,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) -> bool {
        if vertices.len() == 0 {
            return true;
        }
        let is_even =
            self.settings.lighting == Lighting::Classic || !self.settings.features.soft_shadows;
        self.weigh(vertices, &mut shadow_rays.weights);
        shadow_rays.begin();
        self.recall(vertices);
        let mut first = 0_u32;
        for (i, lamp) in self.world.lamps(self.settings).enumerate() {
            if i % LIGHTS_AT_ONCE == LIGHTS_AT_ONCE - 1 && (self.stopped)() {
                return false;
            }
            let before = first;
            first = before.saturating_add(lamp.samples(self.settings).unwrap_or(1));
            let Some(row) = self.wanted.row(self.planes.of_light(i)) else {
                continue;
            };
            let frame = if is_even { None } else { lamp.frame() };
            let asked = Asked {
                lamp,
                frame: frame.as_ref(),
                has_extent: lamp.samples(self.settings).is_some(),
                faint: self.faint(lamp),
                first: before,
            };
            self.gather(&asked, row, vertices, shadow_rays);
            self.add_arriving_light(row, shadow_rays);
        }
        true
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

    /// What is known of the lights that something hides from first hits holds for the points that they ask for now.
    fn recall(&mut self, vertices: &Vertices) {
        let Some(visibilities) = &mut self.known.visibilities else {
            return;
        };
        let (mut first, mut single) = (0_u32, 0);
        for lamp in self.world.lamps(self.settings) {
            let samples = lamp.samples(self.settings);
            if samples.is_none() {
                single |= bit(first);
            }
            first = first.saturating_add(samples.unwrap_or(1));
        }
        for i in 0..vertices.len() {
            let sample = vertices.path(i).sample as usize;
            self.known.has_learnt |= visibilities[sample].keep_of(Chooser::of(vertices, i), single);
        }
    }

    /// Points of a light for every vertex, and a shadow ray to each that can add something: `samples` of them at a first
    /// hit, stratified together over all samples of the pixel; one at later hits, and its middle where there are no soft
    /// shadows.
    fn gather(
        &mut self,
        asked: &Asked,
        row: usize,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let lamp = asked.lamp;
        let at_first_hits = lamp.samples(self.settings).unwrap_or(1);
        shadow_rays.ask(vertices, at_first_hits, self.samples, self.pixels);
        if asked.has_extent {
            let ShadowRays {
                asking, numbers, ..
            } = &mut *shadow_rays;
            numbers.draw(asking, Purpose::Light(lamp.id()), self.settings);
        }
        shadow_rays.find_parts(asked.has_extent, self.samples);
        if asked.faint > 0.0 {
            let ShadowRays {
                asking, chances, ..
            } = &mut *shadow_rays;
            let purpose = Purpose::Faint(lamp.id());
            draw_firsts(chances, asking, purpose, self.settings);
        }
        self.answer(asked, vertices, shadow_rays);
        self.collect(asked, row, vertices, shadow_rays);
    }

    /// What a point of a light has to add so that it is always asked for. A dome is one light, and Classic light has no
    /// noise that it does not have to have.
    fn faint(&self, lamp: Lamp) -> f32 {
        let is_physical = self.settings.lighting == Lighting::Physical;
        if is_physical && !matches!(lamp, Lamp::Dome(_)) {
            self.world.needs.faint
        } else {
            0.0
        }
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
                self.answer_in_columns(asked, &source, vertices, shadow_rays);
            }
            None => {
                let all = 0..shadow_rays.askers.len() as u32;
                shadow_rays.others.extend(all);
            }
        }
        self.answer_alone(asked, vertices, shadow_rays);
    }

    /// Answers the questions in columns. Those with an answer out of the ordinary go to the others.
    fn answer_in_columns(
        &self,
        asked: &Asked,
        source: &Source,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let ShadowRays {
            counts,
            firsts,
            numbers,
            chances,
            columns,
            others,
            values,
            rays,
            ..
        } = shadow_rays;
        let t_max = if source.is_far() {
            f32::INFINITY
        } else {
            SHORT_OF_THE_LIGHT
        };
        let moves = !self.world.lights.moving.is_empty();
        for questions in columns.all() {
            if moves {
                questions.stand_at(|vertex| self.seen_from(asked.lamp, vertices, vertex));
            }
            let prepared = source.prepare(questions);
            let most = questions.askers().map(|vertex| counts[vertex]).max();
            for k in 0..most.unwrap_or(0) {
                // Those that ask for fewer points ask for their last one again.
                let question =
                    |vertex: usize| (firsts[vertex] + k.min(counts[vertex] - 1)) as usize;
                if asked.has_extent {
                    questions.draw(numbers, question);
                }
                let Replies {
                    value,
                    origin,
                    along,
                    is_rare,
                } = source.answer(&prepared, questions);
                for (lane, vertex) in questions.askers().enumerate() {
                    let question = question(vertex);
                    if is_rare[lane] != 0 {
                        others.push(question as u32);
                        continue;
                    }
                    let value = column_vector(&value, lane);
                    values[question] = value;
                    if value == Vec3::ZERO || !asked.is_asked(value, chances, question) {
                        continue;
                    }
                    rays[question] = Ray {
                        origin: column_vector(&origin, lane),
                        direction: column_vector(&along, lane),
                        t_max,
                        time: vertices.times[vertex],
                        starts_on: vertices.hits[vertex].id(),
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
            values,
            rays,
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
                values[question] = weights.get(vertex) / counts[vertex] as f32 * reflected;
                rays[question] = shadow_ray(&self.world.aggregate, &surface, &point, time);
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
        row: usize,
        vertices: &Vertices,
        shadow_rays: &mut ShadowRays,
    ) {
        let ShadowRays {
            askers,
            counts,
            firsts,
            numbers,
            chances,
            values,
            points,
            rays,
            shadows,
            ..
        } = shadow_rays;
        shadows.clear();
        for (question, (asker, &value)) in askers.iter().zip(&*values).enumerate() {
            let mut value = value;
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
            if value == Vec3::ZERO {
                continue;
            }
            let chance = asked.chance(value);
            if chance < 1.0 {
                let is_asked = asked.is_asked(value, chances, question);
                self.recorder.left_to_chance(number, chance, is_asked);
                if !is_asked {
                    continue;
                }
                value /= chance;
            }
            let sample = vertices.path(vertex).sample;
            if !self.settings.features.shadows {
                self.add_to(row, sample, Adding::Light(number), value);
                continue;
            }
            let place = asked.first.saturating_add(question as u32 - firsts[vertex]);
            if let Some(visibilities) = &self.known.visibilities
                && let Some(is_hidden) = visibilities[sample as usize].is_hidden(place)
            {
                if !is_hidden {
                    self.add_to(row, sample, Adding::Light(number), value);
                }
                continue;
            }
            self.recorder.shadow_ray(number, &rays[question]);
            shadows.push(Shadow {
                sample,
                value,
                point: number,
                question: question as u32,
                place,
            });
        }
    }

    /// Traces the shadow rays and adds what arrives.
    fn add_arriving_light(&mut self, row: usize, shadow_rays: &mut ShadowRays) {
        shadow_rays.sort_rays();
        let ShadowRays {
            shadows,
            sorted,
            ranks,
            occluded,
            passing,
            ..
        } = shadow_rays;
        let rays = &sorted[..shadows.len()];
        self.counts.shadow += rays.len() as u64;
        if self.settings.features.transparency && self.world.needs.transparency {
            let (world, settings) = (self.world, self.settings);
            let through = |_: usize, hit: &Hit| through(world, settings, hit);
            (world.aggregate).transmittances_in(Order::Light, rays, through, passing);
            let passing = passing.get();
            for (shadow, &rank) in shadows.iter().zip(&*ranks) {
                let transmittance = passing[rank as usize];
                self.recorder.arrived(shadow.point, transmittance);
                let value = shadow.value * transmittance;
                self.add_to(row, shadow.sample, Adding::Light(shadow.point), value);
            }
            return;
        }
        self.world
            .aggregate
            .occlusions_in(Order::Light, rays, occluded);
        if let Some(visibilities) = &mut self.known.visibilities {
            self.known.has_learnt |= !shadows.is_empty();
            for (shadow, &rank) in shadows.iter().zip(&*ranks) {
                let occluded = occluded[rank as usize];
                visibilities[shadow.sample as usize].remember(shadow.place, occluded);
            }
        }
        for (shadow, &rank) in shadows.iter().zip(&*ranks) {
            if !occluded[rank as usize] {
                self.recorder.arrived(shadow.point, Vec3::ONE);
                self.add_to(
                    row,
                    shadow.sample,
                    Adding::Light(shadow.point),
                    shadow.value,
                );
            }
        }
    }
}

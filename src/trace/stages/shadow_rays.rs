//! What is on its way from vertices to points of one light.

use super::questions::Columns;
use super::vertices::Vertices;
use crate::bvh::{Aggregate, Ray, Transmittances};
use crate::instruction_sets::vectorized;
use crate::trace::math::vectors::Vectors;
use crate::trace::random::numbers::{Asking, Pairs};
use crate::trace::world::lights::LightPoint;
use crate::trace::{SampleId, Surface};
use glam::Vec3;

/// A shadow ray ends this much before its light, as a fraction of the distance: a light that lies
/// in a surface is not hidden by it. 64 units of rounding; t itself is good to a few.
pub(super) const SHORT_OF_THE_LIGHT: f32 = 1.0 - 64.0 * f32::EPSILON;

/// The arrays of one light's points, and of the shadow rays to them.
#[derive(Default)]
pub(super) struct ShadowRays {
    /// What each vertex's reflected radiance is multiplied by.
    pub weights: Vectors,
    /// How many points a first hit asked for when the vertices were last looked through: the next light that asks for as many
    /// has the same questions.
    asked: Option<u32>,
    /// How many points of the light each vertex asks for, which share what it reflects, and the first of its questions.
    pub counts: Vec<u32>,
    pub firsts: Vec<u32>,
    /// The vertex of each question, which numbers choose its point, and those numbers.
    pub askers: Vec<u32>,
    pub asking: Asking,
    pub numbers: Pairs,
    /// The part of the light that the point of each question lies in; none where rays go in the order of the questions.
    pub parts: Vec<u32>,
    /// Where there are many lights, the number of each question that decides whether it is asked if it is faint.
    pub chances: Vec<f32>,
    /// What is asked in columns, the same of every light; and whether it is there, and has the counts.
    pub columns: Columns,
    are_gathered: bool,
    are_shared: bool,
    /// The questions of those beside edges.
    beside_edges: Vec<u32>,
    /// The questions that are answered one by one.
    pub others: Vec<u32>,
    /// The answers to all: what each point adds if nothing is in the way, zero where nothing comes from there, and else the ray
    /// that finds out.
    pub values: Vec<Vec3>,
    pub rays: Vec<Ray>,
    /// Points of lights so far at this bounce, those that nothing comes from included: what tells them apart.
    pub points: u32,
    /// What each of the rays that are traced adds to which sample, if the light arrives, and the number of its point.
    pub shadows: Vec<Shadow>,
    /// Those rays, by the parts of the light that they go to, and where that of each shadow stands.
    pub sorted: Vec<Ray>,
    pub ranks: Vec<u32>,
    pub occluded: Vec<bool>,
    /// How much of the light passes what lies on each ray, where anything lets light through.
    pub passing: Transmittances,
}

/// Parts along an edge of a light.
const PARTS: u32 = 4;
const ALL_PARTS: usize = (PARTS * PARTS) as usize;

/// What a shadow ray adds to which sample, if the light arrives.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Shadow {
    pub sample: u32,
    pub value: Vec3,
    /// The number of the light's point.
    pub point: u32,
    /// The question that it answers.
    pub question: u32,
    /// The number of the point among those of all lights for which the vertex may ask.
    pub place: u32,
}

impl ShadowRays {
    /// No question has an answer yet.
    pub fn begin_replies(&mut self) {
        let count = self.askers.len();
        self.values.clear();
        self.values.resize(count, Vec3::ZERO);
        if self.rays.len() < count {
            self.rays.resize(count, Ray::new(Vec3::ZERO, Vec3::ZERO));
        }
        self.others.clear();
    }

    /// Other vertices ask from now on.
    pub fn begin(&mut self) {
        self.points = 0;
        self.asked = None;
        self.are_gathered = false;
    }

    /// Finds the part of a light that each question's point lies in, where samples of one pixel fill packets. Rays of many
    /// pixels to a part of a small light would be farther apart than those of neighbours to all of it.
    pub fn find_parts(&mut self, has_extent: bool, samples: &[SampleId]) {
        const OF_A_PACKET: usize = 16;
        let first = samples.get(..OF_A_PACKET);
        let fills_packets =
            first.is_some_and(|first| first.iter().all(|sample| sample.pixel == first[0].pixel));
        self.parts.clear();
        if has_extent && fills_packets {
            self.parts.resize(self.askers.len(), 0);
            parts_of(&self.numbers.u, &self.numbers.v, &mut self.parts);
        }
    }

    /// Takes the rays of all shadows, those to each part of the light together: as packets they stay close to one another.
    pub fn sort_rays(&mut self) {
        self.ranks.clear();
        if self.parts.is_empty() {
            self.sorted.clear();
            let questions = self.shadows.iter().map(|shadow| shadow.question as usize);
            self.sorted
                .extend(questions.map(|question| self.rays[question]));
            self.ranks.extend(0..self.shadows.len() as u32);
            return;
        }
        let mut counts = [0; ALL_PARTS];
        let part_of = |shadow: &Shadow| self.parts[shadow.question as usize] as usize % ALL_PARTS;
        for shadow in &self.shadows {
            counts[part_of(shadow)] += 1;
        }
        let mut all = 0;
        let mut next = counts.map(|count| {
            let first = all;
            all += count;
            first
        });
        self.sorted.resize(all, Ray::new(Vec3::ZERO, Vec3::ZERO));
        for shadow in &self.shadows {
            let rank = &mut next[part_of(shadow)];
            self.sorted[*rank] = self.rays[shadow.question as usize];
            self.ranks.push(*rank as u32);
            *rank += 1;
        }
    }

    /// The questions of a light that gives them answers in columns; those of vertices beside edges are answered one by one.
    pub fn sort(&mut self, vertices: &Vertices) {
        if !self.are_gathered {
            self.columns.gather(&self.weights, vertices);
            self.are_gathered = true;
            self.are_shared = false;
        }
        if !self.are_shared {
            self.columns.share(&self.counts);
            self.beside_edges.clear();
            for (vertex, (&count, &first)) in self.counts.iter().zip(&self.firsts).enumerate() {
                if vertices.is_near_edge[vertex] {
                    self.beside_edges.extend(first..first + count);
                }
            }
            self.are_shared = true;
        }
        self.others.extend(&self.beside_edges);
    }

    /// Every vertex that light can add something to asks for so many points at a first hit, and for one later: their numbers
    /// go on from sample to sample of the pixel.
    pub fn ask(
        &mut self,
        vertices: &Vertices,
        at_first_hits: u32,
        samples: &[SampleId],
        pixels: &[u32],
    ) {
        if self.asked.replace(at_first_hits) == Some(at_first_hits) {
            return;
        }
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
        self.are_shared = false;
    }
}

/// The part of an edge of a light that a number in [0, 1) chooses a place on.
#[inline(always)]
fn part_along(x: f32) -> u32 {
    ((PARTS as f32 * x) as u32).min(PARTS - 1)
}

vectorized! {
    /// The parts of a light that numbers in [0, 1) choose points of. Those that follow each other lie beside each other.
    fn parts_of(u: &[f32], v: &[f32], parts: &mut [u32]) {
        let (u, v) = (&u[..parts.len()], &v[..parts.len()]);
        for i in 0..parts.len() {
            let (u, v) = (part_along(u[i]), part_along(v[i]));
            let u = if v % 2 == 0 { u } else { PARTS - 1 - u };
            parts[i] = PARTS * v + u;
        }
    }
}

/// From a surface to a light point, ending just before it.
pub(in crate::trace) fn shadow_ray(
    aggregate: &Aggregate,
    surface: &Surface,
    point: &LightPoint,
    time: f32,
) -> Ray {
    let origin = aggregate.leave(&surface.point, point.direction);
    let (direction, t_max) = if point.distance == f32::INFINITY {
        (point.direction, f32::INFINITY)
    } else {
        // From the moved origin to the light itself, so that the ray still ends there.
        let to_light = point.distance * point.direction - (origin - surface.point.position);
        (to_light, SHORT_OF_THE_LIGHT)
    };
    Ray {
        origin,
        direction,
        t_max,
        time,
        starts_on: surface.point.triangle,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::test_scene::Numbers;

    #[test]
    fn rays_to_a_part_of_a_light_stand_together_and_each_shadow_finds_its_own() {
        let mut numbers = Numbers(3);
        let sample = |x: u64, index| SampleId {
            pixel: glam::UVec2::new(x as u32, 0),
            index,
        };
        let of_one: Vec<_> = (0..16).map(|i| sample(0, i)).collect();
        let of_many: Vec<_> = (0..16).map(|i| sample(i / 8, i)).collect();
        for (count, has_extent, samples) in [
            (0, true, &of_one),
            (1, true, &of_one),
            (7, true, &of_one),
            (300, true, &of_one),
            (300, false, &of_one),
            (300, true, &of_many),
        ] {
            let mut shadow_rays = ShadowRays::default();
            shadow_rays.numbers.fill(2 * count, [0.0; 2]);
            for question in 0..2 * count {
                let ray = Ray::new(numbers.in_cube(), Vec3::Y);
                shadow_rays.rays.push(ray);
                shadow_rays.askers.push(0);
                let [u, v] = [numbers.next(), numbers.next()];
                (
                    shadow_rays.numbers.u[question],
                    shadow_rays.numbers.v[question],
                ) = (u, v);
                if question % 2 == 1 {
                    shadow_rays.shadows.push(Shadow {
                        sample: 0,
                        value: Vec3::ONE,
                        point: 0,
                        question: question as u32,
                        place: 0,
                    });
                }
            }
            shadow_rays.find_parts(has_extent, samples);
            shadow_rays.sort_rays();
            let is_sorted = has_extent && samples == &of_one;
            assert_eq!(!shadow_rays.parts.is_empty(), is_sorted && count > 0);
            assert_eq!(shadow_rays.sorted.len(), count);
            let mut parts = vec![None; count];
            for (shadow, &rank) in shadow_rays.shadows.iter().zip(&shadow_rays.ranks) {
                let question = shadow.question as usize;
                let own = shadow_rays.rays[question];
                assert_eq!(shadow_rays.sorted[rank as usize], own);
                let part = shadow_rays.parts.get(question).copied();
                assert_eq!(parts[rank as usize].replace(part.unwrap_or(0)), None);
            }
            assert!(parts.is_sorted() && parts.iter().all(Option::is_some));
            parts.dedup();
            let expected = if is_sorted { count.min(ALL_PARTS) } else { 1 };
            assert!(count < ALL_PARTS || parts.len() == expected, "{parts:?}");
        }
    }

    #[test]
    fn parts_of_a_light_that_follow_each_other_lie_beside_each_other() {
        let mut middles = [Vec3::ZERO; ALL_PARTS];
        for v in 0..PARTS {
            for u in 0..PARTS {
                let middle = [u, v].map(|part| (part as f32 + 0.5) / PARTS as f32);
                let mut part = [0];
                parts_of(&middle[..1], &middle[1..], &mut part);
                let of_part = &mut middles[part[0] as usize];
                assert_eq!(*of_part, Vec3::ZERO);
                *of_part = Vec3::new(u as f32, v as f32, 1.0);
            }
        }
        let beside = |pair: &[Vec3]| pair[0].distance(pair[1]) == 1.0;
        assert!(middles.windows(2).all(beside), "{middles:?}");
        let mut last = [0, 0];
        parts_of(&[1.0, 0.99], &[1.0, 0.99], &mut last);
        assert_eq!(last[0], last[1]);
    }
}

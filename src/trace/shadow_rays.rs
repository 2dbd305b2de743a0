//! What is on its way from vertices to points of one light.

use super::lights::LightPoint;
use super::numbers::{Asking, Pairs};
use super::questions::Columns;
use super::vectors::Vectors;
use super::vertices::Vertices;
use super::{SampleId, Surface};
use crate::bvh::{Aggregate, Ray, Transmittances};
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
    /// that finds out. Later the rays in front are those that are traced.
    pub values: Vec<Vec3>,
    pub rays: Vec<Ray>,
    /// Points of lights so far at this bounce, those that nothing comes from included: what tells them apart.
    pub points: u32,
    /// What each of the rays that are traced adds to which sample, if the light arrives, and the number of its point.
    pub shadows: Vec<Shadow>,
    pub occluded: Vec<bool>,
    /// How much of the light passes what lies on each ray, where anything lets light through.
    pub passing: Transmittances,
}

/// What a shadow ray adds to which sample, if the light arrives.
#[derive(Clone, Copy)]
pub(super) struct Shadow {
    pub sample: u32,
    pub value: Vec3,
    /// The number of the light's point.
    pub point: u32,
    /// The same among those of all lights for which the vertex may ask.
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

/// From a surface to a light point, ending just before it.
pub(super) fn shadow_ray(
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

//! Paths on their way through a scene: a stage's rays, and what is known of each besides.

use crate::bvh::{Hit, Ray};
use crate::trace::Cone;
use glam::Vec3;

/// Paths on their way: the next ray of each, and what is known of it besides.
#[derive(Default)]
pub(in crate::trace) struct Paths {
    pub rays: Vec<Ray>,
    /// One for each ray; none where all of them leave the camera, and so have [`Path::from_camera`].
    pub states: Vec<Path>,
    /// Those that go straight on behind a hit of the same ray, in order.
    pub straight: Vec<u32>,
}

impl Paths {
    pub fn clear(&mut self) {
        self.rays.clear();
        self.states.clear();
        self.straight.clear();
    }

    /// All leave the camera, along the rays that are put in place of those there are.
    pub fn of_camera(&mut self) -> &mut Vec<Ray> {
        self.states.clear();
        self.straight.clear();
        &mut self.rays
    }

    pub fn push(&mut self, ray: Ray, path: Path) {
        if path.after.is_some() {
            self.straight.push(self.rays.len() as u32);
        }
        self.rays.push(ray);
        self.states.push(path);
    }

    /// Whether each is the only one of its sample, and leaves a surface.
    pub fn are_one_of_a_sample(&self) -> bool {
        let mut pairs = self.states.windows(2);
        self.straight.is_empty() && pairs.all(|pair| pair[0].sample < pair[1].sample)
    }

    pub fn get(&self, i: usize, cone: Cone) -> Path {
        if self.states.is_empty() {
            Path::from_camera(i as u32, cone)
        } else {
            self.states[i]
        }
    }
}

/// What is known of a path besides its next ray.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Path {
    /// What the ray's radiance will be multiplied by.
    pub throughput: Vec3,
    pub cone: Cone,
    /// Index into the batch.
    pub sample: u32,
    /// Names this path among those of its sample, for its random numbers: 0 from the camera on.
    pub name: u32,
    /// Mirror bounces so far.
    pub bounces: u32,
    /// Scatterings in translucent surfaces so far.
    pub scatterings: u32,
    /// True until the first hit.
    pub first: bool,
    /// A straight continuation behind this hit of the same ray, instead of a ray from its start.
    pub after: Option<Hit>,
    /// Names the ray that goes straight on, hit after hit, among those of the batch, from 1 on; 0 before it does.
    pub crossing: u32,
}

impl Path {
    pub fn from_camera(sample: u32, cone: Cone) -> Self {
        Self {
            throughput: Vec3::ONE,
            cone,
            sample,
            name: 0,
            bounces: 0,
            scatterings: 0,
            first: true,
            after: None,
            crossing: 0,
        }
    }
}

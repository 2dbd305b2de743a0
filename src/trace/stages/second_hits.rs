//! What the rays that leave first hits meet, remembered from one evaluation of a sample to the next: while lights and
//! materials are edited a mirror mostly shows the same place again.

use crate::bvh::{Hit, Ray};
use bevy::platform::hash::FixedHasher;
use std::hash::BuildHasher;

/// What the ray that leaves a sample's first hit meets, as far as that was found out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondHit {
    /// The ray, as [`number`] names it; 0 where none was traced.
    ray: u64,
    hit: Option<Hit>,
}

impl SecondHit {
    /// Of a ray with this number, before it is traced: [`Self::found`] says what it hits.
    pub(in crate::trace) fn new(ray: u64) -> Self {
        Self { ray, hit: None }
    }

    pub(in crate::trace) fn found(&mut self, hit: Option<Hit>) {
        self.hit = hit;
    }

    /// What the ray with this number hits. `None` where that is not known.
    #[inline(always)]
    pub(in crate::trace) fn of(&self, ray: u64) -> Option<Option<Hit>> {
        (self.ray == ray).then_some(self.hit)
    }
}

/// A ray of a sample as a number that no other one of that sample is likely to have. It is never 0.
pub(in crate::trace) fn number(ray: &Ray) -> u64 {
    let bits = [ray.origin, ray.direction].map(|vector| vector.to_array().map(f32::to_bits));
    FixedHasher.hash_one((bits, ray.t_max.to_bits())) | 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TriangleId;
    use glam::Vec3;

    #[test]
    fn what_a_ray_hit_is_known_of_that_ray_alone() {
        let ray = |direction| Ray {
            origin: Vec3::ONE,
            direction,
            t_max: f32::INFINITY,
            time: 0.0,
            starts_on: TriangleId::NONE,
        };
        let [one, other] = [Vec3::X, Vec3::new(1.0, f32::MIN_POSITIVE, 0.0)].map(ray);
        let unknown = SecondHit::default();
        let missed = SecondHit::new(number(&one));
        assert_eq!(unknown.of(number(&one)), None);
        assert_eq!(missed.of(number(&one)), Some(None));
        assert_eq!(missed.of(number(&other)), None);
        let hit = Hit {
            t: 2.0,
            instance: 3,
            triangle: 4,
            u: 0.25,
            v: 0.5,
        };
        let mut hits = SecondHit::new(number(&other));
        hits.found(Some(hit));
        assert_eq!(hits.of(number(&other)), Some(Some(hit)));
    }
}

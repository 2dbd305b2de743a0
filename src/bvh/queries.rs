//! What a tracer asks: the nearest hit, any hit, the next hit, all hits. Answered from the wide form of the trees
//! ([`super::wide`]); [`super::watched`] answers the first two from the binary one.

use std::slice;

use super::{
    Aggregate,
    goal::{All, Nearest},
    order::Order,
    ray::{Hit, Ray},
    safe_ray::SafeRay,
};

impl Aggregate {
    /// The nearest hit; equal `t` by the smaller (instance, triangle).
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let mut closest = None;
        self.ask_closest(
            Order::None,
            slice::from_ref(ray),
            slice::from_mut(&mut closest),
        );
        closest
    }

    /// The nearest hit of every ray, in their order. `hits` is cleared first. Faster than one call a ray.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        self.closest_hits_in(Order::None, rays, hits);
    }

    /// The nearest hit of every ray, in their order, which is told. `hits` is cleared first. The order only matters for
    /// the time that it takes.
    pub fn closest_hits_in(&self, order: Order, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.resize(rays.len(), None);
        self.ask_closest(order, rays, hits);
    }

    /// Whether anything is hit in `0 < t < t_max`.
    pub fn occluded(&self, ray: &Ray) -> bool {
        let mut occluded = false;
        self.ask_any(
            Order::None,
            slice::from_ref(ray),
            slice::from_mut(&mut occluded),
        );
        occluded
    }

    /// Whether each ray is occluded, in their order. `occluded` is cleared first. Faster than one call a ray.
    pub fn occlusions(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        self.occlusions_in(Order::None, rays, occluded);
    }

    /// Whether each ray is occluded, in their order, which is told. `occluded` is cleared first. The order only matters
    /// for the time that it takes.
    pub fn occlusions_in(&self, order: Order, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.resize(rays.len(), false);
        self.ask_any(order, rays, occluded);
    }

    /// The next hit behind `after`, a hit of the same ray: the ray goes straight on through what it met, and meets every
    /// crossing exactly once, however close they lie. What lies before `after` is not walked again.
    pub fn closest_hit_after(&self, ray: &Ray, after: &Hit) -> Option<Hit> {
        let (ray, after) = SafeRay::from_hit(ray, after)?;
        let mut best = Best::NONE;
        self.ask_every::<Nearest>(&ray, |hit, limit| {
            if after.beats(&hit) {
                best.offer(hit, limit)
            } else {
                limit
            }
        });
        best.found(&ray)
    }

    /// Every hit with `0 < t < t_max`, nearest first, equal `t` by (instance, triangle). `hits` is cleared first; it
    /// is the only memory used.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let Some(ray) = SafeRay::new(ray) else {
            return;
        };
        self.ask_every::<All>(&ray, |hit, limit| {
            hits.push(ray.scaled(hit));
            limit
        });
        hits.sort_unstable_by(|a, b| {
            (a.t.total_cmp(&b.t)).then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
        });
    }
}

/// The nearest hit so far, in a [`SafeRay`]'s `t`.
pub(super) struct Best(pub(super) Hit);

impl Best {
    /// None yet: what any hit beats.
    pub(super) const NONE: Self = Self(Hit {
        t: f32::INFINITY,
        instance: u32::MAX,
        triangle: u32::MAX,
        u: 0.0,
        v: 0.0,
    });

    /// That hit.
    #[inline(always)]
    pub(super) fn of(hit: Hit) -> Self {
        Self(hit)
    }

    /// Takes a hit if it is nearer, and returns the `t` beyond which nothing matters any more.
    #[inline(always)]
    pub(super) fn offer(&mut self, hit: Hit, limit: f32) -> f32 {
        if hit.beats(&self.0) {
            self.0 = hit;
            hit.t
        } else {
            limit
        }
    }

    /// Whether this is the hit.
    #[inline(always)]
    pub(super) fn is(&self, hit: &Hit) -> bool {
        (self.0.instance, self.0.triangle) == (hit.instance, hit.triangle)
    }

    /// The hit, as the caller measures it.
    #[inline(always)]
    pub(super) fn found(&self, ray: &SafeRay) -> Option<Hit> {
        (self.0.instance != u32::MAX).then(|| ray.scaled(self.0))
    }
}

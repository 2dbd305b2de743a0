//! What a tracer asks: the nearest hit, any hit, the next hit, all hits. All are answered by one walk through the wide form
//! of the trees ([`crate::bvh::kernel::wide`]), which a [`Visitor`] may watch.

use crate::bvh::Aggregate;
use crate::bvh::kernel::goal::{All, Any, Behind, Nearest};
use crate::bvh::kernel::order::Order;
use crate::bvh::kernel::ray::{Hit, Ray};
use crate::bvh::kernel::safe_ray::SafeRay;
use crate::bvh::kernel::visitor::Visitor;

impl Aggregate {
    /// The nearest hit; equal `t` by the smaller (instance, triangle).
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit_with(ray, &mut ())
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
        self.occluded_with(ray, &mut ())
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
        self.closest_hit_after_with(ray, after, &mut ())
    }

    /// [`Self::closest_hit`], watched.
    pub fn closest_hit_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> Option<Hit> {
        let ray = SafeRay::new(ray)?;
        let mut goal = Nearest::NONE;
        self.pursue(&ray, &mut goal, visitor);
        goal.found(&ray.measure)
    }

    /// [`Self::closest_hit_after`], watched.
    pub fn closest_hit_after_with<V: Visitor>(
        &self,
        ray: &Ray,
        after: &Hit,
        visitor: &mut V,
    ) -> Option<Hit> {
        let (ray, after) = SafeRay::from_hit(ray, after)?;
        let nearest = Nearest::NONE;
        let mut goal = Behind { after, nearest };
        self.pursue(&ray, &mut goal, visitor);
        goal.nearest.found(&ray.measure)
    }

    /// [`Self::occluded`], watched.
    pub fn occluded_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> bool {
        let mut goal = Any::default();
        if let Some(ray) = SafeRay::new(ray) {
            self.pursue(&ray, &mut goal, visitor);
        }
        goal.is_hit
    }

    /// Every hit with `0 < t < t_max`, nearest first, equal `t` by (instance, triangle). `hits` is cleared first; it
    /// is the only memory used.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let Some(ray) = SafeRay::new(ray) else {
            return;
        };
        self.pursue(&ray, &mut All(hits), &mut ());
        for hit in hits.iter_mut() {
            *hit = ray.measure.scaled(*hit);
        }
        hits.sort_unstable_by(|a, b| {
            (a.t.total_cmp(&b.t)).then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
        });
    }
}

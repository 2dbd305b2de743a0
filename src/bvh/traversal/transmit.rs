//! How much of a light passes what lies on a ray: one walk a ray, whatever the number of layers.
//!
//! The walk meets crossings in no particular order, and a product of rounded numbers depends on theirs. So they are kept
//! until the walk is over, and multiplied nearest first, equal `t` by (instance, triangle): the product is the same to the
//! last bit for every tree, and that of going from crossing to crossing ([`Aggregate::next_crossing`]). What nothing passes
//! ends the walk, since the product is zero whatever else there is; so do so many layers that an `f32` has no digits left.

use glam::{DVec3, Vec3};

use crate::bvh::geometry::aggregate::Aggregate;
use crate::bvh::kernel::goal::{Goal, STOP};
use crate::bvh::kernel::order::Order;
use crate::bvh::kernel::ray::{Hit, Ray};
use crate::bvh::kernel::safe_ray::{Measure, SafeRay};
use crate::bvh::kernel::visitor::Visitor;

/// How much of a light passes on each ray of a batch, and the memory that finding it takes. Kept from batch to batch, so that
/// nothing is allocated once it has grown to its size.
#[derive(Debug, Default)]
pub struct Transmittances {
    pub(in crate::bvh) passing: Vec<Vec3>,
    /// Whether anything lies on a ray.
    pub(in crate::bvh) occluded: Vec<bool>,
    /// Those of one ray.
    pub(super) crossings: Vec<(Hit, Vec3)>,
}

impl Transmittances {
    /// Of each ray, in their order: in [0, 1] where nothing lets through more than arrives.
    pub fn get(&self) -> &[Vec3] {
        &self.passing
    }

    /// All of it, on so many rays.
    pub(in crate::bvh) fn reset(&mut self, rays: usize) {
        self.passing.clear();
        self.passing.resize(rays, Vec3::ONE);
    }
}

/// The part that passes: what `through` says of each crossing, multiplied.
pub(super) struct Transmit<'a> {
    aggregate: &'a Aggregate,
    measure: Measure,
    /// Called where it stands, so that the walk is not compiled for each caller: it looks up surfaces.
    through: &'a mut dyn FnMut(&Hit) -> Vec3,
    crossings: &'a mut Vec<(Hit, Vec3)>,
    /// The product of the crossings that surely count.
    left: DVec3,
    is_blocked: bool,
}

/// Far below the smallest `f32`, and far above what a product in `f64` may be off by.
const NOTHING: f64 = 1e-60;

impl<'a> Transmit<'a> {
    /// The crossings are cleared: they only lend their memory.
    #[inline(always)]
    pub(in crate::bvh) fn new(
        aggregate: &'a Aggregate,
        ray: &SafeRay,
        through: &'a mut dyn FnMut(&Hit) -> Vec3,
        crossings: &'a mut Vec<(Hit, Vec3)>,
    ) -> Self {
        crossings.clear();
        Self {
            aggregate,
            measure: ray.measure,
            through,
            crossings,
            left: DVec3::ONE,
            is_blocked: false,
        }
    }

    /// The product. Triangles that are crossed at once, on an edge or in a corner that they share, count once.
    #[inline(always)]
    pub(in crate::bvh) fn product(&mut self) -> Vec3 {
        if self.is_blocked {
            return Vec3::ZERO;
        }
        if self.crossings.is_empty() {
            return Vec3::ONE;
        }
        self.nearest_first()
    }

    fn nearest_first(&mut self) -> Vec3 {
        self.crossings.sort_unstable_by(|(a, _), (b, _)| {
            (a.t.total_cmp(&b.t)).then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
        });
        let mut product = Vec3::ONE;
        let mut last: Option<Hit> = None;
        for (hit, part) in self.crossings.iter() {
            let again = last.is_some_and(|last| self.aggregate.same_crossing(&last, hit));
            last = Some(*hit);
            if !again {
                product *= *part;
                // Below it a product may stay what it is for ever.
                if product.max_element() < f32::MIN_POSITIVE {
                    return Vec3::ZERO;
                }
            }
        }
        product
    }
}

impl Goal for Transmit<'_> {
    const NEAREST_FIRST: bool = false;
    const ANY: bool = false;
    const MAY_STOP: bool = true;

    #[inline(always)]
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        let part = (self.through)(&self.measure.scaled(hit));
        // What lies on an edge may be another triangle's crossing, which counts in its place.
        if !self.aggregate.is_on_an_edge(&hit) {
            self.left *= part.as_dvec3();
            if self.left.max_element() < NOTHING {
                self.is_blocked = true;
                return (true, STOP);
            }
        }
        self.crossings.push((hit, part));
        (true, limit)
    }
}

impl Aggregate {
    /// How much of a light passes on each ray, in their order, which is told: the product of what `through(ray, hit)`
    /// says of every crossing in `0 < t < t_max`, `ray` an index into `rays`. Triangles that are crossed on an edge or in a
    /// corner that they share count once. What `found` held is gone. `through` may be asked in any order, and of crossings
    /// that do not count; its answer, none of it below zero, may only depend on what it is asked.
    pub fn transmittances_in(
        &self,
        order: Order,
        rays: &[Ray],
        mut through: impl FnMut(usize, &Hit) -> Vec3,
        found: &mut Transmittances,
    ) {
        found.reset(rays.len());
        self.ask_transmittances(order, rays, &mut through, found);
    }

    /// [`Self::transmittances_in`] of one ray, watched.
    pub fn transmittance_with<V: Visitor>(
        &self,
        ray: &Ray,
        mut through: impl FnMut(&Hit) -> Vec3,
        visitor: &mut V,
    ) -> Vec3 {
        let Some(ray) = SafeRay::new(ray) else {
            return Vec3::ONE;
        };
        let mut crossings = Vec::new();
        let mut goal = Transmit::new(self, &ray, &mut through, &mut crossings);
        self.pursue(&ray, &mut goal, visitor);
        goal.product()
    }

    /// Every crossing on a ray, nearest first, as [`Self::next_crossing`] finds them one by one. `crossings` is cleared
    /// first; it is the only memory used.
    pub fn all_crossings(&self, ray: &Ray, crossings: &mut Vec<Hit>) {
        self.all_hits(ray, crossings);
        let mut last: Option<Hit> = None;
        crossings.retain(|hit| {
            let again = last.is_some_and(|last| self.same_crossing(&last, hit));
            last = Some(*hit);
            !again
        });
    }
}

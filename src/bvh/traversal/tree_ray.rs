//! A ray as walks ask for it: by itself, or as one of a [`Batch`](super::batch::Batch).

use crate::bvh::geometry::aggregate::Aggregate;
use crate::bvh::kernel::object_ray::ObjectRay;
use crate::bvh::kernel::ray::TriangleId;
use crate::bvh::kernel::safe_ray::{Measure, SafeRay};
use crate::bvh::kernel::triangle::Shear;
use crate::bvh::kernel::wide::{Eight, Sheared, Sight, WideRay};

/// A ray in the space of a tree over triangles.
pub(super) trait TreeRay {
    type Sight<'a>: Sight
    where
        Self: 'a;

    /// As boxes see it, from `start` on.
    fn wide<E: Eight>(&self, start: f32) -> WideRay<E>;

    /// As triangles see it.
    fn sight(&mut self) -> Self::Sight<'_>;
}

/// A ray by itself.
pub(in crate::bvh) struct LoneRay<'a> {
    ray: &'a ObjectRay,
    /// Made at the first leaf: many rays meet none.
    shear: Option<Shear>,
}

impl<'a> LoneRay<'a> {
    #[inline(always)]
    pub(in crate::bvh) fn new(ray: &'a ObjectRay) -> Self {
        Self { ray, shear: None }
    }
}

impl TreeRay for LoneRay<'_> {
    type Sight<'a>
        = Sheared<'a>
    where
        Self: 'a;

    #[inline(always)]
    fn wide<E: Eight>(&self, start: f32) -> WideRay<E> {
        WideRay::new(&self.ray.slab, start)
    }

    #[inline(always)]
    fn sight(&mut self) -> Sheared<'_> {
        let ray = self.ray;
        let shear = match &mut self.shear {
            Some(shear) => shear,
            none => none.insert(Shear::new(ray.origin, ray.direction)),
        };
        Sheared { ray, shear }
    }
}

/// A ray in the world, on its way through an aggregate.
pub(in crate::bvh) trait WorldRay {
    type InTree<'a>: TreeRay
    where
        Self: 'a;

    /// The same in a tree whose space is the world's.
    fn in_tree(&self) -> Self::InTree<'_>;

    /// As the boxes above all instances see it.
    fn at_top<E: Eight>(&self, aggregate: &Aggregate) -> WideRay<E>;

    fn world(&self) -> ObjectRay;

    /// Hits before this `t` are not asked for.
    fn start(&self) -> f32;

    /// Where it ends.
    fn end(&self) -> f32;

    /// When it is shot.
    fn time(&self) -> f32;

    /// How the caller measures it.
    fn measure(&self) -> Measure;

    /// The triangle that it starts on.
    fn starts_on(&self) -> TriangleId;
}

impl WorldRay for SafeRay {
    type InTree<'a> = LoneRay<'a>;

    #[inline(always)]
    fn in_tree(&self) -> LoneRay<'_> {
        LoneRay::new(&self.world)
    }

    #[inline(always)]
    fn at_top<E: Eight>(&self, aggregate: &Aggregate) -> WideRay<E> {
        let ObjectRay { origin, slab, .. } = self.world;
        let pad = origin.abs().max_element() * aggregate.ray_pad;
        WideRay::new(&slab.with_pad(origin, pad), self.start)
    }

    #[inline(always)]
    fn world(&self) -> ObjectRay {
        self.world
    }

    #[inline(always)]
    fn start(&self) -> f32 {
        self.start
    }

    #[inline(always)]
    fn end(&self) -> f32 {
        self.end
    }

    #[inline(always)]
    fn time(&self) -> f32 {
        self.time
    }

    #[inline(always)]
    fn measure(&self) -> Measure {
        self.measure
    }

    #[inline(always)]
    fn starts_on(&self) -> TriangleId {
        self.starts_on
    }
}

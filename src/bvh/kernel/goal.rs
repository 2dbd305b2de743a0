//! What a ray asks of the trees.

use super::{
    ray::{Hit, TriangleId},
    safe_ray::Measure,
    triangle::Crossing,
    visitor::Visitor,
};

/// A ray that ends here wants nothing more.
pub(crate) const STOP: f32 = f32::NEG_INFINITY;

/// What is wanted of the hits on a ray, and what is known so far. Their `t` is that of the
/// [`SafeRay`](super::safe_ray::SafeRay).
pub(crate) trait Goal {
    /// Whether nodes are walked in the order in which the ray enters them.
    const NEAREST_FIRST: bool;
    /// Whether it matters only that something is hit, and not where.
    const ANY: bool;
    /// Whether a ray may end before its way does.
    const MAY_STOP: bool;

    /// Takes a hit that lies on the ray, no farther than the limit. Returns whether it is wanted, and the new limit: the
    /// `t` beyond which nothing matters any more, or [`STOP`].
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32);
}

/// The nearest hit.
pub(crate) struct Nearest(pub(crate) Hit);

impl Nearest {
    /// None yet: what any hit beats.
    pub(crate) const NONE: Self = Self(Hit {
        t: f32::INFINITY,
        instance: u32::MAX,
        triangle: u32::MAX,
        u: 0.0,
        v: 0.0,
    });

    /// The hit, as the caller measures it.
    #[inline(always)]
    pub(crate) fn found(&self, measure: &Measure) -> Option<Hit> {
        (self.0.instance != u32::MAX).then(|| measure.scaled(self.0))
    }
}

impl Goal for Nearest {
    const NEAREST_FIRST: bool = true;
    const ANY: bool = false;
    const MAY_STOP: bool = false;

    #[inline(always)]
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        if hit.beats(&self.0) {
            self.0 = hit;
            (true, hit.t)
        } else {
            (false, limit)
        }
    }
}

/// The nearest hit behind another.
pub(crate) struct Behind {
    pub(crate) after: Hit,
    pub(crate) nearest: Nearest,
}

impl Goal for Behind {
    const NEAREST_FIRST: bool = true;
    const ANY: bool = false;
    const MAY_STOP: bool = false;

    #[inline(always)]
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        if self.after.beats(&hit) {
            self.nearest.meet(hit, limit)
        } else {
            (false, limit)
        }
    }
}

/// Whether there is a hit.
#[derive(Default)]
pub(crate) struct Any {
    pub(crate) is_hit: bool,
}

impl Goal for Any {
    const NEAREST_FIRST: bool = false;
    const ANY: bool = true;
    const MAY_STOP: bool = true;

    #[inline(always)]
    fn meet(&mut self, _: Hit, _: f32) -> (bool, f32) {
        self.is_hit = true;
        (true, STOP)
    }
}

/// Every hit, in no particular order.
pub(crate) struct All<'a>(pub(crate) &'a mut Vec<Hit>);

impl Goal for All<'_> {
    const NEAREST_FIRST: bool = false;
    const ANY: bool = false;
    const MAY_STOP: bool = false;

    #[inline(always)]
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        self.0.push(hit);
        (true, limit)
    }
}

/// A ray's goal on its way through the trees, and who watches.
pub(crate) struct Question<'a, G, V> {
    pub(crate) measure: Measure,
    /// The triangle that the ray starts on.
    pub(crate) starts_on: TriangleId,
    pub(crate) goal: &'a mut G,
    pub(crate) visitor: &'a mut V,
}

/// Whether a limit ends a ray.
#[inline(always)]
pub(crate) fn is_end<G: Goal>(limit: f32) -> bool {
    G::MAY_STOP && limit == STOP
}

impl<G: Goal, V: Visitor> Question<'_, G, V> {
    /// The number of the triangle of an instance that the ray starts on; no triangle's where it starts elsewhere.
    #[inline(always)]
    pub(crate) fn starts_on(&self, instance: u32) -> u32 {
        if self.starts_on.instance == instance {
            self.starts_on.triangle
        } else {
            TriangleId::NONE.triangle
        }
    }

    /// Takes a crossing with a triangle of an instance if it lies on the ray, no farther than the limit. Returns as
    /// [`Goal::meet`].
    #[inline(always)]
    pub(crate) fn meet(
        &mut self,
        (instance, triangle): (u32, u32),
        Crossing { t, u, v }: Crossing,
        limit: f32,
    ) -> (bool, f32) {
        if t <= limit && self.measure.reaches(t) {
            let hit = Hit {
                t,
                instance,
                triangle,
                u,
                v,
            };
            self.goal.meet(hit, limit)
        } else {
            (false, limit)
        }
    }
}

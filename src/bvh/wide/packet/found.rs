//! What the rays of a packet have found so far.

use crate::bvh::{goal::Goal, queries::Best, ray::Hit, traverse::STOP, wide::Lanes};

/// The lanes whose bits are set.
#[inline(always)]
pub(crate) fn lanes_of(mut bits: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        (bits != 0).then(|| {
            let lane = bits.trailing_zeros() as usize;
            bits &= bits - 1;
            lane
        })
    })
}

/// The nearest hits of a packet's rays, or which of them have any.
pub(crate) struct Found<L> {
    /// Where each ray ends.
    end: L,
    /// The `t` of its nearest hit, or where it ends.
    pub(super) limit: L,
    /// Edge functions of the triangle that it hits: those of corners 1 and 2, and the sum of all.
    pub(super) edges: [L; 3],
    /// The bits of numbers.
    pub(super) triangle: L,
    pub(super) instance: L,
    /// The rays that have hit something.
    pub(super) hit: u32,
    /// The rays that go on: all, unless any hit is enough.
    pub(crate) active: u32,
    /// The largest limit of them.
    pub(super) farthest: f32,
}

/// Where answers are put, ray by ray.
pub(crate) enum Answers<'a> {
    /// The nearest hits.
    Closest(&'a mut [Option<Hit>]),
    /// Whether there are any.
    Any(&'a mut [bool]),
}

impl Answers<'_> {
    /// The answer for one ray.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, hit: Option<Hit>) {
        match self {
            Self::Closest(closest) => closest[lane] = hit,
            Self::Any(any) => any[lane] = hit.is_some(),
        }
    }
}

impl<L: Lanes> Found<L> {
    /// Nothing, for rays that end there. Those that are not `active` are not asked for.
    #[inline(always)]
    pub(crate) fn nothing(end: L, active: u32) -> Self {
        let zero = L::splat(0.0);
        let mut found = Self {
            end,
            limit: end,
            edges: [zero; 3],
            triangle: zero,
            instance: zero,
            hit: 0,
            active,
            farthest: 0.0,
        };
        found.look_ahead();
        found
    }

    /// Finds the largest limit anew.
    #[inline(always)]
    pub(super) fn look_ahead(&mut self) {
        let nothing = L::splat(f32::NEG_INFINITY);
        self.farthest = L::select(L::mask(self.active), self.limit, nothing).largest();
    }

    /// A ray hit something, and any hit is enough.
    #[inline(always)]
    pub(super) fn end(&mut self, lanes: u32) {
        self.hit |= lanes;
        self.active &= !lanes;
    }

    /// One of the rays, to go on alone.
    #[inline(always)]
    pub(crate) fn alone(&self, lane: usize) -> Alone {
        let of = |column: L| column.to_array().as_ref()[lane];
        let limit = of(self.limit);
        let hit = Hit {
            t: limit,
            instance: of(self.instance).to_bits(),
            triangle: of(self.triangle).to_bits(),
            u: 0.0,
            v: 0.0,
        };
        let is_hit = self.hit >> lane & 1 == 1;
        Alone {
            lane,
            end: of(self.end),
            limit,
            best: if is_hit { Best::of(hit) } else { Best::NONE },
            is_new: false,
        }
    }

    /// What that ray has found.
    #[inline(always)]
    pub(crate) fn rejoin<G: Goal>(&mut self, alone: Alone) {
        if !alone.is_new {
            return;
        }
        let bit = 1 << alone.lane;
        if G::ANY {
            return self.end(bit);
        }
        let Best(hit) = alone.best;
        let mask = L::mask(bit);
        let put = |column: &mut L, x: f32| *column = L::select(mask, L::splat(x), *column);
        put(&mut self.limit, hit.t);
        put(&mut self.edges[0], hit.u);
        put(&mut self.edges[1], hit.v);
        put(&mut self.edges[2], 1.0);
        put(&mut self.triangle, f32::from_bits(hit.triangle));
        put(&mut self.instance, f32::from_bits(hit.instance));
        self.hit |= bit;
        self.look_ahead();
    }

    /// Writes the answers down.
    #[inline(always)]
    pub(crate) fn write(&self, answers: &mut Answers<'_>) {
        match answers {
            Answers::Any(any) => lanes_of(self.hit).for_each(|lane| any[lane] = true),
            Answers::Closest(closest) if self.hit != 0 => {
                let inverse = L::splat(1.0).div(self.edges[2]);
                let [u, v] = [self.edges[0].mul(inverse), self.edges[1].mul(inverse)];
                let [t, u, v] = [self.limit, u, v].map(L::to_array);
                let [triangle, instance] = [self.triangle, self.instance].map(L::to_array);
                for lane in lanes_of(self.hit) {
                    closest[lane] = Some(Hit {
                        t: t.as_ref()[lane],
                        instance: instance.as_ref()[lane].to_bits(),
                        triangle: triangle.as_ref()[lane].to_bits(),
                        u: u.as_ref()[lane],
                        v: v.as_ref()[lane],
                    });
                }
            }
            Answers::Closest(_) => {}
        }
    }
}

/// A ray of a packet that goes on alone.
pub(crate) struct Alone {
    lane: usize,
    end: f32,
    /// Beyond this nothing matters.
    pub(crate) limit: f32,
    best: Best,
    is_new: bool,
}

impl Alone {
    /// Takes a hit if it lies on the ray and is nearer; the new limit, or [`STOP`] where any hit is enough.
    #[inline(always)]
    pub(crate) fn offer<G: Goal>(&mut self, hit: Hit, limit: f32) -> f32 {
        if !(hit.t > 0.0 && hit.t < self.end && hit.t <= limit) {
            return limit;
        }
        if G::ANY {
            self.is_new = true;
            return STOP;
        }
        let new = self.best.offer(hit, limit);
        self.is_new |= self.best.is(&hit);
        new
    }
}

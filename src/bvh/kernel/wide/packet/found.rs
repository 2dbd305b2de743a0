//! What the rays of a packet have found so far.

use std::marker::PhantomData;

use super::super::super::goal::{Goal, Nearest, Question, STOP};
use super::super::super::ray::{Hit, TriangleId};
use super::super::super::safe_ray::Measure;
use super::super::Lanes;

/// The lanes whose bits are set.
#[inline(always)]
pub(crate) fn lanes_of(bits: u32) -> LanesOf {
    LanesOf(bits)
}

/// [`lanes_of`].
pub(crate) struct LanesOf(u32);

impl Iterator for LanesOf {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

/// One lane.
#[inline(always)]
fn number<L: Lanes>(lanes: L, lane: usize) -> f32 {
    lanes.to_array().as_ref()[lane]
}

/// Puts a number into the lanes that the mask names.
#[inline(always)]
fn put<L: Lanes>(lanes: &mut L, mask: L::Mask, x: f32) {
    *lanes = L::select(mask, L::splat(x), *lanes);
}

/// The nearest hits of a packet's rays, or which of them have any.
pub(crate) struct Found<L> {
    /// Where each ray ends.
    end: L,
    /// The triangle that it starts on: the bits of its instance's number and of its own. `None` where no ray does.
    starts_on: Option<[L; 2]>,
    /// The `t` of its nearest hit, or where it ends.
    pub(super) limit: L,
    /// Edge functions of the triangle that it hits: those of corners 1 and 2, and the sum of all.
    pub(super) edges: [L; 3],
    /// The bits of numbers.
    pub(super) triangle: L,
    pub(super) instance: L,
    /// The rays that have hit something.
    pub(super) hit: u32,
    /// The rays that are on their way: all of a group, unless any hit is enough.
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

impl<L: Lanes> Found<L> {
    /// Nothing, for rays that end there and start on those triangles: the bits of instances' numbers and of their own.
    #[inline(always)]
    pub(crate) fn nothing(end: L, starts_on: Option<[L; 2]>) -> Self {
        let zero = L::splat(0.0);
        Self {
            end,
            starts_on,
            limit: end,
            edges: [zero; 3],
            triangle: zero,
            instance: zero,
            hit: 0,
            active: 0,
            farthest: 0.0,
        }
    }

    /// The rays that start on that triangle.
    #[inline(always)]
    pub(super) fn starting_on(&self, of: TriangleId) -> u32 {
        let Some([instance, triangle]) = self.starts_on else {
            return 0;
        };
        let bits = |number: u32| L::splat(f32::from_bits(number));
        L::bits(L::and(
            instance.same_bits(bits(of.instance)),
            triangle.same_bits(bits(of.triangle)),
        ))
    }

    /// A group of rays sets out that has not done so before.
    #[inline(always)]
    pub(crate) fn begin(&mut self, lanes: u32) {
        self.active = lanes;
        self.look_ahead();
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
    pub(crate) fn alone<G>(&self, lane: usize) -> Alone<G> {
        let limit = number(self.limit, lane);
        let hit = Hit {
            t: limit,
            instance: number(self.instance, lane).to_bits(),
            triangle: number(self.triangle, lane).to_bits(),
            u: 0.0,
            v: 0.0,
        };
        let is_hit = self.hit >> lane & 1 == 1;
        Alone {
            lane,
            end: number(self.end, lane),
            starts_on: (self.starts_on).map_or(TriangleId::NONE, |[instance, triangle]| {
                TriangleId {
                    instance: number(instance, lane).to_bits(),
                    triangle: number(triangle, lane).to_bits(),
                }
            }),
            limit,
            best: if is_hit { Nearest(hit) } else { Nearest::NONE },
            is_new: false,
            goal: PhantomData,
        }
    }

    /// What that ray has found.
    #[inline(always)]
    pub(crate) fn rejoin<G: Goal>(&mut self, alone: Alone<G>) {
        if !alone.is_new {
            return;
        }
        let bit = 1 << alone.lane;
        if G::ANY {
            return self.end(bit);
        }
        let Nearest(hit) = alone.best;
        let mask = L::mask(bit);
        put(&mut self.limit, mask, hit.t);
        put(&mut self.edges[0], mask, hit.u);
        put(&mut self.edges[1], mask, hit.v);
        put(&mut self.edges[2], mask, 1.0);
        put(&mut self.triangle, mask, f32::from_bits(hit.triangle));
        put(&mut self.instance, mask, f32::from_bits(hit.instance));
        self.hit |= bit;
        self.look_ahead();
    }

    /// Writes the answers down.
    #[inline(always)]
    pub(crate) fn write(&self, answers: &mut Answers<'_>) {
        match answers {
            Answers::Any(any) => {
                for lane in lanes_of(self.hit) {
                    any[lane] = true;
                }
            }
            Answers::Closest(closest) if self.hit != 0 => {
                let inverse = L::splat(1.0).div(self.edges[2]);
                // As single rays do, which makes a zero positive.
                let zero = L::splat(0.0);
                let u = self.edges[0].mul(inverse).add(zero).to_array();
                let v = self.edges[1].mul(inverse).add(zero).to_array();
                let t = self.limit.to_array();
                let (triangle, instance) = (self.triangle.to_array(), self.instance.to_array());
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

/// A ray of a packet that goes on alone, with the packet's goal.
pub(crate) struct Alone<G> {
    lane: usize,
    end: f32,
    starts_on: TriangleId,
    /// Beyond this nothing matters.
    pub(crate) limit: f32,
    best: Nearest,
    is_new: bool,
    goal: PhantomData<G>,
}

impl<G: Goal> Alone<G> {
    /// What it asks for, as single rays do. A packet's rays are safe as they are.
    #[inline(always)]
    pub(crate) fn question<'a, V>(&'a mut self, visitor: &'a mut V) -> Question<'a, Self, V> {
        Question {
            measure: Measure::unscaled(self.end),
            starts_on: self.starts_on,
            goal: self,
            visitor,
        }
    }
}

impl<G: Goal> Goal for Alone<G> {
    const NEAREST_FIRST: bool = G::NEAREST_FIRST;
    const ANY: bool = G::ANY;
    const MAY_STOP: bool = G::ANY;

    #[inline(always)]
    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        if G::ANY {
            self.is_new = true;
            return (true, STOP);
        }
        let (is_wanted, limit) = self.best.meet(hit, limit);
        self.is_new |= is_wanted;
        (is_wanted, limit)
    }
}

//! Many crossings of a ray that goes straight on, several of them found in one walk (Gribble, Naveros, Kerzner, "Multi-Hit
//! Ray Traversal", Journal of Computer Graphics Techniques 3(1), 2014).
//!
//! A walk from one crossing to the next enters every box that the ray has not left yet. Of sheets that lie across the ray
//! these are few; of slanted ones, whose boxes overlap, all the others: crossing by crossing n of them cost n². So who has
//! crossed some asks for as many again at once.

use std::{cmp::Ordering, collections::BinaryHeap};

use crate::bvh::kernel::goal::Goal;
use crate::bvh::kernel::safe_ray::SafeRay;
use crate::bvh::{Aggregate, Hit, Ray, Visitor};

/// So many crossings are found one by one. Most rays end before: in something opaque, or since little is left of them.
const ONE_BY_ONE: usize = 16;
/// The most that are found at once: they are kept, and rays wait by the thousand.
const MOST_AT_ONCE: usize = 512;

/// A ray on its way through what it crosses, and the crossings that were found before they are asked for.
#[derive(Debug, Default)]
pub struct MultiHit {
    /// The ray, and the crossing that it was at last.
    at: Option<(Ray, Hit)>,
    crossed: usize,
    /// Those behind that one, the nearest last.
    ahead: Vec<Farther>,
    /// Whether nothing is behind those.
    is_all: bool,
}

impl MultiHit {
    /// The next crossing behind `after`, a hit of the same ray: that of [`Aggregate::next_crossing`], to the last bit.
    /// Whoever asks for one after the other, of an aggregate that stays the same, pays less for many.
    pub fn next_crossing<V: Visitor>(
        &mut self,
        aggregate: &Aggregate,
        ray: &Ray,
        after: &Hit,
        visitor: &mut V,
    ) -> Option<Hit> {
        if self.at != Some((*ray, *after)) {
            self.forget();
        }
        self.crossed += 1;
        let found = if self.crossed <= ONE_BY_ONE {
            aggregate.next_crossing_with(ray, after, visitor)
        } else {
            if self.ahead.is_empty() && !self.is_all {
                let most = self.crossed.next_power_of_two() / 2;
                self.look_ahead(aggregate, ray, after, most.min(MOST_AT_ONCE), visitor);
            }
            self.ahead.pop().map(|Farther(hit)| hit)
        };
        self.at = found.map(|hit| (*ray, hit));
        found
    }

    /// Of another aggregate, or of one that was changed, nothing is known.
    pub fn forget(&mut self) {
        self.at = None;
        self.crossed = 0;
        self.ahead.clear();
        self.is_all = false;
    }

    fn look_ahead<V: Visitor>(
        &mut self,
        aggregate: &Aggregate,
        ray: &Ray,
        after: &Hit,
        most: usize,
        visitor: &mut V,
    ) {
        let mut last = *after;
        while self.ahead.is_empty() && !self.is_all {
            let found = std::mem::take(&mut self.ahead);
            self.ahead = aggregate.hits_behind(ray, &last, most, found, visitor);
            self.is_all = self.ahead.len() < most;
            self.ahead.retain(|Farther(hit)| {
                let again = aggregate.same_crossing(&last, hit);
                last = *hit;
                !again
            });
        }
        self.ahead.reverse();
    }
}

impl Aggregate {
    /// The nearest hits behind `after`, a hit of the same ray, `most` of them or as many as there are, nearest first.
    /// `found` is empty, and only lends its memory.
    fn hits_behind<V: Visitor>(
        &self,
        ray: &Ray,
        after: &Hit,
        most: usize,
        found: Vec<Farther>,
        visitor: &mut V,
    ) -> Vec<Farther> {
        let Some((ray, after)) = SafeRay::from_hit(ray, after) else {
            return found;
        };
        let mut nearest = BinaryHeap::from(found);
        let mut goal = Several {
            after,
            most,
            nearest: &mut nearest,
        };
        self.pursue(&ray, &mut goal, visitor);
        let mut found = nearest.into_sorted_vec();
        for Farther(hit) in &mut found {
            *hit = ray.measure.scaled(*hit);
        }
        found
    }
}

/// The nearest hits behind another, so many at most.
struct Several<'a> {
    after: Hit,
    most: usize,
    nearest: &'a mut BinaryHeap<Farther>,
}

impl Goal for Several<'_> {
    const NEAREST_FIRST: bool = true;
    const ANY: bool = false;
    const MAY_STOP: bool = false;

    fn meet(&mut self, hit: Hit, limit: f32) -> (bool, f32) {
        if !self.after.beats(&hit) {
            return (false, limit);
        }
        if self.nearest.len() < self.most {
            self.nearest.push(Farther(hit));
        } else if let Some(mut farthest) = self.nearest.peek_mut()
            && hit.beats(&farthest.0)
        {
            *farthest = Farther(hit);
        } else {
            return (false, limit);
        }
        let is_full = self.nearest.len() == self.most;
        let farthest = self.nearest.peek().filter(|_| is_full);
        (true, farthest.map_or(limit, |Farther(hit)| hit.t))
    }
}

/// A hit that is greater the farther away it is: equal `t` by (instance, triangle).
#[derive(Clone, Copy, Debug)]
struct Farther(Hit);

impl Ord for Farther {
    fn cmp(&self, Self(other): &Self) -> Ordering {
        let id = |hit: &Hit| (hit.instance, hit.triangle);
        (self.0.t.total_cmp(&other.t)).then_with(|| id(&self.0).cmp(&id(other)))
    }
}

impl PartialOrd for Farther {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Farther {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Farther {}

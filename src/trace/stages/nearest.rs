//! What the rays of a bounce hit: all of them together, those behind a hit one by one, and those of which it is known from
//! before not at all.

use super::paths::Paths;
use super::radiance::Batch;
use super::recorder::Recorder;
use super::second_hits::{SecondHit, number};
use crate::bvh::{Hit, MultiHit, Order, Ray};

/// Rays that go on behind a hit are asked one by one, all others together: their numbers, the rays and what they hit.
#[derive(Default)]
pub(super) struct Behind {
    others: Vec<u32>,
    rays: Vec<Ray>,
    hits: Vec<Option<Hit>>,
    /// Of each ray that goes on, by [`Path::crossing`](super::paths::Path::crossing) and no more than [`MOST_CROSSING`]: those
    /// share them.
    crossing: Vec<MultiHit>,
}

/// They are kept, each with what lies behind it.
const MOST_CROSSING: usize = 1 << 13;

impl Behind {
    /// A batch begins, perhaps in another world.
    pub fn begin(&mut self) {
        self.crossing.iter_mut().for_each(MultiHit::forget);
    }
}

impl<R: Recorder> Batch<'_, R> {
    /// What every path's ray hits, where that is not known.
    pub(super) fn find_hits(
        &mut self,
        paths: &Paths,
        hits: &mut Vec<Option<Hit>>,
        behind: &mut Behind,
    ) {
        if paths.states.is_empty() && !self.known.has_camera_hits() {
            self.counts.camera += paths.rays.len() as u64;
        }
        if let Some(known) = self.known.take_hits() {
            self.find_other_hits(paths, known, hits, behind);
        } else if !self.known.has_camera_hits() {
            self.find_nearest(paths, hits, behind);
        }
    }

    fn find_nearest(&self, paths: &Paths, hits: &mut Vec<Option<Hit>>, behind: &mut Behind) {
        let aggregate = &self.world.aggregate;
        if paths.straight.is_empty() {
            aggregate.closest_hits_in(self.order(paths), &paths.rays, hits);
            return;
        }
        let is_straight = |i: usize| paths.states[i].after.is_some();
        let others = (0..paths.rays.len()).filter(|&i| !is_straight(i));
        behind.others.clear();
        behind.others.extend(others.map(|i| i as u32));
        behind.rays.clear();
        behind
            .rays
            .extend(behind.others.iter().map(|&i| paths.rays[i as usize]));
        aggregate.closest_hits_in(self.order(paths), &behind.rays, &mut behind.hits);
        hits.clear();
        hits.resize(paths.rays.len(), None);
        for (&i, hit) in behind.others.iter().zip(&behind.hits) {
            hits[i as usize] = *hit;
        }
        let crossing = &mut behind.crossing;
        let count = (self.crossings as usize).min(MOST_CROSSING);
        if crossing.len() < count {
            crossing.resize_with(count, MultiHit::default);
        }
        for &i in &paths.straight {
            let (ray, path) = (&paths.rays[i as usize], &paths.states[i as usize]);
            let crossing = &mut crossing[path.crossing as usize % count];
            hits[i as usize] = (path.after)
                .and_then(|after| crossing.next_crossing(aggregate, ray, &after, &mut ()));
        }
    }

    /// The same where it is `known` of some samples, of which one ray goes on each: the others' is known then.
    fn find_other_hits(
        &mut self,
        paths: &Paths,
        known: &mut [SecondHit],
        hits: &mut Vec<Option<Hit>>,
        behind: &mut Behind,
    ) {
        hits.clear();
        behind.others.clear();
        behind.rays.clear();
        for (i, (ray, path)) in paths.rays.iter().zip(&paths.states).enumerate() {
            let number = number(ray);
            let kept = &mut known[path.sample as usize];
            let hit = kept.of(number);
            if hit.is_some() {
                let counts = &mut self.counts;
                *if path.bounces > 0 {
                    &mut counts.mirror
                } else {
                    &mut counts.transmission
                } -= 1;
            } else {
                behind.others.push(i as u32);
                behind.rays.push(*ray);
                *kept = SecondHit::new(number);
            }
            hits.push(hit.flatten());
        }
        let order = self.order(paths);
        let aggregate = &self.world.aggregate;
        aggregate.closest_hits_in(order, &behind.rays, &mut behind.hits);
        for (&i, hit) in behind.others.iter().zip(&behind.hits) {
            hits[i as usize] = *hit;
            known[paths.states[i as usize].sample as usize].found(*hit);
        }
        if !behind.others.is_empty() {
            self.known.found_hits();
        }
    }

    /// How rays follow each other. Those of neighbouring pixels are neighbours, and their mirrored ones often are.
    fn order(&self, paths: &Paths) -> Order {
        let features = &self.settings.features;
        let is_scattered = features.glossy || features.translucency;
        if paths.states.is_empty() || !is_scattered {
            Order::Tile
        } else {
            Order::None
        }
    }
}

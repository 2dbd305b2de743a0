//! Many rays on all threads; what they find does not depend on how many there are.

use crate::bvh::hard_cases::oracle::Tally;
use crate::bvh::hard_cases::random::Random;
use crate::bvh::{Aggregate, Ray};
use rayon::prelude::*;

/// Rays that one random generator makes, at most.
const CHUNK: usize = 20_000;

/// Splits `rays` into pieces with a generator each, and gives what each piece came to.
pub(super) fn pieces<T: Send>(
    rays: usize,
    seed: u64,
    work: impl Fn(&mut Random, usize) -> T + Sync,
) -> Vec<T> {
    // As many pieces whatever the threads, so that the rays are the same.
    let chunk = rays.div_ceil(64).clamp(1, CHUNK);
    (0..rays.div_ceil(chunk))
        .into_par_iter()
        .map(|piece| {
            let count = chunk.min(rays - piece * chunk);
            let mut random = Random::new((seed << 32) + piece as u64 + 1);
            work(&mut random, count)
        })
        .collect()
}

/// How many of these rays something is true for.
pub(super) fn count(rays: usize, seed: u64, holds: impl Fn(&mut Random) -> bool + Sync) -> usize {
    let counts = pieces(rays, seed, |random, count| {
        (0..count).filter(|_| holds(random)).count()
    });
    counts.into_iter().sum()
}

/// Both oracles on so many rays.
pub(super) fn tally(
    aggregate: &Aggregate,
    rays: usize,
    seed: u64,
    ray: impl Fn(&mut Random) -> Ray + Sync,
) -> Tally {
    let mut sum = Tally::default();
    let tallies = pieces(rays, seed, |random, count| {
        Tally::of(aggregate, (0..count).map(|_| ray(random)))
    });
    tallies.into_iter().for_each(|tally| sum.add(tally));
    sum
}

//! Million rays a second.

use super::Kernel;
use super::rays::{CLASSES, RaySets};
use crate::report::Options;
use crate::report::timing::{median, seconds};
use std::hint::black_box;

/// Rays that are handed over together, as the tracer does.
pub(super) const BATCH: usize = 4096;

/// Rounds that are counted.
pub(super) fn rounds(options: &Options) -> usize {
    if options.quick { 3 } else { 7 }
}

/// Of each kernel and each kind of rays; not a number where the scene has no such ray.
pub(super) fn speeds(
    kernels: &[Box<dyn Kernel>],
    rays: &RaySets,
    options: &Options,
    progress: &dyn Fn(u64, u64),
) -> Vec<[f64; CLASSES.len()]> {
    let rounds = rounds(options);
    let mut times = vec![vec![Vec::with_capacity(rounds); CLASSES.len()]; kernels.len()];
    let (mut found, mut occluded) = (Vec::new(), Vec::new());
    let all = (kernels.len() * (rounds + 1)) as u64;
    for round in 0..=rounds {
        for (number, (kernel, times)) in kernels.iter().zip(&mut times).enumerate() {
            for (class, times) in times.iter_mut().enumerate() {
                let time = seconds(|| match rays.closest.get(class) {
                    Some(rays) => rays.chunks(BATCH).for_each(|rays| {
                        kernel.closest(rays, &mut found);
                        black_box(&found);
                    }),
                    None => rays.shadow.chunks(BATCH).for_each(|rays| {
                        kernel.occluded(rays, &mut occluded);
                        black_box(&occluded);
                    }),
                });
                // The first round warms caches.
                if round > 0 {
                    times.push(time);
                }
            }
            progress((round * kernels.len() + number + 1) as u64, all);
        }
    }
    let counts = [
        rays.closest[0].len(),
        rays.closest[1].len(),
        rays.closest[2].len(),
        rays.shadow.len(),
    ];
    times
        .into_iter()
        .map(|times| {
            let mut speeds = [f64::NAN; CLASSES.len()];
            for ((speed, times), count) in speeds.iter_mut().zip(times).zip(counts) {
                if count > 0 {
                    *speed = count as f64 / median(times) / 1e6;
                }
            }
            speeds
        })
        .collect()
}

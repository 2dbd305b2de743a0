//! How fast a view's own rays are answered.

use crate::bvh::{Aggregate, Ray};
use crate::scene::RenderSettings;
use crate::trace::{Camera, RayKind, Samples, World, probe};
use glam::UVec2;
use serde::Serialize;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Speed on a view's own rays: one thread, the queries that a render makes, with the scene's own
/// levels of trees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BuilderRates {
    /// Million closest hits a second; `None` where the view has no such ray.
    pub closest_mrays_per_s: Option<f64>,
    /// Million occlusion tests a second; `None` where the view has no such ray.
    pub occlusion_mrays_per_s: Option<f64>,
}

/// Pixels along each side of the grid whose rays are timed.
const GRID: u32 = 24;

/// A measurement takes at least this long, or all rays.
const LEAST: Duration = Duration::from_millis(4);

/// Measurements of each builder, taking turns; the middle one counts.
const ROUNDS: usize = 5;

/// How often [`ViewRays::rates`] asks whether to go on: before each round, of either query.
pub(super) const STEPS: usize = 2 * (1 + ROUNDS);

/// Rays of a view, by the query that a render makes with them.
pub(super) struct ViewRays {
    closest: Vec<Ray>,
    occlusion: Vec<Ray>,
}

impl ViewRays {
    /// Those of the first sample of a grid of pixels. Straight continuations are left out: their
    /// query is another.
    pub fn of(world: &World, camera: &Camera, settings: &RenderSettings) -> Self {
        let mut rays = Self {
            closest: Vec::new(),
            occlusion: Vec::new(),
        };
        for i in 0..GRID * GRID {
            let cell = UVec2::new(i % GRID, i / GRID);
            let pixel = (2 * cell + UVec2::ONE) * settings.size / (2 * GRID);
            let Ok(tree) = probe(world, camera, settings, pixel, &Samples::One(0)) else {
                continue;
            };
            for ray in tree.rays.iter().filter(|ray| ray.end.is_traced()) {
                match ray.kind {
                    RayKind::Transmission => {}
                    kind if kind.is_for_light() => rays.occlusion.push(ray.ray()),
                    _ => rays.closest.push(ray.ray()),
                }
            }
        }
        rays
    }

    /// Of each aggregate. `go_on` is asked before each round.
    pub fn rates(
        &self,
        aggregates: &[Arc<Aggregate>],
        go_on: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> ControlFlow<(), Vec<BuilderRates>> {
        let mut hits = Vec::new();
        let closest = rates(&self.closest, aggregates, go_on, |aggregate, rays| {
            aggregate.closest_hits(rays, &mut hits);
        })?;
        let mut occluded = Vec::new();
        let occlusion = rates(&self.occlusion, aggregates, go_on, |aggregate, rays| {
            aggregate.occlusions(rays, &mut occluded);
        })?;
        let both = closest.into_iter().zip(occlusion);
        ControlFlow::Continue(
            both.map(
                |(closest_mrays_per_s, occlusion_mrays_per_s)| BuilderRates {
                    closest_mrays_per_s,
                    occlusion_mrays_per_s,
                },
            )
            .collect(),
        )
    }
}

/// Million rays a second of each aggregate.
fn rates(
    rays: &[Ray],
    aggregates: &[Arc<Aggregate>],
    go_on: &mut dyn FnMut() -> ControlFlow<()>,
    mut trace: impl FnMut(&Aggregate, &[Ray]),
) -> ControlFlow<(), Vec<Option<f64>>> {
    if rays.is_empty() {
        return ControlFlow::Continue(vec![None; aggregates.len()]);
    }
    let mut seconds = |aggregate: &Aggregate, count: usize| {
        let start = Instant::now();
        let mut left = count;
        while left > 0 {
            let part = left.min(rays.len());
            trace(aggregate, &rays[..part]);
            left -= part;
        }
        start.elapsed()
    };
    // As many rays as take long enough; a power of two times a few.
    go_on()?;
    let counts: Vec<usize> = aggregates
        .iter()
        .map(|aggregate| {
            let mut count = 16;
            while seconds(aggregate, count) < LEAST && count < 1 << 24 {
                count *= 2;
            }
            count
        })
        .collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); aggregates.len()];
    for _ in 0..ROUNDS {
        go_on()?;
        for (i, aggregate) in aggregates.iter().enumerate() {
            let took = seconds(aggregate, counts[i]).as_secs_f64();
            measured[i].push(counts[i] as f64 / took.max(1e-9) / 1e6);
        }
    }
    let middle = measured.into_iter().map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        Some(rates[ROUNDS / 2])
    });
    ControlFlow::Continue(middle.collect())
}

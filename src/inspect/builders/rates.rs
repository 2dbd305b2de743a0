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

/// A measurement takes at least this long.
const LEAST: Duration = Duration::from_millis(4);

/// Of a slow tree so few rays of the view are timed, if they take that long.
const FEWEST: usize = 16;

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

/// Rays from all over the view, and how often each of them is traced: whole passes, so that no part of the view counts more
/// than another.
struct Load {
    rays: Vec<Ray>,
    passes: usize,
}

impl Load {
    /// The fewest, by powers of two, that are enough.
    fn of(rays: &[Ray], mut is_enough: impl FnMut(&Self) -> bool) -> Self {
        let mut every = (rays.len() / FEWEST).max(1);
        let mut passes = 1;
        loop {
            let load = Self {
                rays: rays.iter().step_by(every).copied().collect(),
                passes,
            };
            if is_enough(&load) || load.count() >= 1 << 24 {
                return load;
            }
            match every {
                1 => passes *= 2,
                _ => every /= 2,
            }
        }
    }

    fn count(&self) -> usize {
        self.rays.len() * self.passes
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
    let mut seconds = |aggregate: &Aggregate, load: &Load| {
        let start = Instant::now();
        (0..load.passes).for_each(|_| trace(aggregate, &load.rays));
        start.elapsed()
    };
    go_on()?;
    let loads: Vec<Load> = aggregates
        .iter()
        .map(|aggregate| Load::of(rays, |load| seconds(aggregate, load) >= LEAST))
        .collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); aggregates.len()];
    for round in 0..ROUNDS {
        go_on()?;
        // Who comes first in one round comes last in the next.
        for turn in 0..aggregates.len() {
            let i = (turn + round) % aggregates.len();
            let took = seconds(&aggregates[i], &loads[i]).as_secs_f64();
            measured[i].push(loads[i].count() as f64 / took.max(1e-9) / 1e6);
        }
    }
    let middle = measured.into_iter().map(|mut rates| {
        rates.sort_by(f64::total_cmp);
        Some(rates[ROUNDS / 2])
    });
    ControlFlow::Continue(middle.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn what_is_timed_is_from_all_over_the_view_in_whole_passes() {
        let rays: Vec<Ray> = (0..100)
            .map(|i| Ray::new(Vec3::X * i as f32, Vec3::Z))
            .collect();
        let load = |least: usize| Load::of(&rays, |load| load.count() >= least);
        for (least, count, passes) in [
            (1, 17, 1),
            (18, 34, 1),
            (40, 100, 1),
            (101, 100, 2),
            (500, 100, 8),
        ] {
            let load = load(least);
            assert_eq!((load.rays.len(), load.passes), (count, passes), "{least}");
            assert!(load.rays[count - 1].origin.x >= 95.0, "{least}");
        }
        let one = Load::of(&rays[..1], |load| load.passes > 2);
        assert_eq!((one.rays.len(), one.passes), (1, 4));
    }
}

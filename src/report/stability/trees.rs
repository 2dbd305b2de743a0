//! Trees that are hard to build or to walk.

use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::{alone, soup};
use crate::bvh::hard_cases::oracle::{brute, same};
use crate::bvh::{Aggregate, BuildOptions, Builder, Counters, MAX_DEPTH, Ray, TreeStats};
use crate::report::table::digits;
use glam::Vec3;
use std::time::{Duration, Instant};

const BUILDERS: [Builder; 3] = [Builder::Median, Builder::Sah, Builder::Ploc];

fn built(scene: &Aggregate) -> (TreeStats, Duration) {
    let mesh = &scene.instances()[0].mesh;
    (mesh.stats(), mesh.build_time())
}

/// A heap of that many triangles, in one place.
fn identical(count: usize, options: &BuildOptions) -> Aggregate {
    alone(soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; count]), options)
}

/// Where a triangle of a row stands.
fn in_row(i: usize) -> Vec3 {
    Vec3::X * (2 * i) as f32
}

/// A row of that many triangles.
fn collinear(count: usize, options: &BuildOptions) -> Aggregate {
    let at = (0..count).map(in_row);
    alone(soup(at.map(|at| [at, at + Vec3::X, at + Vec3::Y])), options)
}

/// Seconds that this thread has worked, where the system tells; else those of a clock. What else the machine does takes no part
/// in the former.
fn worked(clock: Instant) -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    nanoseconds.filter(|ns| *ns > 0.0).map_or_else(
        || clock.elapsed().as_secs_f64(),
        |nanoseconds| 1e-9 * nanoseconds,
    )
}

/// How many times as much work a tree of four times as many triangles is: 4.7 times where that is n log n, 16 where it is n².
/// On one thread, and of each the quicker of two in turn; four of the smaller trees, since the system counts in milliseconds.
fn growth(count: usize, build: impl Fn(usize) -> Aggregate + Sync) -> Option<f64> {
    let clock = Instant::now();
    let mut least = [f64::INFINITY; 2];
    let thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    thread.ok()?.install(|| {
        for _ in 0..2 {
            for (least, (trees, count)) in least.iter_mut().zip([(4, count / 4), (1, count)]) {
                let start = worked(clock);
                (0..trees).for_each(|_| drop(build(count)));
                *least = least.min((worked(clock) - start) / f64::from(trees));
            }
        }
    });
    Some(least[1] / least[0])
}

/// Half-way between n log n and n², as factors: nine times for four times as many.
const MOST_GROWTH: f64 = 9.0;

pub(super) fn heaps(effort: &Effort) -> Outcome {
    let count = 100_000;
    let probes = (effort.rays / 100).clamp(1, count);
    let (mut wrong, mut deepest, mut dearest) = (0, 0, 0.0_f64);
    // Of what was not measured nothing is known.
    let (mut slowest, mut steepest) = (Duration::ZERO, Some(0.0_f64));
    for builder in BUILDERS {
        let options = BuildOptions {
            builder,
            ..BuildOptions::default()
        };
        let heap = identical(count, &options);
        let target = Vec3::new(0.25, 0.25, 0.0);
        let hit = heap.closest_hit(&Ray::new(target + Vec3::Z, -Vec3::Z));
        wrong += usize::from(hit.map(|hit| hit.triangle) != Some(0));
        let row = collinear(count, &options);
        let mut counters = Counters::default();
        for probe in 0..probes {
            let i = probe * (count / probes);
            let from = in_row(i) + Vec3::new(0.25, 0.25, 3.0);
            let hit = row.closest_hit_with(&Ray::new(from, -Vec3::Z), &mut counters);
            wrong += usize::from(hit.map(|hit| hit.triangle) != Some(i as u32));
        }
        dearest = dearest.max((counters.boxes + counters.triangles) as f64 / probes as f64);
        for build in [identical, collinear] {
            let growth = growth(count, |count| build(count, &options));
            steepest = steepest.zip(growth).map(|(most, growth)| most.max(growth));
        }
        for scene in [&heap, &row] {
            let (stats, time) = built(scene);
            deepest = deepest.max(stats.levels);
            slowest = slowest.max(time);
        }
    }
    let figures = format!(
        "built in at most {} ms, by {} times the work of a quarter of them; {deepest} levels, {} boxes and triangles a ray, \
         {wrong} wrong hits",
        digits(1e3 * slowest.as_secs_f64(), 3),
        digits(steepest.unwrap_or(f64::NAN), 2),
        digits(dearest, 3)
    );
    Outcome::new(BUILDERS.len() * (probes + 1), figures)
        .require(wrong == 0, format!("{wrong} wrong hits"))
        .require(deepest as usize <= MAX_DEPTH, format!("{deepest} levels"))
        .require(
            dearest < 300.0,
            format!("{dearest} boxes and triangles a ray"),
        )
        .require(
            steepest.is_some_and(|steepest| steepest < MOST_GROWTH),
            match steepest {
                Some(steepest) => format!("four times as many are {steepest:.1} times the work"),
                None => "a thread that builds could not be started".into(),
            },
        )
}

pub(super) fn deep(_: &Effort) -> Outcome {
    // Triangles that shrink by powers of two: the best tree peels off one after another.
    let triangles: Vec<[Vec3; 3]> = (-60..39)
        .flat_map(|exponent| {
            let size = (exponent as f32).exp2();
            [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| {
                let (right, up) = axis.any_orthonormal_pair();
                let at = axis * size;
                [
                    at - 0.3 * size * right,
                    at + 0.3 * size * right,
                    at + 0.3 * size * up,
                ]
            })
        })
        .collect();
    let (mut lost, mut deepest, mut rays) = (0, 0, 0);
    for builder in BUILDERS {
        for max_leaf_size in [1, 8] {
            let options = BuildOptions {
                builder,
                max_leaf_size,
                max_depth: u32::MAX,
                ..BuildOptions::default()
            };
            let scene = alone(soup(triangles.iter().copied()), &options);
            deepest = deepest.max(built(&scene).0.levels);
            for [a, b, c] in &triangles {
                let target = (*a + *b + *c) / 3.0;
                for ray in [
                    Ray::new(Vec3::ZERO, target),
                    Ray::new(target * 1.5, -target),
                ] {
                    let (found, truth) = (scene.closest_hit(&ray), brute(&scene, &ray));
                    lost += usize::from(!same(found, truth) || found.is_none());
                    rays += 1;
                }
            }
        }
    }
    Outcome::new(
        rays,
        format!("{deepest} levels of at most {MAX_DEPTH}, {lost} lost hits"),
    )
    .require(lost == 0, format!("{lost} lost hits"))
    .require(
        deepest > 40 && deepest as usize <= MAX_DEPTH,
        format!("{deepest} levels"),
    )
}

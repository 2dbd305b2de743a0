//! Trees that are hard to build or to walk.

use super::{Effort, Outcome};
use crate::bvh::hard_cases::meshes::{alone, soup};
use crate::bvh::hard_cases::oracle::{brute, same};
use crate::bvh::{Aggregate, BuildOptions, Builder, Counters, MAX_DEPTH, Ray, TreeStats};
use crate::report::table::digits;
use glam::Vec3;
use std::time::Duration;

const BUILDERS: [Builder; 3] = [Builder::Median, Builder::Sah, Builder::Ploc];

fn built(scene: &Aggregate) -> (TreeStats, Duration) {
    let mesh = &scene.instances()[0].mesh;
    (mesh.stats(), mesh.build_time())
}

pub(super) fn heaps(effort: &Effort) -> Outcome {
    let count = 100_000;
    let probes = (effort.rays / 100).clamp(1, count);
    let (mut wrong, mut deepest, mut dearest) = (0, 0, 0.0_f64);
    let mut slowest = Duration::ZERO;
    for builder in BUILDERS {
        let options = BuildOptions {
            builder,
            ..BuildOptions::default()
        };
        let identical = alone(soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; count]), &options);
        let target = Vec3::new(0.25, 0.25, 0.0);
        let hit = identical.closest_hit(&Ray::new(target + Vec3::Z, -Vec3::Z));
        wrong += usize::from(hit.map(|hit| hit.triangle) != Some(0));
        let at = |i: usize| Vec3::X * (2 * i) as f32;
        let row = alone(
            soup((0..count).map(|i| [at(i), at(i) + Vec3::X, at(i) + Vec3::Y])),
            &options,
        );
        let mut counters = Counters::default();
        for probe in 0..probes {
            let i = probe * (count / probes);
            let from = at(i) + Vec3::new(0.25, 0.25, 3.0);
            let hit = row.closest_hit_with(&Ray::new(from, -Vec3::Z), &mut counters);
            wrong += usize::from(hit.map(|hit| hit.triangle) != Some(i as u32));
        }
        dearest = dearest.max((counters.boxes + counters.triangles) as f64 / probes as f64);
        for scene in [&identical, &row] {
            let (stats, time) = built(scene);
            deepest = deepest.max(stats.levels);
            slowest = slowest.max(time);
        }
    }
    let figures = format!(
        "built in at most {} ms, {deepest} levels, {} boxes and triangles a ray, {wrong} wrong hits",
        digits(1e3 * slowest.as_secs_f64(), 3),
        digits(dearest, 3)
    );
    Outcome::new(BUILDERS.len() * (probes + 1), figures)
        .require(wrong == 0, format!("{wrong} wrong hits"))
        .require(deepest as usize <= MAX_DEPTH, format!("{deepest} levels"))
        .require(
            dearest < 300.0,
            format!("{dearest} boxes and triangles a ray"),
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

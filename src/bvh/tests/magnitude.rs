//! Scenes very small and very large, near and far, and how exact `t` is.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{
    meshes::{alone, cube, joined, knot, moved, placed, scatter, soup, sphere},
    oracle::{ExactRay, Verdict, check},
    random::Random,
    rays::{at_one_of, into_unit, mixed, slivers},
};
use crate::bvh::{Aggregate, BuildOptions, Counters, Hit, Instance, MeshTree, Ray};

/// Rays from around a mesh of size 1 to somewhere in it.
fn rays_into(count: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random::new(seed);
    (0..count).map(|_| into_unit(&mut random)).collect()
}

#[test]
fn a_power_of_two_changes_no_bit_of_a_hit() {
    let hits = |exponent: i32| -> Vec<Option<Hit>> {
        let scale = (exponent as f32).exp2();
        let aggregate = alone(moved(&mixed(), |p| p * scale), &BuildOptions::default());
        let ray = |ray: Ray| Ray::new(ray.origin * scale, ray.direction);
        let rays = rays_into(10_000, 1).into_iter().map(ray);
        rays.map(|ray| {
            aggregate.closest_hit(&ray).map(|hit| Hit {
                t: hit.t / scale,
                ..hit
            })
        })
        .collect()
    };
    let unscaled = hits(0);
    let found = unscaled.iter().flatten().count();
    assert!(found > 5_000, "only {found} hits");
    for exponent in [-20, -17, -10, -1, 1, 7, 13, 20] {
        let other = hits(exponent);
        let differ = unscaled.iter().zip(&other).filter(|(a, b)| a != b).count();
        assert_eq!(
            differ, 0,
            "scale 2^{exponent}: {differ} of 10000 hits differ"
        );
    }
}

#[test]
fn scales_from_a_millionth_to_a_million_agree_with_both_oracles() {
    for scale in [1e-6, 1e-3, 0.1, 3.0, 1e3, 1e6] {
        let aggregate = alone(moved(&mixed(), |p| p * scale), &BuildOptions::default());
        let ray = |ray: Ray| Ray::new(ray.origin * scale, ray.direction * scale);
        let rays = rays_into(17_000, 2).into_iter().map(ray);
        let tally = check(&format!("scale {scale}"), &aggregate, rays);
        assert!(
            tally.hits > 8_000,
            "scale {scale}: only {} hits",
            tally.hits
        );
    }
}

#[test]
fn far_from_the_origin_t_stays_within_its_running_bound() {
    for distance in [1e2, 1e3, 1e4, 1e5, 1e6] {
        let offset = Vec3::new(1.0, -0.7, 0.4) * distance;
        let aggregate = alone(moved(&mixed(), |p| p + offset), &BuildOptions::default());
        let rays = rays_into(20_000, 3).into_iter();
        let rays = rays.map(|ray| Ray::new(ray.origin + offset, ray.direction));
        let tally = check(&format!("offset {distance}"), &aggregate, rays);
        assert!(
            tally.hits > 8_000,
            "offset {distance}: only {} hits",
            tally.hits
        );
    }
}

#[test]
fn a_sphere_in_a_stadium_a_million_times_larger_is_never_missed_and_costs_no_more() {
    let sphere = sphere(5);
    let stadium = moved(&cube(), |p| p * 1e6);
    let options = BuildOptions::default();
    let without = alone(sphere.clone(), &options);
    let as_one_mesh = alone(joined(&[sphere.clone(), stadium.clone()]), &options);
    let apart = placed(
        &[(sphere, Affine3A::IDENTITY), (stadium, Affine3A::IDENTITY)],
        &options,
    );
    for (what, scene) in [("one mesh", as_one_mesh), ("two meshes", apart)] {
        for from in [3.0, 1e3, 9e5] {
            let mut random = Random::new(9);
            let (mut misses, mut cost, mut cost_without) =
                (0, Counters::default(), Counters::default());
            for _ in 0..20_000 {
                let origin = random.direction() * from;
                let ray = Ray::new(origin, random.cube() * 0.4 - origin);
                let hit = scene.closest_hit_with(&ray, &mut cost);
                without.closest_hit_with(&ray, &mut cost_without);
                misses += usize::from(hit.is_none_or(|h| h.t > 2.0));
            }
            assert_eq!(
                misses, 0,
                "{what}: {misses} of 20000 rays from {from} missed the sphere"
            );
            let work = |c: Counters| (c.boxes + c.triangles) as f64 / 20_000.0;
            let (with, without) = (work(cost), work(cost_without));
            println!(
                "{what}, from {from}: {with:.1} boxes and triangles a ray, {without:.1} without the stadium"
            );
            // Far away boxes are taken for larger by how far off both the ray's start and the mesh reach: up to twice
            // as much where the mesh reaches as far as the start.
            assert!(
                with < without * 1.6 + 40.0,
                "{what}, from {from}: {with:.1} a ray, {without:.1} without"
            );
        }
    }
}

#[test]
fn slivers_a_million_times_longer_than_wide_are_hit_where_they_are() {
    let mut random = Random::new(14);
    let slivers = slivers(300, &mut random);
    let aggregate = alone(soup(slivers.iter().copied()), &BuildOptions::default());
    let rays = (0..100_000).map(|_| at_one_of(&slivers, &mut random));
    let tally = check("slivers", &aggregate, rays);
    assert!(tally.hits > 1_000, "only {} hits", tally.hits);
}

#[test]
fn t_is_exact_to_an_ulp_as_a_rule_and_within_its_running_bound_always() {
    let triangles = joined(&[scatter(40, 1.0, 33), knot(12, 6)]);
    let mesh = Arc::new(MeshTree::build(triangles, &BuildOptions::default()));
    let instance = Instance::new(mesh, &Affine3A::IDENTITY).expect("the identity has an inverse");
    let aggregate = Aggregate::build(vec![instance], &BuildOptions::default());
    let mut random = Random::new(8);
    let mut ulps = Vec::new();
    let mut worst: f64 = 0.0;
    for _ in 0..100_000 {
        let ray = Ray::new(random.cube() * 2.0, random.direction());
        let Some(hit) = aggregate.closest_hit(&ray) else {
            continue;
        };
        let instance = &aggregate.instances()[0];
        let corners = instance.mesh.triangles().corners(hit.triangle);
        let exact = ExactRay::new(instance, &ray).cross(corners);
        if exact.verdict != Verdict::Hit {
            continue;
        }
        let error = (f64::from(hit.t) - exact.t).abs();
        let ulp = f64::from(hit.t.next_up() - hit.t);
        assert!(
            error <= exact.t_bound,
            "{error} > {} for {ray:?} {hit:?}",
            exact.t_bound
        );
        worst = worst.max(error / exact.t_bound);
        ulps.push(error / ulp);
    }
    ulps.sort_by(f64::total_cmp);
    let at = |part: f64| ulps[(ulps.len() as f64 * part) as usize];
    println!(
        "t: median {:.2} ulp, 99 % {:.2}, most {:.1}, {:.3} of its bound",
        at(0.5),
        at(0.99),
        at(0.99999),
        worst
    );
    assert!(ulps.len() > 20_000, "only {} hits", ulps.len());
    assert!(at(0.5) <= 1.0, "the median error of t is {} ulp", at(0.5));
    assert!(
        at(0.99) <= 8.0,
        "99 % of the errors of t are below {} ulp",
        at(0.99)
    );
}

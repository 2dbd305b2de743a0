//! What rays find in wide trees: the same hits, by every instruction set, in every order, alone or in packets.

use super::super::kernel::wide::FEW;
use super::{
    each_set::Asked,
    leaks::name_untested,
    meshes::{cube, joined, knot, placed, scatter, soup},
    oracle::same,
    random::Random,
    transforms::any_transform,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Hit, Instance, Levels, MAX_DEPTH, MeshTree, Order, Ray,
    Transmittances, TriangleId, Triangles,
};
use glam::{Affine3A, Vec3};
use std::sync::Arc;

/// Rays from everywhere to everywhere, some along axes and into corners, some that end early.
fn rays(count: usize, places: &[Affine3A]) -> Vec<Ray> {
    let mut random = Random::new(77);
    (0..count)
        .map(|i| {
            let place = random.of(places);
            let (mut from, mut to) = (random.cube() * 2.0, random.cube());
            if i % 3 == 0 {
                (from, to) = ((from * 2.0).round() / 2.0, (to * 2.0).round() / 2.0);
            }
            let from = place.transform_point3(from);
            let direction = place.transform_point3(to) - from;
            Ray {
                t_max: random.of(&[f32::INFINITY, 1.0, 0.7]),
                ..Ray::new(from, direction)
            }
        })
        .collect()
}

/// Rays that go nearly the same way, sixteen by sixteen and now and then one fewer, from one place or from several; some
/// that cannot be traced, or only alone, are among them.
fn bundles(count: usize, places: &[Affine3A]) -> Vec<Ray> {
    let mut random = Random::new(78);
    let odd = |ray: Ray, i: usize| match i % 40 {
        0 => Ray {
            direction: Vec3::ZERO,
            ..ray
        },
        1 => Ray {
            t_max: f32::NAN,
            ..ray
        },
        2 => Ray {
            direction: ray.direction * 1e-36,
            ..ray
        },
        3 => Ray {
            origin: Vec3::INFINITY,
            ..ray
        },
        4 => Ray {
            direction: ray.direction * Vec3::new(0.0, -0.0, 1.0),
            ..ray
        },
        5 => Ray { time: 2.0, ..ray },
        6 => Ray {
            direction: ray.direction * 1e30,
            t_max: ray.t_max * 1e-30,
            ..ray
        },
        7 => Ray {
            t_max: 1e-40,
            ..ray
        },
        _ => ray,
    };
    let widths = [0.0, 1e-6, 0.02, 0.5];
    (0..count / 16)
        .flat_map(|bundle| {
            let lead = rays(1, places)[0];
            let place = random.of(places);
            let from = place.transform_point3(random.cube() * 2.0);
            let to = place.transform_point3((random.cube() * 2.0).round() / 2.0);
            let (spread, apart) = (random.of(&widths), random.of(&widths));
            let t_max = random.of(&[f32::INFINITY, 1.0, 0.7]);
            let count = 16 - bundle % 11 / 10;
            (0..count)
                .map(|i| {
                    let ray = Ray {
                        origin: from + random.cube() * apart,
                        direction: to - from + random.cube() * spread,
                        t_max,
                        time: if bundle % 3 == 0 {
                            (i as f32) / 16.0
                        } else {
                            lead.time
                        },
                        starts_on: TriangleId::NONE,
                    };
                    odd(ray, if bundle % 9 == 0 { bundle + i } else { 39 })
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A mesh at each of these places.
fn repeated(mesh: &Triangles, places: &[Affine3A], levels: Levels) -> Aggregate {
    let options = BuildOptions {
        levels,
        ..BuildOptions::default()
    };
    let meshes: Vec<(Triangles, Affine3A)> =
        places.iter().map(|&place| (mesh.clone(), place)).collect();
    placed(&meshes, &options)
}

/// Every third ray starts on the triangle that it hits; how many do.
fn start_on_what_they_hit(scene: &Aggregate, rays: &mut [Ray]) -> usize {
    let some = rays.iter_mut().step_by(3);
    some.filter_map(|ray| {
        ray.starts_on = scene.closest_hit(ray)?.id();
        Some(())
    })
    .count()
}

#[test]
fn a_ray_meets_everything_but_the_triangle_that_it_starts_on() {
    let mut random = Random::new(6);
    let mesh = joined(&[scatter(300, 0.2, 3), knot(30, 8)]);
    let turned: Vec<Affine3A> = (0..5).map(|_| any_transform(&mut random)).collect();
    for places in [vec![Affine3A::IDENTITY], turned] {
        for levels in [Levels::One, Levels::Two] {
            let scene = repeated(&mesh, &places, levels);
            let mut rays = rays(10_000, &places);
            rays.extend(bundles(10_000, &places));
            let plain = rays.clone();
            let count = start_on_what_they_hit(&scene, &mut rays);
            assert!(count > 1_000, "only {count} rays");
            let (mut all, mut left, mut found) = (Vec::new(), Vec::new(), Vec::new());
            let mut occluded = Vec::new();
            scene.closest_hits_in(Order::Tile, &rays, &mut found);
            scene.occlusions_in(Order::Light, &rays, &mut occluded);
            for (i, (ray, plain)) in rays.iter().zip(&plain).enumerate() {
                scene.all_hits(plain, &mut all);
                all.retain(|hit| hit.id() != ray.starts_on);
                scene.all_hits(ray, &mut left);
                assert_eq!(left, all, "{levels:?}: {ray:?}");
                let nearest = all.first().copied();
                assert!(
                    same(found[i], nearest),
                    "{levels:?}: {:?}, {ray:?}",
                    found[i]
                );
                assert!(same(scene.closest_hit(ray), nearest), "{levels:?}: {ray:?}");
                assert_eq!(occluded[i], nearest.is_some(), "{levels:?}: {ray:?}");
            }
        }
    }
}

/// What a crossing lets through.
fn through(hit: &Hit) -> Vec3 {
    let part = 0.5 + (hit.triangle % 8) as f32 / 17.0;
    Vec3::new(part, 1.0, (hit.instance % 5) as f32 / 4.0)
}

#[test]
fn every_instruction_set_and_every_order_finds_the_same_bits() {
    let mut random = Random::new(5);
    let mesh = joined(&[scatter(3_000, 0.1, 3), cube(), knot(60, 12), cube()]);
    let turned: Vec<Affine3A> = (0..12).map(|_| any_transform(&mut random)).collect();
    for places in [vec![Affine3A::IDENTITY], turned] {
        for levels in [Levels::One, Levels::Two] {
            let scene = repeated(&mesh, &places, levels);
            // A million over the four scenes.
            let mut rays = rays(100_000, &places);
            rays.extend(bundles(150_000, &places));
            let through_the_first = start_on_what_they_hit(&scene, &mut rays);
            assert!(through_the_first > 10_000, "only {through_the_first} rays");
            // Each by itself, not made ready with others.
            let hits: Vec<_> = rays.iter().map(|ray| scene.closest_hit(ray)).collect();
            let occluded: Vec<_> = rays.iter().map(|ray| scene.occluded(ray)).collect();
            let mut passing = Transmittances::default();
            scene.transmittances_in(Order::None, &rays, |_, hit| through(hit), &mut passing);
            let found = hits.iter().flatten().count();
            assert!(found > 50_000, "{levels:?}: only {found} hits");
            for order in [Order::None, Order::Tile, Order::Light] {
                let asked = Asked {
                    aggregate: &scene,
                    order,
                    rays: &rays,
                    through,
                };
                let lacking = asked.with_each(|set, found| {
                    for (i, ray) in rays.iter().enumerate() {
                        let (a, b) = (hits[i], found.hits[i]);
                        assert!(
                            same(a, b),
                            "{set}, {order:?}, {levels:?}: {b:?} instead of {a:?}, {ray:?}"
                        );
                        assert_eq!(
                            occluded[i], found.occluded[i],
                            "{set}, {order:?}, {levels:?}: occluded, {ray:?}"
                        );
                        assert_eq!(
                            passing.get()[i],
                            found.passing.get()[i],
                            "{set}, {order:?}, {levels:?}: passing, {ray:?}"
                        );
                        assert_eq!(a.is_some(), occluded[i], "{levels:?}: {ray:?}");
                    }
                });
                name_untested(&lacking);
            }
        }
    }
}

#[test]
fn moving_instances_are_met_by_packets_as_by_single_rays() {
    let options = BuildOptions::default();
    let tree = Arc::new(MeshTree::build(knot(60, 12), &options));
    let mut random = Random::new(9);
    let places: Vec<Affine3A> = (0..12).map(|_| any_transform(&mut random)).collect();
    let instances = places.iter().map(|place| {
        let instance = Instance::new(tree.clone(), place).unwrap();
        instance.moving(random.cube()).unwrap()
    });
    let scene = Aggregate::build(instances.collect(), &options);
    let rays = bundles(60_000, &places);
    let (mut hits, mut packets) = (Vec::new(), Vec::new());
    scene.closest_hits(&rays, &mut hits);
    scene.closest_hits_in(Order::Tile, &rays, &mut packets);
    let found = hits.iter().flatten().count();
    assert!(found > 6_000, "only {found} hits");
    for (i, ray) in rays.iter().enumerate() {
        assert!(
            same(hits[i], packets[i]),
            "{:?}, in a packet {:?}, {ray:?}",
            hits[i],
            packets[i]
        );
    }
}

#[test]
fn a_mesh_that_needs_a_large_stack_is_traced_like_any_other() {
    // Boxes that shrink by powers of two: the best tree parts one after another from all smaller ones.
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = soup((-60..38).flat_map(|exponent| {
        axes.map(|axis| {
            let far = axis * 2f32.powi(exponent);
            let aside = Vec3::new(axis.y, axis.z, axis.x) * far.length() * 0.3;
            [far, far * 0.5 + aside, far * 0.5 - aside]
        })
    }));
    let options = BuildOptions {
        builder: Builder::Sah,
        max_leaf_size: 1,
        max_depth: MAX_DEPTH as u32,
        ..BuildOptions::default()
    };
    let scene = placed(&[(triangles, Affine3A::IDENTITY)], &options);
    let most_pending = scene.instances()[0].mesh.wide_stats().most_pending;
    assert!(most_pending > FEW, "only {most_pending} pending");
    for ray in rays(2_000, &[Affine3A::IDENTITY]) {
        let hit = scene.closest_hit(&ray);
        assert!(same(hit, super::oracle::brute(&scene, &ray)), "{ray:?}");
    }
}

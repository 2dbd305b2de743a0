//! The tree changes the time a ray takes, and not one bit of what it finds.

use std::sync::Arc;

use glam::{Affine3A, Quat, Vec3};
use proptest::prelude::*;

use super::{
    meshes::{cube, joined, moved, scatter, soup},
    oracle::{brute, same},
    random::Random,
    transforms::any_transform,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Hit, Instance, Levels, MeshTree, Order, Preset, Ray,
    Triangles,
};

/// Every builder with one level and two, and leaves and depths out of the ordinary.
fn ways() -> Vec<BuildOptions> {
    let mut ways = Vec::new();
    for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
        for levels in [Levels::One, Levels::Two] {
            let usual = BuildOptions {
                builder,
                levels,
                ..BuildOptions::default()
            };
            ways.extend([
                usual,
                BuildOptions {
                    max_depth: 3,
                    max_leaf_size: 1,
                    preset: Preset::Fastest,
                    ..usual
                },
            ]);
        }
    }
    ways
}

fn build(meshes: &[(Triangles, Vec<Affine3A>)], options: &BuildOptions) -> Aggregate {
    let instances = meshes.iter().flat_map(|(triangles, places)| {
        let mesh = Arc::new(MeshTree::build(triangles.clone(), options));
        let place = move |at| Instance::new(mesh.clone(), at).expect("invertible");
        places.iter().map(place).collect::<Vec<_>>()
    });
    Aggregate::build(instances.collect(), options)
}

/// Asserts that every way to build finds the same hits, alone, in batches and in packets, and returns how many there are.
fn assert_identical(what: &str, meshes: &[(Triangles, Vec<Affine3A>)], rays: &[Ray]) -> usize {
    let mut expected: Vec<Option<Hit>> = Vec::new();
    let mut expected_all: Vec<Vec<Hit>> = Vec::new();
    for (way, options) in ways().iter().enumerate() {
        let scene = build(meshes, options);
        let (mut hits, mut occluded, mut all) = (Vec::new(), Vec::new(), Vec::new());
        let (mut in_packets, mut occluded_in_packets) = (Vec::new(), Vec::new());
        scene.closest_hits(rays, &mut hits);
        scene.occlusions(rays, &mut occluded);
        scene.closest_hits_in(Order::Tile, rays, &mut in_packets);
        scene.occlusions_in(Order::Light, rays, &mut occluded_in_packets);
        if way == 0 {
            expected = rays.iter().map(|ray| brute(&scene, ray)).collect();
        }
        for (i, ray) in rays.iter().enumerate() {
            let at = || format!("{what}, {options:?}, ray {i} {ray:?}");
            assert!(
                same(hits[i], expected[i]),
                "{}: {:?} but {:?}",
                at(),
                hits[i],
                expected[i]
            );
            assert_eq!(occluded[i], hits[i].is_some(), "{}", at());
            let packed = in_packets[i];
            assert!(same(packed, hits[i]), "{}: packed {packed:?}", at());
            assert_eq!(occluded_in_packets[i], occluded[i], "{}: packed", at());
            if i % 16 == 0 {
                scene.all_hits(ray, &mut all);
                assert_eq!(all.first().copied(), hits[i], "{}", at());
                if way == 0 {
                    expected_all.push(all.clone());
                }
                assert_eq!(all, expected_all[i / 16], "{}", at());
            }
        }
    }
    expected.iter().flatten().count()
}

#[test]
fn builders_and_levels_agree_on_duplicated_and_coplanar_triangles() {
    let twice = scatter(40, 0.6, 1);
    // Whole coordinates on few planes: many faces overlap exactly, in both windings.
    let mut random = Random::new(2);
    let coplanar = soup((0..60).map(|_| {
        let mut corner = || {
            Vec3::new(
                random.of(&[-1.0, 0.0, 1.0]),
                random.of(&[-1.0, 0.0, 1.0]),
                random.of(&[0.0, 0.5]),
            )
        };
        [corner(), corner(), corner()]
    }));
    let mesh = joined(&[
        cube(),
        twice.clone(),
        coplanar.clone(),
        cube(),
        twice,
        coplanar,
    ]);
    let places = vec![Affine3A::IDENTITY, Affine3A::IDENTITY];
    let rays: Vec<Ray> = (0..6_000)
        .map(|i| {
            let (mut from, mut to) = (random.cube() * 2.0, random.cube());
            if i % 2 == 0 {
                (from, to) = ((from * 2.0).round() / 2.0, (to * 2.0).round() / 2.0);
            }
            Ray::new(from, to - from)
        })
        .collect();
    let hits = assert_identical("coplanar", &[(mesh, places)], &rays);
    assert!(hits > 3_000, "only {hits} hits");
}

#[test]
fn builders_and_levels_agree_on_sheared_mirrored_and_duplicated_instances() {
    let mut random = Random::new(3);
    let meshes: Vec<(Triangles, Vec<Affine3A>)> = (0..4)
        .map(|i| {
            let mut places: Vec<Affine3A> = (0..4).map(|_| any_transform(&mut random)).collect();
            // Duplicates, and one that is almost the identity.
            places.push(places[0]);
            places.push(Affine3A::from_quat(Quat::from_rotation_y(1e-4)));
            places.push(Affine3A::IDENTITY);
            (joined(&[scatter(20, 0.8, i), cube()]), places)
        })
        .collect();
    let all: Vec<Affine3A> = meshes.iter().flat_map(|m| m.1.clone()).collect();
    let rays: Vec<Ray> = (0..4_000)
        .map(|_| {
            let from = random
                .of(&all)
                .transform_point3(random.cube() * random.of(&[0.5, 3.0, 100.0]));
            let to = random.of(&all).transform_point3(random.cube() * 1.2);
            Ray::new(from, (to - from) * random.of(&[1.0, 1e-3, 1e5]))
        })
        .collect();
    let hits = assert_identical("instances", &meshes, &rays);
    assert!(hits > 2_000, "only {hits} hits");
}

#[test]
fn builders_and_levels_agree_on_rays_that_graze_edges_of_instances() {
    let mut random = Random::new(4);
    let places: Vec<Affine3A> = (0..30).map(|_| any_transform(&mut random)).collect();
    let offset = Vec3::new(1234.0, -99.0, 77.0);
    let mesh = moved(&cube(), |p| p + offset);
    let corner = |random: &mut Random| {
        Vec3::new(
            random.of(&[-1.0, 1.0]),
            random.of(&[-1.0, 1.0]),
            random.of(&[-1.0, 1.0]),
        )
    };
    let rays: Vec<Ray> = (0..6_000)
        .map(|_| {
            let place = random.of(&places);
            let (a, b) = (corner(&mut random), corner(&mut random));
            let on_edge = place.transform_point3(offset + a + (b - a) * random.unit());
            let from =
                place.transform_point3(offset + random.cube() * random.of(&[1.5, 10.0, 1e4]));
            Ray::new(from, on_edge - from)
        })
        .collect();
    let hits = assert_identical("edges", &[(mesh, places)], &rays);
    assert!(hits > 2_000, "only {hits} hits");
}

#[test]
fn builders_and_levels_agree_on_rays_that_touch_the_outermost_corner_of_a_far_instance() {
    // The corner that decides a face of the instance's world box, and rays within that face: only the pads of the
    // world's rays and boxes keep these hits. Without the first, rays from afar lose some; without the second, rays
    // from near the origin at what is far away.
    let mut random = Random::new(5);
    let places: Vec<Affine3A> = (0..24)
        .map(|_| {
            let turn = Quat::from_axis_angle(random.direction(), random.between(0.0, 6.0));
            let scale = Vec3::new(1.0, random.between(0.1, 1.0), random.between(0.1, 1.0));
            let far = random.cube() * random.of(&[10.0, 1e3, 1e5]);
            let far = random.of(&[far, far * Vec3::X]);
            Affine3A::from_scale_rotation_translation(scale, turn, far)
        })
        .collect();
    let corners: Vec<Vec3> = cube().positions().to_vec();
    let rays: Vec<Ray> = (0..6_000)
        .map(|_| {
            let place = random.of(&places);
            let axis = random.below(3);
            let sign = random.of(&[-1.0, 1.0]);
            let outermost = corners
                .iter()
                .map(|&corner| place.transform_point3(corner))
                .max_by(|a, b| (a[axis] * sign).total_cmp(&(b[axis] * sign)))
                .expect("a cube has corners");
            let distance = random.of(&[2.0, 100.0, 1e5]);
            let mut origin = outermost - random.direction() * distance;
            if random.unit() < 0.5 {
                origin = random.cube();
            }
            let mut direction = outermost - origin;
            direction[axis] = 0.0;
            origin[axis] = match random.below(3) {
                0 => outermost[axis],
                1 => outermost[axis].next_up(),
                _ => outermost[axis].next_down(),
            };
            Ray::new(origin, direction)
        })
        .collect();
    let hits = assert_identical("outermost corners", &[(cube(), places)], &rays);
    assert!(hits > 1_000, "only {hits} hits");
}

#[test]
fn builders_and_levels_agree_on_rays_almost_in_the_planes_of_triangles() {
    // Seen edge on, a triangle's plane is crossed anywhere: only the clamp to its box keeps `t` near the triangle, and
    // so where no box above it is passed over.
    let mut random = Random::new(6);
    let mesh = scatter(80, 0.3, 61);
    let rays: Vec<Ray> = (0..5_000)
        .flat_map(|_| {
            let [a, b, c] = mesh.corners(random.below(80) as u32);
            let mut within = || {
                let (u, v) = (random.between(-3.0, 3.0), random.between(-3.0, 3.0));
                a + (b - a) * u + (c - a) * v
            };
            let (from, to) = (within(), within());
            // So many that they stay together in a packet.
            [Ray::new(from, to - from); 4]
        })
        .collect();
    // A turned mesh beside it, for which all boxes above are padded.
    let turned = Affine3A::from_rotation_translation(
        Quat::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, 0.7),
        Vec3::new(4.0, 0.0, 0.0),
    );
    for places in [vec![Affine3A::IDENTITY], vec![Affine3A::IDENTITY, turned]] {
        let hits = assert_identical("in planes", &[(mesh.clone(), places)], &rays);
        assert!(hits > 3_000, "only {hits} hits");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_scene_looks_the_same_through_any_tree(seed in any::<u64>(), count in 1usize..40, size in 1e-4f32..4.0) {
        let mut random = Random::new(seed);
        let mesh = scatter(count, size, seed);
        let places: Vec<Affine3A> = (0..3).map(|_| any_transform(&mut random)).collect();
        let rays: Vec<Ray> = (0..100)
            .map(|_| {
                let place = random.of(&places);
                let target = mesh.corners(random.below(mesh.len()) as u32);
                let target = (target[0] + target[1]) * 0.5;
                let from = place.transform_point3(random.cube() * 2.0);
                Ray::new(from, place.transform_point3(target) - from)
            })
            .collect();
        assert_identical("any scene", &[(mesh, places)], &rays);
    }
}

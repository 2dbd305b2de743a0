//! Directions that divide by zero, and rays that are not rays.

use glam::{Affine3A, Quat, Vec3};

use super::{
    meshes::{alone, cube, moved, placed},
    oracle::{brute, check, same},
    random::Random,
    rays::{
        at_thin_target, boxed, flat_square, in_faces, in_plane, is_ray, not_numbers, signed_zeros,
        thin_targets,
    },
};
use crate::bvh::{BuildOptions, Ray};

#[test]
fn signed_zeros_and_tiny_components_are_ordinary_directions() {
    let aggregate = alone(boxed(), &BuildOptions::default());
    let mut random = Random::new(5);
    let rays: Vec<Ray> = (0..100_000).map(|_| signed_zeros(&mut random)).collect();
    let tally = check("signed zeros", &aggregate, rays.iter().copied());
    assert!(
        tally.hits > 10_000,
        "only {} hits: the test tests nothing",
        tally.hits
    );
    for ray in rays {
        let positive = Ray {
            direction: ray.direction + 0.0,
            ..ray
        };
        let (a, b) = (
            aggregate.closest_hit(&ray),
            aggregate.closest_hit(&positive),
        );
        assert!(same(a, b), "-0.0 differs from +0.0: {ray:?} {a:?} {b:?}");
    }
}

#[test]
fn a_hit_at_the_end_of_the_numbers_is_one_for_every_question() {
    let aggregate = alone(boxed(), &BuildOptions::default());
    let ray = Ray::new(Vec3::new(2.0, 0.0, 1.0), Vec3::new(-1e-38, 0.0, 1e-45));
    let hit = aggregate.closest_hit(&ray);
    let mut occluded = Vec::new();
    aggregate.occlusions(&[ray], &mut occluded);
    assert_eq!(
        [aggregate.occluded(&ray), occluded[0]],
        [hit.is_some(); 2],
        "{hit:?}"
    );
}

#[test]
fn directions_of_any_length_find_the_same_triangles() {
    let turn = Affine3A::from_rotation_y(0.3) * Affine3A::from_scale(Vec3::splat(1e-4));
    let meshes = [
        (cube(), Affine3A::IDENTITY),
        (moved(&cube(), |p| p * 5e3), turn),
    ];
    let aggregate = placed(&meshes, &BuildOptions::default());
    let mut random = Random::new(11);
    let mut hits = 0;
    for _ in 0..20_000 {
        let ray = Ray::new(random.cube() * 2.0, random.direction());
        let hit = aggregate.closest_hit(&ray);
        hits += usize::from(hit.is_some());
        for exponent in [-140, -120, -100, -61, -10, 10, 59, 100, 120] {
            let scaled = ray.direction.as_dvec3() * 2f64.powi(exponent);
            let scaled = Ray {
                direction: scaled.as_vec3(),
                ..ray
            };
            // Below 2^-126 the direction itself is rounded, beyond 2^±100 so is t.
            let other = aggregate.closest_hit(&scaled);
            if exponent >= -100 {
                assert_eq!(
                    hit.map(|h| (h.instance, h.triangle, h.u)),
                    other.map(|h| (h.instance, h.triangle, h.u)),
                    "times 2^{exponent}: {ray:?}"
                );
            } else if exponent == -120 {
                assert_eq!(
                    hit.map(|h| h.triangle),
                    other.map(|h| h.triangle),
                    "2^{exponent}: {ray:?}"
                );
            }
        }
    }
    assert!(hits > 4_000, "only {hits} hits");
}

#[test]
fn axis_parallel_rays_find_a_target_of_a_hundred_thousandth_at_ten_thousand() {
    let aggregate = alone(thin_targets(), &BuildOptions::default());
    let mut random = Random::new(2);
    let hit = |_: &u32| {
        aggregate
            .closest_hit(&at_thin_target(&mut random))
            .is_some()
    };
    let misses = 100_000 - (0..100_000).filter(hit).count();
    assert_eq!(misses, 0, "{misses} of 100000 rays missed the target");
}

#[test]
fn a_ray_in_the_plane_of_a_triangle_misses_it_and_nothing_is_nan() {
    let mut random = Random::new(4);
    for height in [0.0, 0.3, -1e5] {
        let alone_there = alone(flat_square(height), &BuildOptions::default());
        for _ in 0..50_000 {
            let ray = in_plane(height, &mut random);
            let hit = alone_there.closest_hit(&ray);
            assert_eq!(hit, None, "a ray in the plane z = {height} hit: {ray:?}");
        }
    }
    // In the plane of a box's face it misses that face, but meets the faces that it crosses at their edge.
    let boxed = alone(cube(), &BuildOptions::default());
    let along_the_top = Ray::new(Vec3::new(-3.0, 0.25, 1.0), Vec3::X);
    let hit = boxed
        .closest_hit(&along_the_top)
        .expect("the side's upper edge is hit");
    assert_eq!((hit.t, hit.t.is_nan()), (2.0, false), "{hit:?}");
    let rays = (0..25_000).map(|_| in_faces(&mut random));
    check("in the faces of a box", &boxed, rays);
}

#[test]
fn rays_that_are_not_numbers_miss() {
    let turned = Affine3A::from_quat(Quat::from_rotation_x(0.3));
    let aggregate = placed(
        &[(cube(), Affine3A::IDENTITY), (cube(), turned)],
        &BuildOptions::default(),
    );
    let mut random = Random::new(6);
    for _ in 0..100_000 {
        let ray = not_numbers(&mut random);
        let hit = aggregate.closest_hit(&ray);
        assert!(same(hit, brute(&aggregate, &ray)), "{ray:?}");
        assert_eq!(aggregate.occluded(&ray), hit.is_some(), "{ray:?}");
        if let Some(hit) = hit {
            assert!(
                is_ray(&ray) && hit.t > 0.0 && hit.t < ray.t_max,
                "{ray:?} hit {hit:?}"
            );
        }
    }
    let zero = Ray::new(Vec3::ZERO, Vec3::ZERO);
    assert_eq!(
        aggregate.closest_hit(&zero),
        None,
        "a ray without a direction"
    );
}

#[test]
fn hits_lie_strictly_between_the_ends_of_a_ray() {
    let aggregate = alone(cube(), &BuildOptions::default());
    let ray = Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z);
    for (t_max, expected) in [
        (2.0, None),
        (2.0f32.next_up(), Some(2.0)),
        (0.0, None),
        (-1.0, None),
    ] {
        let ray = Ray { t_max, ..ray };
        assert_eq!(
            aggregate.closest_hit(&ray).map(|h| h.t),
            expected,
            "t_max {t_max}"
        );
        assert_eq!(
            aggregate.occluded(&ray),
            expected.is_some(),
            "t_max {t_max}"
        );
    }
    let on_the_face = Ray {
        origin: Vec3::new(0.1, 0.2, -1.0),
        ..ray
    };
    assert_eq!(aggregate.closest_hit(&on_the_face).map(|h| h.t), Some(2.0));
}

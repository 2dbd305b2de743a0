//! Instances: sheared, mirrored, tiny, huge, far away, singular.

use std::sync::Arc;

use glam::{Affine3A, Mat3, Vec3};

use super::{
    meshes::{alone, cube, joined, placed, scatter, sphere},
    oracle::check,
    random::Random,
    transforms::any_transform,
};
use crate::bvh::{Aggregate, BuildOptions, Instance, MeshTree, Ray, SingularTransform};

#[test]
fn instances_of_any_shape_and_scale_agree_with_both_oracles() {
    let mut random = Random::new(41);
    let mesh = joined(&[sphere(1), scatter(40, 0.7, 5)]);
    let mut hits = 0;
    for round in 0..50 {
        let transform = any_transform(&mut random);
        let scene = placed(&[(mesh.clone(), transform)], &BuildOptions::default());
        let rays: Vec<Ray> = (0..2_000)
            .map(|_| {
                let (from, to) = (random.cube() * 3.0, random.cube());
                let (from, to) = (
                    transform.transform_point3(from),
                    transform.transform_point3(to),
                );
                Ray::new(from, to - from)
            })
            .collect();
        hits += check(&format!("instance {round}, {transform}"), &scene, rays).hits;
    }
    assert!(hits > 50_000, "only {hits} hits");
}

#[test]
fn an_instance_is_its_mesh_baked_where_baking_is_exact() {
    // Quarter turns, mirrors, powers of two and whole steps: world positions are exact in f32.
    let mut random = Random::new(43);
    let eighths = |v: Vec3| (v * 8.0).round() / 8.0;
    let mesh = scatter(60, 0.5, 6);
    let mesh = super::meshes::moved(&mesh, eighths);
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let (mut hits, mut apart) = (0, 0);
    for _ in 0..20 {
        let first = random.below(3);
        let second = (first + 1 + random.below(2)) % 3;
        let columns = [axes[first], axes[second], axes[3 - first - second]];
        let mut column = |i: usize| columns[i] * random.of(&[-4.0, -0.5, 0.25, 1.0, 8.0]);
        let linear = Mat3::from_cols(column(0), column(1), column(2));
        let transform = Affine3A::from_mat3_translation(linear, eighths(random.cube() * 16.0));
        let instanced = placed(&[(mesh.clone(), transform)], &BuildOptions::default());
        let baked = super::meshes::moved(&mesh, |p| transform.transform_point3(p));
        let baked = alone(baked, &BuildOptions::default());
        for _ in 0..5_000 {
            let (from, to) = (random.cube() * 3.0, random.cube());
            let (from, to) = (
                transform.transform_point3(from),
                transform.transform_point3(to),
            );
            let ray = Ray::new(from, to - from);
            let (a, b) = (instanced.closest_hit(&ray), baked.closest_hit(&ray));
            hits += usize::from(a.is_some());
            match (a, b) {
                (Some(a), Some(b)) if a.triangle == b.triangle => {
                    let off = (a.t - b.t).abs() / b.t;
                    assert!(off < 1e-3, "t differs by {off}: {a:?} {b:?} {ray:?}");
                }
                (None, None) => {}
                _ => apart += 1,
            }
        }
    }
    assert!(hits > 30_000, "only {hits} hits");
    // Rays within rounding of an edge: both oracles judge them above.
    assert!(
        apart <= 5,
        "{apart} of 100000 rays find another triangle when the mesh is baked"
    );
}

#[test]
fn the_identity_takes_the_world_ray_bit_for_bit_and_a_mirror_mirrors() {
    let mesh = Arc::new(MeshTree::build(cube(), &BuildOptions::default()));
    let place = |transform| Instance::new(mesh.clone(), &transform).expect("invertible");
    assert!(!place(Affine3A::IDENTITY).mirrored());
    assert!(place(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0))).mirrored());
    assert!(!place(Affine3A::from_scale(Vec3::new(-1.0, -1.0, 1.0))).mirrored());
    let point = Vec3::new(0.1, 0.2, 0.3);
    assert_eq!(place(Affine3A::IDENTITY).to_world_point(point), point);
    let stretched = place(Affine3A::from_scale(Vec3::new(2.0, 1.0, 1.0)));
    let normal = stretched.to_world_normal(Vec3::new(1.0, 1.0, 0.0));
    let along = stretched.to_world_vector(Vec3::new(1.0, -1.0, 0.0));
    assert_eq!(
        normal.dot(along),
        0.0,
        "a normal stays perpendicular: {normal}"
    );
}

#[test]
fn transforms_without_a_usable_inverse_are_refused() {
    let mesh = Arc::new(MeshTree::build(cube(), &BuildOptions::default()));
    let refused = |transform: Affine3A| Instance::new(mesh.clone(), &transform).err();
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    assert_eq!(refused(flat), Some(SingularTransform::Flat));
    let nan = Affine3A::from_translation(Vec3::new(f32::NAN, 0.0, 0.0));
    assert_eq!(refused(nan), Some(SingularTransform::NotFinite));
    let infinite = Affine3A::from_scale(Vec3::splat(f32::INFINITY));
    assert_eq!(refused(infinite), Some(SingularTransform::NotFinite));
    let far = Affine3A::from_translation(Vec3::splat(1e20));
    assert_eq!(refused(far), Some(SingularTransform::NotFinite));
    let tiny = refused(Affine3A::from_scale(Vec3::splat(1e-20)));
    assert!(
        matches!(tiny, Some(SingularTransform::Scale { .. })),
        "{tiny:?}"
    );
    let huge = refused(Affine3A::from_scale(Vec3::splat(1e20)));
    assert!(
        matches!(huge, Some(SingularTransform::Scale { .. })),
        "{huge:?}"
    );
    // Two columns that differ in their last bits.
    let skewed = Mat3::from_cols(Vec3::ONE, Vec3::new(1.0, 1.0, 1.0 + 1e-6), Vec3::X);
    let skewed = refused(Affine3A::from_mat3(skewed));
    assert!(
        matches!(skewed, Some(SingularTransform::Skewed { .. })),
        "{skewed:?}"
    );
    let singular = Mat3::from_cols(Vec3::ONE, Vec3::ONE * 3.0, Vec3::X);
    assert!(refused(Affine3A::from_mat3(singular)).is_some());
    for size in [1e-4, 1e4] {
        assert_eq!(
            refused(Affine3A::from_scale(Vec3::splat(size))),
            None,
            "scale {size}"
        );
        assert_eq!(
            refused(Affine3A::from_scale(Vec3::new(1.0 / size, 1.0, size))),
            None,
            "scale {size}"
        );
    }
}

#[test]
fn instances_far_apart_and_of_all_sizes_are_one_scene() {
    let mut random = Random::new(47);
    let mesh = Arc::new(MeshTree::build(sphere(1), &BuildOptions::default()));
    let instances: Vec<Instance> = (0..12)
        .map(|_| Instance::new(mesh.clone(), &any_transform(&mut random)).expect("invertible"))
        .collect();
    let transforms: Vec<Affine3A> = instances.iter().map(|i| *i.world_from_object()).collect();
    let scene = Aggregate::build(instances, &BuildOptions::default());
    let rays = (0..20_000).map(|_| {
        let from = random.of(&transforms).transform_point3(random.cube() * 3.0);
        let to = random.of(&transforms).transform_point3(random.cube());
        Ray::new(from, to - from)
    });
    let tally = check("all sizes", &scene, rays);
    assert!(tally.hits > 5_000, "only {} hits", tally.hits);
}

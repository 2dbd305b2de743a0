//! Rays that start where another ended.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};

use super::{
    meshes::{alone, cube, placed, sphere},
    random::Random,
};
use crate::bvh::{
    BuildOptions, Ray,
    hard_cases::spawned::{self_hits, triangles_of_all_sizes},
};

#[test]
fn a_ray_that_leaves_a_triangle_of_any_size_does_not_meet_it_again() {
    let mut random = Random::new(17);
    let (scene, targets) = triangles_of_all_sizes(&mut random);
    let (spawned, same) = self_hits(&scene, &targets, 100_000, &mut random);
    assert!(spawned > 100_000, "only {spawned} rays");
    assert_eq!(same, 0, "{same} of {spawned} rays hit what they left");
}

#[test]
fn a_ray_that_leaves_an_instance_does_not_meet_its_triangle_again() {
    let mut random = Random::new(19);
    let mut meshes = Vec::new();
    let mut targets = Vec::new();
    for _ in 0..40 {
        let scale = Vec3::new(1.0, random.between(0.2, 2.0), -random.between(0.5, 2.0))
            * random.between(-8.0, 8.0).exp();
        let place = random.cube() * random.between(-8.0, 10.0).exp();
        let turn = Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
        meshes.push((
            sphere(1),
            Affine3A::from_scale_rotation_translation(scale, turn, place),
        ));
        targets.push(place);
    }
    let scene = placed(&meshes, &BuildOptions::default());
    let (spawned, same) = self_hits(&scene, &targets, 100_000, &mut random);
    assert!(spawned > 100_000, "only {spawned} rays");
    assert_eq!(same, 0, "{same} of {spawned} rays hit what they left");
}

#[test]
fn rays_that_leave_the_inside_of_a_closed_convex_mesh_stay_inside() {
    let mut random = Random::new(23);
    for (name, mesh) in [("cube", cube()), ("sphere", sphere(3))] {
        let scene = alone(mesh, &BuildOptions::default());
        let mut lost = 0;
        for _ in 0..1_000 {
            let mut ray = Ray::new(random.cube() * 0.3, random.direction());
            for _ in 0..50 {
                let Some(hit) = scene.closest_hit(&ray) else {
                    lost += 1;
                    break;
                };
                let surface = scene.instances()[0].surface_point(&hit, 0.0);
                let inwards = if surface.normal.dot(ray.direction) < 0.0 {
                    1.0
                } else {
                    -1.0
                };
                // Not so grazing that a flat corner between two facets is in the way.
                let direction = (surface.normal * inwards + random.direction() * 0.9).normalize();
                ray = Ray::new(surface.leave(direction), direction);
            }
        }
        assert_eq!(
            lost, 0,
            "{name}: {lost} of 1000 paths of 50 bounces left it"
        );
    }
}

#[test]
fn the_normal_is_on_the_side_that_the_winding_says_mirrored_or_not() {
    for scale in [Vec3::ONE, Vec3::new(-1.0, 2.0, 0.5), Vec3::splat(-3.0)] {
        let transform = Affine3A::from_scale(scale);
        let scene = placed(&[(sphere(2), transform)], &BuildOptions::default());
        let mut random = Random::new(1);
        for _ in 0..1_000 {
            let ray = Ray::new(Vec3::ZERO, random.direction());
            let hit = scene.closest_hit(&ray).expect("the sphere is closed");
            let surface = scene.instances()[0].surface_point(&hit, 0.0);
            let outwards = surface.normal.dot(ray.direction);
            assert!(
                outwards > 0.0,
                "scale {scale}: the outer side's normal points inwards: {surface:?}"
            );
            assert!((surface.normal.length() - 1.0).abs() < 1e-6, "{surface:?}");
            let apart = (surface.position - ray.at(hit.t)).length();
            assert!(
                apart < 1e-5,
                "scale {scale}: two ways to the same point differ by {apart}"
            );
        }
    }
}

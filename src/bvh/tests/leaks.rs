//! Closed meshes seen from inside: a ray that finds nothing has leaked.

use glam::Vec3;

use super::{
    meshes::{alone, cube, moved, sphere},
    oracle::check,
    random::Random,
};
use crate::bvh::{
    BuildOptions, Ray,
    hard_cases::leaks::{AIMS, FAR, away, closed, leaks, target},
};

#[test]
fn no_ray_leaves_a_closed_mesh_through_a_face_an_edge_or_a_vertex() {
    for (name, mesh, inside) in closed() {
        for aim in AIMS {
            let mut random = Random::new(aim as u64);
            let scene = away(&mesh, Vec3::ZERO);
            let (lost, first) = leaks(&scene, inside, Vec3::ZERO, aim, 100_000, &mut random);
            assert_eq!(
                lost, 0,
                "{name}, {aim:?}: {lost} of 100000 rays leaked, first {first:?}"
            );
        }
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh_far_from_the_origin() {
    // Rounding to coordinates of 1/64 must leave the random points inside and the meshes closed.
    for (name, mesh, inside) in closed() {
        if name.contains("near") {
            continue;
        }
        for aim in AIMS {
            let mut random = Random::new(aim as u64);
            let (lost, first) = leaks(&away(&mesh, FAR), inside, FAR, aim, 100_000, &mut random);
            assert_eq!(
                lost, 0,
                "{name}, {aim:?}: {lost} of 100000 rays leaked, first {first:?}"
            );
        }
    }
}

#[test]
fn rays_inside_closed_meshes_agree_with_both_oracles() {
    let mut random = Random::new(7);
    for offset in [Vec3::ZERO, FAR] {
        for (name, mesh) in [("sphere", sphere(2)), ("cube", cube())] {
            let aggregate = alone(moved(&mesh, |p| p + offset), &BuildOptions::default());
            let triangles = aggregate.instances()[0].mesh.triangles().clone();
            let rays = (0..25_000).map(|i| {
                let origin = random.cube() * 0.5 + offset;
                Ray::new(
                    origin,
                    target(AIMS[i % 3], &triangles, origin, &mut random) - origin,
                )
            });
            let tally = check(&format!("inside the {name} at {offset}"), &aggregate, rays);
            assert_eq!(tally.hits, tally.rays, "{name}: some rays leaked");
        }
    }
}

//! Closed meshes seen from inside: a ray that finds nothing has leaked.

use std::io::{Write, stderr};

use glam::Vec3;

use super::{
    each_set::Asked,
    meshes::{alone, cube, moved, sphere},
    oracle::check,
    random::Random,
};
use crate::bvh::{
    BuildOptions, Order, Ray,
    hard_cases::leaks::{AIMS, Aim, FAR, away, bundles, closed, leaks, target},
};

/// Says on the terminal itself, since what passing tests print is not shown, which instruction sets nobody has tested.
pub(super) fn name_untested(sets: &[&str]) {
    for set in sets {
        // A terminal that is gone is no reason to fail.
        let _ = writeln!(stderr(), "NOT TESTED, since this machine has no {set}");
    }
}

/// Shoots about so many rays at edges, corners and along axes, with every instruction set, alone and in packets, at the
/// origin and far from it.
fn shoot_with_every_set(rays: usize) {
    const AT: [Aim; 3] = [Aim::Edge, Aim::Vertex, Aim::Axis];
    let meshes = closed();
    let each = rays / (2 * meshes.len() * AT.len());
    let mut lacking = Vec::new();
    for (name, mesh, inside) in &meshes {
        for offset in [Vec3::ZERO, FAR] {
            // Rounding to coordinates of 1/64 takes points that are near walls to the other side.
            if offset != Vec3::ZERO && name.contains("near") {
                continue;
            }
            let scene = away(mesh, offset);
            let triangles = scene.instances()[0].mesh.triangles();
            for aim in AT {
                let mut random = Random::new(aim as u64 + 11);
                let rays = bundles(triangles, *inside, offset, aim, each, &mut random);
                for order in [Order::None, Order::Tile, Order::Light] {
                    let asked = Asked {
                        aggregate: &scene,
                        order,
                        rays: &rays,
                        through: |_| Vec3::ZERO,
                    };
                    lacking = asked.with_each(|set, found| {
                        let lost = found.hits.iter().filter(|hit| hit.is_none()).count();
                        let first = found.hits.iter().position(Option::is_none);
                        let first = first.map(|i| rays[i]);
                        let occluded = found.occluded.iter().filter(|occluded| **occluded);
                        let lit = found.passing.get().iter().filter(|part| **part != Vec3::ZERO);
                        let unseen = rays.len() - occluded.count() + lit.count();
                        assert_eq!(
                            (lost, unseen),
                            (0, 0),
                            "{name} at {offset}, {aim:?}, {set}, {order:?}: of {} rays leaked, first {first:?}",
                            rays.len()
                        );
                    });
                }
            }
        }
    }
    name_untested(&lacking);
}

#[test]
fn no_ray_leaks_with_any_instruction_set_alone_or_in_a_packet() {
    shoot_with_every_set(200_000);
}

#[test]
#[ignore = "ten million rays with every instruction set take minutes"]
fn no_ray_of_ten_million_leaks_with_any_instruction_set_alone_or_in_a_packet() {
    shoot_with_every_set(10_000_000);
}

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

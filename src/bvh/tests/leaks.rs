//! Closed meshes seen from inside: a ray that finds nothing has leaked.

use glam::Vec3;

use super::{
    meshes::{alone, cube, knot, knot_centre, moved, sphere},
    oracle::check,
    random::Random,
};
use crate::bvh::{BuildOptions, Ray, Triangles};

/// Where on a triangle a ray is aimed.
#[derive(Clone, Copy, Debug)]
enum Aim {
    Anywhere,
    Edge,
    Vertex,
}

const AIMS: [Aim; 3] = [Aim::Anywhere, Aim::Edge, Aim::Vertex];

fn target(aim: Aim, triangles: &Triangles, origin: Vec3, random: &mut Random) -> Vec3 {
    let triangle = random.below(triangles.len()) as u32;
    let corners = triangles.corners(triangle);
    let corner = random.below(3);
    let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
    match aim {
        Aim::Anywhere => origin + random.direction(),
        Aim::Edge => a + (b - a) * random.unit(),
        Aim::Vertex => a,
    }
}

/// Closed meshes and random points inside of them.
type Inside = fn(&mut Random) -> Vec3;

fn closed() -> [(&'static str, Triangles, Inside); 4] {
    [
        ("cube", cube(), |random| random.cube() * 0.95),
        // So near to walls that the far corners' roundings are larger than the distance to the wall.
        ("cube, near its edges", cube(), |random| {
            let near = |random: &mut Random| {
                random.of(&[-1.0, 1.0]) * (1.0 - (-random.between(2.0, 16.0)).exp2())
            };
            Vec3::new(near(random), near(random), random.between(-0.9, 0.9))
        }),
        ("sphere", sphere(4), |random| random.cube() * 0.5),
        ("knot", knot(240, 12), |random| {
            knot_centre(random.below(240) as f32 / 240.0) + random.cube() * 0.1
        }),
    ]
}

fn leaks(
    mesh: &Triangles,
    inside: Inside,
    offset: Vec3,
    aim: Aim,
    rays: usize,
) -> (usize, Option<Ray>) {
    let aggregate = alone(moved(mesh, |p| p + offset), &BuildOptions::default());
    let triangles = aggregate.instances()[0].mesh.triangles();
    let mut random = Random::new(rays as u64 + aim as u64);
    let mut lost = 0;
    let mut first = None;
    for _ in 0..rays {
        let origin = inside(&mut random) + offset;
        let ray = Ray::new(origin, target(aim, triangles, origin, &mut random) - origin);
        if ray.direction != Vec3::ZERO && aggregate.closest_hit(&ray).is_none() {
            lost += 1;
            first.get_or_insert(ray);
        }
    }
    (lost, first)
}

#[test]
fn no_ray_leaves_a_closed_mesh_through_a_face_an_edge_or_a_vertex() {
    for (name, mesh, inside) in closed() {
        for aim in AIMS {
            let (lost, first) = leaks(&mesh, inside, Vec3::ZERO, aim, 100_000);
            assert_eq!(
                lost, 0,
                "{name}, {aim:?}: {lost} of 100000 rays leaked, first {first:?}"
            );
        }
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh_far_from_the_origin() {
    let offset = Vec3::new(148_376.0, 1_234.0, -223_423.0);
    // Rounding to coordinates of 1/64 must leave the random points inside and the meshes closed.
    for (name, mesh, inside) in closed() {
        if name.contains("near") {
            continue;
        }
        for aim in AIMS {
            let (lost, first) = leaks(&mesh, inside, offset, aim, 100_000);
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
    for offset in [Vec3::ZERO, Vec3::new(148_376.0, 1_234.0, -223_423.0)] {
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

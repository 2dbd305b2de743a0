//! Closed meshes seen from inside: a ray that finds nothing has leaked.

use glam::Vec3;

use super::{
    meshes::{alone, cube, knot, knot_centre, moved, sphere},
    random::Random,
};
use crate::bvh::{Aggregate, BuildOptions, Ray, Triangles};

/// Where on a triangle a ray is aimed.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Aim {
    Anywhere,
    Edge,
    Vertex,
    /// Not at a triangle, but along an axis.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests alone aim so"))]
    Axis,
}

/// Those that are aimed at nothing special, and at triangles.
pub(crate) const AIMS: [Aim; 3] = [Aim::Anywhere, Aim::Edge, Aim::Vertex];

/// A place on a random triangle, or anywhere around the origin of the ray.
pub(crate) fn target(aim: Aim, triangles: &Triangles, origin: Vec3, random: &mut Random) -> Vec3 {
    let triangle = random.below(triangles.len()) as u32;
    target_on(aim, triangles, triangle, origin, random)
}

/// A place on that triangle, or somewhere around the origin of the ray.
fn target_on(
    aim: Aim,
    triangles: &Triangles,
    triangle: u32,
    origin: Vec3,
    random: &mut Random,
) -> Vec3 {
    let corners = triangles.corners(triangle);
    let corner = random.below(3);
    let (a, b) = (corners[corner], corners[(corner + 1) % 3]);
    match aim {
        Aim::Anywhere => origin + random.direction(),
        Aim::Edge => a + (b - a) * random.unit(),
        Aim::Vertex => a,
        Aim::Axis => origin + random.of(&Vec3::AXES) * random.of(&[-1.0, 1.0]),
    }
}

/// Rays that go together, as packets take them.
#[cfg(test)]
const TOGETHER: usize = 16;

/// Rays from inside a mesh that was moved by `offset`. Of sixteen in a row all go towards neighbouring triangles, from one
/// place, or along one axis, from several.
#[cfg(test)]
pub(crate) fn bundles(
    triangles: &Triangles,
    inside: Inside,
    offset: Vec3,
    aim: Aim,
    rays: usize,
    random: &mut Random,
) -> Vec<Ray> {
    let mut all = Vec::with_capacity(rays + TOGETHER);
    while all.len() < rays {
        let from = inside(random) + offset;
        let triangle = random.below(triangles.len());
        let along = target_on(Aim::Axis, triangles, 0, Vec3::ZERO, random);
        for _ in 0..TOGETHER {
            let neighbour = (triangle + random.below(6)) % triangles.len();
            let (from, direction) = match aim {
                Aim::Axis => (inside(random) + offset, along),
                aim => {
                    let to = target_on(aim, triangles, neighbour as u32, from, random);
                    (from, to - from)
                }
            };
            if direction != Vec3::ZERO {
                all.push(Ray::new(from, direction));
            }
        }
    }
    all
}

/// A random point inside a mesh.
pub(crate) type Inside = fn(&mut Random) -> Vec3;

/// Closed meshes and random points inside of them.
pub(crate) fn closed() -> [(&'static str, Triangles, Inside); 5] {
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
        // Along an axis from there, rays meet edges and corners.
        ("sphere, from its planes", sphere(4), |random| {
            (random.cube() * 4.0).round() / 8.0
        }),
        ("knot", knot(240, 12), |random| {
            knot_centre(random.below(240) as f32 / 240.0) + random.cube() * 0.1
        }),
    ]
}

/// How many rays from inside a mesh, which stands alone in `aggregate` moved by `offset`, find nothing; and the first.
pub(crate) fn leaks(
    aggregate: &Aggregate,
    inside: Inside,
    offset: Vec3,
    aim: Aim,
    rays: usize,
    random: &mut Random,
) -> (usize, Option<Ray>) {
    let triangles = aggregate.instances()[0].mesh.triangles();
    let mut lost = 0;
    let mut first = None;
    for _ in 0..rays {
        let origin = inside(random) + offset;
        let ray = Ray::new(origin, target(aim, triangles, origin, random) - origin);
        if ray.direction != Vec3::ZERO && aggregate.closest_hit(&ray).is_none() {
            lost += 1;
            first.get_or_insert(ray);
        }
    }
    (lost, first)
}

/// A mesh moved away from the origin, alone.
pub(crate) fn away(mesh: &Triangles, offset: Vec3) -> Aggregate {
    alone(moved(mesh, |p| p + offset), &BuildOptions::default())
}

/// Where far from the origin is: coordinates there are multiples of 1/64.
pub(crate) const FAR: Vec3 = Vec3::new(148_376.0, 1_234.0, -223_423.0);

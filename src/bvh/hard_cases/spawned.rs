//! Rays that start where another ended.

use std::f32::consts::TAU;

use glam::Vec3;

use super::{
    meshes::{alone, soup},
    random::Random,
};
use crate::bvh::{Aggregate, BuildOptions, Ray};

/// A unit direction on the side of `normal`, as often grazing (down to 1e-7) as steep.
fn leaving(normal: Vec3, random: &mut Random) -> Vec3 {
    let height = (-random.between(0.0, 16.0)).exp();
    let (sin, cos) = random.between(0.0, TAU).sin_cos();
    let side = normal.any_orthonormal_vector();
    let along = side * cos + normal.cross(side) * sin;
    (normal * height + along).normalize()
}

/// Rays from everywhere at a scene, and on from where they hit: how many of those hit the very same triangle.
pub(crate) fn self_hits(
    aggregate: &Aggregate,
    targets: &[Vec3],
    rays: usize,
    random: &mut Random,
) -> (usize, usize) {
    let (mut spawned, mut same) = (0, 0);
    for _ in 0..rays {
        let target = random.of(targets);
        let distance = random.between(-8.0, 8.0).exp();
        let origin = target + random.direction() * distance;
        let Some(hit) = aggregate.closest_hit(&Ray::new(origin, target - origin)) else {
            continue;
        };
        let surface = aggregate.instances()[hit.instance as usize].surface_point(&hit, 0.0);
        for side in [surface.normal, -surface.normal] {
            let direction = leaving(side, random);
            let start = aggregate.leave(&surface, direction);
            let next = aggregate.closest_hit(&Ray::new(start, direction));
            spawned += 1;
            same += usize::from(
                next.is_some_and(|n| (n.instance, n.triangle) == (hit.instance, hit.triangle)),
            );
        }
    }
    (spawned, same)
}

/// Triangles of sizes from e^-8 to e^8, and their middles.
pub(crate) fn triangles_of_all_sizes(random: &mut Random) -> (Aggregate, Vec<Vec3>) {
    let triangles: Vec<[Vec3; 3]> = (0..400)
        .map(|_| {
            let size = random.between(-8.0, 8.0).exp();
            let centre = random.cube() * random.between(-8.0, 8.0).exp();
            [(); 3].map(|()| centre + random.cube() * size)
        })
        .collect();
    let targets = triangles
        .iter()
        .map(|[a, b, c]| (*a + *b + *c) / 3.0)
        .collect();
    (alone(soup(triangles), &BuildOptions::default()), targets)
}

//! Rays that start where another ended.

use std::f32::consts::TAU;

use glam::{Affine3A, DVec3, Quat, Vec3};

use super::{
    meshes::{alone, cube, placed, soup},
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

/// A ray is mirrored to and fro inside a closed convex body, the only one of a scene, from its middle on and so often: how
/// many rays leave its sides, and whether the last of them starts outside. Nothing follows that.
pub(crate) fn mirrored_inside(
    scene: &Aggregate,
    bounces: usize,
    random: &mut Random,
) -> (usize, bool) {
    let instance = &scene.instances()[0];
    let triangles = instance.mesh.triangles();
    let time = random.unit();
    let stands = instance.stands_at(time).as_dvec3();
    let linear = instance.exact_linear();
    // The planes of its sides, which it lies behind.
    let planes: Vec<(DVec3, f64)> = (0..triangles.len() as u32)
        .map(|i| {
            let [a, b, c] = triangles.corners(i).map(|p| linear * p.as_dvec3());
            let normal = (b - a).cross(c - a).normalize();
            let inwards = -normal * normal.dot(a).signum();
            (inwards, inwards.dot(a))
        })
        .collect();
    let is_inside = |p: Vec3| {
        let p = p.as_dvec3() - stands;
        planes.iter().all(|(inwards, at)| inwards.dot(p) > *at)
    };
    let mut ray = Ray {
        time,
        ..Ray::new(stands.as_vec3(), random.direction())
    };
    if !is_inside(ray.origin) {
        return (0, false);
    }
    for bounce in 1..=bounces {
        let hit = scene.closest_hit(&ray).expect("the body is closed");
        let point = instance.surface_point(&hit, time);
        let direction = ray.direction - 2.0 * ray.direction.dot(point.normal) * point.normal;
        ray = Ray {
            time,
            ..scene.leaving(&point, direction.normalize())
        };
        if !is_inside(ray.origin) {
            return (bounce, true);
        }
    }
    (bounces, false)
}

/// From so many steps of the coordinates on no ray leaves a pane by starting on its other side.
pub(crate) const SAFE_PANE: f32 = 6.0;
/// In thinner ones so many starts of rays that leave a side far from its edges may lie outside (`bvh/geometry/leave.rs`).
pub(crate) const OUTSIDE_OF_THIN_PANES: f64 = 1e-3;

/// A pane of 20 m by 40 m that stands 148 km away, turned and moving; so many steps of the coordinates thick.
pub(crate) fn far_pane(steps: f32, random: &mut Random) -> Aggregate {
    const DISTANCE: f32 = 148_376.0;
    let mut turn = || Quat::from_axis_angle(random.direction(), random.between(0.0, TAU));
    let (outer, inner) = (turn(), turn());
    let mirror = Vec3::new(-1.0, 1.0, 1.0);
    let place = DISTANCE * Vec3::new(1.0, 0.25, -0.5);
    let thickness = steps * (DISTANCE.next_up() - DISTANCE);
    let transform = Affine3A::from_scale_rotation_translation(mirror, outer, place)
        * Affine3A::from_quat(inner)
        * Affine3A::from_scale(Vec3::new(10.0, 20.0, 0.5 * thickness));
    let still = placed(&[(cube(), transform)], &BuildOptions::default());
    let velocity = 3.0 * random.cube();
    let moving = still.instances()[0].clone().moving(velocity);
    let moving = moving.expect("it is not too fast");
    Aggregate::build(vec![moving], &BuildOptions::default())
}

/// Of so many panes, with so many steps between their sides: how many rays leave a side, and how many of them start outside.
pub(crate) fn outside_of_panes(
    panes: usize,
    steps: [f32; 2],
    random: &mut Random,
) -> (usize, usize) {
    let (mut left, mut outside) = (0, 0);
    for _ in 0..panes {
        let pane = far_pane(random.between(steps[0], steps[1]), random);
        for _ in 0..20 {
            let (rays, ends_outside) = mirrored_inside(&pane, 50, random);
            left += rays;
            outside += usize::from(ends_outside);
        }
    }
    (left, outside)
}

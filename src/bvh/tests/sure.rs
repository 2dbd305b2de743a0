//! What a ray surely crosses is not asked for its box: that changes no bit.

use glam::{Vec3, Vec3A};

use super::super::kernel::goal::{Any, Goal, Nearest, Question};
use super::super::kernel::object_ray::ObjectRay;
use super::super::kernel::safe_ray::Measure;
use super::super::kernel::wide::{Owner, Portable, Sheared, TriangleBlock};
use super::{
    random::Random,
    single::{ReadyRay, SingleTriangle},
};
use crate::bvh::{TriangleId, Triangles};

/// What a goal has found after a block was tested.
fn asked<G: Goal>(block: &TriangleBlock, ray: &ReadyRay, reach: f32, limit: f32, mut goal: G) -> G {
    let sight = Sheared {
        ray: ray.ray(),
        shear: ray.shear(),
    };
    let owner = Owner { instance: 0, reach };
    let mut question = Question {
        measure: Measure::unscaled(f32::INFINITY),
        starts_on: TriangleId::NONE,
        goal: &mut goal,
        visitor: &mut (),
    };
    block.cross::<Portable, G, ()>(&sight, owner, limit, &mut question);
    goal
}

/// Triangles of all sizes, near and far, fat, flat and along the ray; rays through them, from anywhere to as near to an edge as
/// numbers are; limits around where they cross.
#[test]
fn a_triangle_that_is_surely_crossed_is_crossed_as_its_box_and_plane_say() {
    let mut random = Random::new(23);
    let mut met = 0;
    for round in 0..600_000 {
        let scale = (random.between(-30.0, 30.0) as i32 as f32).exp2();
        let direction = random.cube();
        let middle = random.cube() * [0.0, 1.0, 30.0][round % 3];
        // Along the ray, so that it is seen from its edge, or else anyhow.
        let along = direction * [0.0, 1.0, 30.0][round / 3 % 3];
        let size = random.between(-20.0, 0.0).exp2();
        let corners = [(); 3]
            .map(|()| (middle + along * random.between(-1.0, 1.0) + random.cube() * size) * scale);
        // As far from the edge as its hundred-millionth part.
        let q = [0.3, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8][round / 9 % 7] * random.between(0.0, 1.0);
        let p = random.between(0.0, 1.0);
        let target = corners[0].lerp(corners[1], p).lerp(corners[2], q);
        // The least and the largest `t` are those of which is known at once whether there is a hit.
        let away = [2.0, 2.0, 2.0, 1e-7, 1e8][round / 63 % 5] * random.between(-0.1, 1.0);
        let origin = target - direction * scale * away;
        if direction == Vec3::ZERO {
            continue;
        }
        let longest = direction.abs().max_element();
        let ray = ObjectRay::new(Vec3A::from(origin), Vec3A::from(direction), longest);
        let ray = ReadyRay::of(ray);
        let mesh = Triangles::new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let mut blocks = Vec::new();
        TriangleBlock::append(&[0], &mesh, &mut blocks);
        let reach = corners.iter().map(|v| v.abs().max_element());
        let reach = reach.fold(0.0, f32::max);
        let triangle = SingleTriangle::new(corners);
        let t = triangle
            .cross(&ray, f32::INFINITY)
            .map_or(scale, |hit| hit.0);
        for limit in [f32::INFINITY, t, t.next_down(), t.next_up(), 0.5 * t] {
            let expected = triangle.cross(&ray, limit);
            let found = asked(&blocks[0], &ray, reach, limit, Nearest::NONE).0;
            let found = (found.triangle == 0).then_some((found.t, found.u, found.v));
            assert_eq!(
                found, expected,
                "round {round}, limit {limit:e}, {corners:?}"
            );
            let any = asked(&blocks[0], &ray, reach, limit, Any::default());
            let is_met = expected.is_some();
            assert_eq!(any.is_hit, is_met, "round {round}, any before {limit:e}");
            met += usize::from(is_met);
        }
    }
    assert!(met > 300_000, "{met} met");
}

//! Crossings that are found together.

use glam::{Affine3A, Vec3};

use super::{
    meshes::{cube, joined, knot, mesh, placed, scatter, soup},
    random::Random,
    transforms::any_transform,
};
use crate::bvh::{Aggregate, BuildOptions, Builder, Hit, Levels, MultiHit, Ray, Triangles};

/// Sheets that are cut by each other, each turned another way, around the origin; two of three lie where another does.
fn turned_sheets(count: usize, random: &mut Random) -> Triangles {
    let sheets = (0..count).flat_map(|_| {
        let normal = random.direction();
        let (a, b) = normal.any_orthonormal_pair();
        let at = 0.3 * random.cube();
        let corners = [at - a - b, at + a - b, at + a + b, at - a + b];
        let [p, q, r, s] = corners;
        std::iter::repeat_n([[p, q, r], [p, r, s]], 3).flatten()
    });
    soup(sheets)
}

/// Many layers of fans, whose triangles all meet on the axis: each is one crossing there.
fn fans(layers: u32) -> Triangles {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for layer in 0..layers {
        let z = -1.0 + 0.02 * layer as f32;
        let middle = positions.len() as u32;
        positions.push(Vec3::new(0.0, 0.0, z));
        positions.extend((0..24).map(|i| {
            let (sin, cos) = (i as f32 * std::f32::consts::TAU / 24.0).sin_cos();
            Vec3::new(cos, sin, z)
        }));
        indices.extend((0..24).map(|i| [middle, middle + 1 + i, middle + 1 + (i + 1) % 24]));
    }
    mesh(positions, indices)
}

fn one_by_one(scene: &Aggregate, ray: &Ray) -> Vec<Hit> {
    let first = scene.closest_hit(ray);
    std::iter::successors(first, |hit| scene.next_crossing(ray, hit)).collect()
}

fn together(scene: &Aggregate, ray: &Ray, multi_hit: &mut MultiHit) -> Vec<Hit> {
    let first = scene.closest_hit(ray);
    let next = |hit: &Hit| multi_hit.next_crossing(scene, ray, hit, &mut ());
    std::iter::successors(first, next).collect()
}

#[test]
fn crossings_that_are_found_together_are_those_found_one_by_one_to_the_bit() {
    let mut random = Random::new(47);
    let sheets = joined(&[turned_sheets(60, &mut random), cube(), knot(20, 8)]);
    let mesh = joined(&[sheets, scatter(500, 0.5, 7), fans(100)]);
    let places: Vec<Affine3A> = (0..2).map(|_| any_transform(&mut random)).collect();
    for (builder, levels, rays) in [
        (Builder::Sah, Levels::Two, 30),
        (Builder::Ploc, Levels::One, 30),
        (Builder::None, Levels::Two, 3),
    ] {
        let options = BuildOptions {
            builder,
            levels,
            ..BuildOptions::default()
        };
        // The first as it is, so that rays along the axis meet corners exactly.
        let places = std::iter::once(&Affine3A::IDENTITY).chain(&places);
        let meshes: Vec<_> = places.map(|&place| (mesh.clone(), place)).collect();
        let scene = placed(&meshes, &options);
        let (mut most, mut multi_hit) = (0, MultiHit::default());
        for i in 0..rays {
            let (from, to) = (3.0 * random.direction(), 0.3 * random.cube());
            let ray = match i % 3 {
                0 => Ray::new(
                    Vec3::new(0.0, 0.0, -5.0),
                    Vec3::Z * random.between(-80.0, 80.0).exp2(),
                ),
                _ => Ray::new(from, to - from),
            };
            let expected = one_by_one(&scene, &ray);
            assert_eq!(together(&scene, &ray, &mut multi_hit), expected, "{ray:?}");
            most = most.max(expected.len());
        }
        assert!(most > 200, "{builder:?}: at most {most} crossings");
    }
}

#[test]
fn what_was_found_for_one_ray_is_not_given_to_another_or_from_another_place_on_it() {
    let scene = placed(&[(fans(100), Affine3A::IDENTITY)], &BuildOptions::default());
    let ray = |x: f32| Ray::new(Vec3::new(x, 0.1, -5.0), Vec3::Z);
    let (here, there) = (ray(0.2), ray(-0.3));
    let expected = one_by_one(&scene, &here);
    let mut multi_hit = MultiHit::default();
    let mut next = |ray: &Ray, after: &Hit| multi_hit.next_crossing(&scene, ray, after, &mut ());
    for i in 0..40 {
        assert_eq!(next(&here, &expected[i]), Some(expected[i + 1]));
    }
    // Back on the same ray, and on from there.
    for i in 5..60 {
        assert_eq!(next(&here, &expected[i]), Some(expected[i + 1]));
    }
    let other = one_by_one(&scene, &there);
    assert_eq!(next(&there, &other[60]), Some(other[61]));
    assert_eq!(next(&here, &expected[61]), Some(expected[62]));
    assert_eq!(next(&here, &expected[99]), None);
}

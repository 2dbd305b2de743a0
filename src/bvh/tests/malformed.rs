//! Meshes that are broken, degenerate or not there.

use std::sync::Arc;

use glam::{Affine3A, Vec3};

use super::{
    broken::{degenerate, not_finite, with_extra},
    meshes::{alone, cube, mesh},
    oracle::{check, same},
    random::Random,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree, Ray, Triangles, TrianglesError,
};

const BUILDERS: [Builder; 4] = [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];

fn every_way() -> impl Iterator<Item = BuildOptions> {
    BUILDERS.into_iter().flat_map(|builder| {
        [Levels::One, Levels::Two].map(|levels| BuildOptions {
            builder,
            levels,
            ..BuildOptions::default()
        })
    })
}

fn rays(count: usize) -> impl Iterator<Item = Ray> {
    let mut random = Random::new(12);
    (0..count).map(move |_| {
        let origin = random.cube() * 2.0;
        Ray::new(origin, random.cube() - origin)
    })
}

#[test]
fn degenerate_triangles_are_counted_and_never_hit() {
    let mut random = Random::new(3);
    let extra = degenerate(&mut random);
    let (broken, count) = with_extra(&extra);
    assert_eq!(
        broken.degenerate() as usize,
        count,
        "degenerate triangles counted"
    );
    for options in every_way() {
        let aggregate = alone(broken.clone(), &options);
        let aimed = extra
            .iter()
            .map(|[a, b, _]| Ray::new(Vec3::splat(3.0), *a * 0.5 + *b * 0.5 - 3.0));
        for ray in rays(12_500).chain(aimed) {
            let hit = aggregate.closest_hit(&ray);
            let triangle = hit.map_or(u32::MAX, |h| h.triangle);
            assert!(
                triangle >= count as u32,
                "{options:?}: degenerate triangle {triangle} was hit by {ray:?}"
            );
        }
    }
    check(
        "among degenerate triangles",
        &alone(broken, &BuildOptions::default()),
        rays(20_000),
    );
}

#[test]
fn triangles_that_are_not_finite_are_left_out_counted_and_the_rest_is_intact() {
    let mut random = Random::new(4);
    let extra = not_finite(&mut random);
    let (broken, count) = with_extra(&extra);
    assert_eq!(broken.left_out() as usize, count, "triangles left out");
    let (intact, none) = with_extra(&[]);
    assert_eq!((intact.left_out(), intact.degenerate(), none), (0, 0, 0));
    for options in every_way() {
        let (broken, intact) = (
            alone(broken.clone(), &options),
            alone(intact.clone(), &options),
        );
        for ray in rays(12_500) {
            let renumbered = broken.closest_hit(&ray).map(|mut hit| {
                hit.triangle -= count as u32;
                hit
            });
            let expected = intact.closest_hit(&ray);
            assert!(same(renumbered, expected), "{options:?}: {ray:?}");
        }
    }
}

#[test]
fn an_index_out_of_range_is_an_error_that_names_the_triangle() {
    let error =
        Triangles::new(vec![Vec3::ZERO; 3], vec![[0, 1, 2], [0, 1, 3]]).expect_err("index 3 of 3");
    let expected = TrianglesError::IndexOutOfRange {
        triangle: 1,
        index: 3,
        positions: 3,
    };
    assert_eq!(error, expected);
    assert!(error.to_string().contains("triangle 1"), "{error}");
    assert!(
        Triangles::new(Vec::new(), vec![[u32::MAX; 3]]).is_err(),
        "no positions at all"
    );
}

#[test]
fn nothing_is_hit_where_nothing_is() {
    let empty = mesh(Vec::new(), Vec::new());
    let only_points = mesh(vec![Vec3::ONE; 2], vec![[0, 1, 0]; 4]);
    for options in every_way() {
        let mut scenes = vec![Aggregate::default(), Aggregate::build(Vec::new(), &options)];
        scenes.push(alone(empty.clone(), &options));
        scenes.push(alone(only_points.clone(), &options));
        for scene in &scenes {
            for ray in rays(2_000) {
                assert_eq!(scene.closest_hit(&ray), None, "{options:?}");
                assert!(!scene.occluded(&ray), "{options:?}");
            }
        }
    }
}

#[test]
fn empty_meshes_among_others_are_passed_over() {
    for options in every_way() {
        let tree = |triangles| Arc::new(MeshTree::build(triangles, &options));
        let (empty, full) = (tree(mesh(Vec::new(), Vec::new())), tree(cube()));
        let place = |mesh: &Arc<MeshTree>| {
            Instance::new(mesh.clone(), &Affine3A::IDENTITY).expect("identity")
        };
        let scene = Aggregate::build(vec![place(&empty), place(&full), place(&empty)], &options);
        assert!(
            place(&empty).world_bounds().is_none(),
            "an empty mesh has no bounds"
        );
        let hit = scene.closest_hit(&Ray::new(Vec3::new(0.1, 0.2, -3.0), Vec3::Z));
        assert_eq!(
            hit.map(|h| (h.t, h.instance)),
            Some((2.0, 1)),
            "{options:?}"
        );
    }
}

#[test]
fn one_triangle_is_hit_where_it_is() {
    let one = mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    for options in every_way() {
        let tally = check("one triangle", &alone(one.clone(), &options), rays(12_500));
        assert!(tally.hits > 100, "{options:?}: only {} hits", tally.hits);
    }
}

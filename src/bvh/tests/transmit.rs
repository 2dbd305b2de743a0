//! How much of a light passes what lies on a ray.

use glam::{Affine3A, Vec3};
use std::sync::Arc;

use super::super::kernel::safe_ray::SafeRay;
use super::{
    meshes::{alone, cube, joined, knot, mesh, placed, scatter, soup},
    random::Random,
    single::{ReadyRay, SingleTriangle},
    transforms::any_transform,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Counters, Hit, Instance, Levels, MeshTree, NodeEvent, Order,
    Ray, Transmittances, TreeRef, Visitor,
};

/// What a triangle lets through: a number for each colour that depends on which it is, and of some nothing.
pub(super) fn part(instance: u32, triangle: u32) -> Vec3 {
    let mut random = Random::new(u64::from(instance) << 32 | u64::from(triangle));
    if random.unit() < 0.02 {
        return Vec3::ZERO;
    }
    Vec3::splat(0.6) + 0.4 * Vec3::new(random.unit(), random.unit(), random.unit())
}

fn through(hit: &Hit) -> Vec3 {
    part(hit.instance, hit.triangle)
}

/// Every triangle in turn, in f64; and how many are crossed.
fn brute(scene: &Aggregate, ray: &Ray) -> (glam::DVec3, usize) {
    let (mut product, mut crossed) = (glam::DVec3::ONE, 0);
    let Some(safe) = SafeRay::new(ray) else {
        return (product, 0);
    };
    for (number, instance) in (0..).zip(scene.instances()) {
        let Some(object) = instance.to_object_ray(&safe.world, ray.time) else {
            continue;
        };
        let ready = ReadyRay::of(object);
        let triangles = instance.mesh.triangles();
        for triangle in (0..triangles.len() as u32).filter(|&t| triangles.is_traced(t)) {
            let single = SingleTriangle::new(triangles.corners(triangle));
            let crossing = single.cross(&ready, f32::INFINITY);
            if crossing.is_some_and(|(t, ..)| safe.measure.reaches(t)) {
                product *= part(number, triangle).as_dvec3();
                crossed += 1;
            }
        }
    }
    (product, crossed)
}

/// From crossing to crossing, nearest first.
fn layer_by_layer(scene: &Aggregate, ray: &Ray) -> Vec3 {
    let mut product = Vec3::ONE;
    let mut next = scene.closest_hit(ray);
    while let Some(hit) = next {
        product *= through(&hit);
        next = scene.next_crossing(ray, &hit);
    }
    product
}

/// Whether it is the product of so many numbers, each product rounded.
fn is_close(found: Vec3, exact: glam::DVec3, factors: usize) -> bool {
    let bound = (factors + 1) as f64 * f64::from(f32::EPSILON) / 2.0;
    (0..3).all(|i| (f64::from(found[i]) - exact[i]).abs() <= bound * exact[i])
}

fn passing(scene: &Aggregate, order: Order, rays: &[Ray]) -> Vec<Vec3> {
    let mut found = Transmittances::default();
    scene.transmittances_in(order, rays, |_, hit| through(hit), &mut found);
    found.get().to_vec()
}

#[test]
fn what_passes_is_the_product_over_all_triangles_for_every_tree_and_order_to_the_bit() {
    let mut random = Random::new(6);
    let mesh = joined(&[scatter(1_500, 0.3, 3), cube(), knot(20, 8)]);
    let places: Vec<Affine3A> = (0..3).map(|_| any_transform(&mut random)).collect();
    let rays: Vec<Ray> = (0..3_000)
        .map(|i| {
            let place = random.of(&places);
            let from = place.transform_point3(random.cube() * 2.0);
            let to = place.transform_point3(random.cube());
            Ray {
                t_max: [f32::INFINITY, 1.0, 0.4][i % 3],
                ..Ray::new(from, to - from)
            }
        })
        .collect();
    let mut first: Option<Vec<Vec3>> = None;
    for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
        for levels in [Levels::One, Levels::Two] {
            let options = BuildOptions {
                builder,
                levels,
                ..BuildOptions::default()
            };
            let meshes: Vec<_> = places.iter().map(|&place| (mesh.clone(), place)).collect();
            let scene = placed(&meshes, &options);
            for order in [Order::None, Order::Light] {
                let found = passing(&scene, order, &rays);
                let first = first.get_or_insert_with(|| {
                    let (mut most, mut zeros) = (0, 0);
                    for (ray, &found) in rays.iter().zip(&found) {
                        let (exact, crossed) = brute(&scene, ray);
                        assert!(
                            is_close(found, exact, crossed),
                            "{found}, {exact} in f64 over {crossed} crossings, {ray:?}"
                        );
                        assert_eq!(found, layer_by_layer(&scene, ray), "{ray:?}");
                        most = most.max(crossed);
                        zeros += usize::from(found == Vec3::ZERO);
                    }
                    assert!(most > 50, "at most {most} crossings");
                    assert!((100..2_900).contains(&zeros), "{zeros} of 3000 are blocked");
                    found.clone()
                });
                assert_eq!(*first, found, "{builder:?}, {levels:?}, {order:?}");
            }
            for (ray, &first) in rays.iter().zip(first.iter().flatten()) {
                let watched = scene.transmittance_with(ray, through, &mut Counters::default());
                assert_eq!(first, watched, "{builder:?}, {levels:?}, watched: {ray:?}");
            }
        }
    }
}

/// How often the tree that comes first was entered at its root, and boxes and triangles tested.
#[derive(Default)]
struct Effort {
    first: Option<TreeRef>,
    roots: usize,
    tests: usize,
}

impl Visitor for Effort {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, _: f32) {
        self.tests += 1;
        let is_first = *self.first.get_or_insert(tree) == tree;
        self.roots += usize::from(is_first && (node, event) == (0, NodeEvent::Entered));
    }

    fn triangle(&mut self, _: u32, _: u32, _: bool) {
        self.tests += 1;
    }
}

/// Square sheets, one behind the other: of one mesh, or an object each.
fn sheets(count: usize, one_mesh: bool) -> Aggregate {
    let options = BuildOptions::default();
    let sheet = |z: f32| {
        let [a, b, c, d] =
            [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(|[x, y]| Vec3::new(x as f32, y as f32, z));
        [[a, b, c], [a, c, d]]
    };
    if one_mesh {
        return alone(
            soup((0..count).flat_map(|i| sheet(i as f32 * 0.01))),
            &options,
        );
    }
    let mesh = Arc::new(MeshTree::build(soup(sheet(0.0)), &options));
    let instances = (0..count).map(|i| {
        let place = Affine3A::from_translation(Vec3::Z * (i as f32 * 0.01));
        Instance::new(mesh.clone(), &place).unwrap()
    });
    Aggregate::build(instances.collect(), &options)
}

#[test]
fn ten_thousand_sheets_are_one_walk_whose_length_grows_as_they_do() {
    let ray = Ray::new(Vec3::new(0.1, 0.3, -1.0), Vec3::new(0.001, 0.002, 1.0));
    let part =
        |number: u32| Vec3::new(1.0, 0.9999, 0.999) - Vec3::splat(1e-5 * (number % 7) as f32);
    for one_mesh in [true, false] {
        let mut before = None;
        for count in [0, 1, 2, 7, 100, 2_500, 5_000, 10_000] {
            let scene = sheets(count, one_mesh);
            let number = |hit: &Hit| match one_mesh {
                true => hit.triangle / 2,
                false => hit.instance,
            };
            let (mut effort, mut asked) = (Effort::default(), 0);
            let through = |hit: &Hit| {
                asked += 1;
                part(number(hit))
            };
            let found = scene.transmittance_with(&ray, through, &mut effort);
            let exact: glam::DVec3 = (0..count as u32).map(|i| part(i).as_dvec3()).product();
            assert!(
                is_close(found, exact, count),
                "{count} sheets: {found}, {exact} in f64"
            );
            assert_eq!(asked, count, "each sheet is asked once");
            let walks = usize::from(count > 0);
            assert_eq!(effort.roots, walks, "{count} sheets: walks");
            if count > 2_500 {
                let more = effort.tests as f64 / before.unwrap_or(1) as f64;
                assert!(
                    more <= 2.2,
                    "{count} sheets: {more} times the boxes and triangles of half as many"
                );
            }
            before = Some(effort.tests);
        }
    }
}

#[test]
fn triangles_that_share_the_edge_or_corner_of_a_crossing_let_through_once() {
    // A fan of eight triangles around the origin.
    let corner = |i: usize| {
        let angle = i as f32 * std::f32::consts::TAU / 8.0;
        Vec3::new(angle.cos(), 0.0, angle.sin())
    };
    let corners: Vec<Vec3> = std::iter::once(Vec3::ZERO)
        .chain((0..8).map(corner))
        .collect();
    let indices = (0..8).map(|i| [0, i + 1, (i + 1) % 8 + 1]).collect();
    let fan = alone(mesh(corners, indices), &BuildOptions::default());
    let down = |to: Vec3| Ray::new(to + Vec3::Y, Vec3::NEG_Y);
    let halves = |hit: &Hit| Vec3::splat(if hit.triangle == 0 { 0.5 } else { 0.25 });
    let passing = |ray: &Ray| fan.transmittance_with(ray, halves, &mut ());
    assert_eq!(passing(&down(Vec3::ZERO)), Vec3::splat(0.5), "the corner");
    assert_eq!(
        passing(&down(corner(0) * 0.5)),
        Vec3::splat(0.5),
        "an edge of the first"
    );
    assert_eq!(
        passing(&down(corner(3) * 0.5)),
        Vec3::splat(0.25),
        "another edge"
    );
    // The first one's crossing counts, though nothing passes the other, which the walk may meet before.
    let opaque = |hit: &Hit| Vec3::splat(if hit.triangle == 0 { 0.5 } else { 0.0 });
    let found = fan.transmittance_with(&down(corner(0) * 0.5), opaque, &mut ());
    assert_eq!(found, Vec3::splat(0.5), "an edge with an opaque triangle");
}

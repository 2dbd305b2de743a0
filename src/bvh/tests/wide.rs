//! The wide form of a tree: the same triangles, the same hits, on every machine.

use glam::{Affine3A, Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};

use super::{
    each_set::Asked,
    leaks::name_untested,
    meshes::{cube, joined, knot, mesh, placed, scatter, soup},
    oracle::same,
    random::Random,
    transforms::any_transform,
    trees::chain,
};
use std::sync::Arc;

use super::super::kernel::goal::{All, Nearest, Question};
use super::super::kernel::safe_ray::Measure;
use super::super::kernel::slab::SlabRay;
use super::super::kernel::visitor::TreeRef;
use super::super::kernel::wide::{
    FEW, LEAF, Leaves, MANY, Portable, TriangleBlock, WIDTH, WideRay, WideTree, walk,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Hit, Instance, Levels, MAX_DEPTH, MeshTree, Order, Ray,
    Transmittances, TriangleId, Triangles,
};

/// Rays from everywhere to everywhere, some along axes and into corners, some that end early.
fn rays(count: usize, places: &[Affine3A]) -> Vec<Ray> {
    let mut random = Random::new(77);
    (0..count)
        .map(|i| {
            let place = random.of(places);
            let (mut from, mut to) = (random.cube() * 2.0, random.cube());
            if i % 3 == 0 {
                (from, to) = ((from * 2.0).round() / 2.0, (to * 2.0).round() / 2.0);
            }
            let from = place.transform_point3(from);
            let direction = place.transform_point3(to) - from;
            Ray {
                t_max: random.of(&[f32::INFINITY, 1.0, 0.7]),
                ..Ray::new(from, direction)
            }
        })
        .collect()
}

/// Rays that go nearly the same way, sixteen by sixteen and now and then one fewer, from one place or from several; some
/// that cannot be traced, or only alone, are among them.
fn bundles(count: usize, places: &[Affine3A]) -> Vec<Ray> {
    let mut random = Random::new(78);
    let odd = |ray: Ray, i: usize| match i % 40 {
        0 => Ray {
            direction: Vec3::ZERO,
            ..ray
        },
        1 => Ray {
            t_max: f32::NAN,
            ..ray
        },
        2 => Ray {
            direction: ray.direction * 1e-36,
            ..ray
        },
        3 => Ray {
            origin: Vec3::INFINITY,
            ..ray
        },
        4 => Ray {
            direction: ray.direction * Vec3::new(0.0, -0.0, 1.0),
            ..ray
        },
        5 => Ray { time: 2.0, ..ray },
        6 => Ray {
            direction: ray.direction * 1e30,
            t_max: ray.t_max * 1e-30,
            ..ray
        },
        7 => Ray {
            t_max: 1e-40,
            ..ray
        },
        _ => ray,
    };
    let widths = [0.0, 1e-6, 0.02, 0.5];
    (0..count / 16)
        .flat_map(|bundle| {
            let lead = rays(1, places)[0];
            let place = random.of(places);
            let from = place.transform_point3(random.cube() * 2.0);
            let to = place.transform_point3((random.cube() * 2.0).round() / 2.0);
            let (spread, apart) = (random.of(&widths), random.of(&widths));
            let t_max = random.of(&[f32::INFINITY, 1.0, 0.7]);
            let count = 16 - bundle % 11 / 10;
            (0..count)
                .map(|i| {
                    let ray = Ray {
                        origin: from + random.cube() * apart,
                        direction: to - from + random.cube() * spread,
                        t_max,
                        time: if bundle % 3 == 0 {
                            (i as f32) / 16.0
                        } else {
                            lead.time
                        },
                        starts_on: TriangleId::NONE,
                    };
                    odd(ray, if bundle % 9 == 0 { bundle + i } else { 39 })
                })
                .collect::<Vec<_>>()
        })
        .collect()
}

/// A mesh at each of these places.
fn repeated(mesh: &Triangles, places: &[Affine3A], levels: Levels) -> Aggregate {
    let options = BuildOptions {
        levels,
        ..BuildOptions::default()
    };
    let meshes: Vec<(Triangles, Affine3A)> =
        places.iter().map(|&place| (mesh.clone(), place)).collect();
    placed(&meshes, &options)
}

/// Every third ray starts on the triangle that it hits; how many do.
fn start_on_what_they_hit(scene: &Aggregate, rays: &mut [Ray]) -> usize {
    let some = rays.iter_mut().step_by(3);
    some.filter_map(|ray| {
        ray.starts_on = scene.closest_hit(ray)?.id();
        Some(())
    })
    .count()
}

#[test]
fn a_ray_meets_everything_but_the_triangle_that_it_starts_on() {
    let mut random = Random::new(6);
    let mesh = joined(&[scatter(300, 0.2, 3), knot(30, 8)]);
    let turned: Vec<Affine3A> = (0..5).map(|_| any_transform(&mut random)).collect();
    for places in [vec![Affine3A::IDENTITY], turned] {
        for levels in [Levels::One, Levels::Two] {
            let scene = repeated(&mesh, &places, levels);
            let mut rays = rays(10_000, &places);
            rays.extend(bundles(10_000, &places));
            let plain = rays.clone();
            let count = start_on_what_they_hit(&scene, &mut rays);
            assert!(count > 1_000, "only {count} rays");
            let (mut all, mut left, mut found) = (Vec::new(), Vec::new(), Vec::new());
            let mut occluded = Vec::new();
            scene.closest_hits_in(Order::Tile, &rays, &mut found);
            scene.occlusions_in(Order::Light, &rays, &mut occluded);
            for (i, (ray, plain)) in rays.iter().zip(&plain).enumerate() {
                scene.all_hits(plain, &mut all);
                all.retain(|hit| hit.id() != ray.starts_on);
                scene.all_hits(ray, &mut left);
                assert_eq!(left, all, "{levels:?}: {ray:?}");
                let nearest = all.first().copied();
                assert!(
                    same(found[i], nearest),
                    "{levels:?}: {:?}, {ray:?}",
                    found[i]
                );
                assert!(same(scene.closest_hit(ray), nearest), "{levels:?}: {ray:?}");
                assert_eq!(occluded[i], nearest.is_some(), "{levels:?}: {ray:?}");
            }
        }
    }
}

/// What a crossing lets through.
fn through(hit: &Hit) -> Vec3 {
    let part = 0.5 + (hit.triangle % 8) as f32 / 17.0;
    Vec3::new(part, 1.0, (hit.instance % 5) as f32 / 4.0)
}

#[test]
fn every_instruction_set_and_every_order_finds_the_same_bits() {
    let mut random = Random::new(5);
    let mesh = joined(&[scatter(3_000, 0.1, 3), cube(), knot(60, 12), cube()]);
    let turned: Vec<Affine3A> = (0..12).map(|_| any_transform(&mut random)).collect();
    for places in [vec![Affine3A::IDENTITY], turned] {
        for levels in [Levels::One, Levels::Two] {
            let scene = repeated(&mesh, &places, levels);
            // A million over the four scenes.
            let mut rays = rays(100_000, &places);
            rays.extend(bundles(150_000, &places));
            let through_the_first = start_on_what_they_hit(&scene, &mut rays);
            assert!(through_the_first > 10_000, "only {through_the_first} rays");
            // Each by itself, not made ready with others.
            let hits: Vec<_> = rays.iter().map(|ray| scene.closest_hit(ray)).collect();
            let occluded: Vec<_> = rays.iter().map(|ray| scene.occluded(ray)).collect();
            let mut passing = Transmittances::default();
            scene.transmittances_in(Order::None, &rays, |_, hit| through(hit), &mut passing);
            let found = hits.iter().flatten().count();
            assert!(found > 50_000, "{levels:?}: only {found} hits");
            for order in [Order::None, Order::Tile, Order::Light] {
                let asked = Asked {
                    aggregate: &scene,
                    order,
                    rays: &rays,
                    through,
                };
                let lacking = asked.with_each(|set, found| {
                    for (i, ray) in rays.iter().enumerate() {
                        let (a, b) = (hits[i], found.hits[i]);
                        assert!(
                            same(a, b),
                            "{set}, {order:?}, {levels:?}: {b:?} instead of {a:?}, {ray:?}"
                        );
                        assert_eq!(
                            occluded[i], found.occluded[i],
                            "{set}, {order:?}, {levels:?}: occluded, {ray:?}"
                        );
                        assert_eq!(
                            passing.get()[i],
                            found.passing.get()[i],
                            "{set}, {order:?}, {levels:?}: passing, {ray:?}"
                        );
                        assert_eq!(a.is_some(), occluded[i], "{levels:?}: {ray:?}");
                    }
                });
                name_untested(&lacking);
            }
        }
    }
}

#[test]
fn moving_instances_are_met_by_packets_as_by_single_rays() {
    let options = BuildOptions::default();
    let tree = Arc::new(MeshTree::build(knot(60, 12), &options));
    let mut random = Random::new(9);
    let places: Vec<Affine3A> = (0..12).map(|_| any_transform(&mut random)).collect();
    let instances = places.iter().map(|place| {
        let instance = Instance::new(tree.clone(), place).unwrap();
        instance.moving(random.cube()).unwrap()
    });
    let scene = Aggregate::build(instances.collect(), &options);
    let rays = bundles(60_000, &places);
    let (mut hits, mut packets) = (Vec::new(), Vec::new());
    scene.closest_hits(&rays, &mut hits);
    scene.closest_hits_in(Order::Tile, &rays, &mut packets);
    let found = hits.iter().flatten().count();
    assert!(found > 6_000, "only {found} hits");
    for (i, ray) in rays.iter().enumerate() {
        assert!(
            same(hits[i], packets[i]),
            "{:?}, in a packet {:?}, {ray:?}",
            hits[i],
            packets[i]
        );
    }
}

/// What is wrong with a mesh's wide form, if anything.
fn fault(tree: &MeshTree) -> Option<String> {
    let (wide, blocks) = tree.wide();
    let nodes: Vec<Vec<(Aabb, u32)>> = wide.nodes().collect();
    let mut found = Vec::new();
    let everywhere = Aabb::INFINITY;
    let mut pending: Vec<(Aabb, u32)> = wide
        .root()
        .map(|root| (everywhere, root))
        .into_iter()
        .collect();
    let mut visited = 0;
    while let Some((bounds, child)) = pending.pop() {
        let within =
            |inner: &Aabb| inner.min.cmpge(bounds.min).all() && inner.max.cmple(bounds.max).all();
        if child & LEAF == 0 {
            visited += 1;
            let children = &nodes[child as usize];
            if !(2..=WIDTH).contains(&children.len()) {
                return Some(format!("node {child} has {} children", children.len()));
            }
            if !children.iter().all(|(inner, _)| within(inner)) {
                return Some(format!("a child of node {child} sticks out"));
            }
            pending.extend(children);
            continue;
        }
        for block in &blocks[(child & !LEAF) as usize..] {
            for (corners, number) in block.triangles() {
                let [a, b, c] = corners.map(Vec3A::from);
                if !within(&Aabb::new(a.min(b).min(c), a.max(b).max(c))) {
                    return Some(format!("triangle {number} sticks out of its leaf"));
                }
                if corners != tree.triangles().corners(number) {
                    return Some(format!("triangle {number} is another one"));
                }
                found.push(number);
            }
            if !block.continues() {
                break;
            }
        }
    }
    let mut expected: Vec<u32> = (0..tree.traced())
        .map(|place| tree.triangle_at(place))
        .collect();
    found.sort_unstable();
    expected.sort_unstable();
    if found != expected {
        return Some(format!(
            "{} triangles instead of {}",
            found.len(),
            expected.len()
        ));
    }
    (visited != nodes.len()).then(|| format!("{visited} of {} nodes are reachable", nodes.len()))
}

#[test]
fn the_binary_and_the_wide_form_hold_exactly_the_same_triangles() {
    let meshes = [
        mesh(Vec::new(), Vec::new()),
        cube(),
        scatter(1, 0.5, 1),
        scatter(8, 0.5, 2),
        scatter(9, 0.5, 3),
        scatter(5_000, 0.05, 4),
        knot(100, 20),
        soup(vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 3_000]),
        soup((0..3_000).map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::X * i as f32))),
    ];
    for triangles in &meshes {
        for builder in [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc] {
            for (max_leaf_size, max_depth) in [(1, 64), (8, 64), (255, 64), (8, 3)] {
                let options = BuildOptions {
                    builder,
                    max_leaf_size,
                    max_depth,
                    ..BuildOptions::default()
                };
                let tree = MeshTree::build(triangles.clone(), &options);
                let stats = tree.wide_stats();
                assert_eq!(fault(&tree), None, "{options:?}, {stats:?}");
                let triangles = stats.triangles_per_block * stats.blocks as f64;
                assert_eq!(triangles.round() as usize, tree.traced(), "{stats:?}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_makes_the_same_of_a_large_mesh() {
    // Enough that threads share single cuts, and the conversion.
    let triangles = knot(1_000, 50);
    let options = BuildOptions::default();
    let [alone, shared] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("a pool of threads");
        pool.install(|| MeshTree::build(triangles.clone(), &options))
    });
    assert_eq!(fault(&alone), None);
    let form = |tree: &MeshTree| {
        let (wide, blocks) = tree.wide();
        let children = |node: Vec<(Aabb, u32)>| node.into_iter().map(|(_, child)| child).collect();
        let nodes: Vec<Vec<u32>> = wide.nodes().map(children).collect();
        let numbers = blocks.iter().flat_map(|block| block.triangles());
        let numbers: Vec<u32> = numbers.map(|(_, number)| number).collect();
        (nodes, numbers)
    };
    assert!(
        form(&alone) == form(&shared),
        "another tree with more threads"
    );
}

#[test]
fn collapsing_fills_nodes_and_blocks_of_an_ordinary_mesh() {
    let tree = MeshTree::build(knot(400, 25), &BuildOptions::default());
    let stats = tree.wide_stats();
    assert!(stats.children_per_node > 10.0, "{stats:?}");
    assert!(stats.triangles_per_block > 6.0, "{stats:?}");
    assert!(stats.bytes < 100 * tree.traced(), "{stats:?}");
}

/// Counts how often each leaf is visited.
struct Visits(Vec<u32>);

impl<G, V> Leaves<Portable, G, V> for Visits {
    fn tree(&self) -> TreeRef {
        TreeRef::Top
    }

    fn visit(&mut self, leaf: u32, limit: f32, _: &mut [u64], _: &mut Question<G, V>) -> f32 {
        self.0[leaf as usize] += 1;
        limit
    }
}

#[test]
fn a_tree_as_deep_as_any_is_walked_to_its_last_leaf_within_its_stack() {
    for leaf_first in [true, false] {
        let tree = Bvh2 {
            nodes: chain(MAX_DEPTH, leaf_first),
            ..Bvh2::default()
        };
        let (wide, leaves) = WideTree::new(&tree, TriangleBlock::CAPACITY, |leaf, leaves| {
            leaves.push(leaf)
        });
        assert!(
            wide.most_pending() <= MANY / 2,
            "{} pending",
            wide.most_pending()
        );
        let slab = SlabRay::new(Vec3A::ZERO, Vec3A::new(0.3, -0.4, 0.5), 0.5, 0.0);
        let ray = WideRay::<Portable>::new(&slab, 0.0);
        let mut visits = Visits(vec![0; leaves.len()]);
        let end = f32::INFINITY;
        let mut stack = vec![0; wide.most_pending() + WIDTH];
        let measure = Measure::unscaled(end);
        let mut goal = Nearest::NONE;
        let mut nearest = Question {
            measure,
            starts_on: TriangleId::NONE,
            goal: &mut goal,
            visitor: &mut (),
        };
        walk(&wide, &mut stack, &ray, end, &mut visits, &mut nearest);
        let mut all = Question {
            measure,
            starts_on: TriangleId::NONE,
            goal: &mut All(&mut Vec::new()),
            visitor: &mut (),
        };
        walk(&wide, &mut stack, &ray, end, &mut visits, &mut all);
        let expected = vec![2; leaves.len()];
        assert_eq!(visits.0, expected, "leaves were visited so often");
    }
}

#[test]
fn a_mesh_that_needs_a_large_stack_is_traced_like_any_other() {
    // Boxes that shrink by powers of two: the best tree parts one after another from all smaller ones.
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let triangles = soup((-60..38).flat_map(|exponent| {
        axes.map(|axis| {
            let far = axis * 2f32.powi(exponent);
            let aside = Vec3::new(axis.y, axis.z, axis.x) * far.length() * 0.3;
            [far, far * 0.5 + aside, far * 0.5 - aside]
        })
    }));
    let options = BuildOptions {
        builder: Builder::Sah,
        max_leaf_size: 1,
        max_depth: MAX_DEPTH as u32,
        ..BuildOptions::default()
    };
    let scene = placed(&[(triangles, Affine3A::IDENTITY)], &options);
    let most_pending = scene.instances()[0].mesh.wide_stats().most_pending;
    assert!(most_pending > FEW, "only {most_pending} pending");
    for ray in rays(2_000, &[Affine3A::IDENTITY]) {
        let hit = scene.closest_hit(&ray);
        assert!(same(hit, super::oracle::brute(&scene, &ray)), "{ray:?}");
    }
}

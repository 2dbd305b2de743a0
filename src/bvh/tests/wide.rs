//! The wide form of a tree: the same triangles, every leaf reached.

use super::super::kernel::goal::{All, Nearest, Question};
use super::super::kernel::safe_ray::Measure;
use super::super::kernel::slab::SlabRay;
use super::super::kernel::visitor::TreeRef;
use super::super::kernel::wide::{
    LEAF, Leaves, MANY, Portable, TriangleBlock, WIDTH, WideRay, WideTree, walk,
};
use super::{
    meshes::{cube, knot, mesh, scatter, soup},
    trees::chain,
};
use crate::bvh::{BuildOptions, Builder, MAX_DEPTH, MeshTree, TriangleId};
use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};

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

//! Boxes in, tree out.

use super::{
    boxes::{self, Item},
    layout, median,
    options::{BuildOptions, Builder},
    ploc,
    sah::{self, Bins},
    top_down::{self, Cut},
    treelets,
};
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, node::Bvh2Node},
};
use rayon::prelude::*;

/// Builds a tree over primitives of which `boxes[i]` bounds the `i`th. Boxes are finite with min ≤ max, and
/// at most 2^31 of them; callers leave out what is not. (A box that is not finite is placed at the origin and
/// spoils the boxes of its ancestors, nothing more.)
///
/// The tree's node boxes are the exact unions of `boxes`. Its `primitive_indices` holds every index once, in
/// the order of the leaves, so that the primitives of a subtree are a range of it. Children stand side by
/// side and after their parent. No boxes, no nodes. The same boxes and options give the same tree, whatever
/// the number of threads; boxes scaled by a power of two too.
pub fn build_tree(boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    let options = options.clamped();
    match options.builder {
        _ if boxes.is_empty() => Bvh2::default(),
        Builder::None => one_leaf(boxes),
        // There is one way to build it. Models of hundreds of thousands of such meshes are read.
        _ if boxes.len() == 1 => one_leaf(boxes),
        Builder::Median => top_down(boxes, &|items, centres, depth, _| {
            median::cut(items, centres, depth, &options)
        }),
        Builder::Sah => top_down(boxes, &|items, centres, depth, bins| {
            sah::cut(items, centres, depth, &options, bins)
        }),
        Builder::Ploc => {
            let normalised = boxes::normalised(boxes);
            let Some(draft) = ploc::build(&normalised, &options) else {
                let builder = Builder::Sah;
                return build_tree(boxes, &BuildOptions { builder, ..options });
            };
            let tree = layout::finish(&draft, &normalised, &options);
            let tree = treelets::rebuild(tree, &normalised, &options);
            layout::finish(&tree, boxes, &options)
        }
    }
}

fn one_leaf(boxes: &[Aabb]) -> Bvh2 {
    let bounds = boxes::union(boxes.iter().copied()).unwrap_or_default();
    let nodes = vec![Bvh2Node::new(bounds, boxes.len() as u32, 0)];
    layout::tree(nodes, (0..boxes.len() as u32).collect(), 0)
}

fn top_down<C>(boxes: &[Aabb], cut: &C) -> Bvh2
where
    C: Fn(&mut [Item], &Aabb, u32, &mut Bins) -> Option<Cut> + Sync,
{
    let mut items = boxes::items(boxes);
    let grown = top_down::build(&mut items, boxes, cut);
    let primitives = items.par_iter().map(Item::number).collect();
    layout::tree(grown.nodes, primitives, grown.depth)
}

#[cfg(test)]
mod tests {
    use super::super::depth::MAX_DEPTH;
    use super::super::options::Preset;
    use super::*;
    use crate::bvh::{TreeStats, sah_cost, specimens};
    use glam::{Vec3, Vec3A, vec3a};
    use proptest::prelude::*;

    const BUILDERS: [Builder; 4] = [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];
    const PRESETS: [Preset; 5] = [
        Preset::Fastest,
        Preset::Fast,
        Preset::Medium,
        Preset::Slow,
        Preset::VerySlow,
    ];

    fn with(builder: Builder) -> BuildOptions {
        BuildOptions {
            builder,
            ..BuildOptions::default()
        }
    }

    /// What is wrong with a tree over `boxes`, and the depth of its deepest leaf if nothing is.
    fn check(tree: &Bvh2, boxes: &[Aabb], options: &BuildOptions) -> Result<usize, String> {
        let mut unseen: Vec<u32> = tree.primitive_indices.clone();
        unseen.sort_unstable();
        if unseen != (0..boxes.len() as u32).collect::<Vec<_>>() {
            return Err("the primitive indices are not a permutation".into());
        }
        let mut visited = 0;
        let mut primitives = 0;
        let mut deepest = 0;
        let mut stack: Vec<(usize, usize)> =
            tree.nodes.first().map(|_| (0, 0)).into_iter().collect();
        while let Some((index, depth)) = stack.pop() {
            let node = tree.nodes[index];
            visited += 1;
            deepest = deepest.max(depth);
            let first = node.first_index as usize;
            let below: Vec<Aabb> = if node.is_leaf() {
                if first != primitives {
                    return Err(format!(
                        "leaf {index} starts at {first}, not at {primitives}"
                    ));
                }
                primitives += node.prim_count as usize;
                let range = first..primitives;
                let limit = options.max_leaf_size as usize;
                if range.len() > limit
                    && options.builder != Builder::None
                    && (options.builder == Builder::Ploc || depth < options.max_depth as usize)
                {
                    return Err(format!("leaf {index} holds {} of {limit}", range.len()));
                }
                let indices = &tree.primitive_indices[range];
                indices.iter().map(|&p| boxes[p as usize]).collect()
            } else {
                if first <= index {
                    return Err(format!("node {index} stands after its child {first}"));
                }
                stack.extend([(first + 1, depth + 1), (first, depth + 1)]);
                vec![*tree.nodes[first].aabb(), *tree.nodes[first + 1].aabb()]
            };
            let union = boxes::union(below).ok_or(format!("node {index} holds nothing"))?;
            if union.min != node.aabb().min || union.max != node.aabb().max {
                return Err(format!(
                    "node {index}: {:?} instead of {union:?}",
                    node.aabb()
                ));
            }
        }
        if (visited, primitives) != (tree.nodes.len(), boxes.len()) {
            return Err(format!(
                "{visited} nodes, {primitives} primitives are reachable"
            ));
        }
        let top_down = matches!(options.builder, Builder::Median | Builder::Sah);
        if deepest > MAX_DEPTH || top_down && deepest > options.max_depth as usize {
            return Err(format!("{deepest} levels"));
        }
        if tree.max_depth <= deepest {
            return Err(format!("max_depth {} of {deepest} levels", tree.max_depth));
        }
        Ok(deepest)
    }

    fn checked(boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
        let tree = build_tree(boxes, options);
        if let Err(fault) = check(&tree, boxes, &options.clamped()) {
            panic!("{options:?}, {} boxes: {fault}", boxes.len());
        }
        tree
    }

    /// Ordinary coordinates, a few that occur again and again, and the largest and smallest there are.
    fn coordinate() -> impl Strategy<Value = f32> {
        prop_oneof![
            4 => -10.0f32..10.0,
            4 => (-3i32..3).prop_map(|i| i as f32),
            1 => (-149i32..128).prop_map(|e| 2f64.powi(e) as f32),
            1 => any::<f32>().prop_filter("finite", |x| x.is_finite()),
        ]
    }

    fn any_box() -> impl Strategy<Value = Aabb> {
        prop::array::uniform2(prop::array::uniform3(coordinate())).prop_map(|[a, b]| {
            let (a, b) = (Vec3A::from(a), Vec3A::from(b));
            Aabb::new(a.min(b), a.max(b))
        })
    }

    fn any_options() -> impl Strategy<Value = BuildOptions> {
        let choices = (
            prop::sample::select(BUILDERS.to_vec()),
            prop::sample::select(PRESETS.to_vec()),
        );
        let numbers = (any_small(), any_small(), any_small());
        (choices, numbers).prop_map(|((builder, preset), (max_depth, max_leaf_size, bins))| {
            BuildOptions {
                builder,
                max_depth,
                max_leaf_size,
                bins,
                preset,
                ..BuildOptions::default()
            }
        })
    }

    fn any_small() -> impl Strategy<Value = u32> {
        prop_oneof![8 => 0u32..70, 1 => any::<u32>()]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(512))]

        #[test]
        fn any_boxes_and_any_options_build_a_correct_tree(
            boxes in prop::collection::vec(any_box(), 0..300),
            options in any_options(),
        ) {
            let tree = build_tree(&boxes, &options);
            if let Err(fault) = check(&tree, &boxes, &options.clamped()) {
                prop_assert!(false, "{}", fault);
            }
        }
    }

    #[test]
    fn nothing_builds_no_nodes_and_one_box_builds_one_leaf() {
        for builder in BUILDERS {
            assert!(checked(&[], &with(builder)).nodes.is_empty(), "{builder:?}");
            let one = [Aabb::new(Vec3A::ZERO, Vec3A::ONE)];
            assert_eq!(checked(&one, &with(builder)).nodes.len(), 1, "{builder:?}");
        }
    }

    #[test]
    fn without_a_tree_one_leaf_holds_everything() {
        let boxes = specimens::boxes(&specimens::soup(1_000, 0.1, 3));
        let stats = TreeStats::of(&checked(&boxes, &with(Builder::None)));
        assert_eq!((stats.nodes, stats.largest_leaf), (1, 1_000));
        assert_eq!(stats.sah_cost, 125.0);
    }

    #[test]
    fn rows_and_heaps_of_equal_boxes_build_shallow_trees() {
        let triangle = [Vec3::ZERO, Vec3::X * 0.5, Vec3::Y * 0.5];
        let row = |step: fn(f32) -> f32| -> Vec<Aabb> {
            let moved = |i| triangle.map(|corner| corner + Vec3::X * step(i as f32));
            specimens::boxes(&(0..100_000).map(moved).collect::<Vec<_>>())
        };
        let cases = [
            ("identical", row(|_| 0.0)),
            ("equally spaced", row(|i| i)),
            ("ever farther apart", row(|i| i * i)),
            ("points", vec![Aabb::from_point(Vec3A::ONE); 100_000]),
            ("points at the origin", vec![Aabb::default(); 100_000]),
        ];
        for (name, boxes) in cases {
            for builder in [Builder::Median, Builder::Sah, Builder::Ploc] {
                let levels = TreeStats::of(&checked(&boxes, &with(builder))).levels;
                let most = if builder == Builder::Ploc { 96 } else { 30 };
                assert!(levels <= most, "{name}, {builder:?}: {levels} levels");
            }
        }
    }

    #[test]
    fn boxes_that_shrink_by_powers_of_two_stay_within_the_depth_limit() {
        // The best tree peels off one box after another, 3 × 250 levels deep.
        let boxes: Vec<Aabb> = (-125..125)
            .flat_map(|e| [Vec3A::X, Vec3A::Y, Vec3A::Z].map(|axis| axis * 2f32.powi(e)))
            .map(|corner| Aabb::new(corner * 0.5, corner))
            .collect();
        for builder in BUILDERS {
            for preset in PRESETS {
                for max_leaf_size in [1, 8] {
                    let options = BuildOptions {
                        builder,
                        preset,
                        max_leaf_size,
                        max_depth: u32::MAX,
                        ..BuildOptions::default()
                    };
                    checked(&boxes, &options);
                }
            }
        }
    }

    #[test]
    fn a_box_that_is_not_finite_leaves_the_others_findable() {
        let mut boxes = specimens::boxes(&specimens::soup(500, 0.1, 3));
        boxes[7].max = Vec3A::NAN;
        boxes[70] = Aabb::INFINITY;
        for builder in BUILDERS {
            let tree = build_tree(&boxes, &with(builder));
            let mut indices = tree.primitive_indices;
            indices.sort_unstable();
            assert!(indices.into_iter().eq(0..500), "{builder:?}");
        }
    }

    #[test]
    fn powers_of_two_and_threads_do_not_change_the_tree() {
        let boxes = specimens::boxes(&specimens::knot(20_000));
        let scaled = |scale: f32| -> Vec<Aabb> {
            let scale_box = |b: &Aabb| Aabb::new(b.min * scale, b.max * scale);
            boxes.iter().map(scale_box).collect()
        };
        let shape = |tree: &Bvh2| -> Vec<(u32, u32)> {
            let nodes = tree.nodes.iter();
            nodes
                .map(|node| (node.prim_count, node.first_index))
                .collect()
        };
        let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        let one_thread = one_thread.expect("a pool of one thread");
        for builder in BUILDERS {
            let options = with(builder);
            let tree = one_thread.install(|| build_tree(&boxes, &options));
            for scale in [1.0, 2f32.powi(-90), 2f32.powi(90)] {
                let other = build_tree(&scaled(scale), &options);
                assert_eq!(
                    tree.primitive_indices, other.primitive_indices,
                    "{builder:?}, {scale:e}"
                );
                assert_eq!(shape(&tree), shape(&other), "{builder:?}, {scale:e}");
            }
        }
    }

    #[test]
    fn sah_costs_less_than_median_and_clustering_at_most_a_twentieth_more_than_sah() {
        let meshes = [
            ("sphere", specimens::bumpy_sphere(40_000)),
            ("knot", specimens::knot(40_000)),
            ("small soup", specimens::soup(40_000, 0.02, 1)),
            ("large soup", specimens::soup(10_000, 0.5, 2)),
            ("needles", specimens::needles(40_000, 3)),
        ];
        for (name, mesh) in meshes {
            let boxes = specimens::boxes(&mesh);
            let cost = |builder| sah_cost(&checked(&boxes, &with(builder)));
            let (median, sah) = (cost(Builder::Median), cost(Builder::Sah));
            let ploc = cost(Builder::Ploc);
            assert!(sah < median, "{name}: SAH {sah:.2}, median {median:.2}");
            assert!(
                ploc <= 1.05 * sah,
                "{name}: PLOC {ploc:.2} is {:.3} x SAH's {sah:.2}",
                ploc / sah
            );
        }
    }

    #[test]
    fn better_presets_build_trees_that_cost_less() {
        let boxes = specimens::boxes(&specimens::bumpy_sphere(40_000));
        let costs = PRESETS.map(|preset| {
            let options = BuildOptions {
                preset,
                ..with(Builder::Ploc)
            };
            sah_cost(&checked(&boxes, &options))
        });
        // Where leaves are merged into blocks, what `Medium` searches more than `Fast` is lost among them.
        let [fastest, fast, medium, slow, very_slow] = costs;
        assert!(fastest > fast.max(medium), "{costs:?}");
        assert!(fast.min(medium) > slow && slow > very_slow, "{costs:?}");
    }

    #[test]
    fn depth_and_leaf_size_are_obeyed_one_against_the_other() {
        let boxes = specimens::boxes(&specimens::soup(4_096, 0.01, 9));
        for builder in [Builder::Median, Builder::Sah] {
            let options = BuildOptions {
                max_depth: 5,
                ..with(builder)
            };
            let stats = TreeStats::of(&checked(&boxes, &options));
            assert_eq!(stats.levels, 5, "{builder:?}");
            assert!(stats.largest_leaf >= 128, "{builder:?}: {stats:?}");
        }
        let halved = TreeStats::of(&checked(&boxes, &with(Builder::Median)));
        assert_eq!(halved.leaf_sizes, [0, 0, 0, 0, 0, 0, 0, 0, 512]);
        assert_eq!(halved.depths[9], 512);
    }

    #[test]
    fn points_that_no_plane_parts_are_halved_by_sah_too() {
        let boxes = vec![Aabb::new(vec3a(1.0, 2.0, 3.0), vec3a(2.0, 3.0, 4.0)); 1_024];
        let stats = TreeStats::of(&checked(&boxes, &with(Builder::Sah)));
        assert_eq!((stats.levels, stats.leaves), (7, 128));
    }
}

//! Any triangles, any parameters: the tree holds exactly those that can be traced, each once, inside its boxes.

use glam::Vec3;
use proptest::prelude::*;

use super::meshes::mesh;
use crate::bvh::{BuildOptions, Builder, MAX_DEPTH, MeshTree, Preset, Triangles};

/// Ordinary coordinates, a few that occur again and again, extreme ones, and none at all.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![
        6 => -10.0f32..10.0,
        6 => (-2i32..2).prop_map(|i| i as f32),
        2 => (-149i32..128).prop_map(|e| 2f64.powi(e) as f32),
        1 => any::<f32>(),
        1 => prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0]),
    ]
}

/// Few positions for many triangles: repeated corners and repeated triangles come by themselves.
fn any_triangles() -> impl Strategy<Value = Triangles> {
    let positions = prop::collection::vec(prop::array::uniform3(coordinate()), 1..40);
    positions.prop_flat_map(|positions| {
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from).collect();
        let count = positions.len() as u32;
        prop::collection::vec(prop::array::uniform3(0..count), 0..200)
            .prop_map(move |indices| mesh(positions.clone(), indices))
    })
}

fn any_options() -> impl Strategy<Value = BuildOptions> {
    let builders = vec![Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];
    let presets = vec![
        Preset::Fastest,
        Preset::Fast,
        Preset::Medium,
        Preset::Slow,
        Preset::VerySlow,
    ];
    let number = || prop_oneof![8 => 0u32..70, 1 => any::<u32>()];
    let numbers = (number(), number(), number());
    (
        prop::sample::select(builders),
        prop::sample::select(presets),
        numbers,
    )
        .prop_map(
            |(builder, preset, (max_depth, max_leaf_size, bins))| BuildOptions {
                builder,
                max_depth,
                max_leaf_size,
                bins,
                preset,
                ..BuildOptions::default()
            },
        )
}

/// What is wrong with a mesh's tree.
fn fault(built: &MeshTree) -> Option<String> {
    let triangles = built.triangles();
    let all = 0..triangles.len() as u32;
    let expected: Vec<u32> = all.filter(|&t| triangles.is_traced(t)).collect();
    let left = triangles.left_out() as usize + triangles.degenerate() as usize;
    if expected.len() + left != triangles.len() {
        return Some(format!(
            "{} traced, {left} not, of {}",
            expected.len(),
            triangles.len()
        ));
    }
    let nodes = &built.tree().nodes;
    let mut found = Vec::new();
    let mut stack: Vec<(usize, usize)> = nodes.first().map(|_| (0, 0)).into_iter().collect();
    while let Some((index, depth)) = stack.pop() {
        let node = nodes[index];
        if depth > MAX_DEPTH {
            return Some(format!("node {index} is {depth} deep"));
        }
        let first = node.first_index as usize;
        let inside = |min: Vec3, max: Vec3| node.min.cmple(min).all() && node.max.cmpge(max).all();
        if node.is_leaf() {
            for place in first..first + node.prim_count as usize {
                let triangle = built.triangle_at(place);
                let corners = triangles.corners(triangle);
                if !corners.iter().all(|&corner| inside(corner, corner)) {
                    return Some(format!("leaf {index} does not contain triangle {triangle}"));
                }
                found.push(triangle);
            }
        } else {
            for child in [first, first + 1] {
                if !inside(nodes[child].min, nodes[child].max) {
                    return Some(format!("node {index} does not contain node {child}"));
                }
                stack.push((child, depth + 1));
            }
        }
    }
    found.sort_unstable();
    (found != expected).then(|| format!("the leaves hold {found:?} instead of {expected:?}"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn any_triangles_and_any_options_build_a_tree_of_exactly_what_can_be_traced(
        triangles in any_triangles(),
        options in any_options(),
    ) {
        let built = MeshTree::build(triangles, &options);
        if let Some(fault) = fault(&built) {
            prop_assert!(false, "{:?}: {}", options, fault);
        }
    }
}

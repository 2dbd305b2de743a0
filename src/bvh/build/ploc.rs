//! obvhs' locally-ordered clustering (Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding
//! Volume Hierarchy Construction", 2018) with reinsertion (the same, "Parallel Reinsertion for Bounding
//! Volume Hierarchy Optimization", 2018).
//!
//! WHEN to use it: to see what building from below does. Rays go through its trees a little more slowly than through those of
//! binned SAH, and it takes longer; `glassbox report` compares them on a scene. It runs on one thread, so that the
//! same boxes always give the same tree.

use super::options::{BuildOptions, Preset};
use super::{boxes, layout};
use crate::bvh::measure::stats;
use crate::bvh::measure::stats::{COST_INTERSECT, COST_TRAVERSE};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
};

/// obvhs' parameters for these options. Written as an update of a preset's value, field by field.
fn parameters(options: &BuildOptions) -> BvhBuildParams {
    let preset = match options.preset {
        Preset::Fastest => BvhBuildParams::fastest_build(),
        Preset::Fast => BvhBuildParams::fast_build(),
        Preset::Medium => BvhBuildParams::medium_build(),
        Preset::Slow => BvhBuildParams::slow_build(),
        Preset::VerySlow => BvhBuildParams::very_slow_build(),
    };
    BvhBuildParams {
        // Split primitives would be in several leaves.
        pre_split: false,
        max_prims_per_leaf: options.max_leaf_size,
        // The presets say 3, which suits another triangle test; leaves here are weighed as everywhere else.
        collapse_traversal_cost: COST_TRAVERSE / COST_INTERSECT,
        ..preset
    }
}

/// Reinsertion searches the tree for a better place for each of its candidates, and the more the boxes overlap
/// the longer it searches: about as the tree's SAH cost. Above this cost there are fewer candidates in
/// proportion, so that time stays O(n log n). Meshes of millions of triangles cost 20 to 50; 1e5 identical
/// triangles cost 1e4, and took `VerySlow` 17 s.
const UNLIMITED_COST: f64 = 512.0;

/// A tree that is deeper is not reinserted into: obvhs' search keeps a stack of 192 entries and panics when
/// that is full, and reinsertion makes trees deeper. (Two million triangles of a sphere with slivers at its
/// poles are 75 deep.)
const REINSERTION_DEPTH: usize = 96;

/// A tree over `boxes`, which are normalised. Its boxes are those of the jittered primitives, its nodes in no
/// particular order, its depth not bounded: [`layout`](super::layout) sees to all three. `None` where obvhs
/// panicked: what is known to make it panic is kept from it, and another builder steps in for the rest.
pub(in crate::bvh) fn build(boxes: &[Aabb], options: &BuildOptions) -> Option<Bvh2> {
    let parameters = parameters(options);
    let boxes = boxes::jittered(boxes);
    std::panic::catch_unwind(|| cluster(&boxes, parameters)).ok()
}

fn cluster(boxes: &[Aabb], parameters: BvhBuildParams) -> Bvh2 {
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        boxes,
        indices,
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    let limit = (UNLIMITED_COST / stats::sah_cost(&tree)).min(1.0) as f32;
    let before = parameters.reinsertion_batch_ratio * limit;
    let after = before * parameters.post_collapse_reinsertion_batch_ratio_multiplier;
    reinsert(&mut tree, before);
    collapse(
        &mut tree,
        parameters.max_prims_per_leaf,
        parameters.collapse_traversal_cost,
    );
    reinsert(&mut tree, after);
    tree
}

fn reinsert(tree: &mut Bvh2, batch_ratio: f32) {
    if batch_ratio > 0.0 && !layout::exceeds(&tree.nodes, 0, REINSERTION_DEPTH) {
        ReinsertionOptimizer::default().run(tree, batch_ratio, None);
    }
}

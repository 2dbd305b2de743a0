//! obvhs' locally-ordered clustering (Meister and Bittner, "Parallel Locally-Ordered Clustering for Bounding
//! Volume Hierarchy Construction", 2018) with reinsertion (the same, "Parallel Reinsertion for Bounding
//! Volume Hierarchy Optimization", 2018).
//!
//! WHEN to use it: always, unless you want to see what another rule does. Its trees cost rays least.

use super::{
    boxes,
    options::{BuildOptions, Preset},
    sah::{COST_INTERSECT, COST_TRAVERSE},
};
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

/// A tree over `boxes`, which are normalised. Its boxes are those of the jittered primitives, its nodes in no
/// particular order, its depth not bounded: [`layout`](super::layout) sees to all three.
pub(super) fn build(boxes: &[Aabb], options: &BuildOptions) -> Bvh2 {
    let parameters = parameters(options);
    let boxes = boxes::jittered(boxes);
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        parameters.ploc_search_distance,
        &boxes,
        indices,
        parameters.sort_precision,
        parameters.search_depth_threshold,
    );
    let before = parameters.reinsertion_batch_ratio;
    let after = before * parameters.post_collapse_reinsertion_batch_ratio_multiplier;
    let mut reinsertion = ReinsertionOptimizer::default();
    reinsertion.run(&mut tree, before, None);
    collapse(
        &mut tree,
        parameters.max_prims_per_leaf,
        parameters.collapse_traversal_cost,
    );
    reinsertion.run(&mut tree, after, None);
    tree
}

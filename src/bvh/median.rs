//! Median split: half of the primitives on either side. Quick, balanced, and blind to empty space.
//!
//! WHEN to use it: as the plain tree that the others are measured against, and where only the depth counts.

use super::{boxes, options::BuildOptions};
use glam::Vec3A;
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// Where to cut `items` (which it reorders), or `None` where they are a leaf.
pub(super) fn cut(items: &mut [Bvh2Node], depth: u32, options: &BuildOptions) -> Option<usize> {
    (items.len() > options.max_leaf_size as usize && depth < options.max_depth)
        .then(|| halve(items))
}

/// Puts the half with the smaller centroids first, along the longest axis of the centroids' bounds, and
/// answers how many there are. `items` holds at least two.
///
/// Equal centroids are ordered by index, so duplicates are halved like anything else and the halves do not
/// depend on how the items were ordered before.
pub(super) fn halve(items: &mut [Bvh2Node]) -> usize {
    let middle = items.len() / 2;
    let axis = centroid_bounds(items).largest_axis();
    items.select_nth_unstable_by(middle, |a, b| {
        boxes::centroid(a)[axis]
            .total_cmp(&boxes::centroid(b)[axis])
            .then(a.first_index.cmp(&b.first_index))
    });
    middle
}

/// The bounds of the centroids.
pub(super) fn centroid_bounds(items: &[Bvh2Node]) -> Aabb {
    let (min, max) = items
        .iter()
        .map(boxes::centroid)
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), c| {
            (min.min(c), max.max(c))
        });
    Aabb::new(min, max)
}

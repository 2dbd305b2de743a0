//! Median split: half of the primitives on either side. Quick, balanced, and blind to empty space.
//!
//! WHEN to use it: as the plain tree that the others are measured against, and where only the depth counts.

use super::{boxes::Item, options::BuildOptions, top_down::Cut};
use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Where to cut `items` (which it reorders), or `None` where they are a leaf. `centres` bounds theirs.
pub(super) fn cut(
    items: &mut [Item],
    centres: &Aabb,
    depth: u32,
    options: &BuildOptions,
) -> Option<Cut> {
    (items.len() > options.max_leaf_size as usize && depth < options.max_depth)
        .then(|| halve(items, centres))
}

/// Puts the half with the smaller centres first, along the longest axis of their bounds. `items` holds at least two.
///
/// Equal centres are ordered by number, so duplicates are halved like anything else and the halves do not
/// depend on how the items were ordered before.
pub(super) fn halve(items: &mut [Item], centres: &Aabb) -> Cut {
    let middle = items.len() / 2;
    let axis = centres.largest_axis();
    items.select_nth_unstable_by(middle, |a, b| {
        a.centre()[axis]
            .total_cmp(&b.centre()[axis])
            .then(a.number().cmp(&b.number()))
    });
    let (left, right) = items.split_at(middle);
    Cut {
        position: middle,
        centres: [centre_bounds(left), centre_bounds(right)],
    }
}

/// The bounds of the centres, doubled as [`Item::centre`] gives them.
pub(super) fn centre_bounds(items: &[Item]) -> Aabb {
    let (min, max) = items
        .iter()
        .map(Item::centre)
        .fold((Vec3A::INFINITY, Vec3A::NEG_INFINITY), |(min, max), c| {
            (min.min(c), max.max(c))
        });
    Aabb::new(min, max)
}

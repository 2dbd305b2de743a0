//! Binned SAH: of 3 × (bins − 1) planes, the split that a random ray pays least for.
//!
//! Wald, "On fast Construction of SAH-based Bounding Volume Hierarchies", 2007, section 3.
//! WHEN to use it: a good tree from a top-down build that is easy to explain, and to draw plane by plane.

use super::{boxes, median, options::BuildOptions};
use glam::Vec3A;
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

/// What visiting an inner node costs a ray, in units that [`COST_INTERSECT`] shares.
pub const COST_TRAVERSE: f32 = 1.0;
/// What testing one primitive costs a ray. Builders and statistics weigh with the same two numbers.
pub const COST_INTERSECT: f32 = 1.0;

/// The primitives whose centroids fall into one slab of the centroids' bounds.
#[derive(Clone, Copy)]
pub(super) struct Bin {
    bounds: Aabb,
    count: u32,
    /// Area times count of all the primitives in this bin and those after it.
    cost_from_here: f32,
}

impl Bin {
    const EMPTY: Self = Self {
        bounds: Aabb::INVALID,
        count: 0,
        cost_from_here: 0.0,
    };
}

/// Items go into bins by this rule, once to count them and once to move them.
#[derive(Clone, Copy)]
struct Binning {
    origin: Vec3A,
    bins_per_length: Vec3A,
    last: u32,
}

impl Binning {
    fn new(centroids: &Aabb, bins: u32) -> Self {
        Self {
            origin: centroids.min,
            bins_per_length: Vec3A::splat(bins as f32) / centroids.diagonal(),
            last: bins - 1,
        }
    }

    /// The bin on each axis. An axis without extent gives 0/0, which turns into bin 0.
    fn of(&self, item: &Bvh2Node) -> [usize; 3] {
        let position = (boxes::centroid(item) - self.origin) * self.bins_per_length;
        position
            .to_array()
            .map(|p| (p as u32).min(self.last) as usize)
    }
}

/// A plane between two bins.
struct Split {
    axis: usize,
    /// The first bin of the right side.
    bin: usize,
    left_count: usize,
    /// Σ area × count of the two sides.
    cost: f32,
}

/// Where to cut `items` (which it reorders), or `None` where they are a leaf: at the greatest depth, or when
/// there are few enough and a leaf costs no more than the best split. Where no plane separates the
/// centroids it halves them.
pub(super) fn cut(
    items: &mut [Bvh2Node],
    depth: u32,
    options: &BuildOptions,
    bins: &mut Vec<Bin>,
) -> Option<usize> {
    if items.len() < 2 || depth >= options.max_depth {
        return None;
    }
    let may_be_leaf = items.len() <= options.max_leaf_size as usize;
    let binning = Binning::new(&median::centroid_bounds(items), options.bins);
    let Some(split) = best_split(items, &binning, bins) else {
        return (!may_be_leaf).then(|| median::halve(items));
    };
    let area = bounds(items).half_area();
    let leaf_cost = area * items.len() as f32 * COST_INTERSECT;
    let split_cost = area * COST_TRAVERSE + split.cost * COST_INTERSECT;
    if may_be_leaf && leaf_cost <= split_cost {
        return None;
    }
    partition(items, |item| binning.of(item)[split.axis] < split.bin);
    Some(split.left_count)
}

fn bounds(items: &[Bvh2Node]) -> Aabb {
    items
        .iter()
        .fold(Aabb::INVALID, |bounds, item| bounds.union(item.aabb()))
}

/// The cheapest of all planes that have primitives on both sides; of equally cheap ones (rows of points have
/// no area anywhere) the most balanced, so that the tree stays shallow. `None` where there is no such plane.
fn best_split(items: &[Bvh2Node], binning: &Binning, bins: &mut Vec<Bin>) -> Option<Split> {
    let per_axis = binning.last as usize + 1;
    bins.clear();
    bins.resize(3 * per_axis, Bin::EMPTY);
    for item in items {
        let chosen = binning.of(item);
        for (axis, &bin) in chosen.iter().enumerate() {
            let bin = &mut bins[axis * per_axis + bin];
            bin.bounds = bin.bounds.union(item.aabb());
            bin.count += 1;
        }
    }
    let mut best: Option<Split> = None;
    let imbalance = |left: usize| (2 * left).abs_diff(items.len());
    for (axis, bins) in bins.chunks_exact_mut(per_axis).enumerate() {
        let mut right = Bin::EMPTY;
        for bin in bins.iter_mut().rev() {
            right.bounds = right.bounds.union(&bin.bounds);
            right.count += bin.count;
            bin.cost_from_here = cost(&right);
        }
        let mut left = Bin::EMPTY;
        for boundary in 1..per_axis {
            let bin = &bins[boundary - 1];
            left.bounds = left.bounds.union(&bin.bounds);
            left.count += bin.count;
            let left_count = left.count as usize;
            if bin.count == 0 || left_count == items.len() {
                continue;
            }
            let cost = cost(&left) + bins[boundary].cost_from_here;
            let better = best.as_ref().is_none_or(|best| {
                cost < best.cost
                    || cost == best.cost && imbalance(left_count) < imbalance(best.left_count)
            });
            if better {
                best = Some(Split {
                    axis,
                    bin: boundary,
                    left_count,
                    cost,
                });
            }
        }
    }
    best
}

/// Area times count; an empty bin's inside-out box counts nothing.
fn cost(bin: &Bin) -> f32 {
    if bin.count == 0 {
        0.0
    } else {
        bin.bounds.half_area() * bin.count as f32
    }
}

/// Moves the items that are `left` before those that are not.
fn partition(items: &mut [Bvh2Node], left: impl Fn(&Bvh2Node) -> bool) {
    let (mut begin, mut end) = (0, items.len());
    while begin < end {
        if left(&items[begin]) {
            begin += 1;
        } else {
            end -= 1;
            items.swap(begin, end);
        }
    }
}

//! The plane that parts a node's children, for those who draw it.

use glam::Vec3A;
use obvhs::{aabb::Aabb, bvh2::Bvh2};
use std::ops::Range;

/// An axis-aligned plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SplitPlane {
    /// 0, 1 or 2 for x, y or z.
    pub axis: usize,
    /// The coordinate on that axis, in the tree's space.
    pub position: f32,
}

/// The plane that has the centroids of one child's primitives on one side and those of the other child's on
/// the other: the criterion by which `Median` and `Sah` split, read back from the tree, so that it holds for
/// every builder. It lies halfway between the nearest centroids of the two sides; where several axes part
/// the children it is the one along which the centroids extend farthest (`Median`'s rule).
///
/// `None` for a leaf, and where no plane does that (clustering knows no planes, and duplicates have none).
/// `box_at` gives the box of the primitive at a place in leaf order. O(n) for a node over n primitives.
pub fn split_plane(tree: &Bvh2, node: usize, box_at: impl Fn(usize) -> Aabb) -> Option<SplitPlane> {
    let parent = tree.nodes.get(node).filter(|node| !node.is_leaf())?;
    let child = parent.first_index as usize;
    let centroids = |node: usize| {
        primitives_below(tree, node).fold(
            (Vec3A::INFINITY, Vec3A::NEG_INFINITY),
            |(min, max), place| {
                let b = box_at(place);
                let centroid = b.min * 0.5 + b.max * 0.5;
                (min.min(centroid), max.max(centroid))
            },
        )
    };
    let (left, right) = (centroids(child), centroids(child + 1));
    let extent = left.1.max(right.1) - left.0.min(right.0);
    let plane = |axis: usize| {
        let (below, above) = if left.1[axis] <= right.0[axis] {
            (left.1[axis], right.0[axis])
        } else if right.1[axis] <= left.0[axis] {
            (right.1[axis], left.0[axis])
        } else {
            return None;
        };
        let position = below * 0.5 + above * 0.5;
        (extent[axis] > 0.0).then_some(SplitPlane { axis, position })
    };
    (0..3)
        .filter_map(plane)
        .max_by(|a, b| extent[a.axis].total_cmp(&extent[b.axis]))
}

/// The plane halfway between the boxes of a node's children, on the axis on which they lie farthest apart
/// (touching counts as 0); `None` for a leaf, and where the boxes overlap. What can be said of a tree whose
/// builder knows no planes.
pub fn gap_plane(tree: &Bvh2, node: usize) -> Option<SplitPlane> {
    let parent = tree.nodes.get(node).filter(|node| !node.is_leaf())?;
    let child = parent.first_index as usize;
    let (left, right) = (&tree.nodes[child], &tree.nodes[child + 1]);
    let gap =
        |axis: usize| (right.min[axis] - left.max[axis]).max(left.min[axis] - right.max[axis]);
    let axis = (0..3).max_by(|&a, &b| gap(a).total_cmp(&gap(b)))?;
    let (below, above) = if left.max[axis] <= right.min[axis] {
        (left.max[axis], right.min[axis])
    } else {
        (right.max[axis], left.min[axis])
    };
    let position = below * 0.5 + above * 0.5;
    (gap(axis) >= 0.0).then_some(SplitPlane { axis, position })
}

/// The part of `primitive_indices` that holds the primitives of a subtree. O(depth).
pub fn primitives_below(tree: &Bvh2, node: usize) -> Range<usize> {
    let end_leaf = |side: usize| {
        let mut node = tree.nodes[node];
        while !node.is_leaf() {
            node = tree.nodes[node.first_index as usize + side];
        }
        node
    };
    let last = end_leaf(1);
    end_leaf(0).first_index as usize..(last.first_index + last.prim_count) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::{BuildOptions, Builder, build_tree, specimens};

    fn row(count: usize) -> Vec<Aabb> {
        (0..count)
            .map(|i| Aabb::from_point(Vec3A::Y * i as f32))
            .collect()
    }

    /// The boxes by their places in the order of the leaves.
    fn in_order<'a>(tree: &'a Bvh2, boxes: &'a [Aabb]) -> impl Fn(usize) -> Aabb + 'a {
        |place| boxes[tree.primitive_indices[place] as usize]
    }

    #[test]
    fn a_row_of_points_is_halved_between_its_middle_points() {
        let boxes = row(10);
        let options = BuildOptions {
            builder: Builder::Median,
            ..BuildOptions::default()
        };
        let tree = build_tree(&boxes, &options);
        assert_eq!(
            split_plane(&tree, 0, in_order(&tree, &boxes)),
            Some(SplitPlane {
                axis: 1,
                position: 4.5
            })
        );
    }

    #[test]
    fn top_down_builders_have_a_plane_in_every_inner_node() {
        let boxes = specimens::boxes(&specimens::soup(5_000, 0.05, 1));
        for builder in [Builder::Median, Builder::Sah] {
            let options = BuildOptions {
                builder,
                ..BuildOptions::default()
            };
            let tree = build_tree(&boxes, &options);
            let inner: Vec<usize> = (0..tree.nodes.len())
                .filter(|&node| !tree.nodes[node].is_leaf())
                .collect();
            let without = inner
                .iter()
                .filter(|&&node| split_plane(&tree, node, in_order(&tree, &boxes)).is_none())
                .count();
            assert_eq!(without, 0, "{builder:?}: of {} inner nodes", inner.len());
        }
    }

    #[test]
    fn boxes_that_do_not_overlap_have_a_plane_between_them_and_overlapping_ones_none() {
        let options = BuildOptions {
            max_leaf_size: 1,
            ..BuildOptions::default()
        };
        let apart = [(0.0, 1.0), (3.0, 4.0)]
            .map(|(min, max)| Aabb::new(Vec3A::new(0.0, min, 0.0), Vec3A::new(1.0, max, 1.0)));
        let tree = build_tree(&apart, &options);
        let plane = SplitPlane {
            axis: 1,
            position: 2.0,
        };
        assert_eq!(gap_plane(&tree, 0), Some(plane));
        assert_eq!(gap_plane(&tree, 1), None);
        let over = [(0.0, 2.0), (1.0, 4.0)]
            .map(|(min, max)| Aabb::new(Vec3A::splat(min), Vec3A::splat(max)));
        assert_eq!(gap_plane(&build_tree(&over, &options), 0), None);
    }

    #[test]
    fn leaves_duplicates_and_nodes_that_do_not_exist_have_no_plane() {
        let boxes = vec![Aabb::from_point(Vec3A::ONE); 20];
        let tree = build_tree(&boxes, &BuildOptions::default());
        for node in 0..=tree.nodes.len() {
            assert_eq!(split_plane(&tree, node, in_order(&tree, &boxes)), None);
        }
    }
}

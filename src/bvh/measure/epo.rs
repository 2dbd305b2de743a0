//! Effective parent overlap: how much surface lies in nodes that it does not belong to.
//!
//! Aila, Karras, Laine, "On Quality Metrics of Bounding Volume Hierarchies", 2013, section 3: SAH cost
//! supposes rays that end nowhere; rays that end on surfaces meet the nodes that overlap there.

use super::stats::own_cost;
use glam::{DVec3, Vec3};
use obvhs::bvh2::{Bvh2, node::Bvh2Node};
use rayon::prelude::*;

/// Triangles that [`epo`] looks at. Up to this many all of them, and the value is exact; of more a sample
/// spread evenly over the tree, so that the time hardly grows with the mesh; the value is then good to a few per
/// cent.
pub const EPO_SAMPLES: usize = 4096;

/// EPO = Σ over nodes of C · A(surface inside the node's box that belongs to none of its primitives) / A(all
/// surface), with C the cost of the node itself as in [`sah_cost`](super::stats::sah_cost). 0 is a tree without
/// overlap. `corners_of` gives the corners of a primitive; triangles without area count nothing.
pub fn epo(tree: &Bvh2, corners_of: impl Fn(u32) -> [Vec3; 3] + Sync) -> f64 {
    if tree.nodes.is_empty() {
        return 0.0;
    }
    let starts = first_primitives(tree);
    let count = tree.primitive_indices.len();
    let samples = count.min(EPO_SAMPLES);
    // Collected in order before they are summed: the sum does not depend on the number of threads.
    let terms: Vec<(f64, f64)> = (0..samples)
        .into_par_iter()
        .map(|sample| {
            let position = (2 * sample + 1) * count / (2 * samples);
            let triangle = Polygon::triangle(corners_of(tree.primitive_indices[position]));
            let overlap = foreign_cost(tree, &starts, position, triangle);
            (overlap, triangle.area())
        })
        .collect();
    let (overlap, area) = terms
        .iter()
        .fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1));
    if area > 0.0 { overlap / area } else { 0.0 }
}

/// For each node the position of its first primitive; its last is before the first of its right neighbour.
fn first_primitives(tree: &Bvh2) -> Vec<u32> {
    let mut firsts: Vec<u32> = tree.nodes.iter().map(|node| node.first_index).collect();
    for (index, node) in tree.nodes.iter().enumerate().rev() {
        if !node.is_leaf() {
            firsts[index] = firsts[node.first_index as usize];
        }
    }
    firsts
}

/// Σ cost × area of the triangle inside, over the nodes that are not its ancestors.
fn foreign_cost(tree: &Bvh2, starts: &[u32], position: usize, triangle: Polygon) -> f64 {
    let mut sum = 0.0;
    let mut stack = vec![(0, true, triangle)];
    while let Some((index, holds_it, polygon)) = stack.pop() {
        let node: &Bvh2Node = &tree.nodes[index];
        let inside = if holds_it {
            polygon
        } else {
            let inside = polygon.clipped_to(node.min.as_dvec3(), node.max.as_dvec3());
            let area = inside.area();
            if area <= 0.0 {
                continue;
            }
            sum += own_cost(node) * area;
            inside
        };
        if !node.is_leaf() {
            let child = node.first_index as usize;
            let is_right = position >= starts[child + 1] as usize;
            stack.push((child, holds_it && !is_right, inside));
            stack.push((child + 1, holds_it && is_right, inside));
        }
    }
    sum
}

/// 3 + 6 + 6.
const MOST_CORNERS: usize = 15;

/// A convex polygon. A triangle cut by a box's six planes has at most nine corners; cut again by a box within,
/// up to one more for each plane until the first box's are cut off.
#[derive(Clone, Copy)]
struct Polygon {
    corners: [DVec3; MOST_CORNERS],
    len: usize,
}

impl Polygon {
    const EMPTY: Self = Self {
        corners: [DVec3::ZERO; MOST_CORNERS],
        len: 0,
    };

    fn triangle(corners: [Vec3; 3]) -> Self {
        let mut polygon = Self::EMPTY;
        for corner in corners {
            polygon.push(corner.as_dvec3());
        }
        polygon
    }

    fn push(&mut self, corner: DVec3) {
        // Rounding can make another corner of a nearly straight one; nothing is lost without it.
        if let Some(slot) = self.corners.get_mut(self.len) {
            *slot = corner;
            self.len += 1;
        }
    }

    fn area(&self) -> f64 {
        let corners = &self.corners[..self.len];
        let Some(&first) = corners.first() else {
            return 0.0;
        };
        let doubled: DVec3 = corners
            .windows(2)
            .map(|edge| (edge[0] - first).cross(edge[1] - first))
            .sum();
        0.5 * doubled.length()
    }

    /// The part inside a box, its faces included (Sutherland and Hodgman 1974).
    fn clipped_to(self, min: DVec3, max: DVec3) -> Self {
        let mut polygon = self;
        for axis in 0..3 {
            polygon = polygon.keep(|corner| corner[axis] - min[axis]);
            polygon = polygon.keep(|corner| max[axis] - corner[axis]);
        }
        polygon
    }

    /// The part where `height`, a distance from a plane, is not negative.
    fn keep(self, height: impl Fn(DVec3) -> f64) -> Self {
        let corners = &self.corners[..self.len];
        let mut kept = Self::EMPTY;
        for (index, &corner) in corners.iter().enumerate() {
            let next = corners[(index + 1) % corners.len()];
            let (here, there) = (height(corner), height(next));
            if here >= 0.0 {
                kept.push(corner);
            }
            if (here < 0.0) != (there < 0.0) {
                kept.push(corner.lerp(next, here / (here - there)));
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::super::stats::COST_INTERSECT;
    use super::*;
    use crate::bvh::{BuildOptions, Builder, build_tree, specimens};

    fn epo_of(triangles: &[[Vec3; 3]], options: &BuildOptions) -> f64 {
        let tree = build_tree(&specimens::boxes(triangles), options);
        epo(&tree, |i| triangles[i as usize])
    }

    const SINGLE: BuildOptions = BuildOptions {
        builder: Builder::Median,
        levels: crate::bvh::Levels::Two,
        max_depth: 64,
        max_leaf_size: 1,
        bins: 16,
        preset: crate::bvh::Preset::Medium,
    };

    #[test]
    fn separate_triangles_have_no_overlap() {
        let triangle = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let apart: Vec<_> = (0..50)
            .map(|i| triangle.map(|corner| corner + Vec3::Z * i as f32))
            .collect();
        assert_eq!(epo_of(&apart, &SINGLE), 0.0);
        assert_eq!(epo_of(&apart[..1], &SINGLE), 0.0);
        assert_eq!(epo_of(&[], &SINGLE), 0.0);
    }

    #[test]
    fn a_triangle_half_inside_a_foreign_box_counts_with_its_clipped_area() {
        // Of the first, of area 2, the unit square lies in the second's box; the second meets the first's
        // flat box in a line.
        let flat = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 2.0];
        let upright = [
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(1.0, 1.0, -1.0),
            Vec3::new(1.0, 1.0, 1.0),
        ];
        let upright_area = 0.5 * 2f64.sqrt() * 2.0;
        let measured = epo_of(&[flat, upright], &SINGLE);
        let expected = f64::from(COST_INTERSECT) / (2.0 + upright_area);
        assert!(
            (measured - expected).abs() < 1e-12,
            "{measured} instead of {expected}"
        );
    }

    #[test]
    fn one_leaf_with_everything_has_no_overlap_and_halving_has_more_than_sah() {
        let soup = specimens::soup(3_000, 0.2, 5);
        let of = |builder| {
            epo_of(
                &soup,
                &BuildOptions {
                    builder,
                    ..BuildOptions::default()
                },
            )
        };
        let (none, median, sah) = (of(Builder::None), of(Builder::Median), of(Builder::Sah));
        assert_eq!(none, 0.0);
        assert!(sah < median, "SAH {sah}, median {median}");
    }

    #[test]
    fn a_sample_of_a_large_mesh_is_close_to_all_of_it() {
        let knot = specimens::knot(40_000);
        let tree = build_tree(&specimens::boxes(&knot), &BuildOptions::default());
        let sampled = epo(&tree, |i| knot[i as usize]);
        let starts = first_primitives(&tree);
        let (mut overlap, mut area) = (0.0, 0.0);
        for (position, &primitive) in tree.primitive_indices.iter().enumerate() {
            let triangle = Polygon::triangle(knot[primitive as usize]);
            overlap += foreign_cost(&tree, &starts, position, triangle);
            area += triangle.area();
        }
        let error = sampled / (overlap / area) - 1.0;
        assert!(
            error.abs() < 0.1,
            "{sampled} is off by {:.1} %",
            100.0 * error
        );
    }
}

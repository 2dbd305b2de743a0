//! Eight triangles, tested against a ray at once.

use glam::Vec3;

use super::Eight;
use crate::bvh::{
    goal::Goal,
    slab::SlabRay,
    traverse::STOP,
    triangle::{Crossing, LeafTriangle, Shear, accept},
};

/// Set in the last lane's number where the next block belongs to the same leaf. Triangles are numbered in 31 bits.
const CONTINUES: u32 = 1 << 31;

/// 320 bytes, five cache lines: up to eight triangles, a lane each, their coordinates axis by axis and corner by
/// corner.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    axes: [[[f32; 8]; 3]; 3],
    numbers: [u32; 8],
}

impl TriangleBlock {
    /// The most triangles.
    pub(crate) const CAPACITY: usize = 8;

    /// Adds a leaf's triangles, in as many blocks as they need.
    pub(crate) fn append(leaf: &[LeafTriangle], blocks: &mut Vec<Self>) {
        let chunks = leaf.chunks(Self::CAPACITY);
        let last = chunks.len() - 1;
        blocks.extend(chunks.enumerate().map(|(i, chunk)| {
            let mut block = Self::new(chunk);
            if i < last {
                block.numbers[Self::CAPACITY - 1] |= CONTINUES;
            }
            block
        }));
    }

    /// At most eight triangles. A lane without one is a point, which no ray hits.
    fn new(triangles: &[LeafTriangle]) -> Self {
        let mut block = Self {
            axes: [[[0.0; 8]; 3]; 3],
            numbers: [0; 8],
        };
        for (lane, triangle) in triangles.iter().enumerate() {
            for (corner, position) in triangle.corners().iter().enumerate() {
                for axis in 0..3 {
                    block.axes[axis][corner][lane] = position[axis];
                }
            }
            block.numbers[lane] = triangle.number;
        }
        block
    }

    /// Whether the next block belongs to the same leaf.
    #[inline(always)]
    pub(crate) fn continues(&self) -> bool {
        self.numbers[7] & CONTINUES != 0
    }

    /// One coordinate of the triangles, corner by corner.
    #[inline(always)]
    pub(super) fn axis(&self, axis: usize) -> &[[f32; 8]; 3] {
        &self.axes[axis]
    }

    /// The number of a triangle in its mesh.
    #[inline(always)]
    pub(super) fn number(&self, lane: usize) -> u32 {
        self.numbers[lane] & !CONTINUES
    }

    /// The triangles in it: lanes that are no point.
    #[cfg(test)]
    pub(crate) fn triangles(&self) -> impl Iterator<Item = ([Vec3; 3], u32)> + '_ {
        let lanes = (0..Self::CAPACITY).map(|lane| (self.corners(lane), self.number(lane)));
        lanes.filter(|([a, b, c], _)| a != b || b != c)
    }

    /// A triangle's corners.
    #[inline(always)]
    pub(super) fn corners(&self, lane: usize) -> [Vec3; 3] {
        let [x, y, z] = &self.axes;
        [
            Vec3::new(x[0][lane], y[0][lane], z[0][lane]),
            Vec3::new(x[1][lane], y[1][lane], z[1][lane]),
            Vec3::new(x[2][lane], y[2][lane], z[2][lane]),
        ]
    }

    /// Hands what [`super::super::triangle::cross`] finds, triangle by triangle, to `at(number, crossing, limit)`, which
    /// returns the new limit, or [`STOP`].
    #[inline(always)]
    pub(crate) fn cross<E: Eight, G: Goal>(
        &self,
        shear: &Shear,
        slab: &SlabRay,
        reach: f32,
        mut limit: f32,
        at: &mut impl FnMut(u32, Crossing, f32) -> f32,
    ) -> f32 {
        let frame = WideFrame::<E>::new(shear);
        let corners = frame.corners(self, shear.axes);
        let (mut passed, [u, v, w]) = edges(&corners);
        if passed == 0 {
            return limit;
        }
        passed &= within(&corners, shear.depths(reach, limit));
        if passed == 0 {
            return limit;
        }
        let [u, v, w] = [u.to_array(), v.to_array(), w.to_array()];
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize % 8;
            passed &= passed - 1;
            let edges = [u[lane], v[lane], w[lane]];
            if let Some(crossing) = accept::<G>(shear, slab, self.corners(lane), edges, limit) {
                limit = at(self.number(lane), crossing, limit);
                if limit == STOP {
                    break;
                }
            }
        }
        limit
    }
}

/// The edge functions, and which triangles they say the line of the ray crosses. The operations are those of
/// [`super::super::triangle::cross`], one by one.
#[inline(always)]
fn edges<E: Eight>([a, b, c]: &[[E; 3]; 3]) -> (u32, [E; 3]) {
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let det = u.add(v).add(w);
    let (zero, infinity) = (E::splat(0.0), E::splat(f32::INFINITY));
    // A NaN may pass here, but then it is in the determinant too.
    let outside = E::and(u.min(v).min(w).lt(zero), zero.lt(u.max(v).max(w)));
    let det = det.abs();
    let area = E::and(zero.lt(det), det.lt(infinity));
    (E::bits(E::and_not(outside, area)), [u, v, w])
}

/// Which triangles are not wholly outside those depths.
#[inline(always)]
fn within<E: Eight>([a, b, c]: &[[E; 3]; 3], (first, last): (f32, f32)) -> u32 {
    let nearest = a[2].min(b[2]).min(c[2]);
    let farthest = a[2].max(b[2]).max(c[2]);
    E::bits(E::and(
        E::splat(first).le(farthest),
        nearest.le(E::splat(last)),
    ))
}

/// The ray's frame, eight times over.
struct WideFrame<E> {
    origin: [E; 3],
    slope: [E; 2],
}

impl<E: Eight> WideFrame<E> {
    #[inline(always)]
    fn new(shear: &Shear) -> Self {
        let ([x, y, z], [right, up]) = (shear.from, shear.slope);
        Self {
            origin: [E::splat(x), E::splat(y), E::splat(z)],
            slope: [E::splat(right), E::splat(up)],
        }
    }

    /// The corners of each triangle in the frame.
    #[inline(always)]
    fn corners(&self, block: &TriangleBlock, axes: [usize; 3]) -> [[E; 3]; 3] {
        let [x, y, z] = axes.map(|axis| &block.axes[axis]);
        [
            self.corner(&x[0], &y[0], &z[0]),
            self.corner(&x[1], &y[1], &z[1]),
            self.corner(&x[2], &y[2], &z[2]),
        ]
    }

    /// A corner of each triangle in the frame.
    #[inline(always)]
    fn corner(&self, x: &[f32; 8], y: &[f32; 8], z: &[f32; 8]) -> [E; 3] {
        let depth = E::load(z).sub(self.origin[2]);
        [
            (E::load(x).sub(self.origin[0])).sub(depth.mul(self.slope[0])),
            (E::load(y).sub(self.origin[1])).sub(depth.mul(self.slope[1])),
            depth,
        ]
    }
}

/// The edge function of the edge between two corners. Not fused: see [`super::super::triangle`].
#[inline(always)]
fn edge<E: Eight>(p: &[E; 3], q: &[E; 3]) -> E {
    p[0].mul(q[1]).sub(p[1].mul(q[0]))
}

//! Eight triangles, tested against a ray at once.

use glam::Vec3;

use super::Eight;
use crate::bvh::{
    goal::{Goal, Question, STOP},
    slab::SlabRay,
    triangle::{Shear, accept},
    triangles::Triangles,
    visitor::Visitor,
};

/// Set in the last lane's number where the next block belongs to the same leaf: the sign, read as an `f32`. Triangles are
/// numbered in 31 bits.
const CONTINUES: u32 = 1 << 31;

/// 320 bytes, five cache lines: up to eight triangles, a lane each, their coordinates axis by axis and corner by
/// corner.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct TriangleBlock {
    axes: [[[f32; 8]; 3]; 3],
    numbers: [u32; 8],
}

/// A ray as the triangles of an instance's mesh see it.
pub(crate) struct Sight<'a> {
    pub(crate) instance: u32,
    pub(crate) shear: &'a Shear,
    pub(crate) slab: &'a SlabRay,
    /// No less than any coordinate of the mesh.
    pub(crate) reach: f32,
}

impl TriangleBlock {
    /// The most triangles.
    pub(crate) const CAPACITY: usize = 8;

    /// Adds a leaf's triangles, those numbers of a mesh, in as many blocks as they need.
    pub(crate) fn append(leaf: &[u32], mesh: &Triangles, blocks: &mut Vec<Self>) {
        let chunks = leaf.chunks(Self::CAPACITY);
        let last = chunks.len() - 1;
        blocks.extend(chunks.enumerate().map(|(i, chunk)| {
            let mut block = Self::new(chunk, mesh);
            if i < last {
                block.numbers[Self::CAPACITY - 1] |= CONTINUES;
            }
            block
        }));
    }

    /// At most eight triangles. A lane without one is a point, which no ray hits.
    fn new(numbers: &[u32], mesh: &Triangles) -> Self {
        let mut block = Self {
            axes: [[[0.0; 8]; 3]; 3],
            numbers: [0; 8],
        };
        for (lane, &number) in numbers.iter().enumerate() {
            for (corner, position) in mesh.corners(number).iter().enumerate() {
                for axis in 0..3 {
                    block.axes[axis][corner][lane] = position[axis];
                }
            }
            block.numbers[lane] = number;
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

    /// The lane of a triangle, as a bit; none where it is not here. No triangle has a number of 32 bits.
    #[inline(always)]
    fn lane_of<E: Eight>(&self, number: u32) -> u32 {
        let numbers = E::load(bytemuck::cast_ref(&self.numbers)).abs();
        E::bits(numbers.same_bits(E::splat(f32::from_bits(number))))
    }

    /// The lanes that hold a triangle: that are no point.
    fn lanes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..Self::CAPACITY).filter(|&lane| {
            let [a, b, c] = self.corners(lane);
            a != b || b != c
        })
    }

    /// The triangles in it.
    #[cfg(test)]
    pub(crate) fn triangles(&self) -> impl Iterator<Item = ([Vec3; 3], u32)> + '_ {
        self.lanes()
            .map(|lane| (self.corners(lane), self.number(lane)))
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

    /// Tests the ray against the triangles: [`super::super::triangle`]'s test, eight times over. Crossings go to the
    /// question; returns the new limit, or [`STOP`].
    #[inline(always)]
    pub(crate) fn cross<E: Eight, G: Goal, V: Visitor>(
        &self,
        sight: &Sight,
        limit: f32,
        question: &mut Question<G, V>,
    ) -> f32 {
        let mut wanted = 0;
        let limit = self.cross_all::<E, G, V>(sight, limit, question, &mut wanted);
        if V::LOOKS {
            for lane in self.lanes() {
                let is_wanted = wanted >> lane & 1 == 1;
                let number = self.number(lane);
                (question.visitor).triangle(sight.instance, number, is_wanted);
            }
        }
        limit
    }

    /// [`Self::cross`], with the lanes whose crossings were wanted where somebody looks.
    #[inline(always)]
    fn cross_all<E: Eight, G: Goal, V: Visitor>(
        &self,
        sight: &Sight,
        mut limit: f32,
        question: &mut Question<G, V>,
        wanted: &mut u32,
    ) -> f32 {
        let Sight {
            instance,
            shear,
            slab,
            reach,
        } = *sight;
        let frame = WideFrame::<E>::new(shear);
        let corners = frame.corners(self, shear.axes);
        let (mut passed, [u, v, w]) = edges(&corners);
        if passed == 0 {
            return limit;
        }
        passed &= within(&corners, shear.depths(reach, limit));
        passed &= !self.lane_of::<E>(question.starts_on(instance));
        if passed == 0 {
            return limit;
        }
        let [u, v, w] = [u.to_array(), v.to_array(), w.to_array()];
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize % 8;
            passed &= passed - 1;
            let edges = [u[lane], v[lane], w[lane]];
            let corners = self.corners(lane);
            if let Some(crossing) = accept(shear, slab, corners, edges, limit, G::ANY) {
                let (is_wanted, new) =
                    question.meet((instance, self.number(lane)), crossing, limit);
                limit = new;
                if V::LOOKS {
                    *wanted |= u32::from(is_wanted) << lane;
                }
                if limit == STOP {
                    break;
                }
            }
        }
        limit
    }
}

/// The edge functions, and which triangles they say the line of the ray crosses.
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

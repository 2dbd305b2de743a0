//! Eight triangles, tested against a ray at once.

use std::hint::black_box;

use glam::Vec3;

use super::super::goal::{Goal, Question, is_end};
use super::super::object_ray::ObjectRay;
use super::super::triangle::{Axis, Crossing, Depths, Shear, UNSURE_EDGE, UNSURE_PLANE, accept};
use super::super::visitor::Visitor;
use super::{Eight, by_axis};
use crate::bvh::triangles::Triangles;

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

/// A ray as triangles see it.
pub(crate) trait Sight {
    /// Which axes are x, y and z in its frame.
    fn axes(&self) -> [Axis; 3];
    /// Its origin along those.
    fn from(&self) -> [f32; 3];
    /// The shear of x and of y by z.
    fn slope(&self) -> [f32; 2];
    fn depths(&self) -> Depths;
    /// The ray, for the few triangles that get so far.
    fn ray(&self) -> ObjectRay;
}

/// [`Sight`] of a ray and its frame.
pub(crate) struct Sheared<'a> {
    pub(crate) ray: &'a ObjectRay,
    pub(crate) shear: &'a Shear,
}

impl Sight for Sheared<'_> {
    #[inline(always)]
    fn axes(&self) -> [Axis; 3] {
        self.shear.axes
    }

    #[inline(always)]
    fn from(&self) -> [f32; 3] {
        self.shear.from
    }

    #[inline(always)]
    fn slope(&self) -> [f32; 2] {
        self.shear.slope
    }

    #[inline(always)]
    fn depths(&self) -> Depths {
        self.shear.depths
    }

    #[inline(always)]
    fn ray(&self) -> ObjectRay {
        *self.ray
    }
}

/// Whose triangles are tested.
#[derive(Clone, Copy)]
pub(crate) struct Owner {
    pub(crate) instance: u32,
    /// No less than any coordinate of its mesh.
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

    /// The lane of a triangle; none where it is not here. No triangle has a number of 32 bits.
    #[inline(always)]
    fn is_triangle<E: Eight>(&self, number: u32) -> E::Mask {
        let numbers = E::load(bytemuck::cast_ref(&self.numbers)).abs();
        numbers.same_bits(E::splat(f32::from_bits(number)))
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
    /// question; returns the new limit, or [`STOP`](super::super::goal::STOP).
    #[inline(always)]
    pub(crate) fn cross<E: Eight, G: Goal, V: Visitor>(
        &self,
        sight: &impl Sight,
        owner: Owner,
        limit: f32,
        question: &mut Question<G, V>,
    ) -> f32 {
        let mut wanted = 0;
        let limit = self.cross_all::<E, G, V>(sight, owner, limit, question, &mut wanted);
        if V::LOOKS {
            for lane in self.lanes() {
                let is_wanted = wanted >> lane & 1 == 1;
                let number = self.number(lane);
                (question.visitor).triangle(owner.instance, number, is_wanted);
            }
        }
        limit
    }

    /// [`Self::cross`], with the lanes whose crossings were wanted where somebody looks.
    #[inline(always)]
    fn cross_all<E: Eight, G: Goal, V: Visitor>(
        &self,
        sight: &impl Sight,
        Owner { instance, reach }: Owner,
        mut limit: f32,
        question: &mut Question<G, V>,
        wanted: &mut u32,
    ) -> f32 {
        let corners = self.moved::<E>(sight);
        let (crossed, [u, v, w]) = edges(&corners);
        let from_start = sight.depths();
        let reached = within(&corners, from_start.span(reach, limit));
        let left = self.is_triangle::<E>(question.starts_on(instance));
        // All at once: most blocks are crossed by the line somewhere.
        let mut passed = E::bits(E::and_not(left, E::and(crossed, reached)));
        if passed == 0 {
            return limit;
        }
        let slack = from_start.slack_of(reach);
        let sure = surely_crossed(&corners, [u, v, w], slack);
        if G::ANY {
            // What follows depends on the ray alone: it would be made ready for all rays, and few of them meet anything.
            let limit = black_box(limit);
            let met = surely_within(&corners, from_start.sure_span(slack, limit));
            let met = passed & E::bits(E::and(sure, met));
            if met != 0 {
                // Somewhere before the limit.
                let crossing = Crossing {
                    t: 0.5 * limit.min(1.0),
                    u: 0.0,
                    v: 0.0,
                };
                let lane = met.trailing_zeros() as usize % 8;
                let (is_wanted, new) =
                    question.meet((instance, self.number(lane)), crossing, limit);
                if V::LOOKS {
                    *wanted |= u32::from(is_wanted) << lane;
                }
                return new;
            }
        }
        let sure = E::bits(sure);
        let [u, v, w] = [u.to_array(), v.to_array(), w.to_array()];
        let ray = sight.ray();
        while passed != 0 {
            let lane = passed.trailing_zeros() as usize % 8;
            passed &= passed - 1;
            let edges = [u[lane], v[lane], w[lane]];
            let is_sure = sure >> lane & 1 == 1;
            if let Some(crossing) = accept(&ray, self.corners(lane), edges, limit, is_sure) {
                let (is_wanted, new) =
                    question.meet((instance, self.number(lane)), crossing, limit);
                limit = new;
                if V::LOOKS {
                    *wanted |= u32::from(is_wanted) << lane;
                }
                if is_end::<G>(limit) {
                    break;
                }
            }
        }
        limit
    }

    /// The triangles' corners in the ray's frame, against its axes: the ray's origin less the corner, since what is
    /// subtracted may come from memory. All signs are the other ones, and the edge functions' the same.
    #[inline(always)]
    fn moved<E: Eight>(&self, sight: &impl Sight) -> [[E; 3]; 3] {
        let from = sight.from();
        let from = by_axis!(|i| E::splat(from[i]));
        let [right, up] = sight.slope();
        let (right, up) = (E::splat(right), E::splat(up));
        let [x, y, z] = sight.axes().map(|axis| &self.axes[axis as usize]);
        by_axis!(|corner| {
            let depth = from[2].sub(E::load(&z[corner]));
            [
                (from[0].sub(E::load(&x[corner]))).sub(depth.mul(right)),
                (from[1].sub(E::load(&y[corner]))).sub(depth.mul(up)),
                depth,
            ]
        })
    }
}

/// Which triangles the edge functions say that the line of the ray crosses, and those.
#[inline(always)]
fn edges<E: Eight>([a, b, c]: &[[E; 3]; 3]) -> (E::Mask, [E; 3]) {
    let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
    let det = u.add(v).add(w);
    let (zero, infinity) = (E::splat(0.0), E::splat(f32::INFINITY));
    // A NaN may pass here, but then it is in the determinant too.
    let outside = E::and(u.min(v).min(w).lt(zero), zero.lt(u.max(v).max(w)));
    let det = det.abs();
    let area = E::and(zero.lt(det), det.lt(infinity));
    (E::and_not(outside, area), [u, v, w])
}

/// Which triangles are not wholly outside those depths.
#[inline(always)]
fn within<E: Eight>(corners: &[[E; 3]; 3], (first, last): (f32, f32)) -> E::Mask {
    let [nearest, farthest] = depths(corners);
    E::and(E::splat(first).le(farthest), nearest.le(E::splat(last)))
}

/// Which triangles are wholly between those depths.
#[inline(always)]
fn surely_within<E: Eight>(corners: &[[E; 3]; 3], (first, last): (f32, f32)) -> E::Mask {
    let [nearest, farthest] = depths(corners);
    E::and(E::splat(first).lt(nearest), farthest.lt(E::splat(last)))
}

/// Which triangles the line of the ray surely crosses, of those that it crosses by the edge functions.
#[inline(always)]
fn surely_crossed<E: Eight>(corners: &[[E; 3]; 3], [u, v, w]: [E; 3], slack: f32) -> E::Mask {
    let [a, b, c] = by_axis!(|corner| corners[corner][0].abs().max(corners[corner][1].abs()));
    let size = a.max(b).max(c);
    let [nearest, farthest] = depths(corners);
    let side = size.add(size).add(farthest.sub(nearest));
    let moved = (size.add(E::splat(slack))).mul(E::splat(slack * UNSURE_EDGE));
    let tilted = side.mul(side).mul(E::splat(UNSURE_PLANE));
    let unsure = moved.add(tilted).add(E::splat(f32::MIN_POSITIVE));
    unsure.lt(u.abs().min(v.abs()).min(w.abs()))
}

/// Between which depths triangles lie.
#[inline(always)]
fn depths<E: Eight>([a, b, c]: &[[E; 3]; 3]) -> [E; 2] {
    [a[2].min(b[2]).min(c[2]), a[2].max(b[2]).max(c[2])]
}

/// The edge function of the edge between two corners. Not fused: see [`super::super::triangle`].
#[inline(always)]
fn edge<E: Eight>(p: &[E; 3], q: &[E; 3]) -> E {
    p[0].mul(q[1]).sub(p[1].mul(q[0]))
}

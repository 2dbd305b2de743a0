//! A group of rays as the boxes and triangles of a tree see it.

use super::{Group, PacketRays};
use crate::bvh::wide::{Eight, InstructionSet, Lanes, node::WideNode};

/// What the tests need of a group of rays in a tree's space.
pub(crate) struct View<S: InstructionSet> {
    /// The rows of a node that hold the faces which the rays meet first, axis by axis. Those they meet last are their
    /// neighbours.
    near: [usize; 3],
    /// What those are measured from, ray by ray.
    pub(super) near_origin: [S::Packet; 3],
    pub(super) far_origin: [S::Packet; 3],
    pub(super) inverse: [S::Packet; 3],
    bounds: Bounds<S::Eight>,
    pub(super) frame: Frame<S::Packet>,
    /// Along which axes the rays go backwards.
    pub(super) backwards: [bool; 3],
}

/// The rays' frame, as [`Shear`](crate::bvh::triangle::Shear) has it of one.
pub(super) struct Frame<L: Lanes> {
    pub(super) axes: [usize; 3],
    pub(super) from: [L; 3],
    pub(super) slope: [L; 2],
    pub(super) origin: [L::Doubles; 3],
    pub(super) direction: [L::Doubles; 3],
}

/// Bounds of all rays, eight times over.
struct Bounds<E> {
    /// Of the origins, those that make a ray enter first and leave last.
    near_origin: [E; 3],
    far_origin: [E; 3],
    least_inverse: [E; 3],
    most_inverse: [E; 3],
}

impl<S: InstructionSet> View<S> {
    #[inline(always)]
    pub(crate) fn new(rays: &PacketRays<S::Packet>, group: &Group) -> Self {
        let mask = S::Packet::mask(group.lanes);
        let smallest = |column: S::Packet| {
            S::Packet::select(mask, column, S::Packet::splat(f32::INFINITY)).smallest()
        };
        let largest = |column: S::Packet| {
            S::Packet::select(mask, column, S::Packet::splat(f32::NEG_INFINITY)).largest()
        };
        let backwards = group.backwards;
        let (mut near_origin, mut far_origin) = (rays.origin, rays.origin);
        let nothing = S::Eight::splat(0.0);
        let mut bounds = Bounds {
            near_origin: [nothing; 3],
            far_origin: [nothing; 3],
            least_inverse: [nothing; 3],
            most_inverse: [nothing; 3],
        };
        for axis in 0..3 {
            let [above, below] = rays.padded(axis);
            let (near, far) = if backwards[axis] {
                near_origin[axis] = below;
                far_origin[axis] = above;
                (smallest(below), largest(above))
            } else {
                near_origin[axis] = above;
                far_origin[axis] = below;
                (largest(above), smallest(below))
            };
            let inverse = rays.inverse[axis];
            bounds.near_origin[axis] = S::Eight::splat(near);
            bounds.far_origin[axis] = S::Eight::splat(far);
            bounds.least_inverse[axis] = S::Eight::splat(smallest(inverse));
            bounds.most_inverse[axis] = S::Eight::splat(largest(inverse));
        }
        Self {
            near: [0, 1, 2].map(|axis| 2 * axis | usize::from(backwards[axis])),
            near_origin,
            far_origin,
            inverse: rays.inverse,
            bounds,
            frame: Frame::new(rays, group.axis),
            backwards,
        }
    }

    /// Which children any ray may enter, if none ends behind `limit`, and where the first does at the earliest.
    #[inline(always)]
    pub(super) fn span(&self, node: &WideNode, limit: f32) -> (u32, S::Eight) {
        let bounds = &self.bounds;
        let crossed = |axis: usize, row: usize, origin: &[S::Eight; 3]| {
            let way = S::Eight::load(node.row(row)).sub(origin[axis]);
            (
                way.mul(bounds.least_inverse[axis]),
                way.mul(bounds.most_inverse[axis]),
            )
        };
        let entry = |axis: usize| {
            let (a, b) = crossed(axis, self.near[axis], &bounds.near_origin);
            a.min(b)
        };
        let exit = |axis: usize| {
            let (a, b) = crossed(axis, self.near[axis] ^ 1, &bounds.far_origin);
            a.max(b)
        };
        // Zero last, so that no entry is -0.0.
        let entries = entry(0)
            .max(entry(1))
            .max(entry(2))
            .max(S::Eight::splat(0.0));
        let exits = exit(0)
            .min(exit(1))
            .min(exit(2))
            .min(S::Eight::splat(limit));
        (S::Eight::bits(entries.le(exits)), entries)
    }

    /// Which rays enter a child, no later than at their limits.
    #[inline(always)]
    pub(super) fn enter(&self, node: &WideNode, child: u32, limit: S::Packet) -> u32 {
        let crossed = |axis: usize, row: usize, origin: &[S::Packet; 3]| {
            let face = node.row(row)[child as usize % 8];
            (S::Packet::splat(face).sub(origin[axis])).mul(self.inverse[axis])
        };
        let entry = |axis: usize| crossed(axis, self.near[axis], &self.near_origin);
        let exit = |axis: usize| crossed(axis, self.near[axis] ^ 1, &self.far_origin);
        let zero = S::Packet::splat(0.0);
        let entries = entry(0).max(entry(1)).max(entry(2)).max(zero);
        let exits = exit(0).min(exit(1)).min(exit(2)).min(limit);
        S::Packet::bits(entries.le(exits))
    }
}

impl<L: Lanes> Frame<L> {
    #[inline(always)]
    fn new(rays: &PacketRays<L>, z: usize) -> Self {
        let axes = [[1, 2, 0], [2, 0, 1], [0, 1, 2]][z % 3];
        let along = axes.map(|axis: usize| rays.direction[axis]);
        Self {
            axes,
            from: axes.map(|axis| rays.origin[axis]),
            slope: [along[0].div(along[2]), along[1].div(along[2])],
            origin: rays.origin.map(L::widen),
            direction: rays.direction.map(L::widen),
        }
    }
}

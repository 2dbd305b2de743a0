//! A group of rays as the boxes and triangles of a tree see it.

use super::super::super::triangle::{Axis, FRAMES};
use super::super::node::{Sides, WideNode};
use super::super::{Eight, InstructionSet, Lanes, by_axis};
use super::{Group, PacketRays};

/// What the tests need of a group of rays in a tree's space.
pub(crate) struct View<S: InstructionSet> {
    /// Which faces the rays meet first.
    sides: &'static Sides,
    /// What those are measured from, ray by ray.
    near_origin: [S::Packet; 3],
    far_origin: [S::Packet; 3],
    inverse: [S::Packet; 3],
    bounds: Bounds<S::Eight>,
    frame: Option<Frame<S::Packet>>,
    /// The longest component of the directions.
    axis: usize,
    /// Along which axes the rays go backwards.
    pub(super) backwards: [bool; 3],
}

/// The rays' frame, as [`Shear`](super::super::super::triangle::Shear) has it of one.
#[derive(Clone, Copy)]
pub(super) struct Frame<L> {
    pub(super) axes: [Axis; 3],
    pub(super) from: [L; 3],
    pub(super) slope: [L; 2],
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
                (smallest(mask, below), largest(mask, above))
            } else {
                near_origin[axis] = above;
                far_origin[axis] = below;
                (largest(mask, above), smallest(mask, below))
            };
            let inverse = rays.inverse[axis];
            bounds.near_origin[axis] = S::Eight::splat(near);
            bounds.far_origin[axis] = S::Eight::splat(far);
            bounds.least_inverse[axis] = S::Eight::splat(smallest(mask, inverse));
            bounds.most_inverse[axis] = S::Eight::splat(largest(mask, inverse));
        }
        Self {
            sides: Sides::of(group.way()),
            near_origin,
            far_origin,
            inverse: rays.inverse,
            bounds,
            // Made at the first leaf: many packets meet none.
            frame: None,
            axis: group.axis,
            backwards,
        }
    }

    /// The rays' frame.
    #[inline(always)]
    pub(super) fn frame(&mut self, rays: &PacketRays<S::Packet>) -> Frame<S::Packet> {
        match self.frame {
            Some(frame) => frame,
            None => *self.frame.insert(Frame::new(rays, self.axis)),
        }
    }

    /// Which children any ray may enter, if none ends behind `limit`, and where the first does at the earliest. The second
    /// half of them is left out where the tree `is_narrow`.
    #[inline(always)]
    pub(super) fn span(
        &self,
        node: &WideNode,
        limit: f32,
        is_narrow: bool,
    ) -> (u32, [S::Eight; 2]) {
        let (first, entries) = self.span_half(node, 0, limit);
        if is_narrow {
            return (first, [entries, entries]);
        }
        let (second, more) = self.span_half(node, 1, limit);
        (first | second << 8, [entries, more])
    }

    /// [`Self::span`], of eight children.
    #[inline(always)]
    fn span_half(&self, node: &WideNode, half: usize, limit: f32) -> (u32, S::Eight) {
        let near = by_axis!(|axis| node.faces(axis, self.sides.first[axis], half));
        let far = by_axis!(|axis| node.faces(axis, self.sides.last[axis], half));
        self.bounds.span(near, far, limit)
    }

    /// Which of eight boxes, by their lower and their upper corners, any ray may enter.
    #[inline(always)]
    pub(super) fn may_enter(&self, [min, max]: &[[[f32; 8]; 3]; 2], limit: f32) -> u32 {
        let [lower, upper] = [min, max];
        let near = by_axis!(|i| if self.backwards[i] {
            &upper[i]
        } else {
            &lower[i]
        });
        let far = by_axis!(|i| if self.backwards[i] {
            &lower[i]
        } else {
            &upper[i]
        });
        self.bounds.span(near, far, limit).0
    }

    /// Which rays enter a child, no later than at their limits.
    #[inline(always)]
    pub(super) fn enter(&self, node: &WideNode, child: u32, limit: S::Packet) -> u32 {
        let Sides { first, last } = self.sides;
        let [x, y, z] = by_axis!(|axis| self.near(axis, node.face(axis, first[axis], child)));
        let entry = x.max(y).max(z).max(S::Packet::splat(0.0));
        let [x, y, z] = by_axis!(|axis| self.far(axis, node.face(axis, last[axis], child)));
        let exit = x.min(y).min(z).min(limit);
        S::Packet::bits(entry.le(exit))
    }

    /// Where the rays meet a face of a box that they meet first of two.
    #[inline(always)]
    fn near(&self, axis: usize, face: f32) -> S::Packet {
        (S::Packet::splat(face).sub(self.near_origin[axis])).mul(self.inverse[axis])
    }

    /// Where the rays meet a face of a box that they meet last of two.
    #[inline(always)]
    fn far(&self, axis: usize, face: f32) -> S::Packet {
        (S::Packet::splat(face).sub(self.far_origin[axis])).mul(self.inverse[axis])
    }
}

impl<E: Eight> Bounds<E> {
    /// See [`View::span`]; of boxes with those faces, axis by axis.
    #[inline(always)]
    fn span(&self, near: [&[f32; 8]; 3], far: [&[f32; 8]; 3], limit: f32) -> (u32, E) {
        let [x, y, z] = by_axis!(|axis| {
            let way = E::load(near[axis]).sub(self.near_origin[axis]);
            way.mul(self.least_inverse[axis])
                .min(way.mul(self.most_inverse[axis]))
        });
        // Zero last, so that no entry is -0.0.
        let entries = x.max(y).max(z).max(E::splat(0.0));
        let [x, y, z] = by_axis!(|axis| {
            let way = E::load(far[axis]).sub(self.far_origin[axis]);
            way.mul(self.least_inverse[axis])
                .max(way.mul(self.most_inverse[axis]))
        });
        let exits = x.min(y).min(z).min(E::splat(limit));
        (E::bits(entries.le(exits)), entries)
    }
}

/// The smallest of the lanes that the mask names.
#[inline(always)]
fn smallest<L: Lanes>(mask: L::Mask, lanes: L) -> f32 {
    L::select(mask, lanes, L::splat(f32::INFINITY)).smallest()
}

/// The largest of the lanes that the mask names.
#[inline(always)]
fn largest<L: Lanes>(mask: L::Mask, lanes: L) -> f32 {
    L::select(mask, lanes, L::splat(f32::NEG_INFINITY)).largest()
}

impl<L: Lanes> Frame<L> {
    #[inline(always)]
    fn new(rays: &PacketRays<L>, z: usize) -> Self {
        let axes = FRAMES[z % FRAMES.len()];
        let along = by_axis!(|i| rays.direction[axes[i] as usize]);
        Self {
            axes,
            from: by_axis!(|i| rays.origin[axes[i] as usize]),
            slope: [along[0].div(along[2]), along[1].div(along[2])],
        }
    }

    /// x and y of a corner in the rays' frames.
    #[inline(always)]
    pub(super) fn corner(&self, x: f32, y: f32, z: f32) -> [L; 2] {
        let depth = L::splat(z).sub(self.from[2]);
        [
            (L::splat(x).sub(self.from[0])).sub(depth.mul(self.slope[0])),
            (L::splat(y).sub(self.from[1])).sub(depth.mul(self.slope[1])),
        ]
    }
}

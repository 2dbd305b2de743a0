//! The rays of a packet, a lane each.

use glam::Vec3A;

use super::super::super::object_ray::ObjectRay;
use super::super::super::slab::{PAD, SlabRay};
use super::super::{Lanes, by_axis};

/// What the tests need of rays in one space, as [`ObjectRay`] has it of one.
#[derive(Clone, Copy)]
pub(crate) struct PacketRays<L> {
    pub(crate) origin: [L; 3],
    pub(crate) direction: [L; 3],
    /// Origins moved up, by axis, and down.
    above: [L; 3],
    below: [L; 3],
    pub(crate) inverse: [L; 3],
}

/// Which rays go farthest along x, and which along y, as [`Shear::new`](super::super::super::triangle::Shear::new) chooses; the others
/// go along z.
#[inline(always)]
pub(crate) fn farthest_along<L: Lanes>([x, y, z]: &[L; 3]) -> [L::Mask; 2] {
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    let in_plane = x.le(y);
    let most = L::select(in_plane, y, x);
    let not_along_z = z.lt(most);
    [
        L::and_not(in_plane, not_along_z),
        L::and(in_plane, not_along_z),
    ]
}

/// The largest of three numbers, without their signs.
#[inline(always)]
pub(crate) fn largest_size<L: Lanes>([x, y, z]: &[L; 3]) -> L {
    x.abs().max(y.abs()).max(z.abs())
}

/// A vector of one lane.
#[inline(always)]
fn vector<L: Lanes>([x, y, z]: &[L; 3], lane: usize) -> Vec3A {
    let (x, y, z) = (x.to_array(), y.to_array(), z.to_array());
    Vec3A::new(x.as_ref()[lane], y.as_ref()[lane], z.as_ref()[lane])
}

impl<L: Lanes> PacketRays<L> {
    /// As [`ObjectRay::new`].
    #[inline(always)]
    pub(crate) fn new(origin: [L; 3], direction: [L; 3], longest: L) -> Self {
        let least = longest.mul(L::splat(1.0 / (1u64 << 32) as f32));
        let one = L::splat(1.0);
        let rays = Self {
            origin,
            direction,
            above: origin,
            below: origin,
            inverse: by_axis!(|i| {
                let raised = direction[i].abs().max(least).copysign(direction[i]);
                one.div(raised)
            }),
        };
        rays.with_pad(PAD)
    }

    /// The same rays with another slack around their origins, relative to their size.
    #[inline(always)]
    pub(crate) fn with_pad(self, pad: f32) -> Self {
        let pad = largest_size(&self.origin).mul(L::splat(pad));
        Self {
            above: by_axis!(|i| self.origin[i].add(pad)),
            below: by_axis!(|i| self.origin[i].sub(pad)),
            ..self
        }
    }

    /// Which rays go backwards along an axis.
    #[inline(always)]
    pub(crate) fn goes_backwards(&self, axis: usize) -> L::Mask {
        self.inverse[axis].lt(L::splat(0.0))
    }

    /// Origins as the faces of boxes are measured from them: those that a ray meets first where its direction along the
    /// axis is not negative, and those it meets last.
    #[inline(always)]
    pub(crate) fn padded(&self, axis: usize) -> [L; 2] {
        [self.above[axis], self.below[axis]]
    }

    /// Where the rays, which all go `backwards` along the axis or none, meet a face of a box that they meet first of two.
    #[inline(always)]
    pub(super) fn near(&self, axis: usize, backwards: bool, face: f32) -> L {
        let [above, below] = self.padded(axis);
        let from = if backwards { below } else { above };
        L::splat(face).sub(from).mul(self.inverse[axis])
    }

    /// Where they meet a face of a box that they meet last of two.
    #[inline(always)]
    pub(super) fn far(&self, axis: usize, backwards: bool, face: f32) -> L {
        self.near(axis, !backwards, face)
    }

    /// One of the rays.
    #[inline(always)]
    pub(crate) fn ray(&self, lane: usize) -> ObjectRay {
        ObjectRay {
            origin: vector(&self.origin, lane),
            direction: vector(&self.direction, lane),
            slab: SlabRay {
                above: vector(&self.above, lane),
                below: vector(&self.below, lane),
                inverse: vector(&self.inverse, lane),
            },
        }
    }
}

/// Rays of a packet that go the same way.
#[derive(Clone, Copy)]
pub(crate) struct Group {
    /// Which rays, as bits.
    pub(crate) lanes: u32,
    /// Along which axis they go farthest.
    pub(super) axis: usize,
    /// Along which axes they go backwards.
    pub(super) backwards: [bool; 3],
}

impl Group {
    /// The axes along which they go backwards, as bits.
    #[inline(always)]
    pub(super) fn way(&self) -> u32 {
        let [x, y, z] = self.backwards.map(u32::from);
        x | y << 1 | z << 2
    }
}

/// The ways that rays go, as bits of each ray.
pub(crate) struct Ways {
    backwards: [u32; 3],
    /// Which go farthest along y, and which along z.
    along: [u32; 2],
}

impl Ways {
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(rays: &PacketRays<L>) -> Self {
        let [x, y] = farthest_along(&rays.direction);
        Self {
            backwards: by_axis!(|i| L::bits(rays.goes_backwards(i))),
            along: [L::bits(y), !(L::bits(x) | L::bits(y))],
        }
    }

    /// Takes a group out of those that are left.
    #[inline(always)]
    pub(crate) fn next_group(&self, left: &mut u32) -> Option<Group> {
        if *left == 0 {
            return None;
        }
        let first = left.trailing_zeros();
        let mut lanes = *left;
        let mut same = |bits: u32| {
            let is_set = bits >> first & 1 == 1;
            lanes &= if is_set { bits } else { !bits };
            is_set
        };
        let backwards = [0, 1, 2].map(|axis: usize| same(self.backwards[axis]));
        let along_y = same(self.along[0]);
        let along_z = same(self.along[1]);
        *left &= !lanes;
        Some(Group {
            lanes,
            axis: if along_z { 2 } else { usize::from(along_y) },
            backwards,
        })
    }
}

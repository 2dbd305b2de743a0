//! The rays of a packet, a lane each.

use glam::Vec3A;

use crate::bvh::{
    mesh_tree::ObjectRay,
    slab::{PAD, SlabRay},
    wide::Lanes,
};

/// What the tests need of rays in one space, as [`ObjectRay`] has it of one.
#[derive(Clone, Copy)]
pub(crate) struct PacketRays<L> {
    pub(crate) origin: [L; 3],
    pub(crate) direction: [L; 3],
    /// Origins moved up, by axis, and down.
    above: [L; 3],
    below: [L; 3],
    pub(super) inverse: [L; 3],
}

/// The largest of three.
#[inline(always)]
pub(crate) fn largest_of<L: Lanes>([x, y, z]: [L; 3]) -> L {
    x.max(y).max(z)
}

impl<L: Lanes> PacketRays<L> {
    /// As [`ObjectRay::new`].
    #[inline(always)]
    pub(crate) fn new(origin: [L; 3], direction: [L; 3], longest: L) -> Self {
        let least = longest.mul(L::splat(1.0 / (1u64 << 32) as f32));
        let raised = direction.map(|d| d.abs().max(least).copysign(d));
        let rays = Self {
            origin,
            direction,
            above: origin,
            below: origin,
            inverse: raised.map(|d| L::splat(1.0).div(d)),
        };
        rays.with_pad(PAD)
    }

    /// The same rays with another slack around their origins, relative to their size.
    #[inline(always)]
    pub(crate) fn with_pad(self, pad: f32) -> Self {
        let pad = largest_of(self.origin.map(L::abs)).mul(L::splat(pad));
        Self {
            above: self.origin.map(|o| o.add(pad)),
            below: self.origin.map(|o| o.sub(pad)),
            ..self
        }
    }

    /// Origins as the faces of boxes are measured from them: those that a ray meets first where its direction along the
    /// axis is not negative, and those it meets last.
    #[inline(always)]
    pub(super) fn padded(&self, axis: usize) -> [L; 2] {
        [self.above[axis], self.below[axis]]
    }

    /// One of the rays.
    #[inline(always)]
    pub(crate) fn ray(&self, lane: usize) -> ObjectRay {
        let of = |columns: &[L; 3]| {
            let [x, y, z] = columns.map(|column| column.to_array().as_ref()[lane]);
            Vec3A::new(x, y, z)
        };
        ObjectRay {
            origin: of(&self.origin),
            direction: of(&self.direction),
            slab: SlabRay {
                above: of(&self.above),
                below: of(&self.below),
                inverse: of(&self.inverse),
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

/// The ways that rays go, as bits of each ray.
pub(crate) struct Ways {
    backwards: [u32; 3],
    /// Which go farthest along y, and which along z.
    along: [u32; 2],
}

impl Ways {
    #[inline(always)]
    pub(crate) fn of<L: Lanes>(rays: &PacketRays<L>) -> Self {
        let [x, y, z] = rays.direction.map(L::abs);
        // As `Shear::new` chooses.
        let in_plane = x.le(y);
        let most = L::select(in_plane, y, x);
        let in_plane = L::bits(in_plane);
        let not_along_z = L::bits(z.lt(most));
        Self {
            backwards: (rays.inverse).map(|inverse| L::bits(inverse.lt(L::splat(0.0)))),
            along: [not_along_z & in_plane, !not_along_z],
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

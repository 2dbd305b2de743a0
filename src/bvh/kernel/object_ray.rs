//! A ray in the space of what it is tested against.

use glam::Vec3A;

use super::slab::SlabRay;

/// A ray in a mesh's own space or in the world's, with what the slab test needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ObjectRay {
    pub(crate) origin: Vec3A,
    pub(crate) direction: Vec3A,
    pub(crate) slab: SlabRay,
}

impl ObjectRay {
    /// `longest` is the size of the direction's largest component, and lies within the range that [`SlabRay`] asks for.
    #[inline(always)]
    pub(crate) fn new(origin: Vec3A, direction: Vec3A, longest: f32) -> Self {
        Self {
            origin,
            direction,
            slab: SlabRay::new(origin, direction, longest, SlabRay::pad_of(origin)),
        }
    }
}

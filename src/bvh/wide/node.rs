//! A node of up to sixteen children, as the kernels read it.

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Marks a child that is a leaf; the other bits then number the leaf, and else the node.
pub(crate) const LEAF: u32 = 1 << 31;
/// Children of a node.
pub(crate) const WIDTH: usize = 16;

/// 448 bytes, seven cache lines: six faces of each child's box and its number, a lane a child.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// The lower faces of the boxes and the upper ones, axis by axis; each in two halves of eight, as they are tested.
    /// Arrays instead of names, because a ray picks the faces that it meets first by a number, and that of two needs no
    /// check.
    faces: [[[[f32; 8]; 2]; 2]; 3],
    children: [u32; WIDTH],
}

impl WideNode {
    /// No child; every ray misses a lane that has none, since its box is inside out.
    pub(super) const EMPTY: Self = Self {
        faces: [[[[f32::INFINITY; 8]; 2], [[f32::NEG_INFINITY; 8]; 2]]; 3],
        children: [0; WIDTH],
    };

    /// Puts a child into a lane. Its box is finite.
    pub(super) fn set(&mut self, lane: usize, bounds: &Aabb, child: u32) {
        let (half, place) = (lane / 8, lane % 8);
        for (axis, [lower, upper]) in self.faces.iter_mut().enumerate() {
            lower[half][place] = bounds.min[axis];
            upper[half][place] = bounds.max[axis];
        }
        self.children[lane] = child;
    }

    /// Gives the child in a lane another number.
    pub(super) fn renumber(&mut self, lane: usize, child: u32) {
        self.children[lane] = child;
    }

    /// The same node where the nodes and the leaves that it counts from 0 begin at these numbers.
    pub(super) fn moved(&self, first_node: u32, first_leaf: u32) -> Self {
        let mut node = *self;
        for child in &mut node.children {
            *child += if *child & LEAF == 0 {
                first_node
            } else {
                first_leaf
            };
        }
        node
    }

    /// Eight children's faces across an axis: the lower ones (`side % 2` is 0) or the upper, of the first eight children
    /// (`half` is 0) or of the others.
    #[inline(always)]
    pub(super) fn faces(&self, axis: usize, side: usize, half: usize) -> &[f32; 8] {
        &self.faces[axis][side % 2][half]
    }

    /// One face of the child in lane `lane % 16`.
    #[inline(always)]
    pub(super) fn face(&self, axis: usize, side: usize, lane: u32) -> f32 {
        let faces: &[f32; WIDTH] = bytemuck::cast_ref(&self.faces[axis][side % 2]);
        faces[lane as usize % WIDTH]
    }

    /// The child in lane `lane % 16`.
    #[inline(always)]
    pub(super) fn child(&self, lane: u32) -> u32 {
        self.children[lane as usize % WIDTH]
    }

    /// The lanes that have a child.
    pub(super) fn lanes(&self) -> impl Iterator<Item = u32> {
        (0..WIDTH as u32).filter(|&lane| self.face(0, 0, lane) <= self.face(0, 1, lane))
    }

    /// The children that there are, with their boxes.
    pub(super) fn children(&self) -> impl Iterator<Item = (Aabb, u32)> {
        self.lanes().map(|lane| {
            let corner = |side: usize| {
                let [x, y, z] = [0, 1, 2].map(|axis| self.face(axis, side, lane));
                Vec3A::new(x, y, z)
            };
            (Aabb::new(corner(0), corner(1)), self.child(lane))
        })
    }
}

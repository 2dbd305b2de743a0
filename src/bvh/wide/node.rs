//! A node of up to eight children, as the kernels read it.

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Marks a child that is a leaf; the other bits then number the leaf, and else the node.
pub(crate) const LEAF: u32 = 1 << 31;

/// The row of the children's numbers.
const CHILDREN: usize = 6;

/// 256 bytes, four cache lines: eight rows of eight numbers, a lane a child. Rows 0, 2 and 4 are the lower faces of the
/// children's boxes (x, y, z), each followed by the upper one; 6 the bits of their numbers, 7 is not used. Rows instead
/// of fields, because a ray picks the faces that it meets first by a number, and that of eight needs no check.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    rows: [[f32; 8]; 8],
}

impl WideNode {
    /// No child; every ray misses a lane that has none, since its box is inside out.
    pub(super) const EMPTY: Self = Self {
        rows: [
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [f32::INFINITY; 8],
            [f32::NEG_INFINITY; 8],
            [0.0; 8],
            [0.0; 8],
        ],
    };

    /// Puts a child into a lane. Its box is finite.
    pub(super) fn set(&mut self, lane: usize, bounds: &Aabb, child: u32) {
        for axis in 0..3 {
            self.rows[2 * axis][lane] = bounds.min[axis];
            self.rows[2 * axis + 1][lane] = bounds.max[axis];
        }
        self.rows[CHILDREN][lane] = f32::from_bits(child);
    }

    /// Gives the child in a lane another number.
    pub(super) fn renumber(&mut self, lane: usize, child: u32) {
        self.rows[CHILDREN][lane] = f32::from_bits(child);
    }

    /// The same node where the nodes and the leaves that it counts from 0 begin at these numbers.
    pub(super) fn moved(&self, first_node: u32, first_leaf: u32) -> Self {
        let mut node = *self;
        for number in &mut node.rows[CHILDREN] {
            let child = number.to_bits();
            let first = if child & LEAF == 0 {
                first_node
            } else {
                first_leaf
            };
            *number = f32::from_bits(child + first);
        }
        node
    }

    /// The faces of row `row % 8`.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> &[f32; 8] {
        &self.rows[row % 8]
    }

    /// The child in lane `lane % 8`.
    #[inline(always)]
    pub(super) fn child(&self, lane: u32) -> u32 {
        self.rows[CHILDREN][lane as usize % 8].to_bits()
    }

    /// The lanes that have a child.
    pub(super) fn lanes(&self) -> impl Iterator<Item = u32> {
        let [lower, upper] = [&self.rows[0], &self.rows[1]];
        (0..8).filter(|&lane| lower[lane as usize] <= upper[lane as usize])
    }

    /// The children that there are, with their boxes.
    pub(super) fn children(&self) -> impl Iterator<Item = (Aabb, u32)> {
        self.lanes().map(|lane| {
            let corner = |first: usize| {
                let [x, y, z] = [0, 2, 4].map(|axis| self.rows[first + axis][lane as usize]);
                Vec3A::new(x, y, z)
            };
            (Aabb::new(corner(0), corner(1)), self.child(lane))
        })
    }
}

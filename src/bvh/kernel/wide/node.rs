//! A node of up to sixteen children, as the kernels read it.

use glam::Vec3A;
use obvhs::aabb::Aabb;

/// Marks a child that is a leaf; the other bits then number the leaf, and else the node.
pub(crate) const LEAF: u32 = 1 << 31;
/// Children of a node.
pub(crate) const WIDTH: usize = 16;

/// Faces of the children's boxes across each axis.
const ACROSS: usize = 2 * WIDTH;

/// One of a box's two faces across an axis. As a number it is where the faces of that side begin among [`ACROSS`], so that a
/// ray finds those that it meets first without arithmetic and without a check.
#[derive(Clone, Copy, Debug)]
#[repr(usize)]
pub(crate) enum Side {
    Lower = 0,
    Upper = WIDTH,
}

/// Which faces of boxes a ray meets, axis by axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sides {
    pub(crate) first: [Side; 3],
    pub(crate) last: [Side; 3],
}

impl Sides {
    /// See [`Self::of`].
    const fn new(backwards: u32) -> Self {
        const fn across(backwards: bool) -> [Side; 2] {
            if backwards {
                [Side::Upper, Side::Lower]
            } else {
                [Side::Lower, Side::Upper]
            }
        }
        let x = across(backwards & 1 != 0);
        let y = across(backwards & 2 != 0);
        let z = across(backwards & 4 != 0);
        Self {
            first: [x[0], y[0], z[0]],
            last: [x[1], y[1], z[1]],
        }
    }

    /// Of a ray that goes backwards along axis `i` where bit `i` is set.
    #[inline(always)]
    pub(crate) fn of(backwards: u32) -> &'static Self {
        static ALL: [Sides; 8] = [
            Sides::new(0),
            Sides::new(1),
            Sides::new(2),
            Sides::new(3),
            Sides::new(4),
            Sides::new(5),
            Sides::new(6),
            Sides::new(7),
        ];
        &ALL[backwards as usize % 8]
    }
}

/// 448 bytes, seven cache lines: six faces of each child's box and its number, a lane a child.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct WideNode {
    /// Axis by axis, the lower faces of the boxes and the upper ones: see [`Side`].
    faces: [f32; 3 * ACROSS],
    children: [u32; WIDTH],
}

impl WideNode {
    /// No child; every ray misses a lane that has none, since its box is inside out.
    pub(super) const EMPTY: Self = Self {
        faces: {
            let mut faces = [f32::INFINITY; 3 * ACROSS];
            let mut i = 0;
            while i < faces.len() {
                if i % ACROSS >= Side::Upper as usize {
                    faces[i] = f32::NEG_INFINITY;
                }
                i += 1;
            }
            faces
        },
        children: [0; WIDTH],
    };

    /// Puts a child into a lane. Its box is finite.
    pub(super) fn set(&mut self, lane: usize, bounds: &Aabb, child: u32) {
        for (axis, faces) in self.faces.chunks_exact_mut(ACROSS).enumerate() {
            faces[Side::Lower as usize + lane] = bounds.min[axis];
            faces[Side::Upper as usize + lane] = bounds.max[axis];
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

    /// Eight children's faces across an axis: of the first eight children (`half` is 0) or of the others.
    #[inline(always)]
    pub(super) fn faces(&self, axis: usize, side: Side, half: usize) -> &[f32; 8] {
        let start = ACROSS * axis + side as usize + 8 * half;
        // The compiler sees that it does: no check is left.
        (self.faces[start..].first_chunk()).expect("a half begins where one begins")
    }

    /// One face of the child in lane `lane % 16`.
    #[inline(always)]
    pub(super) fn face(&self, axis: usize, side: Side, lane: u32) -> f32 {
        self.faces[ACROSS * axis + side as usize + lane as usize % WIDTH]
    }

    /// The child in lane `lane % 16`.
    #[inline(always)]
    pub(super) fn child(&self, lane: u32) -> u32 {
        self.children[lane as usize % WIDTH]
    }

    /// The lanes that have a child.
    pub(super) fn lanes(&self) -> impl Iterator<Item = u32> {
        (0..WIDTH as u32)
            .filter(|&lane| self.face(0, Side::Lower, lane) <= self.face(0, Side::Upper, lane))
    }

    /// The children that there are, with their boxes.
    pub(super) fn children(&self) -> impl Iterator<Item = (Aabb, u32)> {
        self.lanes().map(|lane| {
            let corner = |side: Side| {
                let [x, y, z] = [0, 1, 2].map(|axis| self.face(axis, side, lane));
                Vec3A::new(x, y, z)
            };
            (
                Aabb::new(corner(Side::Lower), corner(Side::Upper)),
                self.child(lane),
            )
        })
    }
}

//! The form of a tree that rays walk: sixteen boxes a node, eight triangles a leaf, tested at once.
//!
//! A [`Bvh2`](obvhs::bvh2::Bvh2) from any builder is [`collapse`]d into [`WideTree`]: nodes of up to sixteen children, in
//! which the SAH says which levels to leave out. Its leaves are [`TriangleBlock`]s (or instances, in the top tree).
//! [`walk`] takes a ray through it, and [`walk_packet`] many that go the same way.
//!
//! # The same hits as the binary tree, bit for bit
//! Node boxes are those of the binary tree, unchanged, and the slab test is that of [`super::slab`]: the same
//! differences, products, minima and maxima, eight at a time. The triangle test is that of [`super::triangle`], eight at
//! a time up to the edge functions' signs and then the same code for the few that pass. What a box above a triangle
//! says does not matter for a hit, as long as it is a box around the triangle's own; so another tree finds the same.
//!
//! Faces and corners are subtracted from the ray's origin and not the other way round, since an instruction may take what it
//! subtracts from memory. Reciprocals have the other sign too, and edge functions are products of two such differences, so
//! the numbers are the same.
//!
//! # Instruction sets
//! The kernels are written once, over [`Lanes`], several `f32`s with the few operations that they need. It has an
//! implementation for each instruction set, in a file of its own: `avx512`, `avx2`, and `portable` for everything else.
//! No operation of them rounds differently. [`answer`] picks one when the program runs.

#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
mod block;
mod collapse;
mod lanes;
mod node;
mod packet;
mod portable;
mod tree;
mod walk;

pub(crate) use block::{Owner, Sheared, Sight, TriangleBlock};
#[cfg(test)]
pub(crate) use lanes::answer_with_each;
pub(crate) use lanes::{Eight, InstructionSet, Lanes, Query, answer, by_axis};
pub(crate) use node::Sides;
#[cfg(test)]
pub(crate) use node::{LEAF, WIDTH};
pub(crate) use packet::{
    Answers, Found, Group, PacketLeaves, PacketRays, View, Ways, farthest_along, lanes_of,
    largest_size, walk_packet,
};
#[cfg(test)]
pub(crate) use portable::Portable;
pub(crate) use tree::WideTree;
pub use tree::{WideBox, WideStats};
pub(crate) use walk::{FEW, Leaves, MANY, WideRay, few_hold, walk, walk_from};

//! Packets: rays that go the same way walk a tree together, each in a lane.
//!
//! A packet's rays are sorted into [`Group`]s, whose directions have the same signs and the same longest component. A
//! group walks the tree once: a node's boxes are tested against bounds of all its rays ([`View::span`]), a box that any ray
//! may enter is tested against all of them when its turn comes, and a triangle against all that entered its leaf. Where
//! no more than [`FEW_RAYS`] go on, they go on alone.
//!
//! # The same hits as single rays, bit for bit
//! Every number that decides on a hit comes from the operations of [`super::super::triangle`] and
//! [`super::super::slab`], one by one, in a lane instead of alone. Which boxes are entered does not matter for a hit, as
//! long as none is left out that its ray enters; and the bounds of a group are monotone under rounding as the slab test
//! is.

mod block;
mod found;
mod rays;
mod view;
mod walk;

pub(crate) use found::{Answers, Found, lanes_of};
pub(crate) use rays::{Group, PacketRays, Ways, farthest_along, largest_size};
pub(crate) use view::View;
pub(crate) use walk::{PacketLeaves, walk_packet};

/// So many rays of a packet go on alone: for them eight boxes at once are less work than one box for all.
pub(crate) const FEW_RAYS: u32 = 2;

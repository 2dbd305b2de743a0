//! One ray, or a packet, against boxes and triangles: tests, and the one walk.
//!
//! [`ray`] asks, [`goal`] says what for, [`safe_ray`] makes it safe, [`object_ray`] is it in the space of what it is tested against.
//! [`slab`] tests boxes, [`triangle`] triangles, [`wide`] many of either at once; [`visitor`] watches. Of a batch, [`order`] says
//! how its rays lie to each other, [`columns`] reads them into lanes.

pub(super) mod columns;
pub(super) mod goal;
pub(super) mod object_ray;
pub(super) mod order;
pub(super) mod ray;
pub(super) mod safe_ray;
pub(super) mod slab;
pub(super) mod triangle;
pub(super) mod visitor;
pub(super) mod wide;

pub use order::Order;
pub use ray::{Hit, Ray, TriangleId};
pub use visitor::{Counters, NodeEvent, TreeRef, Visitor};
pub use wide::{WideBox, WideStats};

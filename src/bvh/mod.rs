//! Triangles, trees over them, and the rays that walk those trees. Knows no scene and no ECS.
//!
//! ```text
//! measure ── build ── kernel ── geometry ── traversal
//! ```
//! `build` makes trees, `measure` tells what they are like; `kernel` walks one of them with a ray or a packet; `geometry` are
//! meshes and instances and where hits lie on them, `traversal` the questions to all of them. Each uses those left of it.
//! Tests and the report check them with `hard_cases`.
//!
//! # The way of a ray
//! ```text
//! positions, indices ── Triangles ── MeshTree ──┐            Ray
//!                       (checked)    (built once)├─ Instance ─┤
//!                                      Affine3A ─┘            │
//!                                                 Aggregate ──┴─ Hit, or nothing
//! ```
//! 1. [`Triangles`] checks a mesh: an index out of range is an error, a corner that is not finite leaves its triangle
//!    out, and both that and degenerate triangles are counted. Triangles keep their numbers whatever happens.
//! 2. [`MeshTree`] hands their boxes to [`build_tree`] (by [`BuildOptions`]: none, median, SAH or obvhs' PLOC; every
//!    builder makes the same kind of [`obvhs::bvh2::Bvh2`]) and copies the corners into the order of the leaves.
//! 3. An [`Instance`] places a mesh by a transform. Many share one mesh.
//! 4. An [`Aggregate`] holds the instances, and a tree over them ([`Levels::Two`]) or over all their triangles
//!    ([`Levels::One`]). Moving an instance rebuilds this one only.
//! 5. A [`Ray`] asks it for the nearest hit ([`Aggregate::closest_hit`]), for any ([`Aggregate::occluded`]), for the next
//!    one behind a hit ([`MultiHit`] where there are many), for all, for how much of a light passes them; one ray at a time or
//!    in batches. They walk a wide form of the trees, many boxes and
//!    triangles at once (`wide`). It is one walk, whatever is asked ([`Aggregate`] → `levels` → `leaves` → `wide::walk` →
//!    `wide::block` → `triangle`), and a [`Visitor`] may watch its every node and triangle.
//!    Of a batch whose [`Order`] says that its rays go the same way, many walk together (`wide::packet`).
//! 6. [`Instance::surface_point`] tells where a [`Hit`] lies, and [`Aggregate::leave`] where a ray starts that leaves it.
//!
//! # What is promised
//! * **Nothing leaks.** A ray that passes a closed mesh's surface hits it, on edges and in corners too, at any distance
//!   from the origin (`triangle`, `slab`). Nor does one that starts at a hit, beside edges and in narrow wedges too
//!   (`surface_point`, `leave`).
//! * **The tree changes no bit.** Every builder, one level or two, or no tree at all find the same hits, to the last bit
//!   of `t`. Three things make it so. A triangle is only hit where the ray passes its own box, and `t` is clamped to
//!   the ray's stretch within it. The slab test is monotone under rounding, so no box above that one is entered later
//!   (`slab`). And boxes in the world are padded by what a ray's way into object space may be off (`instance`). Equal
//!   `t` go to the smaller (instance, triangle).
//! * **`t` is exact** to an ulp where the instance is not transformed: it comes from the triangle's plane in f64. Where it
//!   is, the error is that of the object ray.
//! * **A ray costs no allocation.** No tree is deeper than [`MAX_DEPTH`].
//! * **No input panics.** NaN and infinite rays miss.
//!
//! Rules at the borders: both sides are hit; an edge belongs to all its triangles; a ray in a triangle's plane misses it;
//! hits lie strictly between 0 and `t_max`.

mod build;
mod geometry;
pub(crate) mod hard_cases;
mod kernel;
mod measure;
#[cfg(test)]
mod specimens;
#[cfg(test)]
mod tests;
mod traversal;
mod triangles;

pub use build::{BuildOptions, Builder, Levels, MAX_DEPTH, Preset, build_tree};
pub use geometry::{
    Aggregate, Instance, MeshTree, NearEdge, Primitive, SingularTransform, SurfacePoint,
};
pub(crate) use geometry::{Placement, beyond_error};
pub use kernel::{
    Counters, Hit, NodeEvent, Order, Ray, TreeRef, TriangleId, Visitor, WideBox, WideStats,
};
pub use measure::{
    COST_INTERSECT, COST_TRAVERSE, EPO_SAMPLES, LARGEST_LEAF_BIN, SplitPlane, TreeStats, bytes,
    epo, gap_plane, node_cost, primitives_below, sah_cost, split_plane,
};
pub use traversal::{MultiHit, Transmittances};
pub use triangles::{REACH, Triangles, TrianglesError};

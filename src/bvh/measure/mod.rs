//! What a tree is like, in numbers.
//!
//! [`stats`] has nodes, leaves and SAH cost, [`epo`] the overlap, [`split_plane`] the plane between a node's children.

mod epo;
pub(super) mod split_plane;
pub(super) mod stats;

pub use epo::{EPO_SAMPLES, epo};
pub use split_plane::{SplitPlane, gap_plane, primitives_below, split_plane};
pub use stats::{
    COST_INTERSECT, COST_TRAVERSE, LARGEST_LEAF_BIN, TreeStats, bytes, node_cost, sah_cost,
};

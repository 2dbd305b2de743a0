//! Triangles, trees over them, and the rays that walk those trees.

mod aggregate;
mod boxes;
mod build;
mod crossing;
mod epo;
mod instance;
mod layout;
mod median;
mod mesh_tree;
mod options;
mod ploc;
mod ray;
mod sah;
mod slab;
#[cfg(test)]
mod specimens;
mod split_plane;
mod stats;
mod surface_point;
mod top_down;
mod traverse;
mod treelets;
mod triangle;
mod triangles;
mod visitor;

pub use aggregate::Aggregate;
pub use build::{MAX_DEPTH, build_tree};
pub use epo::{EPO_SAMPLES, epo};
pub use instance::{Instance, SingularTransform};
pub use mesh_tree::MeshTree;
pub use options::{BuildOptions, Builder, Levels, Preset};
pub use ray::{Hit, Ray};
pub use sah::{COST_INTERSECT, COST_TRAVERSE};
pub use split_plane::{SplitPlane, primitives_below, split_plane};
pub use stats::{LARGEST_LEAF_BIN, TreeStats, bytes, sah_cost};
pub use surface_point::SurfacePoint;
pub use triangles::{REACH, Triangles, TrianglesError};
pub use visitor::{Counters, NodeEvent, TreeRef, Visitor};

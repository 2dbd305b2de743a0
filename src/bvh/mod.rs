//! Triangles, trees over them, and the rays that walk those trees.

mod boxes;
mod build;
mod layout;
mod median;
mod options;
mod ploc;
mod sah;
mod stats;
mod top_down;

pub use build::{MAX_DEPTH, build_tree};
pub use options::{BuildOptions, Builder, Levels, Preset};
pub use sah::{COST_INTERSECT, COST_TRAVERSE};
pub use stats::{LARGEST_LEAF_BIN, TreeStats, bytes, sah_cost};

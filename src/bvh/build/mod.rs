//! Boxes in, tree out: every builder makes the same kind of tree.
//!
//! [`build_tree`] calls the builder that [`options`] name: [`median`] and [`sah`], which cut [`top_down`], or [`ploc`], whose last
//! branches [`treelets`] builds anew. All work on [`boxes`] with which none can go wrong, and end in [`layout`], which keeps to
//! [`depth`].

mod boxes;
mod build_tree;
mod depth;
mod layout;
mod median;
pub(super) mod options;
mod ploc;
mod sah;
mod top_down;
mod treelets;

pub use build_tree::build_tree;
pub use depth::MAX_DEPTH;
pub use options::{BuildOptions, Builder, Levels, Preset};

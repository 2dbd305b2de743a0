//! How deep a tree may be.

/// No leaf of any tree is deeper (the root's depth is 0), so the stack of a traversal that keeps one child for
/// later on every level can be an array of this many entries.
pub const MAX_DEPTH: usize = 96;

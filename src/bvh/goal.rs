//! What a ray asks of a tree.

/// A question, known when the walk is compiled.
pub(crate) trait Goal {
    /// Whether nodes are walked in the order in which the ray enters them.
    const NEAREST_FIRST: bool;
    /// Whether it matters only that something is hit, and not where.
    const ANY: bool;
}

/// The nearest hit.
pub(crate) struct Nearest;

impl Goal for Nearest {
    const NEAREST_FIRST: bool = true;
    const ANY: bool = false;
}

/// Whether there is a hit.
pub(crate) struct Any;

impl Goal for Any {
    const NEAREST_FIRST: bool = false;
    const ANY: bool = true;
}

/// Every hit.
pub(crate) struct All;

impl Goal for All {
    const NEAREST_FIRST: bool = false;
    const ANY: bool = false;
}

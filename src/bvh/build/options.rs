//! What a caller chooses about a tree.

/// The rule that splits (or joins) primitives into a tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Builder {
    /// No tree: one leaf that holds everything, so every ray tests every primitive.
    None,
    /// Half of the primitives on either side, along the longest axis of their centroids.
    Median,
    /// Binned surface area heuristic: the split that costs least.
    #[default]
    Sah,
    /// obvhs' locally-ordered clustering with reinsertion.
    Ploc,
}

/// How many levels of trees stand over a scene's triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Levels {
    /// One tree over every triangle of every instance.
    One,
    /// A tree for each mesh, shared by its instances, and one over the instances.
    #[default]
    Two,
}

/// obvhs' own presets, from quick to build to quick to trace. Used by [`Builder::Ploc`] only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Preset {
    /// Clustering with a search distance of 1, no reinsertion.
    Fastest,
    /// A search distance of 6, a little reinsertion.
    Fast,
    /// A search distance of 14, reinsertion before and after leaves are merged.
    #[default]
    Medium,
    /// A search distance of 24, much reinsertion.
    Slow,
    /// Every node is reinserted, again and again.
    VerySlow,
}

/// How a tree is built. Numbers out of range are clamped, so that every value builds a correct tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BuildOptions {
    /// The splitting rule.
    pub builder: Builder,
    /// One tree or two levels. [`build_tree`](super::build_tree::build_tree) builds single trees and does not read it.
    pub levels: Levels,
    /// The deepest leaf of a `Median` or `Sah` tree, the root being at depth 0: a node there is a leaf
    /// whatever its size. 0 to [`MAX_DEPTH`](super::depth::MAX_DEPTH).
    pub max_depth: u32,
    /// Primitives in a leaf, 1 to 255. `Median` and `Sah` exceed it at `max_depth` only.
    pub max_leaf_size: u32,
    /// Bins per axis of `Sah`, 2 to 64.
    pub bins: u32,
    /// How much time `Ploc` takes for a better tree.
    pub preset: Preset,
}

impl Default for BuildOptions {
    fn default() -> Self {
        Self {
            builder: Builder::default(),
            levels: Levels::default(),
            max_depth: 64,
            max_leaf_size: 8,
            bins: 16,
            preset: Preset::default(),
        }
    }
}

impl BuildOptions {
    /// The same choices with every number inside its range.
    pub fn clamped(self) -> Self {
        Self {
            max_depth: self.max_depth.min(super::depth::MAX_DEPTH as u32),
            max_leaf_size: self.max_leaf_size.clamp(1, 255),
            bins: self.bins.clamp(2, 64),
            ..self
        }
    }
}

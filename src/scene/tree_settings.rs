//! How trees are built.

use super::schema::{Label, Needs, documented};
use super::settings::whole;
use bevy::reflect::{Reflect, std_traits::ReflectDefault};

/// A setting that only these builders read.
const fn tree_of(builders: &'static str) -> Needs {
    Needs {
        path: "tree.builder",
        values: builders,
    }
}

documented! {
    /// How the trees are built. The picture does not depend on it.
    #[derive(Reflect, Clone, Copy, Debug, PartialEq)]
    #[reflect(Default, Clone, PartialEq, Debug)]
    pub struct TreeSettings {
        /// How the trees are built.
        pub builder: Builder,
        /// A tree per mesh and one over the objects, or one tree over all triangles.
        pub levels: Levels,
        /// Levels of median and SAH trees; a node at the last level is a leaf whatever its size.
        #[reflect(@whole(1, 64), @Label("Most levels"), @tree_of("Median|Sah"))]
        pub max_depth: u32,
        /// Triangles of a leaf; median and SAH trees exceed it only at their last level.
        #[reflect(@whole(1, 255).logarithmic(), @Label("Leaf size"), @tree_of("Median|Sah|Ploc"))]
        pub max_leaf_size: u32,
        /// Bins per axis of SAH trees.
        #[reflect(@whole(2, 64), @tree_of("Sah"))]
        pub bins: u32,
        /// How much time PLOC takes for a better tree.
        #[reflect(@tree_of("Ploc"))]
        pub preset: Preset,
    }
}

impl Default for TreeSettings {
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

impl TreeSettings {
    /// A simple textbook tree, to compare with: median split, at most ten levels, one tree for all.
    pub const SIMPLE: Self = Self {
        builder: Builder::Median,
        levels: Levels::One,
        max_depth: 10,
        max_leaf_size: 8,
        bins: 16,
        preset: Preset::Medium,
    };
}

documented! {
    /// How a tree is built.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum Builder {
        /// No tree: every ray tests every triangle.
        None,
        /// Half of the triangles on either side, along the longest axis.
        Median,
        /// Binned surface area heuristic: splits where the estimated cost is lowest.
        #[default]
        #[reflect(@Label("SAH"))]
        Sah,
        /// Merges neighbours bottom-up, then improves the tree: the lowest estimated cost, slower to build.
        ///
        /// obvhs: parallel locally-ordered clustering, then reinsertion.
        #[reflect(@Label("PLOC"))]
        Ploc,
    }
}

documented! {
    /// How many levels of trees there are.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum Levels {
        /// One tree over every triangle of every object.
        One,
        /// A tree per mesh, shared by the objects that use it, and one over the objects: moving rebuilds little.
        #[default]
        Two,
    }
}

documented! {
    /// obvhs' own presets, from quick to build to quick to trace.
    #[derive(Reflect, Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    #[reflect(Default, Clone, PartialEq, Debug, Hash)]
    pub enum Preset {
        /// The quickest to build, and the slowest to trace.
        Fastest,
        /// Quick to build: a little improvement.
        Fast,
        /// A middle way between building and tracing.
        #[default]
        Medium,
        /// Much improvement: slow to build, quick to trace.
        Slow,
        /// Improves every node, again and again: the quickest to trace.
        VerySlow,
    }
}

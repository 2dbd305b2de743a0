//! All instances of a scene, and the tree above their meshes' trees. [`crate::bvh::traversal::queries`] asks it.

use std::{
    ops::Range,
    time::{Duration, Instant},
};

use obvhs::{aabb::Aabb, bvh2::Bvh2};
use rayon::prelude::*;

use super::instance::Instance;
use crate::bvh::build::options::{BuildOptions, Levels};
use crate::bvh::build_tree;
use crate::bvh::kernel::wide::{TriangleBlock, WideBox, WideStats, WideTree};
use crate::bvh::measure::stats::TreeStats;

/// The boxes of fewer instances take less time than handing them to other threads.
const PARALLEL_SIZE: usize = 1 << 7;

/// The instances, and a tree over them or over all their triangles. The default is empty: every ray misses.
#[derive(Clone, Default)]
pub struct Aggregate {
    instances: Vec<Instance>,
    options: BuildOptions,
    pub(in crate::bvh) tree: Bvh2,
    /// What a leaf of `tree` holds, in leaf order.
    pub(crate) places: Places,
    /// The tree as rays walk it.
    pub(in crate::bvh) wide: WideTree,
    /// What its leaves hold: ranges of the places of instances, or of the blocks.
    pub(in crate::bvh) wide_leaves: Vec<Range<usize>>,
    /// One level: all triangles, each block's of one instance.
    pub(in crate::bvh) blocks: Vec<TriangleBlock>,
    /// Which instance that is.
    pub(in crate::bvh) block_instances: Vec<u32>,
    /// Entries of a stack that a walk through this tree and any mesh's needs.
    pub(in crate::bvh) most_pending: usize,
    /// The factor of |o|∞ that pads the origin of a world ray.
    pub(in crate::bvh) ray_pad: f32,
    build_time: Duration,
}

#[derive(Clone)]
pub(crate) enum Places {
    /// Two levels: instances.
    Instances(Vec<u32>),
    /// One level: (instance, place in the leaf order of its mesh).
    Triangles(Vec<(u32, u32)>),
}

/// What a leaf of the top tree holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Primitive {
    /// Two levels: an instance, by its number.
    Instance(u32),
    /// One level: a triangle of an instance's mesh.
    Triangle {
        /// Index into [`Aggregate::instances`].
        instance: u32,
        /// Index into the mesh's [`crate::bvh::Triangles::indices`].
        triangle: u32,
    },
}

impl Default for Places {
    fn default() -> Self {
        Self::Instances(Vec::new())
    }
}

impl Aggregate {
    /// Builds the tree above the meshes' own. With [`Levels::One`] the meshes' own trees are not used.
    pub fn build(instances: Vec<Instance>, options: &BuildOptions) -> Self {
        let start = Instant::now();
        let mut boxes: Vec<Aabb> = Vec::new();
        let (tree, places) = match options.levels {
            Levels::Two => {
                let bounds: Vec<Option<Aabb>> = (instances.par_iter().with_min_len(PARALLEL_SIZE))
                    .map(Instance::world_bounds)
                    .collect();
                let mut numbers = Vec::new();
                for (number, bounds) in bounds.into_iter().enumerate() {
                    if let Some(bounds) = bounds {
                        numbers.push(number as u32);
                        boxes.push(bounds);
                    }
                }
                // An instance is dear to enter, so none shares its leaf.
                let options = BuildOptions {
                    max_leaf_size: 1,
                    ..*options
                };
                let tree = build_tree(&boxes, &options);
                let places = tree
                    .primitive_indices
                    .iter()
                    .map(|&slot| numbers[slot as usize]);
                let places = Places::Instances(places.collect());
                (tree, places)
            }
            Levels::One => {
                let mut pairs = Vec::new();
                for (number, instance) in instances.iter().enumerate() {
                    for place in 0..instance.mesh.traced() {
                        pairs.push((number as u32, place as u32));
                        boxes.push(instance.to_world_box(&instance.mesh.box_at(place)));
                    }
                }
                let tree = build_tree(&boxes, options);
                let places = tree
                    .primitive_indices
                    .iter()
                    .map(|&slot| pairs[slot as usize]);
                let places = Places::Triangles(places.collect());
                (tree, places)
            }
        };
        let capacity = match &places {
            // An instance is dear to enter, so none shares its leaf.
            Places::Instances(_) => 1,
            Places::Triangles(_) => TriangleBlock::CAPACITY,
        };
        let (wide, mut wide_leaves) =
            WideTree::new(&tree, capacity, |leaf, leaves| leaves.push(leaf));
        let (mut blocks, mut block_instances) = (Vec::new(), Vec::new());
        if let Places::Triangles(places) = &places {
            for leaf in &mut wide_leaves {
                let first = blocks.len();
                let mut pairs = places[leaf.clone()].to_vec();
                pairs.sort_unstable();
                for same in pairs.chunk_by(|a, b| a.0 == b.0) {
                    let number = same[0].0;
                    let mesh = &instances[number as usize].mesh;
                    let places = same.iter().map(|&(_, place)| place as usize);
                    let triangles: Vec<u32> = places.map(|place| mesh.triangle_at(place)).collect();
                    TriangleBlock::append(&triangles, mesh.triangles(), &mut blocks);
                    block_instances.resize(blocks.len(), number);
                }
                *leaf = first..blocks.len();
            }
        }
        let meshes = instances.iter().map(|i| i.mesh.most_pending());
        let most_pending = wide.most_pending() + meshes.max().unwrap_or(0);
        let ray_pad = instances.iter().map(Instance::ray_pad).fold(0.0, f32::max);
        Self {
            instances,
            options: *options,
            tree,
            places,
            wide,
            wide_leaves,
            blocks,
            block_instances,
            most_pending,
            ray_pad,
            build_time: start.elapsed(),
        }
    }

    /// The instances, in the order in which hits number them.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// How the tree was built.
    pub fn options(&self) -> &BuildOptions {
        &self.options
    }

    /// The top tree: over instances, or over all triangles.
    pub fn tree(&self) -> &Bvh2 {
        &self.tree
    }

    /// What stands at a place of the top tree's leaf order (`first_index ..` of a leaf).
    pub fn primitive(&self, place: usize) -> Option<Primitive> {
        match &self.places {
            Places::Instances(places) => places.get(place).map(|&i| Primitive::Instance(i)),
            Places::Triangles(places) => places.get(place).map(|&(instance, place)| {
                let triangle = self.instances[instance as usize]
                    .mesh
                    .triangle_at(place as usize);
                Primitive::Triangle { instance, triangle }
            }),
        }
    }

    /// The world box of what stands at a place of the top tree's leaf order.
    pub(crate) fn box_at(&self, place: usize) -> Option<Aabb> {
        match &self.places {
            Places::Instances(places) => {
                self.instances[*places.get(place)? as usize].world_bounds()
            }
            Places::Triangles(places) => {
                let &(number, place) = places.get(place)?;
                let instance = &self.instances[number as usize];
                Some(instance.to_world_box(&instance.mesh.box_at(place as usize)))
            }
        }
    }

    /// Statistics of the top tree's form that rays walk.
    pub fn wide_stats(&self) -> WideStats {
        let nodes = self.wide.stats();
        let triangles = match &self.places {
            Places::Instances(_) => 0,
            Places::Triangles(places) => places.len(),
        };
        WideStats {
            blocks: self.blocks.len(),
            triangles_per_block: triangles as f64 / self.blocks.len().max(1) as f64,
            bytes: nodes.bytes + size_of_val(self.blocks.as_slice()),
            ..nodes
        }
    }

    /// The boxes of the top tree's form that rays walk, parents before children.
    pub fn wide_boxes(&self) -> Vec<WideBox> {
        let root = self.tree.nodes.first().map(|root| *root.aabb());
        self.wide.boxes(&root.unwrap_or_default())
    }

    /// Statistics of the top tree.
    pub fn stats(&self) -> TreeStats {
        TreeStats::of(&self.tree)
    }

    /// How long building the top tree took; the meshes' own times are theirs.
    pub fn build_time(&self) -> Duration {
        self.build_time
    }

    /// Memory of the top tree, in bytes, without the meshes.
    pub fn bytes(&self) -> usize {
        let places = match &self.places {
            Places::Instances(places) => size_of_val(places.as_slice()),
            Places::Triangles(places) => size_of_val(places.as_slice()),
        };
        places
            + size_of_val(self.tree.nodes.as_slice())
            + size_of_val(self.tree.primitive_indices.as_slice())
            + size_of_val(self.instances.as_slice())
            + self.wide.bytes()
            + size_of_val(self.wide_leaves.as_slice())
            + size_of_val(self.blocks.as_slice())
            + size_of_val(self.block_instances.as_slice())
    }
}

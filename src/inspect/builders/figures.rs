//! One builder's tree in numbers.

use super::BuilderRates;
use crate::bvh::{Builder, TreeStats, epo};
use crate::trace::World;
use bevy::platform::collections::HashSet;
use glam::Vec3;
use serde::Serialize;
use std::sync::Arc;
use std::time::Duration;

/// The tree over all triangles of a world, as one builder makes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuilderFigures {
    /// `none`, `median`, `sah` or `ploc`.
    pub builder: &'static str,
    /// Of all objects: a mesh that two objects share counts twice.
    pub triangles: u64,
    /// The depth of the deepest leaf; the root's is 0.
    pub levels: u32,
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Triangles of the largest leaf.
    pub largest_leaf: u32,
    /// Expected cost of a random ray that hits the root's box, from surface areas.
    pub sah_cost: f64,
    /// Effective parent overlap: how much of the surface lies inside boxes of nodes that do not hold it
    /// (Aila et al. 2013).
    pub epo: f64,
    /// Nodes of the wide form, which rays walk.
    pub wide_nodes: usize,
    /// Children of such a node on average, of sixteen.
    pub children_per_wide_node: f64,
    /// Triangles of a block of its leaves on average, of eight.
    pub triangles_per_block: f64,
    /// Of the tree and all that tracing keeps of the triangles.
    pub bytes: usize,
    /// The same for each triangle.
    pub bytes_per_triangle: f64,
    /// Milliseconds.
    pub build_ms: f64,
    /// `leaf_sizes[n]` leaves hold n triangles; the last entry counts larger ones too.
    pub leaf_sizes: Vec<u32>,
    /// `depths[d]` leaves are at depth d.
    pub depths: Vec<u32>,
    /// Speed on a view's own rays, where it was measured.
    pub rates: Option<BuilderRates>,
}

impl BuilderFigures {
    /// The figures of a world whose trees have one level.
    pub fn of(world: &World) -> Self {
        let corners = corners(world);
        let aggregate = &world.aggregate;
        let TreeStats {
            levels,
            nodes,
            leaves,
            largest_leaf,
            leaf_sizes,
            depths,
            sah_cost,
            ..
        } = aggregate.stats();
        let wide = aggregate.wide_stats();
        let mut seen = HashSet::new();
        let meshes: usize = world
            .objects
            .iter()
            .filter(|object| seen.insert(Arc::as_ptr(&object.mesh)))
            .map(|object| object.mesh.bytes())
            .sum();
        let bytes = meshes + aggregate.bytes();
        let triangles: u64 = world
            .objects
            .iter()
            .map(|object| object.mesh.tree.triangles().len() as u64)
            .sum();
        Self {
            builder: builder_name(aggregate.options().builder),
            triangles,
            levels,
            nodes,
            leaves,
            largest_leaf,
            sah_cost,
            epo: epo(aggregate.tree(), |slot| corners[slot as usize]),
            wide_nodes: wide.nodes,
            children_per_wide_node: wide.children_per_node,
            triangles_per_block: wide.triangles_per_block,
            bytes,
            bytes_per_triangle: bytes as f64 / triangles.max(1) as f64,
            build_ms: build_time(world).as_secs_f64() * 1e3,
            leaf_sizes,
            depths,
            rates: None,
        }
    }
}

/// A builder as tables and statistics call it.
pub fn builder_name(builder: Builder) -> &'static str {
    match builder {
        Builder::None => "none",
        Builder::Median => "median",
        Builder::Sah => "sah",
        Builder::Ploc => "ploc",
    }
}

/// Time spent on the trees of a world, each counted once.
pub fn build_time(world: &World) -> Duration {
    let mut seen = HashSet::new();
    let meshes: Duration = world
        .objects
        .iter()
        .filter(|object| seen.insert(Arc::as_ptr(&object.mesh.tree)))
        .map(|object| object.mesh.tree.build_time())
        .sum();
    meshes + world.aggregate.build_time()
}

/// Corners in the world of every primitive of a tree over all triangles, in the order in which
/// `Aggregate::build` numbers them: object by object, each in its mesh's leaf order.
pub(crate) fn corners(world: &World) -> Vec<[Vec3; 3]> {
    let instances = world.aggregate.instances().iter();
    instances
        .flat_map(|instance| {
            let mesh = &instance.mesh;
            (0..mesh.traced()).map(move |place| {
                let corners = mesh.triangles().corners(mesh.triangle_at(place));
                corners.map(|corner| instance.to_world_point(corner))
            })
        })
        .collect()
}

//! The trees that rays walk, one after the other, and what is to be known of a node.

use crate::bvh::{
    Builder, Instance, Levels, Primitive, SplitPlane, TreeRef, gap_plane, node_cost,
    primitives_below, split_plane,
};
use crate::trace::World;
use glam::Vec3;
use obvhs::bvh2::Bvh2;

use super::line_set::box_corners;

/// One of the trees: the top one, or that of an instance's mesh.
#[derive(Clone, Copy)]
pub struct TreeView<'a> {
    /// Which one.
    pub name: TreeRef,
    /// Its nodes.
    pub tree: &'a Bvh2,
    world: &'a World,
}

/// The trees that rays walk: the top one, then, with two levels, that of each instance's mesh. Two
/// instances of one mesh share the tree, and each has it in its own place.
pub fn trees(world: &World) -> impl Iterator<Item = TreeView<'_>> {
    let two = world.aggregate.options().levels == Levels::Two;
    let instances = if two {
        world.aggregate.instances().len() as u32
    } else {
        0
    };
    let names = std::iter::once(TreeRef::Top).chain((0..instances).map(TreeRef::Mesh));
    names.filter_map(|name| TreeView::new(world, name))
}

/// What is to be known of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeFacts {
    /// Levels below its tree's root.
    pub depth: u32,
    /// Its box in its tree's space: the world for the top tree, the object for a mesh's.
    pub bounds: [Vec3; 2],
    /// Its children; `None` for a leaf.
    pub children: Option<[u32; 2]>,
    /// Triangles (or, in a top tree over objects, objects) in and below it.
    pub primitives: u32,
    /// Its own term of the tree's SAH cost.
    pub cost: f64,
    /// The whole tree's SAH cost.
    pub tree_cost: f64,
}

impl<'a> TreeView<'a> {
    /// The tree of that name, if rays walk one.
    pub fn new(world: &'a World, name: TreeRef) -> Option<Self> {
        let aggregate = &world.aggregate;
        let tree = match name {
            TreeRef::Top => aggregate.tree(),
            TreeRef::Mesh(_) if aggregate.options().levels == Levels::One => return None,
            TreeRef::Mesh(instance) => aggregate.instances().get(instance as usize)?.mesh.tree(),
        };
        Some(Self { name, tree, world })
    }

    /// The tree of an instance's mesh; without one the top tree.
    pub fn of(world: &'a World, instance: Option<u32>) -> Option<Self> {
        Self::new(world, instance.map_or(TreeRef::Top, TreeRef::Mesh))
    }

    /// The instance whose mesh's tree it is; `None` for the top tree.
    pub fn instance(&self) -> Option<(u32, &'a Instance)> {
        match self.name {
            TreeRef::Top => None,
            TreeRef::Mesh(i) => Some((i, &self.world.aggregate.instances()[i as usize])),
        }
    }

    /// The `SceneId` of that instance's object.
    pub fn object(&self) -> Option<u64> {
        let (instance, _) = self.instance()?;
        Some(self.world.objects[instance as usize].id)
    }

    /// The corners of a node's box in the world, at time 0, numbered by the bits x, y, z.
    pub fn corners(&self, node: u32) -> [Vec3; 8] {
        let node = &self.tree.nodes[node as usize];
        self.place(box_corners(node.min, node.max))
    }

    /// Points of the tree's space, in the world at time 0.
    pub(super) fn place<const N: usize>(&self, points: [Vec3; N]) -> [Vec3; N] {
        match self.instance() {
            None => points,
            Some((_, instance)) => points.map(|point| instance.to_world_point(point)),
        }
    }

    /// The depth of every node; the root's is 0.
    pub fn depths(&self) -> Vec<u32> {
        let nodes = &self.tree.nodes;
        let mut depths = vec![0; nodes.len()];
        for (index, node) in nodes.iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
            let child = node.first_index as usize;
            // Children stand behind their parents.
            (depths[child], depths[child + 1]) = (depths[index] + 1, depths[index] + 1);
        }
        depths
    }

    /// The leaves, in the order of what they hold.
    pub fn leaves(&self) -> Vec<u32> {
        let nodes = &self.tree.nodes;
        let mut leaves: Vec<u32> = (0..nodes.len() as u32)
            .filter(|&node| nodes[node as usize].is_leaf())
            .collect();
        leaves.sort_unstable_by_key(|&node| nodes[node as usize].first_index);
        leaves
    }

    /// The nodes from the root to the leaf that holds a place of the leaf order.
    pub fn path(&self, place: usize) -> Vec<u32> {
        let mut path = Vec::new();
        if place >= self.tree.primitive_indices.len() {
            return path;
        }
        let mut node = 0;
        loop {
            path.push(node as u32);
            let here = &self.tree.nodes[node];
            if here.is_leaf() {
                return path;
            }
            let left = here.first_index as usize;
            node = left + usize::from(place >= primitives_below(self.tree, left).end);
        }
    }

    /// The place in the leaf order that an instance, or a triangle of it, has in this tree.
    pub fn place_of(&self, instance: u32, triangle: u32) -> Option<usize> {
        let places = 0..self.tree.primitive_indices.len();
        match self.instance() {
            Some((own, of)) => places
                .filter(|_| own == instance)
                .find(|&place| of.mesh.triangle_at(place) == triangle),
            None => {
                let wanted = Primitive::Triangle { instance, triangle };
                let aggregate = &self.world.aggregate;
                places
                    .map(|place| (place, aggregate.primitive(place)))
                    .find(|(_, held)| {
                        *held == Some(wanted) || *held == Some(Primitive::Instance(instance))
                    })
                    .map(|(place, _)| place)
            }
        }
    }

    /// The triangles that a leaf holds, as (instance, triangle); none where it holds objects.
    pub fn triangles(&self, leaf: u32) -> Vec<(u32, u32)> {
        let node = &self.tree.nodes[leaf as usize];
        let places = node.first_index as usize..(node.first_index + node.prim_count) as usize;
        match self.instance() {
            Some((number, instance)) => places
                .map(|place| (number, instance.mesh.triangle_at(place)))
                .collect(),
            None => places
                .filter_map(|place| match self.world.aggregate.primitive(place) {
                    Some(Primitive::Triangle { instance, triangle }) => Some((instance, triangle)),
                    _ => None,
                })
                .collect(),
        }
    }

    /// What is to be known of a node; `None` where the tree has no such node.
    pub fn facts(&self, node: u32) -> Option<NodeFacts> {
        let here = self.tree.nodes.get(node as usize)?;
        let left = here.first_index;
        Some(NodeFacts {
            depth: self.depths()[node as usize],
            bounds: [here.min, here.max],
            children: (!here.is_leaf()).then_some([left, left + 1]),
            primitives: primitives_below(self.tree, node as usize).len() as u32,
            cost: node_cost(self.tree, node as usize),
            tree_cost: crate::bvh::sah_cost(self.tree),
        })
    }

    /// The planes that part the children of inner nodes, as their builder did it; for a builder that
    /// knows no planes, between boxes that do not overlap.
    pub(super) fn split_planes(&self) -> SplitPlanes<'_> {
        let by_centroids = matches!(
            self.world.aggregate.options().builder,
            Builder::Median | Builder::Sah
        );
        SplitPlanes {
            view: self,
            by_centroids,
        }
    }
}

/// Looks up split planes of one tree.
pub(super) struct SplitPlanes<'a> {
    view: &'a TreeView<'a>,
    pub by_centroids: bool,
}

impl SplitPlanes<'_> {
    pub fn of(&self, node: u32) -> Option<SplitPlane> {
        let TreeView { tree, world, .. } = *self.view;
        if !self.by_centroids {
            return gap_plane(tree, node as usize);
        }
        let box_at = |place: usize| match self.view.instance() {
            Some((_, instance)) => instance.mesh.box_at(place),
            None => world.aggregate.box_at(place).unwrap_or_default(),
        };
        split_plane(tree, node as usize, box_at)
    }
}
/// Where a triangle of an instance lies at time 0; `None` where there is none: rays may be older than the world, and what
/// they hit be gone.
pub fn triangle_in_world(world: &World, instance: u32, triangle: u32) -> Option<[Vec3; 3]> {
    let of = world.aggregate.instances().get(instance as usize)?;
    let triangles = of.mesh.triangles();
    let is_there = (triangle as usize) < triangles.len();
    let corners = is_there.then(|| triangles.corners(triangle))?;
    Some(corners.map(|corner| of.to_world_point(corner)))
}

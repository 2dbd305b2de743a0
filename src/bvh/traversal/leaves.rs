//! What the leaves of the trees hold, and how a ray meets it.

use super::tree_ray::{LoneRay, TreeRay, WorldRay};
use crate::bvh::geometry::aggregate::Aggregate;
use crate::bvh::geometry::mesh_tree::MeshTree;
use crate::bvh::kernel::goal::{Goal, Question, is_end};
use crate::bvh::kernel::object_ray::ObjectRay;
use crate::bvh::kernel::triangle::Shear;
use crate::bvh::kernel::visitor::{TreeRef, Visitor};
use crate::bvh::kernel::wide::{Eight, Leaves, Owner, Sheared, walk};

/// A mesh's leaf is blocks of triangles, and each a leaf of the wide tree.
pub(super) struct MeshLeaves<'a, R> {
    mesh: &'a MeshTree,
    instance: u32,
    /// In the mesh's space.
    ray: R,
}

impl<'a, R: TreeRay> MeshLeaves<'a, R> {
    #[inline(always)]
    pub(in crate::bvh) fn new(mesh: &'a MeshTree, instance: u32, ray: R) -> Self {
        Self {
            mesh,
            instance,
            ray,
        }
    }

    /// Walks the mesh's tree along its ray, from the first `t` of the span to the second, the limit; returns the new one.
    #[inline(always)]
    pub(in crate::bvh) fn walk<E: Eight, G: Goal, V: Visitor>(
        mut self,
        stack: &mut [u64],
        (start, limit): (f32, f32),
        question: &mut Question<G, V>,
    ) -> f32 {
        let tree = &self.mesh.wide;
        let ray = self.ray.wide::<E>(start);
        walk(tree, stack, &ray, limit, &mut self, question)
    }
}

impl<E: Eight, G: Goal, V: Visitor, R: TreeRay> Leaves<E, G, V> for MeshLeaves<'_, R> {
    #[inline(always)]
    fn tree(&self) -> TreeRef {
        TreeRef::Mesh(self.instance)
    }

    #[inline(always)]
    fn visit(
        &mut self,
        block: u32,
        limit: f32,
        _: &mut [u64],
        question: &mut Question<G, V>,
    ) -> f32 {
        let owner = Owner {
            instance: self.instance,
            reach: self.mesh.reach(),
        };
        let sight = self.ray.sight();
        self.mesh.blocks[block as usize].cross::<E, G, V>(&sight, owner, limit, question)
    }

    #[inline(always)]
    fn prefetch(&self, block: u32) {
        if let Some(block) = self.mesh.blocks.get(block as usize) {
            E::prefetch(block);
        }
    }

    #[inline(always)]
    fn rest(&self, block: u32) -> Option<u32> {
        let continues = self.mesh.blocks[block as usize].continues();
        continues.then_some(block + 1)
    }
}

/// Two levels: a leaf of the top tree is an instance, or several where they could not be told apart.
pub(super) struct InstanceLeaves<'a> {
    scene: &'a Aggregate,
    places: &'a [u32],
    world: ObjectRay,
    start: f32,
    time: f32,
}

impl<'a> InstanceLeaves<'a> {
    #[inline(always)]
    pub(in crate::bvh) fn new(
        scene: &'a Aggregate,
        places: &'a [u32],
        ray: &impl WorldRay,
    ) -> Self {
        Self {
            scene,
            places,
            world: ray.world(),
            start: ray.start(),
            time: ray.time(),
        }
    }
}

impl<E: Eight, G: Goal, V: Visitor> Leaves<E, G, V> for InstanceLeaves<'_> {
    #[inline(always)]
    fn tree(&self) -> TreeRef {
        TreeRef::Top
    }

    #[inline(always)]
    fn prefetch(&self, leaf: u32) {
        let places = self.scene.wide_leaves.get(leaf as usize);
        let place = places.and_then(|places| self.places.get(places.start));
        if let Some(&number) = place
            && let Some(instance) = self.scene.instances().get(number as usize)
        {
            instance.prefetch::<E>();
        }
    }

    #[inline(always)]
    fn visit(
        &mut self,
        leaf: u32,
        mut limit: f32,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    ) -> f32 {
        for &number in &self.places[self.scene.wide_leaves[leaf as usize].clone()] {
            let instance = &self.scene.instances()[number as usize];
            let Some(object) = instance.to_object_ray(&self.world, self.time) else {
                continue;
            };
            let leaves = MeshLeaves::new(&instance.mesh, number, LoneRay::new(&object));
            limit = leaves.walk::<E, G, V>(stack, (self.start, limit), question);
            if is_end::<G>(limit) {
                break;
            }
        }
        limit
    }
}

/// One level: a leaf of the tree is blocks of triangles, each of one instance.
pub(super) struct FlatLeaves<'a> {
    scene: &'a Aggregate,
    world: ObjectRay,
    time: f32,
    /// The instance met last, with the ray in its space and its frame there; `None` where it cannot be met.
    last: Option<(u32, Option<(ObjectRay, Shear)>)>,
}

impl<'a> FlatLeaves<'a> {
    #[inline(always)]
    pub(in crate::bvh) fn new(scene: &'a Aggregate, ray: &impl WorldRay) -> Self {
        Self {
            scene,
            world: ray.world(),
            time: ray.time(),
            last: None,
        }
    }

    /// The ray in an instance's space and its frame there, made anew when the instance is not the last one; `None`
    /// where the instance cannot be met.
    #[inline(always)]
    fn object_ray(&mut self, number: u32) -> Option<&(ObjectRay, Shear)> {
        if self.last.as_ref().is_none_or(|(of, _)| *of != number) {
            let instance = &self.scene.instances()[number as usize];
            let object = instance.to_object_ray(&self.world, self.time);
            let with_frame = |object: ObjectRay| {
                let shear = Shear::new(object.origin, object.direction);
                (object, shear)
            };
            self.last = Some((number, object.map(with_frame)));
        }
        self.last.as_ref().and_then(|(_, object)| object.as_ref())
    }
}

impl<E: Eight, G: Goal, V: Visitor> Leaves<E, G, V> for FlatLeaves<'_> {
    #[inline(always)]
    fn tree(&self) -> TreeRef {
        TreeRef::Top
    }

    #[inline(always)]
    fn visit(
        &mut self,
        leaf: u32,
        mut limit: f32,
        _: &mut [u64],
        question: &mut Question<G, V>,
    ) -> f32 {
        let scene = self.scene;
        for block in scene.wide_leaves[leaf as usize].clone() {
            let number = scene.block_instances[block];
            let Some((ray, shear)) = self.object_ray(number) else {
                continue;
            };
            let sight = Sheared { ray, shear };
            let owner = Owner {
                instance: number,
                reach: scene.instances()[number as usize].mesh.reach(),
            };
            limit = scene.blocks[block].cross::<E, G, V>(&sight, owner, limit, question);
            if is_end::<G>(limit) {
                break;
            }
        }
        limit
    }
}

//! What the leaves of the trees hold, and how a ray meets it.

use super::{
    aggregate::Aggregate,
    goal::{Goal, Question, STOP},
    mesh_tree::{MeshTree, ObjectRay},
    safe_ray::SafeRay,
    slab::SlabRay,
    triangle::Shear,
    visitor::{TreeRef, Visitor},
    wide::{Eight, Leaves, Sight, WideRay, walk},
};

impl Aggregate {
    /// The ray as the boxes of the top tree need it.
    #[inline(always)]
    pub(crate) fn top_slab(&self, world: &ObjectRay) -> SlabRay {
        let pad = world.origin.abs().max_element() * self.ray_pad;
        world.slab.with_pad(world.origin, pad)
    }
}

/// A mesh's leaf is blocks of triangles, and each a leaf of the wide tree.
pub(super) struct MeshLeaves<'a> {
    pub(super) mesh: &'a MeshTree,
    pub(super) instance: u32,
    /// In the mesh's space.
    pub(super) ray: &'a ObjectRay,
    /// Made at the first leaf: many rays meet none.
    shear: Option<Shear>,
}

impl<'a> MeshLeaves<'a> {
    #[inline(always)]
    pub(super) fn new(mesh: &'a MeshTree, instance: u32, ray: &'a ObjectRay) -> Self {
        Self {
            mesh,
            instance,
            ray,
            shear: None,
        }
    }

    /// Walks the mesh's tree along its ray, from the first `t` of the span to the second, the limit; returns the new one.
    #[inline(always)]
    pub(super) fn walk<E: Eight, G: Goal, V: Visitor>(
        mut self,
        stack: &mut [u64],
        (start, limit): (f32, f32),
        question: &mut Question<G, V>,
    ) -> f32 {
        let tree = &self.mesh.wide;
        let ray = WideRay::<E>::new(&self.ray.slab, start);
        walk(tree, stack, &ray, limit, &mut self, question)
    }
}

impl<E: Eight, G: Goal, V: Visitor> Leaves<E, G, V> for MeshLeaves<'_> {
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
        let ray = self.ray;
        let shear = match &mut self.shear {
            Some(shear) => shear,
            none => none.insert(Shear::new(ray.origin, ray.direction)),
        };
        let sight = Sight {
            instance: self.instance,
            shear,
            slab: &ray.slab,
            reach: self.mesh.reach(),
        };
        self.mesh.blocks[block as usize].cross::<E, G, V>(&sight, limit, question)
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
    pub(super) scene: &'a Aggregate,
    pub(super) places: &'a [u32],
    pub(super) ray: &'a SafeRay,
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
        let ray = self.ray;
        for &number in &self.places[self.scene.wide_leaves[leaf as usize].clone()] {
            let instance = &self.scene.instances()[number as usize];
            let Some(object) = instance.to_object_ray(&ray.world, ray.time) else {
                continue;
            };
            let leaves = MeshLeaves::new(&instance.mesh, number, &object);
            limit = leaves.walk::<E, G, V>(stack, (ray.start, limit), question);
            if limit == STOP {
                break;
            }
        }
        limit
    }
}

/// One level: a leaf of the tree is blocks of triangles, each of one instance.
pub(super) struct FlatLeaves<'a> {
    pub(super) scene: &'a Aggregate,
    pub(super) ray: &'a SafeRay,
    /// The instance met last, with the ray in its space and its frame there; `None` where it cannot be met.
    pub(super) last: Option<(u32, Option<(ObjectRay, Shear)>)>,
}

impl FlatLeaves<'_> {
    /// The ray in an instance's space and its frame there, made anew when the instance is not the last one; `None`
    /// where the instance cannot be met.
    #[inline(always)]
    fn object_ray(&mut self, number: u32) -> Option<&(ObjectRay, Shear)> {
        if self.last.as_ref().is_none_or(|(of, _)| *of != number) {
            let instance = &self.scene.instances()[number as usize];
            let object = instance.to_object_ray(&self.ray.world, self.ray.time);
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
            let Some((object, shear)) = self.object_ray(number) else {
                continue;
            };
            let sight = Sight {
                instance: number,
                shear,
                slab: &object.slab,
                reach: scene.instances()[number as usize].mesh.reach(),
            };
            limit = scene.blocks[block].cross::<E, G, V>(&sight, limit, question);
            if limit == STOP {
                break;
            }
        }
        limit
    }
}

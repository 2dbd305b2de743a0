//! What a leaf of an aggregate's tree holds, and how a ray crosses it.

use std::marker::PhantomData;

use super::{
    aggregate::Aggregate,
    goal::Goal,
    mesh_tree::ObjectRay,
    ray::Hit,
    safe_ray::SafeRay,
    slab::SlabRay,
    traverse::STOP,
    triangle::{Crossing, Shear},
    wide::{Eight, Leaves},
};

/// Calls `at(hit, limit)` if the crossing lies on the ray, not beyond the limit.
#[inline(always)]
pub(super) fn offer(
    ray: &SafeRay,
    (instance, triangle): (u32, u32),
    Crossing { t, u, v }: Crossing,
    limit: f32,
    at: &mut impl FnMut(Hit, f32) -> f32,
) -> f32 {
    if t <= limit && ray.reaches(t) {
        let hit = Hit {
            t,
            instance,
            triangle,
            u,
            v,
        };
        at(hit, limit)
    } else {
        limit
    }
}

impl Aggregate {
    /// The ray as the boxes of the top tree need it.
    #[inline(always)]
    pub(crate) fn top_slab(&self, world: &ObjectRay) -> SlabRay {
        let pad = world.origin.abs().max_element() * self.ray_pad;
        world.slab.with_pad(world.origin, pad)
    }

    /// The ray in an instance's space and its frame there, made anew when the instance is not the last one; `None`
    /// where the instance cannot be met.
    #[inline(always)]
    pub(crate) fn object_ray<'a>(
        &self,
        ray: &SafeRay,
        number: u32,
        last: &'a mut Option<(u32, Option<(ObjectRay, Shear)>)>,
    ) -> Option<&'a (ObjectRay, Shear)> {
        if last.as_ref().is_none_or(|(of, _)| *of != number) {
            let instance = &self.instances()[number as usize];
            let object = instance.to_object_ray(&ray.world, ray.time);
            let with_frame = |object: ObjectRay| {
                let shear = Shear::new(object.origin, object.direction);
                (object, shear)
            };
            *last = Some((number, object.map(with_frame)));
        }
        last.as_ref().and_then(|(_, object)| object.as_ref())
    }
}

/// Two levels: a leaf of the top tree is an instance, or several where they could not be told apart.
pub(super) struct InstanceLeaves<'a, At, G> {
    pub(super) goal: PhantomData<G>,
    pub(super) scene: &'a Aggregate,
    pub(super) places: &'a [u32],
    pub(super) ray: &'a SafeRay,
    pub(super) at: At,
}

impl<E: Eight, At: FnMut(Hit, f32) -> f32, G: Goal> Leaves<E> for InstanceLeaves<'_, At, G> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, mut limit: f32, stack: &mut [u64]) -> f32 {
        let ray = self.ray;
        for &number in &self.places[self.scene.wide_leaves[leaf as usize].clone()] {
            let instance = &self.scene.instances()[number as usize];
            let Some(object) = instance.to_object_ray(&ray.world, ray.time) else {
                continue;
            };
            let at = |triangle, crossing, limit| {
                offer(ray, (number, triangle), crossing, limit, &mut self.at)
            };
            let mesh = &instance.mesh;
            let span = (ray.start, limit);
            limit = mesh.walk_wide::<E, G>(&object, stack, span, at);
            if limit == STOP {
                break;
            }
        }
        limit
    }
}

/// One level: a leaf of the tree is blocks of triangles, each of one instance.
pub(super) struct FlatLeaves<'a, At, G> {
    pub(super) goal: PhantomData<G>,
    pub(super) scene: &'a Aggregate,
    pub(super) ray: &'a SafeRay,
    pub(super) last: Option<(u32, Option<(ObjectRay, Shear)>)>,
    pub(super) at: At,
}

impl<E: Eight, At: FnMut(Hit, f32) -> f32, G: Goal> Leaves<E> for FlatLeaves<'_, At, G> {
    #[inline(always)]
    fn visit(&mut self, leaf: u32, mut limit: f32, _: &mut [u64]) -> f32 {
        let (scene, ray) = (self.scene, self.ray);
        for block in scene.wide_leaves[leaf as usize].clone() {
            let number = scene.block_instances[block];
            let Some((object, shear)) = scene.object_ray(ray, number, &mut self.last) else {
                continue;
            };
            let reach = scene.instances()[number as usize].mesh.reach();
            let mut at = |triangle, crossing, limit| {
                offer(ray, (number, triangle), crossing, limit, &mut self.at)
            };
            limit = scene.blocks[block].cross::<E, G>(shear, &object.slab, reach, limit, &mut at);
            if limit == STOP {
                break;
            }
        }
        limit
    }
}

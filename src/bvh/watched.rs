//! The nearest hit, the next one behind a hit, and occlusion from the binary trees, with a [`Visitor`] who sees every node and triangle. They find
//! what [`super::queries`] find, bit for bit.

use super::{
    aggregate::{Aggregate, Places},
    queries::Best,
    ray::{Hit, Ray},
    safe_ray::SafeRay,
    traverse::{EMPTY, STOP, walk},
    triangle::Crossing,
    visitor::{TreeRef, Visitor},
};

impl Aggregate {
    /// The nearest hit, watched.
    pub fn closest_hit_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> Option<Hit> {
        let ray = SafeRay::new(ray)?;
        let mut best = Best::NONE;
        self.watch(&ray, visitor, |hit, limit| {
            let new = best.offer(hit, limit);
            (best.is(&hit), new)
        });
        best.found(&ray)
    }

    /// The next hit behind `after`, watched.
    pub fn closest_hit_after_with<V: Visitor>(
        &self,
        ray: &Ray,
        after: &Hit,
        visitor: &mut V,
    ) -> Option<Hit> {
        let (ray, after) = SafeRay::from_hit(ray, after)?;
        let mut best = Best::NONE;
        self.watch(&ray, visitor, |hit, limit| {
            if !after.beats(&hit) {
                return (false, limit);
            }
            let new = best.offer(hit, limit);
            (best.is(&hit), new)
        });
        best.found(&ray)
    }

    /// Whether anything is hit, watched.
    pub fn occluded_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> bool {
        let Some(ray) = SafeRay::new(ray) else {
            return false;
        };
        let mut occluded = false;
        self.watch(&ray, visitor, |_, _| {
            occluded = true;
            (true, STOP)
        });
        occluded
    }

    /// Hands the hits on the ray whose `t` is not beyond the limit to `at(hit, limit)`, in no particular order. It
    /// returns whether it wants the hit, and the new limit (or [`STOP`]). `t` is the [`SafeRay`]'s.
    fn watch<V: Visitor>(
        &self,
        ray: &SafeRay,
        visitor: &mut V,
        mut at: impl FnMut(Hit, f32) -> (bool, f32),
    ) {
        let mut at = |instance, triangle, crossing, limit, visitor: &mut V| {
            let (mut wanted, mut new_limit) = (false, limit);
            if let Some(Crossing { t, u, v }) = crossing
                && t <= limit
                && ray.reaches(t)
            {
                let hit = Hit {
                    t,
                    instance,
                    triangle,
                    u,
                    v,
                };
                (wanted, new_limit) = at(hit, limit);
            }
            visitor.triangle(instance, triangle, wanted);
            new_limit
        };
        let (mut stack, mut mesh_stack) = (EMPTY, EMPTY);
        let mut last = None;
        let leaf = |first: u32, count: u32, mut limit: f32, visitor: &mut V| {
            for place in first as usize..(first + count) as usize {
                limit = match &self.places {
                    Places::Instances(places) => {
                        let number = places[place];
                        let instance = &self.instances()[number as usize];
                        let Some(object) = instance.to_object_ray(&ray.world, ray.time) else {
                            continue;
                        };
                        let at = |triangle, crossing, limit, visitor: &mut V| {
                            at(number, triangle, crossing, limit, visitor)
                        };
                        let stack = &mut mesh_stack;
                        let span = (ray.start, limit);
                        (instance.mesh).walk(&object, stack, span, number, visitor, at)
                    }
                    Places::Triangles(places) => {
                        let (number, place) = places[place];
                        let Some((object, shear)) = self.object_ray(ray, number, &mut last) else {
                            continue;
                        };
                        let mesh = &self.instances()[number as usize].mesh;
                        let (triangle, crossing) = mesh.cross_at(shear, object, place, limit);
                        at(number, triangle, crossing, limit, visitor)
                    }
                };
                if limit == STOP {
                    break;
                }
            }
            limit
        };
        let slab = self.top_slab(&ray.world);
        let nodes = &self.tree.nodes;
        walk(
            nodes,
            &mut stack,
            &slab,
            (ray.start, ray.end),
            TreeRef::Top,
            visitor,
            leaf,
        );
    }
}

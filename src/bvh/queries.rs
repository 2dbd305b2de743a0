//! What a tracer asks: the nearest hit, any hit, the next hit, all hits.

use super::{
    aggregate::{Aggregate, Places},
    mesh_tree::ObjectRay,
    ray::{Hit, Ray},
    safe_ray::SafeRay,
    slab::SlabRay,
    traverse::{EMPTY, STOP, Stack, walk},
    triangle::{Crossing, Shear},
    visitor::{TreeRef, Visitor},
};

/// What a traversal puts off, on either level.
struct Stacks {
    top: Stack,
    mesh: Stack,
}

impl Stacks {
    #[inline(always)]
    fn new() -> Self {
        Self {
            top: EMPTY,
            mesh: EMPTY,
        }
    }
}

impl Aggregate {
    /// The nearest hit; equal `t` by the smaller (instance, triangle).
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit_with(ray, &mut ())
    }

    /// The nearest hit, watched.
    pub fn closest_hit_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> Option<Hit> {
        self.find_closest(ray, &mut Stacks::new(), visitor)
    }

    /// The nearest hit of every ray, in their order. `hits` is cleared first. Faster than one call a ray.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        let mut stacks = Stacks::new();
        hits.clear();
        hits.extend((rays.iter()).map(|ray| self.find_closest(ray, &mut stacks, &mut ())));
    }

    /// Whether anything is hit in `0 < t < t_max`.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_with(ray, &mut ())
    }

    /// Whether anything is hit, watched.
    pub fn occluded_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> bool {
        self.find_any(ray, &mut Stacks::new(), visitor)
    }

    /// Whether each ray is occluded, in their order. `occluded` is cleared first. Faster than one call a ray.
    pub fn occlusions(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        let mut stacks = Stacks::new();
        occluded.clear();
        occluded.extend((rays.iter()).map(|ray| self.find_any(ray, &mut stacks, &mut ())));
    }

    /// The next hit behind `after`, a hit of the same ray: the ray goes straight on through what it met, and meets every
    /// crossing exactly once, however close they lie.
    pub fn closest_hit_after(&self, ray: &Ray, after: &Hit) -> Option<Hit> {
        let ray = SafeRay::new(ray)?;
        let after = ray.unscaled(*after);
        let mut best: Option<Hit> = None;
        self.each_hit(&ray, &mut Stacks::new(), &mut (), |hit, limit| {
            if after.beats(&hit) && best.is_none_or(|best| hit.beats(&best)) {
                best = Some(hit);
                (true, hit.t)
            } else {
                (false, limit)
            }
        });
        best.map(|hit| ray.scaled(hit))
    }

    /// Every hit with `0 < t < t_max`, nearest first, equal `t` by (instance, triangle). `hits` is cleared first; it
    /// is the only memory used.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let Some(ray) = SafeRay::new(ray) else {
            return;
        };
        self.each_hit(&ray, &mut Stacks::new(), &mut (), |hit, limit| {
            hits.push(ray.scaled(hit));
            (true, limit)
        });
        hits.sort_unstable_by(|a, b| {
            (a.t.total_cmp(&b.t)).then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
        });
    }

    #[inline(always)]
    fn find_closest<V: Visitor>(
        &self,
        ray: &Ray,
        stacks: &mut Stacks,
        visitor: &mut V,
    ) -> Option<Hit> {
        let ray = SafeRay::new(ray)?;
        let mut best = Hit {
            t: f32::INFINITY,
            instance: u32::MAX,
            triangle: u32::MAX,
            u: 0.0,
            v: 0.0,
        };
        self.each_hit(&ray, stacks, visitor, |hit, limit| {
            if hit.beats(&best) {
                best = hit;
                (true, hit.t)
            } else {
                (false, limit)
            }
        });
        (best.instance != u32::MAX).then(|| ray.scaled(best))
    }

    #[inline(always)]
    fn find_any<V: Visitor>(&self, ray: &Ray, stacks: &mut Stacks, visitor: &mut V) -> bool {
        let Some(ray) = SafeRay::new(ray) else {
            return false;
        };
        let mut occluded = false;
        self.each_hit(&ray, stacks, visitor, |_, _| {
            occluded = true;
            (true, STOP)
        });
        occluded
    }

    /// Hands the hits on the ray whose `t` is not beyond the limit to `at(hit, limit)`, in no particular order. It
    /// returns whether it wants the hit, and the new limit (or [`STOP`]). `t` is the [`SafeRay`]'s.
    #[inline(always)]
    fn each_hit<V: Visitor>(
        &self,
        ray: &SafeRay,
        stacks: &mut Stacks,
        visitor: &mut V,
        mut at: impl FnMut(Hit, f32) -> (bool, f32),
    ) {
        let world = &ray.world;
        let pad = world.origin.abs().max_element() * self.ray_pad;
        let slab = SlabRay::new(world.origin, world.direction, pad);
        let mut at_triangle = |instance, triangle, crossing, limit, visitor: &mut V| {
            let mut wanted = false;
            let mut new_limit = limit;
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
        match &self.places {
            Places::Instances(places) => {
                walk(
                    &self.tree.nodes,
                    &mut stacks.top,
                    &slab,
                    ray.end,
                    TreeRef::Top,
                    visitor,
                    |first, count, mut limit, visitor| {
                        for &number in &places[first as usize..(first + count) as usize] {
                            let instance = &self.instances()[number as usize];
                            if let Some(object) = instance.to_object_ray(world, ray.time) {
                                limit = instance.mesh.walk(
                                    &object,
                                    &mut stacks.mesh,
                                    limit,
                                    number,
                                    visitor,
                                    |triangle, crossing, limit, visitor| {
                                        at_triangle(number, triangle, crossing, limit, visitor)
                                    },
                                );
                                if limit == STOP {
                                    break;
                                }
                            }
                        }
                        limit
                    },
                );
            }
            Places::Triangles(places) => {
                let mut last: Option<(u32, ObjectRay, Shear)> = None;
                walk(
                    &self.tree.nodes,
                    &mut stacks.top,
                    &slab,
                    ray.end,
                    TreeRef::Top,
                    visitor,
                    |first, count, mut limit, visitor| {
                        for &(number, place) in &places[first as usize..(first + count) as usize] {
                            let instance = &self.instances()[number as usize];
                            if last.is_none_or(|(of, ..)| of != number) {
                                let Some(object) = instance.to_object_ray(world, ray.time) else {
                                    continue;
                                };
                                last = Some((
                                    number,
                                    object,
                                    Shear::new(object.origin, object.direction),
                                ));
                            }
                            if let Some((_, object, shear)) = &last {
                                let (triangle, crossing) =
                                    instance.mesh.cross_at(shear, object, place, limit);
                                limit = at_triangle(number, triangle, crossing, limit, visitor);
                                if limit == STOP {
                                    break;
                                }
                            }
                        }
                        limit
                    },
                );
            }
        }
    }
}

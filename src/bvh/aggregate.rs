//! All instances of a scene, and the queries that a tracer asks.

use std::time::{Duration, Instant};

use obvhs::{aabb::Aabb, bvh2::Bvh2};

use super::{
    build_tree,
    instance::Instance,
    mesh_tree::ObjectRay,
    options::{BuildOptions, Levels},
    ray::{Hit, Ray},
    slab::{SMALLEST_DIRECTION, SlabRay},
    stats::TreeStats,
    traverse::{STOP, walk},
    triangle::{Crossing, Shear},
    triangles::REACH,
    visitor::{TreeRef, Visitor},
};

/// The instances, and a tree over them or over all their triangles. The default is empty: every ray misses.
#[derive(Clone, Default)]
pub struct Aggregate {
    instances: Vec<Instance>,
    options: BuildOptions,
    tree: Bvh2,
    /// What a leaf of `tree` holds, in leaf order.
    places: Places,
    /// The factor of |o|∞ that pads the origin of a world ray.
    ray_pad: f32,
    build_time: Duration,
}

#[derive(Clone)]
enum Places {
    /// Two levels: instances.
    Instances(Vec<u32>),
    /// One level: (instance, place in the leaf order of its mesh).
    Triangles(Vec<(u32, u32)>),
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
                let mut numbers = Vec::new();
                for (number, instance) in instances.iter().enumerate() {
                    if let Some(bounds) = instance.world_bounds() {
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
        let ray_pad = instances.iter().map(Instance::ray_pad).fold(0.0, f32::max);
        Self {
            instances,
            options: *options,
            tree,
            places,
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
    }

    /// The nearest hit; equal `t` by the smaller (instance, triangle).
    pub fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit_with(ray, &mut ())
    }

    /// The nearest hit, watched.
    pub fn closest_hit_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> Option<Hit> {
        let mut best = Hit {
            t: ray.t_max,
            instance: u32::MAX,
            triangle: u32::MAX,
            u: 0.0,
            v: 0.0,
        };
        self.each_hit(ray, visitor, |hit, _| {
            let better = hit.t < ray.t_max && hit.beats(&best);
            if better {
                best = hit;
            }
            (better, best.t)
        });
        (best.instance != u32::MAX).then_some(best)
    }

    /// The next hit behind `after`, a hit of the same ray: the ray goes straight on through what it met, and meets every
    /// crossing exactly once, however close they lie.
    pub fn closest_hit_after(&self, ray: &Ray, after: &Hit) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.each_hit(ray, &mut (), |hit, limit| {
            let wanted = after.beats(&hit) && best.is_none_or(|best| hit.beats(&best));
            if wanted {
                best = Some(hit);
                (true, hit.t)
            } else {
                (false, limit)
            }
        });
        best
    }

    /// Whether anything is hit in `0 < t < t_max`.
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_with(ray, &mut ())
    }

    /// Whether anything is hit, watched.
    pub fn occluded_with<V: Visitor>(&self, ray: &Ray, visitor: &mut V) -> bool {
        let mut occluded = false;
        self.each_hit(ray, visitor, |_, _| {
            occluded = true;
            (true, STOP)
        });
        occluded
    }

    /// The nearest hit of every ray, in their order. `hits` is cleared first.
    pub fn closest_hits(&self, rays: &[Ray], hits: &mut Vec<Option<Hit>>) {
        hits.clear();
        hits.extend(rays.iter().map(|ray| self.closest_hit(ray)));
    }

    /// Whether each ray is occluded, in their order. `occluded` is cleared first.
    pub fn occlusions(&self, rays: &[Ray], occluded: &mut Vec<bool>) {
        occluded.clear();
        occluded.extend(rays.iter().map(|ray| self.occluded(ray)));
    }

    /// Every hit with `0 < t < t_max`, nearest first, equal `t` by (instance, triangle). `hits` is cleared first; it
    /// is the only memory used.
    pub fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        self.each_hit(ray, &mut (), |hit, limit| {
            hits.push(hit);
            (true, limit)
        });
        hits.sort_unstable_by(|a, b| {
            (a.t.total_cmp(&b.t)).then((a.instance, a.triangle).cmp(&(b.instance, b.triangle)))
        });
    }

    /// Hands hits with `0 < t < t_max` and `t <=` the limit to `at(hit, limit)`, in no particular order. It returns
    /// whether it wants the hit, and the new limit (or [`STOP`]).
    #[inline(always)]
    fn each_hit<V: Visitor>(
        &self,
        ray: &Ray,
        visitor: &mut V,
        mut at: impl FnMut(Hit, f32) -> (bool, f32),
    ) {
        let Some((world, scale)) = prepare(ray) else {
            return;
        };
        let t_max = ray.t_max / scale;
        let slab = SlabRay::new(
            world.origin,
            world.direction,
            world.origin.abs().max_element() * self.ray_pad,
        );
        let mut at_triangle = |instance: u32,
                               triangle: u32,
                               crossing: Option<Crossing>,
                               limit: f32,
                               visitor: &mut V| {
            let mut wanted = false;
            let mut new_limit = limit;
            if let Some(Crossing { t, u, v }) = crossing
                && t > 0.0
                && t < t_max
                && t <= limit
            {
                let hit = Hit {
                    t: t * scale,
                    instance,
                    triangle,
                    u,
                    v,
                };
                (wanted, new_limit) = at(hit, limit * scale);
                new_limit /= scale;
            }
            visitor.triangle(instance, triangle, wanted);
            new_limit
        };
        match &self.places {
            Places::Instances(places) => {
                walk(
                    &self.tree.nodes,
                    &slab,
                    t_max,
                    TreeRef::Top,
                    visitor,
                    |first, count, mut limit, visitor| {
                        for &number in &places[first as usize..(first + count) as usize] {
                            let instance = &self.instances[number as usize];
                            if let Some(object) = instance.to_object_ray(&world) {
                                limit = instance.mesh.walk(
                                    &object,
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
                    &slab,
                    t_max,
                    TreeRef::Top,
                    visitor,
                    |first, count, mut limit, visitor| {
                        for &(number, place) in &places[first as usize..(first + count) as usize] {
                            let instance = &self.instances[number as usize];
                            if last.is_none_or(|(of, ..)| of != number) {
                                let Some(object) = instance.to_object_ray(&world) else {
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
                                    instance.mesh.cross_at(shear, object, place);
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

/// A world ray that is safe to trace, and the power of two its direction was multiplied by; `None` is a miss.
#[inline(always)]
fn prepare(ray: &Ray) -> Option<(ObjectRay, f32)> {
    // -0.0 becomes +0.0, so that both mean the same.
    let mut direction = ray.direction + 0.0;
    let size = direction.abs().max_element();
    let mut scale = 1.0;
    if !(ORDINARY..=1.0 / ORDINARY).contains(&size) {
        (direction, scale) = rescale(direction)?;
    }
    let sane = ray.origin.is_finite()
        && direction.is_finite()
        && ray.origin.abs().max_element() <= REACH
        && ray.t_max > 0.0;
    sane.then(|| (ObjectRay::new(ray.origin + 0.0, direction), scale))
}

/// Directions this long, or as much longer than 1, stay in range through every instance's transform.
const ORDINARY: f32 = SMALLEST_DIRECTION * (1u64 << 30) as f32;

/// A very short or long direction, times a power of two.
#[cold]
fn rescale(direction: glam::Vec3) -> Option<(glam::Vec3, f32)> {
    if !direction.is_finite() || direction == glam::Vec3::ZERO {
        return None;
    }
    let scale = if direction.abs().max_element() < 1.0 {
        (1u128 << 100) as f32
    } else {
        1.0 / (1u128 << 100) as f32
    };
    Some((direction * scale, scale))
}

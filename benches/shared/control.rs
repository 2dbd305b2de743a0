//! A control: the nearest hit from the binary trees as it would be written if nobody ever watched a
//! traversal. It is `bvh::watched` and `bvh::traverse` without their visitor, and nothing else.

use crate::bvh::aggregate::{Aggregate, Places};
use crate::bvh::mesh_tree::{MeshTree, ObjectRay};
use crate::bvh::safe_ray::SafeRay;
use crate::bvh::slab::SlabRay;
use crate::bvh::triangle::{Crossing, Shear, cross};
use crate::bvh::{Hit, MAX_DEPTH, Ray};
use obvhs::bvh2::node::Bvh2Node;

/// What a query answers that wants nothing more. This one always wants the nearest, and asks all the same: it is
/// the visitor alone that it does without.
const STOP: f32 = f32::NEG_INFINITY;

type Stack = [(f32, u32); MAX_DEPTH];
const EMPTY: Stack = [(0.0, 0); MAX_DEPTH];

/// The nearest hit so far.
struct Best(Hit);

impl Best {
    const NONE: Self = Self(Hit {
        t: f32::INFINITY,
        instance: u32::MAX,
        triangle: u32::MAX,
        u: 0.0,
        v: 0.0,
    });

    #[inline(always)]
    fn offer(&mut self, hit: Hit, limit: f32) -> f32 {
        if hit.beats(&self.0) {
            self.0 = hit;
            hit.t
        } else {
            limit
        }
    }
}

/// The nearest hit.
pub fn closest_hit(aggregate: &Aggregate, ray: &Ray) -> Option<Hit> {
    let ray = SafeRay::new(ray)?;
    let mut best = Best::NONE;
    each_hit(aggregate, &ray, |hit, limit| best.offer(hit, limit));
    (best.0.instance != u32::MAX).then(|| ray.scaled(best.0))
}

/// Hands the hits on the ray whose `t` is not beyond the limit to `at(hit, limit)`, which returns the
/// new limit.
fn each_hit(aggregate: &Aggregate, ray: &SafeRay, mut at: impl FnMut(Hit, f32) -> f32) {
    let mut at = |instance, triangle, crossing, limit| {
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
            new_limit = at(hit, limit);
        }
        new_limit
    };
    let (mut stack, mut mesh_stack) = (EMPTY, EMPTY);
    let mut last = None;
    let leaf = |first: u32, count: u32, mut limit: f32| {
        for place in first as usize..(first + count) as usize {
            limit = match &aggregate.places {
                Places::Instances(places) => {
                    let number = places[place];
                    let instance = &aggregate.instances()[number as usize];
                    let Some(object) = instance.to_object_ray(&ray.world, ray.time) else {
                        continue;
                    };
                    let at = |triangle, crossing, limit| at(number, triangle, crossing, limit);
                    let stack = &mut mesh_stack;
                    walk_mesh(&instance.mesh, &object, stack, limit, at)
                }
                Places::Triangles(places) => {
                    let (number, place) = places[place];
                    let Some((object, shear)) = aggregate.object_ray(ray, number, &mut last) else {
                        continue;
                    };
                    let mesh = &aggregate.instances()[number as usize].mesh;
                    let (triangle, crossing) = mesh.cross_at(shear, object, place, limit);
                    at(number, triangle, crossing, limit)
                }
            };
            if limit == STOP {
                break;
            }
        }
        limit
    };
    let slab = aggregate.top_slab(&ray.world);
    walk(&aggregate.tree().nodes, &mut stack, &slab, ray.end, leaf);
}

/// Walks a mesh's tree along a ray in object space.
#[inline(always)]
fn walk_mesh(
    mesh: &MeshTree,
    ray: &ObjectRay,
    stack: &mut Stack,
    limit: f32,
    mut at: impl FnMut(u32, Option<Crossing>, f32) -> f32,
) -> f32 {
    let mut shear = None;
    walk(
        &mesh.tree().nodes,
        stack,
        &ray.slab,
        limit,
        |first, count, mut limit| {
            let shear = shear.get_or_insert_with(|| Shear::new(ray.origin, ray.direction));
            let first = first as usize;
            for triangle in &mesh.leaves[first..first + count as usize] {
                let crossing = cross(shear, &ray.slab, triangle, limit);
                limit = at(triangle.number, crossing, limit);
                if limit == STOP {
                    break;
                }
            }
            limit
        },
    )
}

/// Walks `nodes` along the ray, nearest child first.
#[inline(always)]
fn walk(
    nodes: &[Bvh2Node],
    stack: &mut Stack,
    slab: &SlabRay,
    mut limit: f32,
    mut leaf: impl FnMut(u32, u32, f32) -> f32,
) -> f32 {
    let Some(root) = nodes.first() else {
        return limit;
    };
    let (entry, exit) = slab.span_from(0.0, root.aabb());
    if entry > exit || entry > limit {
        return limit;
    }
    let mut pending = 0;
    let mut node = root;
    loop {
        let next = if node.prim_count != 0 {
            limit = leaf(node.first_index, node.prim_count, limit);
            if limit == STOP {
                return STOP;
            }
            None
        } else {
            let (left, right) = (node.first_index, node.first_index + 1);
            let children = &nodes[left as usize..][..2];
            let (left_entry, left_exit) = slab.span_from(0.0, children[0].aabb());
            let (right_entry, right_exit) = slab.span_from(0.0, children[1].aabb());
            let left_hit = (left_entry <= left_exit) & (left_entry <= limit);
            let right_hit = (right_entry <= right_exit) & (right_entry <= limit);
            match (left_hit, right_hit) {
                (true, true) => {
                    let (near, far) = if right_entry < left_entry {
                        ((right_entry, right), (left_entry, left))
                    } else {
                        ((left_entry, left), (right_entry, right))
                    };
                    stack[pending] = far;
                    pending += 1;
                    Some(near)
                }
                (true, false) => Some((left_entry, left)),
                (false, true) => Some((right_entry, right)),
                (false, false) => None,
            }
        };
        let (_, index) = match next {
            Some(next) => next,
            None => loop {
                if pending == 0 {
                    return limit;
                }
                pending -= 1;
                let (entry, index) = stack[pending];
                if entry <= limit {
                    break (entry, index);
                }
            },
        };
        node = &nodes[index as usize];
    }
}

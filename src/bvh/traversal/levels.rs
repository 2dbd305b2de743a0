//! The ways in which an aggregate is arranged (one mesh, a tree over meshes' trees, one tree over all triangles), and the
//! questions that rays ask. Each is compiled for each arrangement apart, so that a scene pays for its own alone.

use std::marker::PhantomData;

use glam::Vec3;

use super::batch::Batch;
use super::leaves::{FlatLeaves, InstanceLeaves, MeshLeaves};
use super::packets::{Packet, PacketOfInstances, PacketOfMesh, trace_packet};
use super::transmit::{Transmit, Transmittances};
use super::tree_ray::WorldRay;
use crate::bvh::geometry::aggregate::{Aggregate, Places};
use crate::bvh::geometry::mesh_tree::MeshTree;
use crate::bvh::kernel::goal::{Any, Goal, Nearest, Question};
use crate::bvh::kernel::order::Order;
use crate::bvh::kernel::ray::{Hit, Ray};
use crate::bvh::kernel::safe_ray::SafeRay;
use crate::bvh::kernel::slab::PAD;
use crate::bvh::kernel::visitor::Visitor;
use crate::bvh::kernel::wide::{
    Answers, Eight, FEW, Found, Group, InstructionSet, Lanes, MANY, Query, View, answer, few_hold,
    walk, walk_packet,
};

/// What rays walk: one of the ways in which an aggregate is arranged.
pub(super) trait Arrangement: Copy {
    /// Whether packets walk it.
    const HAS_PACKETS: bool;

    /// Entries of a stack that a walk needs.
    fn most_pending(self) -> usize;

    /// The slack around their origins, relative to their size, with which rays of the world meet its boxes.
    fn pad(self) -> f32;

    /// Walks along the ray until the question has its answer.
    fn walk<E: Eight, G: Goal, V: Visitor>(
        self,
        ray: &impl WorldRay,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    );

    /// Walks along the ray until the goal is reached.
    #[inline(always)]
    fn pursue<E: Eight, G: Goal, V: Visitor>(
        self,
        ray: &impl WorldRay,
        stack: &mut [u64],
        goal: &mut G,
        visitor: &mut V,
    ) {
        let mut question = Question {
            measure: ray.measure(),
            starts_on: ray.starts_on(),
            goal,
            visitor,
        };
        self.walk::<E, G, V>(ray, stack, &mut question);
    }

    /// Walks with a group of a packet's rays, where there are packets.
    fn packet<S: InstructionSet, G: Goal>(
        self,
        packet: &Packet<S>,
        group: &Group,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    );
}

/// Runs `$ask` with `$of` as the arrangement of an aggregate.
macro_rules! arranged {
    ($aggregate:expr, $of:ident => $ask:expr) => {
        match &$aggregate.places {
            Places::Instances(places) => match $aggregate.instances() {
                [instance] if instance.is_identity() => {
                    let $of = OneMesh(&instance.mesh);
                    $ask
                }
                _ => {
                    let $of = TwoLevels($aggregate, places);
                    $ask
                }
            },
            Places::Triangles(_) => {
                let $of = OneLevel($aggregate);
                $ask
            }
        }
    };
}

#[cfg(test)]
pub(in crate::bvh) use arranged;

impl Aggregate {
    /// Puts the nearest hit of each ray into its place in `hits`, where there is `None` before.
    pub(super) fn ask_closest(&self, order: Order, rays: &[Ray], hits: &mut [Option<Hit>]) {
        arranged!(self, of => answer(Closest { of, order, rays, hits }));
    }

    /// Sets those of `occluded`, all false before, whose rays hit anything.
    pub(super) fn ask_any(&self, order: Order, rays: &[Ray], occluded: &mut [bool]) {
        arranged!(self, of => answer(AnyOf { of, order, rays, occluded }));
    }

    /// Multiplies what passes on each ray, all one before, by what its crossings let through.
    pub(super) fn ask_transmittances(
        &self,
        order: Order,
        rays: &[Ray],
        through: &mut dyn FnMut(usize, &Hit) -> Vec3,
        found: &mut Transmittances,
    ) {
        let aggregate = self;
        arranged!(self, of => answer(Passing { of, aggregate, order, rays, through, found }));
    }

    /// Walks along one ray until the goal is reached, watched.
    pub(super) fn pursue<G: Goal, V: Visitor>(&self, ray: &SafeRay, goal: &mut G, visitor: &mut V) {
        arranged!(self, of => answer(One { of, ray, goal, visitor }));
    }
}

/// A stack for walks through this arrangement, on the program's own: `$stack` becomes a slice of it. Clearing [`FEW`]
/// entries takes as long as a node or two; [`MANY`] are for trees out of the ordinary.
macro_rules! stack_for {
    ($of:expr, $stack:ident) => {
        let (mut few, mut many);
        let $stack: &mut [u64] = if few_hold($of.most_pending()) {
            few = [0; FEW];
            &mut few
        } else {
            many = [0; MANY];
            &mut many
        };
    };
}

/// The nearest hit of each ray.
pub(in crate::bvh) struct Closest<'a, Of> {
    pub(in crate::bvh) of: Of,
    pub(in crate::bvh) order: Order,
    pub(in crate::bvh) rays: &'a [Ray],
    pub(in crate::bvh) hits: &'a mut [Option<Hit>],
}

impl<Of: Arrangement> Query for Closest<'_, Of> {
    type Answer = ();

    #[inline(always)]
    fn ask<S: InstructionSet>(self) {
        stack_for!(self.of, stack);
        if Of::HAS_PACKETS && self.order != Order::None {
            let most = S::Packet::COUNT;
            for (rays, hits) in self.rays.chunks(most).zip(self.hits.chunks_mut(most)) {
                let mut answers = Answers::Closest(hits);
                trace_packet::<_, S, Nearest>(self.of, rays, &mut answers, stack);
            }
            return;
        }
        let size = Batch::SIZE;
        for (rays, hits) in self.rays.chunks(size).zip(self.hits.chunks_mut(size)) {
            let batch = Batch::new::<S::Eight>(rays, self.of.pad());
            for ray in batch.rays() {
                let mut goal = Nearest::NONE;
                (self.of).pursue::<S::Eight, _, _>(&ray, stack, &mut goal, &mut ());
                hits[ray.place()] = goal.found(&ray.measure());
            }
        }
    }
}

/// Whether each ray hits anything.
pub(in crate::bvh) struct AnyOf<'a, Of> {
    pub(in crate::bvh) of: Of,
    pub(in crate::bvh) order: Order,
    pub(in crate::bvh) rays: &'a [Ray],
    pub(in crate::bvh) occluded: &'a mut [bool],
}

impl<Of: Arrangement> Query for AnyOf<'_, Of> {
    type Answer = ();

    #[inline(always)]
    fn ask<S: InstructionSet>(self) {
        stack_for!(self.of, stack);
        if Of::HAS_PACKETS && self.order != Order::None {
            let most = S::Packet::COUNT;
            let rays = self.rays.chunks(most);
            for (rays, occluded) in rays.zip(self.occluded.chunks_mut(most)) {
                let mut answers = Answers::Any(occluded);
                trace_packet::<_, S, Any>(self.of, rays, &mut answers, stack);
            }
            return;
        }
        let size = Batch::SIZE;
        let rays = self.rays.chunks(size);
        for (rays, occluded) in rays.zip(self.occluded.chunks_mut(size)) {
            let batch = Batch::new::<S::Eight>(rays, self.of.pad());
            for ray in batch.rays() {
                let mut goal = Any::default();
                (self.of).pursue::<S::Eight, _, _>(&ray, stack, &mut goal, &mut ());
                occluded[ray.place()] = goal.is_hit;
            }
        }
    }
}

/// How much of a light passes on each ray.
pub(in crate::bvh) struct Passing<'a, Of> {
    pub(in crate::bvh) of: Of,
    pub(in crate::bvh) aggregate: &'a Aggregate,
    pub(in crate::bvh) order: Order,
    pub(in crate::bvh) rays: &'a [Ray],
    pub(in crate::bvh) through: &'a mut dyn FnMut(usize, &Hit) -> Vec3,
    pub(in crate::bvh) found: &'a mut Transmittances,
}

impl<Of: Arrangement> Query for Passing<'_, Of> {
    type Answer = ();

    #[inline(always)]
    fn ask<S: InstructionSet>(self) {
        let Self {
            of, order, rays, ..
        } = self;
        let Transmittances {
            passing,
            occluded,
            crossings,
        } = self.found;
        // Most rays meet nothing: packets find that out.
        let has_packets = Of::HAS_PACKETS && order != Order::None;
        occluded.clear();
        occluded.resize(rays.len(), !has_packets);
        if has_packets {
            AnyOf {
                of,
                order,
                rays,
                occluded,
            }
            .ask::<S>();
        }
        stack_for!(of, stack);
        for (i, (ray, passing)) in rays.iter().zip(passing).enumerate() {
            if occluded[i]
                && let Some(ray) = SafeRay::new(ray)
            {
                let through = &mut |hit: &Hit| (self.through)(i, hit);
                let mut goal = Transmit::new(self.aggregate, &ray, through, crossings);
                of.pursue::<S::Eight, _, _>(&ray, stack, &mut goal, &mut ());
                *passing = goal.product();
            }
        }
    }
}

/// One ray, watched.
struct One<'a, Of, G, V> {
    of: Of,
    ray: &'a SafeRay,
    goal: &'a mut G,
    visitor: &'a mut V,
}

impl<Of: Arrangement, G: Goal, V: Visitor> Query for One<'_, Of, G, V> {
    type Answer = ();

    #[inline(always)]
    fn ask<S: InstructionSet>(self) {
        stack_for!(self.of, stack);
        (self.of).pursue::<S::Eight, G, V>(self.ray, stack, self.goal, self.visitor);
    }
}

/// One mesh that stands still where it was modelled: no tree above it, and no other ray.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct OneMesh<'a>(pub(in crate::bvh) &'a MeshTree);

impl Arrangement for OneMesh<'_> {
    const HAS_PACKETS: bool = true;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending()
    }

    #[inline(always)]
    fn pad(self) -> f32 {
        PAD
    }

    #[inline(always)]
    fn walk<E: Eight, G: Goal, V: Visitor>(
        self,
        ray: &impl WorldRay,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    ) {
        let leaves = MeshLeaves::new(self.0, 0, ray.in_tree());
        leaves.walk::<E, G, V>(stack, (ray.start(), ray.end()), question);
    }

    #[inline(always)]
    fn packet<S: InstructionSet, G: Goal>(
        self,
        packet: &Packet<S>,
        group: &Group,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        let leaves = PacketOfMesh::<S, G>::new(self.0, &packet.world, 0);
        leaves.walk(group, found, stack);
    }
}

/// A tree over instances, and one for each mesh.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct TwoLevels<'a>(
    pub(in crate::bvh) &'a Aggregate,
    pub(in crate::bvh) &'a [u32],
);

impl Arrangement for TwoLevels<'_> {
    const HAS_PACKETS: bool = true;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending
    }

    #[inline(always)]
    fn pad(self) -> f32 {
        self.0.ray_pad
    }

    #[inline(always)]
    fn walk<E: Eight, G: Goal, V: Visitor>(
        self,
        ray: &impl WorldRay,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    ) {
        let Self(scene, places) = self;
        let mut leaves = InstanceLeaves::new(scene, places, ray);
        let top = ray.at_top::<E>(scene);
        walk(&scene.wide, stack, &top, ray.end(), &mut leaves, question);
    }

    #[inline(always)]
    fn packet<S: InstructionSet, G: Goal>(
        self,
        packet: &Packet<S>,
        group: &Group,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        let Self(scene, places) = self;
        let rays = packet.world.with_pad(scene.ray_pad);
        let mut view = View::<S>::new(&rays, group);
        let mut leaves = PacketOfInstances::<S, G> {
            scene,
            places,
            packet,
            goal: PhantomData,
        };
        walk_packet::<S, G>(
            &scene.wide,
            stack,
            &mut view,
            group.lanes,
            found,
            &mut leaves,
        );
    }
}

/// One tree over all triangles.
#[derive(Clone, Copy)]
pub(in crate::bvh) struct OneLevel<'a>(pub(in crate::bvh) &'a Aggregate);

impl Arrangement for OneLevel<'_> {
    const HAS_PACKETS: bool = false;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending
    }

    #[inline(always)]
    fn pad(self) -> f32 {
        self.0.ray_pad
    }

    #[inline(always)]
    fn walk<E: Eight, G: Goal, V: Visitor>(
        self,
        ray: &impl WorldRay,
        stack: &mut [u64],
        question: &mut Question<G, V>,
    ) {
        let scene = self.0;
        let mut leaves = FlatLeaves::new(scene, ray);
        let top = ray.at_top::<E>(scene);
        walk(&scene.wide, stack, &top, ray.end(), &mut leaves, question);
    }

    #[inline(always)]
    fn packet<S: InstructionSet, G: Goal>(
        self,
        _: &Packet<S>,
        _: &Group,
        _: &mut Found<S::Packet>,
        _: &mut [u64],
    ) {
    }
}

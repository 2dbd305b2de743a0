//! How the wide trees of an aggregate hang together, and the questions that are compiled for each way apart: what a
//! scene does not have costs nothing, not even the registers.

use std::marker::PhantomData;

#[cfg(test)]
use super::wide::answer_with_each;
use super::{
    aggregate::{Aggregate, Places},
    goal::{Any, Goal, Nearest},
    leaves::{FlatLeaves, InstanceLeaves, offer},
    mesh_tree::MeshTree,
    order::Order,
    packets::{Packet, PacketOfInstances, trace_packet},
    queries::Best,
    ray::{Hit, Ray},
    safe_ray::SafeRay,
    traverse::STOP,
    wide::{
        Answers, Eight, FEW, Found, Group, InstructionSet, Lanes, MANY, Query, View, WideRay,
        answer, few_hold, walk, walk_packet,
    },
};

/// What rays walk: one of the ways in which an aggregate is arranged.
pub(super) trait Arrangement: Copy {
    /// Whether packets walk it.
    const HAS_PACKETS: bool;

    /// Entries of a stack that a walk needs.
    fn most_pending(self) -> usize;

    /// Hands the hits on the ray whose `t` is not beyond the limit to `at(hit, limit)`, which returns the new limit, or
    /// [`STOP`]. `t` is the [`SafeRay`]'s. The order is that of [`walk`].
    fn each_hit<E: Eight, G: Goal>(
        self,
        ray: &SafeRay,
        stack: &mut [u64],
        at: impl FnMut(Hit, f32) -> f32,
    );

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

impl Aggregate {
    /// Puts the nearest hit of each ray into its place in `hits`, where there is `None` before.
    pub(super) fn ask_closest(&self, order: Order, rays: &[Ray], hits: &mut [Option<Hit>]) {
        arranged!(self, of => answer(Closest { of, order, rays, hits }));
    }

    /// Sets those of `occluded`, all false before, whose rays hit anything.
    pub(super) fn ask_any(&self, order: Order, rays: &[Ray], occluded: &mut [bool]) {
        arranged!(self, of => answer(AnyOf { of, order, rays, occluded }));
    }

    /// [`Arrangement::each_hit`].
    pub(super) fn ask_every<G: Goal>(&self, ray: &SafeRay, at: impl FnMut(Hit, f32) -> f32) {
        arranged!(self, of => answer(Every::<_, _, G> { of, ray, at, goal: PhantomData }));
    }
}

#[cfg(test)]
impl Aggregate {
    /// What [`Aggregate::closest_hits_in`] and [`Aggregate::occlusions_in`] find with each instruction set of this
    /// machine; the names of those that it lacks.
    pub(super) fn ask_with_each(
        &self,
        order: Order,
        rays: &[Ray],
        mut check: impl FnMut(&str, Vec<Option<Hit>>, Vec<bool>),
    ) -> Vec<&'static str> {
        let both = || Both {
            aggregate: self,
            order,
            rays,
        };
        answer_with_each(both, |name, (hits, occluded)| check(name, hits, occluded))
    }
}

#[cfg(test)]
struct Both<'a> {
    aggregate: &'a Aggregate,
    order: Order,
    rays: &'a [Ray],
}

#[cfg(test)]
impl Query for Both<'_> {
    type Answer = (Vec<Option<Hit>>, Vec<bool>);

    #[inline(always)]
    fn ask<S: InstructionSet>(self) -> Self::Answer {
        let Self {
            aggregate,
            order,
            rays,
        } = self;
        let (mut all_hits, mut all_occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
        let (hits, occluded) = (all_hits.as_mut_slice(), all_occluded.as_mut_slice());
        arranged!(aggregate, of => {
            Closest { of, order, rays, hits }.ask::<S>();
            AnyOf { of, order, rays, occluded }.ask::<S>();
        });
        (all_hits, all_occluded)
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
struct Closest<'a, Of> {
    of: Of,
    order: Order,
    rays: &'a [Ray],
    hits: &'a mut [Option<Hit>],
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
        for (ray, closest) in self.rays.iter().zip(self.hits) {
            if let Some(ray) = SafeRay::new(ray) {
                let mut best = Best::NONE;
                let offer = |hit, limit| best.offer(hit, limit);
                self.of.each_hit::<S::Eight, Nearest>(&ray, stack, offer);
                *closest = best.found(&ray);
            }
        }
    }
}

/// Whether each ray hits anything.
struct AnyOf<'a, Of> {
    of: Of,
    order: Order,
    rays: &'a [Ray],
    occluded: &'a mut [bool],
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
        for (ray, occluded) in self.rays.iter().zip(self.occluded) {
            if let Some(ray) = SafeRay::new(ray) {
                self.of.each_hit::<S::Eight, Any>(&ray, stack, |_, _| {
                    *occluded = true;
                    STOP
                });
            }
        }
    }
}

/// Every hit of one ray up to a limit that may shrink.
struct Every<'a, Of, At, G> {
    of: Of,
    ray: &'a SafeRay,
    at: At,
    goal: PhantomData<G>,
}

impl<Of, At, G> Query for Every<'_, Of, At, G>
where
    G: Goal,
    Of: Arrangement,
    At: FnMut(Hit, f32) -> f32,
{
    type Answer = ();

    #[inline(always)]
    fn ask<S: InstructionSet>(self) {
        stack_for!(self.of, stack);
        (self.of).each_hit::<S::Eight, G>(self.ray, stack, self.at);
    }
}

/// One mesh that stands still where it was modelled: no tree above it, and no other ray.
#[derive(Clone, Copy)]
pub(super) struct OneMesh<'a>(pub(super) &'a MeshTree);

impl Arrangement for OneMesh<'_> {
    const HAS_PACKETS: bool = true;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending()
    }

    #[inline(always)]
    fn each_hit<E: Eight, G: Goal>(
        self,
        ray: &SafeRay,
        stack: &mut [u64],
        mut at: impl FnMut(Hit, f32) -> f32,
    ) {
        let at = |triangle, crossing, limit| offer(ray, (0, triangle), crossing, limit, &mut at);
        let span = (ray.start, ray.end);
        (self.0).walk_wide::<E, G>(&ray.world, stack, span, at);
    }

    #[inline(always)]
    fn packet<S: InstructionSet, G: Goal>(
        self,
        packet: &Packet<S>,
        group: &Group,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        (self.0).walk_packet::<S, G>(&packet.world, group, 0, found, stack);
    }
}

/// A tree over instances, and one for each mesh.
#[derive(Clone, Copy)]
pub(super) struct TwoLevels<'a>(&'a Aggregate, &'a [u32]);

impl Arrangement for TwoLevels<'_> {
    const HAS_PACKETS: bool = true;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending
    }

    #[inline(always)]
    fn each_hit<E: Eight, G: Goal>(
        self,
        ray: &SafeRay,
        stack: &mut [u64],
        at: impl FnMut(Hit, f32) -> f32,
    ) {
        let Self(scene, places) = self;
        let mut leaves = InstanceLeaves::<_, G> {
            scene,
            places,
            ray,
            at,
            goal: PhantomData,
        };
        let top = WideRay::new(&scene.top_slab(&ray.world), ray.start);
        walk::<E, G>(&scene.wide, stack, &top, ray.end, &mut leaves);
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
pub(super) struct OneLevel<'a>(&'a Aggregate);

impl Arrangement for OneLevel<'_> {
    const HAS_PACKETS: bool = false;

    #[inline(always)]
    fn most_pending(self) -> usize {
        self.0.most_pending
    }

    #[inline(always)]
    fn each_hit<E: Eight, G: Goal>(
        self,
        ray: &SafeRay,
        stack: &mut [u64],
        at: impl FnMut(Hit, f32) -> f32,
    ) {
        let scene = self.0;
        let mut leaves = FlatLeaves::<_, G> {
            scene,
            ray,
            last: None,
            at,
            goal: PhantomData,
        };
        let top = WideRay::new(&scene.top_slab(&ray.world), ray.start);
        walk::<E, G>(&scene.wide, stack, &top, ray.end, &mut leaves);
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

//! A batch's rays as packets: read into lanes, sorted by where they go, and traced together or alone.

use std::marker::PhantomData;

use super::leaves::{InstanceLeaves, MeshLeaves};
use super::levels::Arrangement;
use super::tree_ray::{LoneRay, TreeRay, WorldRay};
use crate::bvh::geometry::aggregate::Aggregate;
use crate::bvh::geometry::mesh_tree::MeshTree;
use crate::bvh::kernel::columns::Columns;
use crate::bvh::kernel::goal::{Any, Goal, Nearest};
use crate::bvh::kernel::ray::Ray;
use crate::bvh::kernel::safe_ray::SafeRay;
use crate::bvh::kernel::wide::{
    Answers, Found, Group, InstructionSet, Lanes, PacketLeaves, PacketRays, View, Ways, lanes_of,
    walk_from, walk_packet,
};

/// Rays of a batch as a packet, a lane each.
pub(in crate::bvh) struct Packet<'a, S: InstructionSet> {
    rays: &'a [Ray],
    pub(in crate::bvh) world: PacketRays<S::Packet>,
    time: S::Packet,
    end: S::Packet,
    /// The triangle that each starts on: the bits of its instance's number and of its own. `None` where none does.
    starts_on: Option<[S::Packet; 2]>,
    /// Which rays can be traced together.
    lanes: u32,
}

impl<'a, S: InstructionSet> Packet<'a, S> {
    /// At most as many rays as there are lanes.
    #[inline(always)]
    fn new(rays: &'a [Ray]) -> Self {
        let Columns {
            world,
            end,
            time,
            safe,
            is_spawned,
        } = Columns::of(rays);
        // Rays of a camera start on no triangle.
        let mut starts_on = None;
        if is_spawned {
            let mut names = [S::Packet::splat(0.0).to_array(); 2];
            for (lane, ray) in rays.iter().enumerate() {
                names[0].as_mut()[lane] = f32::from_bits(ray.starts_on.instance);
                names[1].as_mut()[lane] = f32::from_bits(ray.starts_on.triangle);
            }
            starts_on = Some([S::Packet::load(&names[0]), S::Packet::load(&names[1])]);
        }
        Self {
            rays,
            world,
            time,
            end,
            starts_on,
            lanes: safe,
        }
    }
}

/// Groups of no more than this part of a packet go on alone, ray by ray. Measured: diffuse rays, which should not have come
/// in packets at all, fall into such.
const SMALL_GROUP: u32 = 3;

/// Answers a question of at most as many rays as there are lanes.
#[inline(always)]
pub(super) fn trace_packet<Of: Arrangement, S: InstructionSet, G: Goal>(
    of: Of,
    rays: &[Ray],
    answers: &mut Answers,
    stack: &mut [u64],
) {
    let packet = Packet::<S>::new(rays);
    let mut found = Found::nothing(packet.end, packet.starts_on);
    let ways = Ways::of(&packet.world);
    let mut left = packet.lanes;
    let mut alone = !left & ((1 << rays.len()) - 1);
    while let Some(group) = ways.next_group(&mut left) {
        if group.lanes.count_ones() * SMALL_GROUP <= S::Packet::COUNT as u32 {
            alone |= group.lanes;
        } else {
            found.begin(group.lanes);
            of.packet::<S, G>(&packet, &group, &mut found, stack);
        }
    }
    found.write(answers);
    for lane in lanes_of(alone) {
        // Otherwise a miss.
        if let Some(ray) = SafeRay::new(&rays[lane]) {
            match answers {
                Answers::Closest(closest) => {
                    let mut goal = Nearest::NONE;
                    of.pursue::<S::Eight, _, _>(&ray, stack, &mut goal, &mut ());
                    closest[lane] = goal.found(&ray.measure);
                }
                Answers::Any(any) => {
                    let mut goal = Any::default();
                    of.pursue::<S::Eight, _, _>(&ray, stack, &mut goal, &mut ());
                    any[lane] = goal.is_hit;
                }
            }
        }
    }
}

/// Two levels, with a packet's rays.
pub(super) struct PacketOfInstances<'a, S: InstructionSet, G> {
    pub(in crate::bvh) scene: &'a Aggregate,
    pub(in crate::bvh) places: &'a [u32],
    pub(in crate::bvh) packet: &'a Packet<'a, S>,
    pub(in crate::bvh) goal: PhantomData<G>,
}

impl<S: InstructionSet, G: Goal> PacketLeaves<S> for PacketOfInstances<'_, S, G> {
    #[inline(always)]
    fn visit(
        &mut self,
        leaf: u32,
        lanes: u32,
        view: &mut View<S>,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        let packet = self.packet;
        for &number in &self.places[self.scene.wide_leaves[leaf as usize].clone()] {
            let instance = &self.scene.instances()[number as usize];
            if instance.is_identity() {
                // Its space is the world's, and what is padded for all instances is padded enough for its tree.
                let mut leaves = PacketOfMesh::<S, G>::new(&instance.mesh, &packet.world, number);
                let tree = &instance.mesh.wide;
                walk_packet::<S, G>(tree, stack, view, lanes, found, &mut leaves);
                continue;
            }
            let (rays, in_range) = instance.to_object_packet(&packet.world, packet.time);
            let ways = Ways::of(&rays);
            let mut left = lanes & in_range;
            while let Some(group) = ways.next_group(&mut left) {
                let leaves = PacketOfMesh::<S, G>::new(&instance.mesh, &rays, number);
                leaves.walk(&group, found, stack);
            }
        }
    }

    #[inline(always)]
    fn alone(&mut self, child: u32, lanes: u32, found: &mut Found<S::Packet>, stack: &mut [u64]) {
        let (scene, places) = (self.scene, self.places);
        for lane in lanes_of(lanes) {
            let Some(ray) = SafeRay::new(&self.packet.rays[lane]) else {
                continue;
            };
            let mut alone = found.alone::<G>(lane);
            let limit = alone.limit;
            let mut leaves = InstanceLeaves::new(scene, places, &ray);
            let top = ray.at_top::<S::Eight>(scene);
            let mut nobody = ();
            let question = &mut alone.question(&mut nobody);
            walk_from(
                &scene.wide,
                child,
                stack,
                &top,
                limit,
                &mut leaves,
                question,
            );
            found.rejoin(alone);
        }
    }
}

/// A mesh's wide tree, with a packet's rays in its space.
pub(super) struct PacketOfMesh<'a, S: InstructionSet, G> {
    mesh: &'a MeshTree,
    rays: &'a PacketRays<S::Packet>,
    instance: u32,
    goal: PhantomData<G>,
}

impl<'a, S: InstructionSet, G: Goal> PacketOfMesh<'a, S, G> {
    #[inline(always)]
    pub(in crate::bvh) fn new(
        mesh: &'a MeshTree,
        rays: &'a PacketRays<S::Packet>,
        instance: u32,
    ) -> Self {
        Self {
            mesh,
            rays,
            instance,
            goal: PhantomData,
        }
    }

    /// Walks the mesh's tree with a group of the rays.
    #[inline(always)]
    pub(in crate::bvh) fn walk(
        mut self,
        group: &Group,
        found: &mut Found<S::Packet>,
        stack: &mut [u64],
    ) {
        let mut view = View::<S>::new(self.rays, group);
        let tree = &self.mesh.wide;
        walk_packet::<S, G>(tree, stack, &mut view, group.lanes, found, &mut self);
    }
}

impl<S: InstructionSet, G: Goal> PacketLeaves<S> for PacketOfMesh<'_, S, G> {
    #[inline(always)]
    fn visit(
        &mut self,
        leaf: u32,
        lanes: u32,
        view: &mut View<S>,
        found: &mut Found<S::Packet>,
        _: &mut [u64],
    ) {
        for block in &self.mesh.blocks[leaf as usize..] {
            block.cross_packet::<S, G>(self.rays, view, lanes, self.instance, found);
            if !block.continues() {
                break;
            }
        }
    }

    #[inline(always)]
    fn alone(&mut self, child: u32, lanes: u32, found: &mut Found<S::Packet>, stack: &mut [u64]) {
        for lane in lanes_of(lanes) {
            let ray = self.rays.ray(lane);
            let mut alone = found.alone::<G>(lane);
            let limit = alone.limit;
            let tree = &self.mesh.wide;
            let ray = LoneRay::new(&ray);
            let wide = ray.wide::<S::Eight>(0.0);
            let mut leaves = MeshLeaves::new(self.mesh, self.instance, ray);
            let mut nobody = ();
            let question = &mut alone.question(&mut nobody);
            walk_from(tree, child, stack, &wide, limit, &mut leaves, question);
            found.rejoin(alone);
        }
    }
}

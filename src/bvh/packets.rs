//! A batch's rays as packets: read into lanes, sorted by where they go, and traced together or alone.

use std::marker::PhantomData;

use super::{
    aggregate::Aggregate,
    goal::{Any, Goal, Nearest},
    leaves::{InstanceLeaves, MeshLeaves},
    levels::Arrangement,
    mesh_tree::MeshTree,
    ray::{Ray, TriangleId},
    safe_ray::{ORDINARY, SafeRay},
    triangles::REACH,
    wide::{
        Answers, Found, Group, InstructionSet, Lanes, PacketLeaves, PacketRays, View, Ways,
        WideRay, by_axis, lanes_of, largest_size, walk_from, walk_packet,
    },
};

/// Rays of a batch as a packet, a lane each.
pub(super) struct Packet<'a, S: InstructionSet> {
    rays: &'a [Ray],
    pub(super) world: PacketRays<S::Packet>,
    time: S::Packet,
    end: S::Packet,
    /// The triangle that each starts on: the bits of its instance's number and of its own. `None` where none does.
    starts_on: Option<[S::Packet; 2]>,
    /// Which rays can be traced together.
    lanes: u32,
}

impl<'a, S: InstructionSet> Packet<'a, S> {
    /// At most as many rays as there are lanes; what [`SafeRay::new`] does with one, where it needs no scale.
    #[inline(always)]
    fn new(rays: &'a [Ray]) -> Self {
        let zero = S::Packet::splat(0.0);
        let mut rows = [[0.0; 8]; 16];
        let mut all = TriangleId::NONE.triangle;
        for (row, ray) in rows.iter_mut().zip(rays) {
            let numbers: &[f32; 10] = bytemuck::cast_ref(ray);
            row.copy_from_slice(&numbers[..8]);
            all &= ray.starts_on.triangle;
        }
        // Rays of a camera start on none.
        let mut starts_on = None;
        if all != TriangleId::NONE.triangle {
            let mut names = [zero.to_array(); 2];
            for (lane, ray) in rays.iter().enumerate() {
                names[0].as_mut()[lane] = f32::from_bits(ray.starts_on.instance);
                names[1].as_mut()[lane] = f32::from_bits(ray.starts_on.triangle);
            }
            starts_on = Some([S::Packet::load(&names[0]), S::Packet::load(&names[1])]);
        }
        let columns = S::Packet::columns(&rows);
        let [.., end, time] = columns;
        // -0.0 becomes +0.0, so that both mean the same.
        let origin = by_axis!(|i| columns[i].add(zero));
        let direction = by_axis!(|i| columns[3 + i].add(zero));
        let longest = largest_size(&direction);
        let ordinary = S::Packet::splat(1.0 / ORDINARY);
        let reach = S::Packet::splat(REACH);
        let mut lanes = (1 << rays.len()) - 1;
        for axis in 0..3 {
            lanes &= S::Packet::bits(direction[axis].abs().le(ordinary));
            lanes &= S::Packet::bits(origin[axis].abs().le(reach));
        }
        lanes &= S::Packet::bits(S::Packet::splat(ORDINARY).le(longest));
        lanes &= S::Packet::bits(zero.lt(end));
        lanes &= S::Packet::bits(zero.le(time));
        lanes &= S::Packet::bits(time.le(S::Packet::splat(1.0)));
        Self {
            rays,
            world: PacketRays::new(origin, direction, longest),
            time,
            end,
            starts_on,
            lanes,
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
    pub(super) scene: &'a Aggregate,
    pub(super) places: &'a [u32],
    pub(super) packet: &'a Packet<'a, S>,
    pub(super) goal: PhantomData<G>,
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
            let Some(ray) = &SafeRay::new(&self.packet.rays[lane]) else {
                continue;
            };
            let mut alone = found.alone::<G>(lane);
            let limit = alone.limit;
            let mut leaves = InstanceLeaves { scene, places, ray };
            let top = WideRay::<S::Eight>::new(&scene.top_slab(&ray.world), 0.0);
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
    pub(super) fn new(mesh: &'a MeshTree, rays: &'a PacketRays<S::Packet>, instance: u32) -> Self {
        Self {
            mesh,
            rays,
            instance,
            goal: PhantomData,
        }
    }

    /// Walks the mesh's tree with a group of the rays.
    #[inline(always)]
    pub(super) fn walk(mut self, group: &Group, found: &mut Found<S::Packet>, stack: &mut [u64]) {
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
            let mut leaves = MeshLeaves::new(self.mesh, self.instance, &ray);
            let ray = WideRay::<S::Eight>::new(&ray.slab, 0.0);
            let mut nobody = ();
            let question = &mut alone.question(&mut nobody);
            walk_from(tree, child, stack, &ray, limit, &mut leaves, question);
            found.rejoin(alone);
        }
    }
}

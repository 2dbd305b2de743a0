//! Visited and pruned nodes, and the stepper's stack, against a plain recursive traversal of the trees' wide form in f64.

use super::Scene;
use crate::analytic::Numbers;
use glam::{DVec3, UVec2};
use glassbox::bvh::{Counters, Primitive, TreeRef, WideBox, primitives_below};
use glassbox::inspect::{StackEntry, StepKind, Traversal, TreeView, Visits};
use glassbox::scene::{Levels, RenderSettings};
use glassbox::trace::{RayTree, Samples, TracedRay, World, probe};
use std::collections::BTreeSet;

/// Where two numbers are closer than this, relative to their size, f32 may see them the other way
/// round: such rays are left out, and counted.
const TOO_CLOSE: f64 = 1e-4;

/// One ray's traversal, recursively.
struct Oracle<'a> {
    world: &'a World,
    limit: f64,
    entered: Vec<StackEntry>,
    pruned: BTreeSet<StackEntry>,
    triangles: u64,
    boxes: u64,
    /// The stack when each node was entered.
    stacks: Vec<Vec<StackEntry>>,
    pending: Vec<StackEntry>,
    unsure: bool,
}

#[derive(Clone, Copy)]
struct Ray64 {
    origin: DVec3,
    direction: DVec3,
}

impl<'a> Oracle<'a> {
    fn of(world: &'a World, ray: &TracedRay) -> Self {
        let mut oracle = Self {
            world,
            limit: f64::from(ray.t_max),
            entered: Vec::new(),
            pruned: BTreeSet::new(),
            triangles: 0,
            boxes: 0,
            stacks: Vec::new(),
            pending: Vec::new(),
            unsure: false,
        };
        let ray = Ray64 {
            origin: ray.origin.as_dvec3(),
            direction: ray.direction.as_dvec3(),
        };
        // A mesh that stands alone where it was modelled needs no tree above it.
        let alone = match world.aggregate.instances() {
            [one] => {
                *one.world_from_object() == glam::Affine3A::IDENTITY
                    && one.velocity() == glam::Vec3::ZERO
                    && world.aggregate.options().levels == glassbox::bvh::Levels::Two
            }
            _ => false,
        };
        let name = if alone {
            TreeRef::Mesh(0)
        } else {
            TreeRef::Top
        };
        oracle.root(name, ray);
        oracle
    }

    fn close(&mut self, a: f64, b: f64) {
        if !a.is_finite() || !b.is_finite() {
            return;
        }
        self.unsure |= (a - b).abs() <= TOO_CLOSE * a.abs().max(b.abs()).max(1e-3);
    }

    /// Where the ray enters a node's box and leaves it. The tracer's test is conservative: what is hit
    /// here is hit there; what is hit only with a margin is too close to call.
    fn span(&mut self, view: &TreeView, node: u32, ray: Ray64) -> (f64, f64) {
        let node = &view.tree.nodes[node as usize];
        let (min, max) = (node.min.as_dvec3(), node.max.as_dvec3());
        let largest = min.abs().max(max.abs()).max(ray.origin.abs()).max_element();
        let with_margin = |margin: f64| {
            let (mut entry, mut exit) = (0.0_f64, f64::INFINITY);
            for axis in 0..3 {
                let a = (min[axis] - margin - ray.origin[axis]) / ray.direction[axis];
                let b = (max[axis] + margin - ray.origin[axis]) / ray.direction[axis];
                entry = entry.max(a.min(b));
                exit = exit.min(a.max(b));
            }
            (entry, exit)
        };
        let (entry, exit) = with_margin(0.0);
        let (wide_entry, wide_exit) = with_margin(1e-5 * largest);
        self.unsure |= (entry <= exit) != (wide_entry <= wide_exit);
        (entry, exit)
    }

    /// The root is entered without a test.
    fn root(&mut self, name: TreeRef, ray: Ray64) {
        let Some(view) = TreeView::new(self.world, name) else {
            return;
        };
        let boxes = boxes_of(self.world, &view);
        if let Some(root) = boxes.first() {
            self.enter(&view, &boxes, root, ray);
        }
    }

    fn enter(&mut self, view: &TreeView, boxes: &[WideBox], here: &WideBox, ray: Ray64) {
        self.entered.push(place(view, here.node));
        self.stacks.push(self.pending.clone());
        self.boxes += 1;
        if here.is_leaf {
            return self.leaf(view, here.node, ray);
        }
        let mut hit: Vec<(&WideBox, f64)> = Vec::new();
        for child in children(view, boxes, here) {
            let (entry, exit) = self.span(view, child.node, ray);
            if entry > exit {
                self.boxes += 1;
                continue;
            }
            self.close(entry, self.limit);
            if entry > self.limit {
                self.boxes += 1;
                self.pruned.insert(place(view, child.node));
            } else {
                hit.push((child, entry));
            }
        }
        // Stable: nodes before leaves where both begin inside, and else in the order of the node.
        hit.sort_by(|a, b| (a.1.total_cmp(&b.1)).then(a.0.is_leaf.cmp(&b.0.is_leaf)));
        for pair in hit.windows(2) {
            if pair[1].1 > 0.0 {
                self.close(pair[0].1, pair[1].1);
            }
        }
        let bottom = self.pending.len();
        let far = hit.iter().skip(1).rev();
        (self.pending).extend(far.map(|(child, _)| place(view, child.node)));
        for (i, (child, entry)) in hit.into_iter().enumerate() {
            if i > 0 {
                self.pending.pop();
                self.close(entry, self.limit);
            }
            if entry <= self.limit {
                self.enter(view, boxes, child, ray);
            } else {
                self.boxes += 1;
                self.pruned.insert(place(view, child.node));
            }
        }
        assert_eq!(self.pending.len(), bottom);
    }

    fn leaf(&mut self, view: &TreeView, leaf: u32, ray: Ray64) {
        let places = primitives_below(view.tree, leaf as usize);
        let first = self.world.aggregate.primitive(places.start);
        if view.name == TreeRef::Top && matches!(first, Some(Primitive::Instance(_))) {
            for place in places {
                let Some(Primitive::Instance(instance)) = self.world.aggregate.primitive(place)
                else {
                    continue;
                };
                let of = &self.world.aggregate.instances()[instance as usize];
                let inverse = glam::DAffine3::from_mat3_translation(
                    glam::DMat3::from_cols(
                        of.world_from_object().matrix3.x_axis.as_dvec3(),
                        of.world_from_object().matrix3.y_axis.as_dvec3(),
                        of.world_from_object().matrix3.z_axis.as_dvec3(),
                    ),
                    of.world_from_object().translation.as_dvec3(),
                )
                .inverse();
                let own = Ray64 {
                    origin: inverse.transform_point3(ray.origin),
                    direction: inverse.transform_vector3(ray.direction),
                };
                self.root(TreeRef::Mesh(instance), own);
            }
            return;
        }
        for (instance, triangle) in triangles(view, self.world, leaf) {
            self.triangles += 1;
            let of = &self.world.aggregate.instances()[instance as usize];
            let corners = of.mesh.triangles().corners(triangle).map(|corner| {
                let corner = match view.name {
                    TreeRef::Top => of.to_world_point(corner),
                    TreeRef::Mesh(_) => corner,
                };
                corner.as_dvec3()
            });
            self.triangle(corners, ray);
        }
    }

    /// Möller and Trumbore 1997, "Fast, Minimum Storage Ray/Triangle Intersection".
    fn triangle(&mut self, [a, b, c]: [DVec3; 3], ray: Ray64) {
        let (ab, ac) = (b - a, c - a);
        let p = ray.direction.cross(ac);
        let det = ab.dot(p);
        let from = ray.origin - a;
        let u = from.dot(p) / det;
        let q = from.cross(ab);
        let v = ray.direction.dot(q) / det;
        let t = ac.dot(q) / det;
        let margin = u.min(v).min(1.0 - u - v);
        if margin.abs() < 1e-6 && t > 0.0 {
            self.unsure = true;
        }
        if margin >= 0.0 && t > 0.0 && t < self.limit {
            self.limit = t;
        }
    }
}

/// The wide form of a tree, parents before children.
fn boxes_of(world: &World, view: &TreeView) -> Vec<WideBox> {
    match view.instance() {
        Some((_, instance)) => instance.mesh.wide_boxes(),
        None => world.aggregate.wide_boxes(),
    }
}

/// The boxes of a wide node's children: those nearest below it in the binary tree, in the order of the wide form.
fn children<'b>(view: &TreeView, boxes: &'b [WideBox], of: &WideBox) -> Vec<&'b WideBox> {
    let mut found = Vec::new();
    let mut pending = vec![view.tree.nodes[of.node as usize].first_index];
    while let Some(left) = pending.pop() {
        for child in [left, left + 1] {
            match boxes.iter().position(|b| b.node == child) {
                Some(place) => found.push(place),
                None => pending.push(view.tree.nodes[child as usize].first_index),
            }
        }
    }
    found.sort_unstable();
    found.into_iter().map(|place| &boxes[place]).collect()
}

/// The triangles of a leaf of the wide form, as (instance, triangle).
fn triangles(view: &TreeView, world: &World, leaf: u32) -> Vec<(u32, u32)> {
    let places = primitives_below(view.tree, leaf as usize);
    match view.instance() {
        Some((number, instance)) => places
            .map(|place| (number, instance.mesh.triangle_at(place)))
            .collect(),
        None => places
            .filter_map(|place| match world.aggregate.primitive(place) {
                Some(Primitive::Triangle { instance, triangle }) => Some((instance, triangle)),
                _ => None,
            })
            .collect(),
    }
}

fn place(view: &TreeView, node: u32) -> StackEntry {
    (view.instance().map(|(instance, _)| instance), node)
}

/// Traces the rays of random pixels of a scene and compares; the number of rays compared.
fn compare(name: &str, change: impl Fn(&mut RenderSettings)) -> usize {
    let mut scene = Scene::open(name, UVec2::new(64, 48));
    change(&mut scene.settings);
    scene.settings.features.transparency = false;
    let mut numbers = Numbers(11);
    let (mut compared, mut unsure) = (0, 0);
    for _ in 0..60 {
        let pixel = UVec2::new(
            (numbers.unit() * 64.0) as u32,
            (numbers.unit() * 48.0) as u32,
        );
        let tree = probe(
            &scene.world,
            &scene.camera,
            &scene.settings,
            pixel,
            &Samples::One(0),
        )
        .unwrap();
        for (index, ray) in (0..).zip(&tree.rays) {
            // An occlusion query ends at the first hit it meets, whichever that is.
            if !ray.end.is_traced() || ray.kind.is_for_light() {
                continue;
            }
            let oracle = Oracle::of(&scene.world, ray);
            if oracle.unsure {
                unsure += 1;
                continue;
            }
            compared += 1;
            check(&scene, &tree, index, &oracle, name);
        }
    }
    println!("{name}: {compared} rays compared, {unsure} too close to call");
    assert!(
        compared > unsure,
        "{name}: {unsure} of {compared} are too close to call"
    );
    compared
}

fn check(scene: &Scene, tree: &RayTree, index: u32, oracle: &Oracle, name: &str) {
    let (world, settings) = (&scene.world, &scene.settings);
    let what = format!("{name}: ray {index} of pixel {}", tree.pixel);
    let mut visits = Visits::default();
    tree.retrace(world, settings, index, &mut visits);
    let named = |(tree, node): (TreeRef, u32)| match tree {
        TreeRef::Top => (None, node),
        TreeRef::Mesh(instance) => (Some(instance), node),
    };
    let of = |wanted: &dyn Fn(TreeRef, u32) -> bool| -> BTreeSet<StackEntry> {
        let nodes = visits.nodes().into_iter();
        nodes
            .filter(|&(tree, node)| wanted(tree, node))
            .map(named)
            .collect()
    };
    let entered: BTreeSet<StackEntry> = oracle.entered.iter().copied().collect();
    assert_eq!(
        of(&|tree, node| visits.entered(tree, node) > 0),
        entered,
        "{what}"
    );
    assert_eq!(
        of(&|tree, node| visits.pruned(tree, node) > 0),
        oracle.pruned,
        "{what}"
    );
    let cost = tree.rays[index as usize].cost;
    assert_eq!(cost.nodes as usize, oracle.entered.len(), "{what}");
    assert_eq!(cost.triangles, oracle.triangles, "{what}");
    assert_eq!(cost.boxes, oracle.boxes, "{what}");
    let mut counters = Counters::default();
    tree.retrace(world, settings, index, &mut counters);
    assert_eq!(counters.boxes, cost.boxes, "{what}");

    // Step by step: the same nodes in the same order, with the same stacks.
    let traversal = Traversal::of(world, settings, tree, index);
    let steps = traversal.steps.iter().enumerate();
    let entered: Vec<_> = steps
        .filter(|(_, step)| step.kind == StepKind::Entered)
        .collect();
    assert_eq!(entered.len(), oracle.entered.len(), "{what}");
    for (k, (i, step)) in entered.into_iter().enumerate() {
        assert_eq!(
            (step.instance, step.node),
            oracle.entered[k],
            "{what}, step {i}"
        );
        assert_eq!(
            traversal.stack_after(i),
            oracle.stacks[k],
            "{what}, step {i}"
        );
    }
    assert_eq!(
        traversal.steps.len() as u64,
        cost.boxes + cost.triangles,
        "{what}: every box and every triangle is a step"
    );
}

#[test]
fn two_levels_of_trees_are_walked_as_a_plain_recursion_walks_them() {
    assert!(compare("head", |_| {}) > 50);
    assert!(compare("showcase", |settings| settings.spp = 1) > 50);
}

#[test]
fn one_level_is_walked_as_a_plain_recursion_walks_it() {
    // The setting is read where the scene is opened; here one mesh is enough to tell.
    let mut scene = Scene::open("teapot", UVec2::new(64, 48));
    let options = glassbox::bvh::BuildOptions {
        levels: glassbox::bvh::Levels::One,
        ..*scene.world.aggregate.options()
    };
    let instances = scene.world.aggregate.instances().to_vec();
    scene.world.aggregate =
        std::sync::Arc::new(glassbox::bvh::Aggregate::build(instances, &options));
    scene.settings.tree.levels = Levels::One;
    let mut compared = 0;
    for i in 0..40 {
        let pixel = UVec2::new(20 + i % 8 * 3, 14 + i / 8 * 4);
        let samples = Samples::One(0);
        let tree = probe(
            &scene.world,
            &scene.camera,
            &scene.settings,
            pixel,
            &samples,
        )
        .unwrap();
        let oracle = Oracle::of(&scene.world, &tree.rays[0]);
        if !oracle.unsure {
            compared += 1;
            check(&scene, &tree, 0, &oracle, "teapot");
        }
    }
    assert!(compared > 20, "{compared} rays compared");
}

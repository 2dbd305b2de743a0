//! Trees that are hard to build or to walk.

use glam::{Affine3A, Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

use super::{
    meshes::{alone, soup},
    random::Random,
};
use crate::bvh::{
    Aggregate, BuildOptions, Builder, Counters, Instance, Levels, MAX_DEPTH, NodeEvent, Ray,
    TreeRef, Visitor, WideBox,
};

/// Depth of the deepest leaf.
fn depth(nodes: &[Bvh2Node]) -> usize {
    let mut depths = vec![0; nodes.len()];
    let mut deepest = 0;
    for (index, node) in nodes.iter().enumerate() {
        deepest = deepest.max(depths[index]);
        if !node.is_leaf() {
            let child = node.first_index as usize;
            assert!(child > index, "children stand behind their parents");
            (depths[child], depths[child + 1]) = (depths[index] + 1, depths[index] + 1);
        }
    }
    deepest
}

fn ways() -> impl Iterator<Item = BuildOptions> {
    [Builder::Median, Builder::Sah, Builder::Ploc]
        .into_iter()
        .flat_map(|builder| {
            [Levels::One, Levels::Two].map(|levels| BuildOptions {
                builder,
                levels,
                ..BuildOptions::default()
            })
        })
}

#[test]
fn a_hundred_thousand_identical_triangles_are_hit_as_the_first_of_them() {
    let one = [Vec3::ZERO, Vec3::X, Vec3::Y];
    for options in ways() {
        let scene = alone(soup(vec![one; 100_000]), &options);
        let tree = if options.levels == Levels::One {
            scene.tree()
        } else {
            scene.instances()[0].mesh.tree()
        };
        let deepest = depth(&tree.nodes);
        assert!(deepest <= MAX_DEPTH, "{options:?}: depth {deepest}");
        let mut random = Random::new(1);
        for _ in 0..20 {
            let target = Vec3::new(random.unit() * 0.5, random.unit() * 0.5, 0.0);
            let hit = scene.closest_hit(&Ray::new(Vec3::Z, target - Vec3::Z));
            assert_eq!(hit.map(|h| h.triangle), Some(0), "{options:?}");
            assert!(scene.occluded(&Ray::new(Vec3::Z, target - Vec3::Z)));
        }
    }
}

#[test]
fn a_hundred_thousand_equally_spaced_triangles_in_a_row_are_each_found() {
    let at = |i: u32| Vec3::X * (i * 2) as f32;
    let row = || (0..100_000).map(|i| [at(i), at(i) + Vec3::X, at(i) + Vec3::Y]);
    for options in ways() {
        let scene = alone(soup(row()), &options);
        let mut counters = Counters::default();
        for i in 0..100_000 {
            let from = at(i) + Vec3::new(0.25, 0.25, 3.0);
            let hit = scene.closest_hit_with(&Ray::new(from, -Vec3::Z), &mut counters);
            assert_eq!(hit.map(|h| h.triangle), Some(i), "{options:?}");
        }
        let triangles = counters.triangles as f64 / 1e5;
        assert!(
            triangles < 100.0,
            "{options:?}: {triangles} triangles tested a ray"
        );
        // Along the whole row.
        let along = Ray::new(Vec3::new(-5.0, 0.25, 0.0), Vec3::new(1.0, 0.0, 1e-9));
        let _ = scene.closest_hit(&along);
    }
}

/// A chain: every inner node has a leaf and the rest of the chain, both of which the ray enters.
pub(super) fn chain(levels: usize, leaf_first: bool) -> Vec<Bvh2Node> {
    let bounds = Aabb::new(Vec3A::splat(-1.0), Vec3A::splat(1.0));
    let mut nodes = vec![Bvh2Node::new(bounds, 0, 1)];
    for level in 0..levels {
        let leaf = Bvh2Node::new(bounds, 1, level as u32);
        let rest = if level + 1 < levels {
            Bvh2Node::new(bounds, 0, nodes.len() as u32 + 2)
        } else {
            Bvh2Node::new(bounds, 1, levels as u32)
        };
        nodes.extend(if leaf_first {
            [leaf, rest]
        } else {
            [rest, leaf]
        });
    }
    nodes
}

/// Remembers every event, and what is on the stack.
#[derive(Default)]
struct Log {
    nodes: Vec<(TreeRef, u32, NodeEvent, f32)>,
    triangles: Vec<(u32, u32, bool)>,
    stack: Vec<(TreeRef, u32)>,
    /// How often something other than what was put there last came off the stack.
    out_of_turn: usize,
}

impl Visitor for Log {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, t_entry: f32) {
        self.nodes.push((tree, node, event, t_entry));
        if self.stack.contains(&(tree, node)) {
            self.out_of_turn += usize::from(self.stack.pop() != Some((tree, node)));
        }
    }

    fn waits(&mut self, tree: TreeRef, node: u32, _: f32) {
        self.stack.push((tree, node));
    }

    fn triangle(&mut self, instance: u32, triangle: u32, hit: bool) {
        self.triangles.push((instance, triangle, hit));
    }
}

/// The boxes of a tree's wide form.
fn boxes(scene: &Aggregate, tree: TreeRef) -> Vec<WideBox> {
    match tree {
        TreeRef::Top => scene.wide_boxes(),
        TreeRef::Mesh(i) => scene.instances()[i as usize].mesh.wide_boxes(),
    }
}

/// A knot where it is, and again, turned.
fn two_of(options: &BuildOptions) -> Aggregate {
    let scene = alone(super::meshes::scatter(2_000, 0.1, 8), options);
    let mesh = scene.instances()[0].mesh.clone();
    let turned = Affine3A::from_rotation_y(0.7) * Affine3A::from_translation(Vec3::X * 0.8);
    let places = [Affine3A::IDENTITY, turned];
    let instances = places.map(|place| Instance::new(mesh.clone(), &place).unwrap());
    Aggregate::build(instances.to_vec(), options)
}

#[test]
fn a_visitor_hears_once_of_every_box_and_triangle_that_is_tested_and_changes_nothing() {
    for options in ways() {
        for scene in [
            alone(super::meshes::scatter(2_000, 0.1, 8), &options),
            two_of(&options),
        ] {
            let mut random = Random::new(31);
            let mut pruned = 0;
            for _ in 0..300 {
                let origin = random.cube() * 2.0;
                let ray = Ray::new(origin, random.cube() - origin);
                let mut log = Log::default();
                let hit = scene.closest_hit_with(&ray, &mut log);
                assert_eq!(hit, scene.closest_hit(&ray));
                pruned += heard(&scene, &options, &log);
                for &(_, _, event, t_entry) in &log.nodes {
                    if event == NodeEvent::Pruned {
                        let t = hit.expect("only a hit prunes here").t;
                        assert!(t_entry > t, "{options:?}: pruned at {t_entry}, hit at {t}");
                    }
                }
                let last = log.triangles.iter().rfind(|t| t.2).map(|t| (t.0, t.1));
                assert_eq!(last, hit.map(|h| (h.instance, h.triangle)), "{options:?}");
                let mut counters = Counters::default();
                assert_eq!(hit, scene.closest_hit_with(&ray, &mut counters));
                let counted = [counters.boxes, counters.triangles].map(|n| n as usize);
                let told = [log.nodes.len(), log.triangles.len()];
                assert_eq!(counted, told, "{options:?}: boxes and triangles counted");
            }
            assert!(pruned > 100, "{options:?}: only {pruned} nodes pruned");
        }
    }
}

/// Checks what a nearest hit's visitor was told; how many nodes were pruned.
fn heard(scene: &Aggregate, options: &BuildOptions, log: &Log) -> usize {
    let mut told: Vec<_> = log
        .nodes
        .iter()
        .map(|e| (format!("{:?}", e.0), e.1))
        .collect();
    told.sort();
    let events = told.len();
    told.dedup();
    assert_eq!(told.len(), events, "{options:?}: a node was told of twice");
    assert_eq!(log.out_of_turn, 0, "{options:?}: nodes out of turn");
    assert!(
        log.stack.is_empty(),
        "{options:?}: {:?} are left",
        log.stack
    );
    let (mut triangles, mut expected) = (0, 0);
    let mut trees: Vec<TreeRef> = Vec::new();
    for &(of, node, event, _) in &log.nodes {
        if !trees.contains(&of) {
            // The root comes first, and untested.
            assert_eq!(
                (node, event),
                (0, NodeEvent::Entered),
                "{options:?}: {of:?}"
            );
            trees.push(of);
            expected += 1;
        }
        if event != NodeEvent::Entered {
            continue;
        }
        let tree = match of {
            TreeRef::Top => scene.tree(),
            TreeRef::Mesh(i) => scene.instances()[i as usize].mesh.tree(),
        };
        let boxes = boxes(scene, of);
        let here = boxes.iter().find(|b| b.node == node).expect("a wide box");
        if here.is_leaf {
            let in_mesh = of != TreeRef::Top || options.levels == Levels::One;
            let below = crate::bvh::primitives_below(tree, node as usize).len();
            triangles += if in_mesh { below } else { 0 };
        } else {
            let mut pending = vec![tree.nodes[node as usize].first_index];
            while let Some(left) = pending.pop() {
                for child in [left, left + 1] {
                    if boxes.iter().any(|b| b.node == child) {
                        expected += 1;
                        let is_told = log.nodes.iter().any(|e| (e.0, e.1) == (of, child));
                        assert!(is_told, "{options:?}: nothing of child {child} of {node}");
                    } else {
                        pending.push(tree.nodes[child as usize].first_index);
                    }
                }
            }
        }
    }
    assert_eq!(events, expected, "{options:?}: boxes of the entered nodes");
    let tested = log.triangles.len();
    assert_eq!(
        tested, triangles,
        "{options:?}: triangles of the entered leaves"
    );
    log.nodes
        .iter()
        .filter(|e| e.2 == NodeEvent::Pruned)
        .count()
}

//! Trees that are hard to build or to walk.

use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::node::Bvh2Node};

use super::{
    meshes::{alone, soup},
    random::Random,
};
use crate::bvh::{
    BuildOptions, Builder, Counters, Levels, MAX_DEPTH, NodeEvent, Ray, TreeRef, Visitor,
    slab::SlabRay,
    traverse::{EMPTY, walk},
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

#[test]
fn a_tree_as_deep_as_any_is_walked_to_its_last_leaf() {
    for leaf_first in [true, false] {
        let nodes = chain(MAX_DEPTH, leaf_first);
        assert_eq!(depth(&nodes), MAX_DEPTH);
        let slab = SlabRay::new(Vec3A::ZERO, Vec3A::new(0.3, 0.4, 0.5), 0.5, 0.0);
        let mut seen = vec![0; MAX_DEPTH + 1];
        walk(
            &nodes,
            &mut EMPTY.clone(),
            &slab,
            (0.0, f32::INFINITY),
            TreeRef::Top,
            &mut (),
            |first, count, limit, _| {
                assert_eq!(count, 1);
                seen[first as usize] += 1;
                limit
            },
        );
        assert!(
            seen.iter().all(|&n| n == 1),
            "leaves were walked {seen:?} times"
        );
    }
}

/// Remembers every event.
#[derive(Default)]
struct Log(Vec<(TreeRef, u32, NodeEvent, f32)>, Vec<(u32, u32, bool)>);

impl Visitor for Log {
    fn node(&mut self, tree: TreeRef, node: u32, event: NodeEvent, t_entry: f32) {
        self.0.push((tree, node, event, t_entry));
    }

    fn triangle(&mut self, instance: u32, triangle: u32, hit: bool) {
        self.1.push((instance, triangle, hit));
    }
}

#[test]
fn a_visitor_hears_once_of_every_node_it_should_and_changes_nothing() {
    for options in ways() {
        let scene = alone(super::meshes::scatter(2_000, 0.1, 8), &options);
        let tree = |tree| match tree {
            TreeRef::Top => scene.tree(),
            TreeRef::Mesh(i) => scene.instances()[i as usize].mesh.tree(),
        };
        let mut random = Random::new(31);
        let mut pruned = 0;
        for _ in 0..2_000 {
            let origin = random.cube() * 2.0;
            let ray = Ray::new(origin, random.cube() - origin);
            let mut log = Log::default();
            let hit = scene.closest_hit_with(&ray, &mut log);
            assert_eq!(hit, scene.closest_hit(&ray));
            let mut told: Vec<_> = log.0.iter().map(|e| (format!("{:?}", e.0), e.1)).collect();
            told.sort();
            let events = told.len();
            told.dedup();
            assert_eq!(told.len(), events, "{options:?}: a node was told of twice");
            let mut triangles = 0;
            for &(of, node, event, t_entry) in &log.0 {
                let node = tree(of).nodes[node as usize];
                match event {
                    NodeEvent::Entered if node.is_leaf() => {
                        let in_mesh = of != TreeRef::Top || options.levels == Levels::One;
                        triangles += if in_mesh { node.prim_count as usize } else { 0 };
                    }
                    NodeEvent::Entered => {
                        for child in [node.first_index, node.first_index + 1] {
                            let heard = log.0.iter().any(|e| (e.0, e.1) == (of, child));
                            assert!(
                                heard,
                                "{options:?}: nothing of child {child} of an entered node"
                            );
                        }
                    }
                    NodeEvent::Pruned => {
                        pruned += 1;
                        let t = hit.expect("only a hit prunes here").t;
                        assert!(t_entry > t, "{options:?}: pruned at {t_entry}, hit at {t}");
                    }
                    NodeEvent::Missed => {}
                }
            }
            assert_eq!(
                log.1.len(),
                triangles,
                "{options:?}: triangles of the entered leaves"
            );
            let last = log.1.iter().rfind(|t| t.2).map(|t| (t.0, t.1));
            assert_eq!(last, hit.map(|h| (h.instance, h.triangle)), "{options:?}");
        }
        assert!(pruned > 100, "{options:?}: only {pruned} nodes pruned");
    }
}

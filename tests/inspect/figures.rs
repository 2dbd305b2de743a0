//! What the panels say of a tree, against counts by walks that share nothing with them.

use super::Scene;
use glam::{DVec3, UVec2, Vec3};
use glassbox::bvh::{Aggregate, Builder, COST_INTERSECT, COST_TRAVERSE, Levels, Primitive};
use glassbox::inspect::{BuilderFigures, compare_builders, csv, markdown, trees};
use glassbox::scene;
use obvhs::bvh2::Bvh2;

const BUILDERS: [Builder; 4] = [Builder::None, Builder::Median, Builder::Sah, Builder::Ploc];

/// The head under one tree over all triangles.
fn head(builder: Builder) -> Scene {
    use glassbox::app::headless_app;
    use glassbox::io::builtin;
    let mut app = headless_app();
    (builtin::find("head").unwrap().spawn)(app.world_mut());
    let mut settings = app.world_mut().resource_mut::<scene::RenderSettings>();
    settings.size = UVec2::new(32, 32);
    settings.tree.levels = scene::Levels::One;
    settings.tree.builder = match builder {
        Builder::None => scene::Builder::None,
        Builder::Median => scene::Builder::Median,
        Builder::Sah => scene::Builder::Sah,
        Builder::Ploc => scene::Builder::Ploc,
    };
    app.update();
    let world = app.world();
    let cameras = world.resource::<glassbox::sync::TracedCameras>();
    Scene {
        world: (*world.resource::<glassbox::sync::Traced>().world).clone(),
        camera: cameras.0[0].camera.clone(),
        settings: world.resource::<scene::RenderSettings>().clone(),
    }
}

/// What a recursive walk finds.
#[derive(Default)]
struct Walk {
    nodes: usize,
    leaves: Vec<(usize, usize)>,
    sah: f64,
    /// For each node, in the order of the walk: its index, its cost, and its primitives' places.
    parts: Vec<(usize, f64, Vec<usize>)>,
}

impl Walk {
    fn visit(&mut self, tree: &Bvh2, node: usize, depth: usize, root_area: f64) -> Vec<usize> {
        let here = &tree.nodes[node];
        self.nodes += 1;
        let (min, max) = (here.min.as_dvec3(), here.max.as_dvec3());
        let side = max - min;
        let area = 2.0 * (side.x * side.y + side.y * side.z + side.z * side.x);
        let root_area = if depth == 0 { area } else { root_area };
        let first = here.first_index as usize;
        let (cost, places) = if here.prim_count > 0 {
            let count = here.prim_count as usize;
            self.leaves.push((depth, count));
            let places: Vec<usize> = (first..first + count).collect();
            (count as f64 * f64::from(COST_INTERSECT), places)
        } else {
            let mut places = self.visit(tree, first, depth + 1, root_area);
            places.extend(self.visit(tree, first + 1, depth + 1, root_area));
            (f64::from(COST_TRAVERSE), places)
        };
        self.sah += cost * area / root_area;
        self.parts.push((node, cost, places.clone()));
        places
    }

    fn of(tree: &Bvh2) -> Self {
        let mut walk = Self::default();
        walk.visit(tree, 0, 0, 1.0);
        walk
    }
}

/// The corners in the world of what stands at each place of the leaf order.
fn corners(aggregate: &Aggregate) -> Vec<[Vec3; 3]> {
    (0..)
        .map_while(|place| aggregate.primitive(place))
        .map(|primitive| match primitive {
            Primitive::Triangle { instance, triangle } => {
                let instance = &aggregate.instances()[instance as usize];
                let corners = instance.mesh.triangles().corners(triangle);
                corners.map(|corner| instance.to_world_point(corner))
            }
            Primitive::Instance(_) => panic!("one level holds triangles"),
        })
        .collect()
}

/// Area of the part of a triangle inside a box: cut by one plane after the other.
fn area_inside(corners: [Vec3; 3], min: DVec3, max: DVec3) -> f64 {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    let apart = a.min(b).min(c).cmpgt(max) | a.max(b).max(c).cmplt(min);
    if apart.any() {
        return 0.0;
    }
    let mut polygon: Vec<DVec3> = corners.iter().map(|corner| corner.as_dvec3()).collect();
    for axis in 0..3 {
        for (sign, limit) in [(1.0, min[axis]), (-1.0, -max[axis])] {
            let height = |p: &DVec3| sign * p[axis] - limit;
            let mut kept = Vec::new();
            for i in 0..polygon.len() {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                let (ha, hb) = (height(&a), height(&b));
                if ha >= 0.0 {
                    kept.push(a);
                }
                if (ha >= 0.0) != (hb >= 0.0) {
                    kept.push(a + (b - a) * (ha / (ha - hb)));
                }
            }
            polygon = kept;
        }
    }
    let mut area = DVec3::ZERO;
    for i in 1..polygon.len().max(1) - 1 {
        area += (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
    }
    0.5 * area.length()
}

#[test]
fn levels_nodes_leaves_histograms_sah_and_epo_are_what_a_plain_walk_finds() {
    for builder in BUILDERS {
        let scene = head(builder);
        let figures = BuilderFigures::of(&scene.world);
        let aggregate = &scene.world.aggregate;
        let walk = Walk::of(aggregate.tree());
        let what = format!("{builder:?}: {figures:?}");
        assert_eq!(figures.nodes, walk.nodes, "{what}");
        assert_eq!(figures.leaves, walk.leaves.len(), "{what}");
        let deepest = walk.leaves.iter().map(|leaf| leaf.0).max().unwrap();
        let largest = walk.leaves.iter().map(|leaf| leaf.1).max().unwrap();
        assert_eq!(figures.levels as usize, deepest, "{what}");
        assert_eq!(figures.largest_leaf as usize, largest, "{what}");
        for (depth, &count) in figures.depths.iter().enumerate() {
            let found = walk.leaves.iter().filter(|leaf| leaf.0 == depth).count();
            assert_eq!(count as usize, found, "depth {depth} of {what}");
        }
        for (size, &count) in figures.leaf_sizes.iter().enumerate() {
            let found = walk
                .leaves
                .iter()
                .filter(|leaf| leaf.1.min(256) == size)
                .count();
            assert_eq!(count as usize, found, "size {size} of {what}");
        }
        let triangles: usize = walk.leaves.iter().map(|leaf| leaf.1).sum();
        assert_eq!(figures.triangles as usize, triangles, "{what}");
        let error = (figures.sah_cost / walk.sah - 1.0).abs();
        assert!(error < 1e-6, "{what}: SAH {} by the walk", walk.sah);

        let corners = corners(aggregate);
        assert_eq!(corners.len(), triangles);
        let area: f64 = corners
            .iter()
            .map(|&t| area_inside(t, DVec3::MIN, DVec3::MAX))
            .sum();
        let mut epo = 0.0;
        for (node, cost, places) in &walk.parts {
            let node = &aggregate.tree().nodes[*node];
            let (min, max) = (node.min.as_dvec3(), node.max.as_dvec3());
            let mut own = vec![false; corners.len()];
            places.iter().for_each(|&place| own[place] = true);
            let foreign = corners.iter().zip(&own).filter(|(_, own)| !**own);
            epo += cost * foreign.map(|(t, _)| area_inside(*t, min, max)).sum::<f64>() / area;
        }
        assert!(
            (figures.epo - epo).abs() < 1e-6 * epo.max(1e-3),
            "{what}: EPO {epo} by the walk"
        );
    }
}

#[test]
fn every_builder_and_both_forms_of_levels_hold_the_same_triangles() {
    let mut all = Vec::new();
    for builder in BUILDERS {
        let scene = head(builder);
        let aggregate = &scene.world.aggregate;
        assert_eq!(aggregate.options().levels, Levels::One);
        let mut held: Vec<(u32, u32)> = trees(&scene.world)
            .flat_map(|view| {
                let leaves = view.leaves();
                leaves
                    .into_iter()
                    .flat_map(move |leaf| view.triangles(leaf))
            })
            .collect();
        held.sort_unstable();
        all.push(held);
    }
    let two = Scene::open("head", UVec2::ONE);
    let mut held: Vec<(u32, u32)> = trees(&two.world)
        .flat_map(|view| {
            let leaves = view.leaves();
            leaves
                .into_iter()
                .flat_map(move |leaf| view.triangles(leaf))
        })
        .collect();
    held.sort_unstable();
    assert!(held.len() > 1000);
    for other in &all {
        assert_eq!(other, &held);
    }
}

#[test]
fn the_facts_of_a_node_are_those_of_the_walk_and_costs_add_up_to_the_trees() {
    let scene = head(Builder::Sah);
    let view = trees(&scene.world).next().unwrap();
    let walk = Walk::of(view.tree);
    let mut sum = 0.0;
    for (node, _, places) in walk.parts.iter().step_by(37) {
        let facts = view.facts(*node as u32).unwrap();
        assert_eq!(facts.primitives as usize, places.len());
        assert!(view.path(places[0]).contains(&(*node as u32)));
        assert_eq!(view.path(places[0])[facts.depth as usize], *node as u32);
    }
    for node in 0..view.tree.nodes.len() {
        sum += glassbox::bvh::node_cost(view.tree, node);
    }
    assert!(
        (sum / walk.sah - 1.0).abs() < 1e-6,
        "{sum} and {}",
        walk.sah
    );
    assert_eq!(view.facts(view.tree.nodes.len() as u32), None);
}

#[test]
fn the_builders_are_compared_with_rates_and_the_tables_hold_every_figure() {
    let scene = Scene::open("cornell-box", UVec2::new(40, 40));
    let rows = compare_builders(
        &scene.world,
        &BUILDERS,
        Some((&scene.camera, &scene.settings)),
    );
    let names: Vec<&str> = rows.iter().map(|row| row.builder).collect();
    assert_eq!(names, ["none", "median", "sah", "ploc"]);
    for row in &rows {
        let rates = row.rates.expect("rates were asked for");
        for rate in [rates.closest_mrays_per_s, rates.occlusion_mrays_per_s] {
            assert!(
                rate.is_some_and(|rate| rate > 0.0 && rate.is_finite()),
                "{row:?}"
            );
        }
    }
    let (table, text) = (csv(&rows), markdown(&rows));
    assert_eq!(table.lines().count(), 5, "{table}");
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(
        table.lines().all(|line| line.split(',').count() == columns),
        "{table}"
    );
    for row in &rows {
        assert!(text.contains(&row.nodes.to_string()), "{text}");
        assert!(table.contains(&format!("{:.3}", row.epo)), "{table}");
    }
    // Both histograms add up to the leaves, in every column.
    for (i, row) in rows.iter().enumerate() {
        let histograms = text.split("Leaves by their ").skip(1).map(|part| {
            let lines = part.lines().filter(|line| line.starts_with("| "));
            lines
                .skip(1)
                .map(|line| {
                    line.split('|')
                        .nth(i + 2)
                        .unwrap()
                        .trim()
                        .parse::<usize>()
                        .unwrap()
                })
                .sum::<usize>()
        });
        assert_eq!(histograms.collect::<Vec<_>>(), [row.leaves; 2], "{text}");
    }
    let without = compare_builders(&scene.world, &[Builder::Sah], None);
    assert_eq!(without[0].rates, None);
    assert_eq!(without[0].sah_cost, rows[2].sah_cost);
}

#[test]
fn an_empty_world_has_trees_without_nodes_and_no_rates() {
    let world = glassbox::trace::World::default();
    let camera = glassbox::trace::Camera::looking_at(Vec3::Z, Vec3::ZERO, Vec3::Y, 1.0);
    let settings = scene::RenderSettings {
        size: UVec2::new(8, 8),
        ..Default::default()
    };
    let rows = compare_builders(&world, &BUILDERS, Some((&camera, &settings)));
    for row in rows {
        assert_eq!((row.nodes, row.triangles), (0, 0));
        assert_eq!(
            row.rates.and_then(|rates| rates.occlusion_mrays_per_s),
            None
        );
    }
}

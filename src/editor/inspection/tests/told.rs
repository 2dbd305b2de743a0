//! What lines stand for.

use super::Bench;
use crate::bvh::node_cost;
use crate::inspect::{InspectSettings, Names, Stands, System, TreeView, node_told, tell};
use crate::sync::Traced;

#[test]
fn a_node_is_told_with_the_figures_of_its_tree() {
    let bench = Bench::open("cornell-box");
    let world = &bench.app.world().resource::<Traced>().world;
    let names = bench.app.world().resource::<Names>();
    let top = world.aggregate.tree();
    let told = node_told(world, None, 0, names).unwrap();
    let figure = |name: &str| {
        let found = told.figures.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| value.as_str()).unwrap_or_default()
    };
    assert_eq!(told.title, "Node 0");
    assert_eq!(figure("level"), "0");
    assert_eq!(figure("holds"), format!("{} objects", world.objects.len()));
    let part = 100.0 * node_cost(top, 0) / crate::bvh::sah_cost(top);
    assert!(figure("SAH").starts_with(&format!("{part:.2} %")));
    let tree = TreeView::of(world, None).unwrap();
    let holds_one = |node: &u32| tree.facts(*node).is_some_and(|facts| facts.primitives == 1);
    let leaf = (0..top.nodes.len() as u32).find(holds_one).unwrap();
    let told = node_told(world, None, leaf, names).unwrap();
    assert!(told.figures.contains(&("holds", "1 object".to_owned())));
    assert_eq!(node_told(world, None, u32::MAX, names), None);
    assert_eq!(node_told(world, Some(u32::MAX), 0, names), None);
}

#[test]
fn whatever_is_drawn_can_be_told_of_and_what_is_gone_cannot() {
    let mut bench = Bench::open("cornell-box");
    bench.shoot([300, 240]);
    let rays = bench.ray().rays().unwrap().clone();
    let world = bench.app.world();
    let (traced, names) = (world.resource::<Traced>(), world.resource::<Names>());
    let inspect = InspectSettings::default();
    let told = |stands| {
        let stands = (stands, System::Rays);
        tell(stands, &traced.world, Some(&rays), &inspect, names)
    };
    for index in 0..rays.rays.len() as u32 {
        let told = told(Stands::Ray(index)).unwrap();
        assert!(
            told.figures.iter().any(|(name, _)| *name == "cost"),
            "{told:?}"
        );
    }
    let triangle = |instance, triangle| Stands::Triangle { instance, triangle };
    assert!(told(triangle(0, 0)).is_some());
    assert_eq!(told(triangle(0, u32::MAX)), None);
    assert_eq!(told(triangle(u32::MAX, 0)), None);
    assert_eq!(told(Stands::Ray(u32::MAX)), None);
    let lamp = traced.world.lights.points[0].id;
    assert_eq!(told(Stands::Light(lamp)).unwrap().title, names.of(lamp));
}

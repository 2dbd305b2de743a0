//! What a line stands for, in words and numbers.

use super::column::{color_text, meets, metres, vector_text};
use super::lit::view;
use super::names::Names;
use crate::bvh::Levels;
use crate::inspect::{InspectSettings, NodeFacts, Stands, System, TreeForm};
use crate::trace::{RayTree, World};
use bevy::math::Vec3;

/// A heading, and figures with what they are called.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::editor) struct Told {
    pub title: String,
    pub figures: Vec<(&'static str, String)>,
}

impl Told {
    fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            figures: Vec::new(),
        }
    }

    fn and(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.figures.push((name, value.into()));
        self
    }

    /// With its way from time 0 to 1, what it hangs below included, where it has one.
    fn moving(self, velocity: Vec3) -> Self {
        if velocity == Vec3::ZERO {
            return self;
        }
        self.and("moves", format!("{} m", vector_text(velocity)))
    }
}

/// What is known of what a line of a system stands for; `None` where it is gone.
pub(in crate::editor) fn tell(
    (stands, system): (Stands, System),
    world: &World,
    rays: Option<&RayTree>,
    inspect: &InspectSettings,
    names: &Names,
) -> Option<Told> {
    match stands {
        Stands::Node { instance, .. }
            if system == System::Boxes && inspect.boxes.form == TreeForm::Wide =>
        {
            let tree = tree_name(world, instance, names)?;
            Some(Told::new("Box of the wide form").and("tree", tree))
        }
        Stands::Node { instance, node } => node_told(world, instance, node, names),
        Stands::Ray(ray) => ray_told(rays?, ray, names),
        Stands::Triangle { instance, triangle } => {
            let object = world.objects.get(instance as usize)?;
            let of = world.aggregate.instances().get(instance as usize)?;
            let known = (triangle as usize) < of.mesh.triangles().len();
            let [a, b, c] = known.then(|| {
                let corners = of.mesh.triangles().corners(triangle);
                corners.map(|corner| of.to_world_point(corner))
            })?;
            let area = 0.5 * (b - a).cross(c - a).length();
            Some(
                Told::new(format!("Triangle {triangle}"))
                    .and("of", names.of(object.id))
                    .and("area", format!("{area:.3e} m²"))
                    .and("corners", [a, b, c].map(vector_text).join("\n")),
            )
        }
        Stands::Object(id) => {
            let place = world.objects.binary_search_by_key(&id, |object| object.id);
            let instance = world.aggregate.instances().get(place.ok()?)?;
            Some(Told::new(names.of(id)).moving(instance.velocity()))
        }
        Stands::Light(id) => Some(Told::new(names.of(id)).moving(world.lights.velocity(id))),
        Stands::Camera => Some(Told::new("Camera")),
    }
}

/// Of which tree a node is, in words.
pub(in crate::editor) fn tree_name(
    world: &World,
    instance: Option<u32>,
    names: &Names,
) -> Option<String> {
    Some(match instance {
        None if world.aggregate.options().levels == Levels::One => {
            "the tree of all triangles".into()
        }
        None => "the top tree".into(),
        Some(instance) => names.of(world.objects.get(instance as usize)?.id),
    })
}

/// Everything about a node. Looks at the whole tree: not for every frame.
pub(in crate::editor) fn node_told(
    world: &World,
    instance: Option<u32>,
    node: u32,
    names: &Names,
) -> Option<Told> {
    let facts = view(world, instance)?.facts(node)?;
    let NodeFacts {
        depth,
        bounds: [min, max],
        children,
        primitives,
        cost,
        tree_cost,
    } = facts;
    let two = world.aggregate.options().levels == Levels::Two;
    let what = match (instance, two) {
        (None, true) => "objects",
        _ => "triangles",
    };
    let part = 100.0 * cost / tree_cost.max(f64::MIN_POSITIVE);
    let children = match children {
        Some([left, right]) => format!("{left} and {right}"),
        None => "none: a leaf".into(),
    };
    let space = match instance {
        Some(_) => "in the object's space",
        None => "in the world",
    };
    Some(
        Told::new(format!("Node {node}"))
            .and("tree", tree_name(world, instance, names)?)
            .and("level", depth.to_string())
            .and("children", children)
            .and("holds", format!("{primitives} {what}"))
            .and("SAH", format!("{part:.2} % of the tree's {tree_cost:.2}"))
            .and("from", vector_text(min))
            .and("to", format!("{} {space}", vector_text(max))),
    )
}

fn ray_told(rays: &RayTree, index: u32, names: &Names) -> Option<Told> {
    let ray = rays.rays.get(index as usize)?;
    let mut end = ray.end.name().to_owned();
    let met = meets(ray, names);
    if !met.is_empty() {
        end += &format!(": {met}");
    }
    let mut told = Told::new(format!("{} ray {index}", ray.kind.name()));
    if let Some(from) = ray.from {
        told = told.and("from", names.of(from));
    }
    told = told.and("end", end);
    if let Some(t) = metres(ray) {
        told = told.and("t", format!("{t:.4} m"));
    }
    if let Some(hit) = &ray.hit {
        told = told.and("triangle", hit.triangle.to_string());
    }
    if ray.kind.is_for_light() {
        told = told.and("transmitted", color_text(ray.transmittance));
    }
    let cost = ray.cost;
    Some(
        told.and("brings", color_text(ray.radiance))
            .and("adds", color_text(ray.added))
            .and(
                "cost",
                format!(
                    "{} nodes, {} boxes, {} triangles",
                    cost.nodes, cost.boxes, cost.triangles
                ),
            ),
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::Bench;
    use super::*;
    use crate::bvh::node_cost;
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
}

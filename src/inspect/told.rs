//! What a line stands for, in words and numbers.

use super::column::{color_text, meets, metres, vector_text};
use super::count::{cost_text, counted};
use super::{
    InspectSettings, Names, NodeFacts, Stands, System, TreeForm, TreeView, triangle_in_world,
};
use crate::bvh::Levels;
use crate::trace::{RayTree, World};
use glam::Vec3;

/// A heading, and figures with what they are called.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    /// What it is.
    pub title: String,
    /// What is known of it.
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
pub fn tell(
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
            let [a, b, c] = triangle_in_world(world, instance, triangle)?;
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
pub fn tree_name(world: &World, instance: Option<u32>, names: &Names) -> Option<String> {
    Some(match instance {
        None if world.aggregate.options().levels == Levels::One => {
            "the tree of all triangles".into()
        }
        None => "the top tree".into(),
        Some(instance) => names.of(world.objects.get(instance as usize)?.id),
    })
}

/// Everything about a node. Looks at the whole tree: not for every frame.
pub fn node_told(world: &World, instance: Option<u32>, node: u32, names: &Names) -> Option<Told> {
    let view = TreeView::of(world, instance)?;
    let facts = view.facts(node)?;
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
        (None, true) => "object",
        _ => "triangle",
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
            .and("holds", counted(primitives.into(), what))
            .and("size", size_text(&view.corners(node)))
            .and("SAH", format!("{part:.2} % of the tree's {tree_cost:.2}"))
            .and("from", vector_text(min))
            .and("to", format!("{} {space}", vector_text(max))),
    )
}

/// How long the three edges of a box are, in the world.
fn size_text(corners: &[Vec3; 8]) -> String {
    let [x, y, z] = [1, 2, 4].map(|corner: usize| corners[corner].distance(corners[0]));
    format!("{x:.3} × {y:.3} × {z:.3} m")
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
            .and("cost", cost_text(&cost)),
    )
}

//! All that is known of a picked pixel, as one JSON document.

use super::column::color_text;
use super::explain::{Source, sources};
use super::{LineSet, Pattern, Traversal};
use crate::scene::{RenderSettings, SETTINGS};
use crate::trace::{DOME, Dome, Lights, RayTree, TracedRay, World};
use glam::{UVec2, Vec3};
use serde::Serialize;
use std::collections::BTreeMap;

/// What the counters of rays count.
const COUNTERS: &str =
    "the walk that traces pictures, ray by ray, through the wide form of the trees";

/// The document. Vectors are arrays; numbers that are not finite are `null` (a ray without an end).
#[derive(Serialize)]
pub struct Document<'a> {
    /// The scene as it was asked for.
    pub scene: &'a str,
    /// The camera's name.
    pub camera: &'a str,
    /// Columns and rows of the picture.
    pub size: UVec2,
    /// Every render setting, by its path.
    pub settings: BTreeMap<&'static str, String>,
    /// What [`RayCost`](crate::trace::RayCost) counts.
    pub counters: &'static str,
    /// The mean of the samples' values, linear RGB.
    pub value: Vec3,
    /// What the rays of each sample add up to: equal to its value, bit for bit.
    pub sums: Vec<Vec3>,
    /// Samples and rays.
    #[serde(flatten)]
    pub rays: &'a RayTree,
    /// Where the value comes from, and how much of its spread over the samples.
    pub sources: Vec<Source>,
    /// The lights, by kind.
    pub lights: &'a Lights,
    /// What a ray carries that meets nothing, where there is no map.
    pub background: Vec3,
    /// What the camera's own rays carry instead, where the environment is hidden from it.
    pub backdrop: Option<Vec3>,
    /// Whether the environment lights, as the light number 0.
    pub environment_lights: bool,
    /// Names of objects and lights, by their `SceneId`.
    pub names: &'a BTreeMap<u64, String>,
    /// What is drawn.
    pub lines: &'a [LineSet],
    /// Where samples lie, if asked for.
    pub pattern: Option<&'a Pattern>,
    /// A ray's way through the trees, if asked for.
    pub traversal: Option<&'a Traversal>,
}

impl<'a> Document<'a> {
    /// The document without lines, pattern and traversal: add those.
    pub fn new(
        (scene, camera): (&'a str, &'a str),
        world: &'a World,
        settings: &RenderSettings,
        rays: &'a RayTree,
        names: &'a BTreeMap<u64, String>,
    ) -> Self {
        Self {
            scene,
            camera,
            size: settings.size,
            settings: SETTINGS
                .iter()
                .map(|setting| (setting.path.as_str(), setting.value_text(settings)))
                .collect(),
            counters: COUNTERS,
            value: rays.mean(),
            sums: rays.sums(),
            rays,
            sources: sources(rays),
            lights: &world.lights,
            background: world.environment.background,
            backdrop: world.environment.backdrop,
            environment_lights: Dome::of(&world.environment, settings).is_some(),
            names,
            lines: &[],
            pattern: None,
            traversal: None,
        }
    }
}

/// A ray as a row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct RayLine {
    /// Index into the tree's rays.
    pub index: u32,
    /// Its cells, as [`Self::HEADER`] calls them.
    pub cells: [String; 9],
}

impl RayLine {
    /// Names of the columns.
    pub const HEADER: [&'static str; 9] = [
        "ray",
        "to",
        "t",
        "radiance",
        "adds",
        "transmitted",
        "nodes",
        "boxes",
        "triangles",
    ];

    /// The rays of one sample in depth-first order, children indented below their parents.
    pub fn of(tree: &RayTree, sample: u32, names: &BTreeMap<u64, String>) -> Vec<Self> {
        let mut children: Vec<Vec<u32>> = vec![Vec::new(); tree.rays.len()];
        let mut stack = Vec::new();
        for (index, ray) in (0..).zip(&tree.rays) {
            match ray.parent {
                _ if ray.sample != sample => {}
                Some(parent) => children[parent as usize].push(index),
                None => stack.push(index),
            }
        }
        stack.reverse();
        let mut lines = Vec::new();
        while let Some(index) = stack.pop() {
            lines.push(Self::new(index, &tree.rays[index as usize], names));
            stack.extend(children[index as usize].iter().rev());
        }
        lines
    }

    fn new(index: u32, ray: &TracedRay, names: &BTreeMap<u64, String>) -> Self {
        let name = |id: u64| named(names, id);
        let aim = ray.light.map(|light| name(light.id));
        let to = match (&aim, ray.hit, ray.met_light) {
            (Some(light), Some(hit), _) => {
                format!("{light}, {} by {}", ray.end.name(), name(hit.object))
            }
            (Some(light), None, _) => format!("{light}, {}", ray.end.name()),
            (None, Some(hit), _) => format!("{} triangle {}", name(hit.object), hit.triangle),
            (None, None, Some(light)) => name(light),
            (None, None, None) => "background".into(),
        };
        let metres = ray.t * ray.direction.length();
        let transmitted = match aim {
            Some(_) => color_text(ray.transmittance),
            None => "-".into(),
        };
        let cost = ray.cost;
        Self {
            index,
            cells: [
                format!(
                    "{}{} {index}",
                    "  ".repeat(ray.depth as usize),
                    ray.kind.name()
                ),
                to,
                if metres.is_finite() {
                    format!("{metres:.4}")
                } else {
                    "-".into()
                },
                color_text(ray.radiance),
                color_text(ray.added),
                transmitted,
                cost.nodes.to_string(),
                cost.boxes.to_string(),
                cost.triangles.to_string(),
            ],
        }
    }
}

/// What an object or a light is called, or what to call it by its number.
pub fn named(names: &BTreeMap<u64, String>, id: u64) -> String {
    match names.get(&id) {
        Some(name) if !name.is_empty() => name.clone(),
        _ if id == DOME => "Environment".into(),
        _ => format!("#{id}"),
    }
}

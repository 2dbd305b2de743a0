//! What a pixel's colour is mixed of, in one sentence: the surface's own colour, the light that it meets, and what it reflects
//! or lets through.

use super::document::named;
use super::explain::{Cause, Source, sources};
use super::noise::{met_name, percent};
use crate::trace::{RayEnd, RayKind, RayTree, TracedRay};
use glam::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Parts that are smaller are not named.
const LEAST: f32 = 0.01;
/// A light whose channels differ by less is white.
const WHITE: f32 = 0.05;

/// Why the pixel has its colour, as the mean of the samples that were traced.
pub(super) fn sentence(tree: &RayTree, names: &BTreeMap<u64, String>) -> String {
    let value = tree.mean();
    let sum = value.element_sum();
    if sum <= 0.0 {
        let why = super::answer::black(tree, names);
        return format!("It is black: {why}");
    }
    let mut parts = sources(tree);
    parts.retain(|part| part.mean.element_sum() >= LEAST * sum);
    parts.sort_by(|a, b| b.mean.element_sum().total_cmp(&a.mean.element_sum()));
    let cameras = tree.rays.iter().filter(|ray| ray.parent.is_none());
    let met: BTreeSet<String> = cameras.map(|ray| met_name(ray, names)).collect();
    let is_one = met.len() == 1;
    let of = Mixture {
        tree,
        names,
        is_one,
    };
    let clauses = parts.iter().map(|part| {
        let share = percent(f64::from(part.mean.element_sum() / sum));
        format!("{} ({share})", of.clause(part))
    });
    let clauses: Vec<String> = clauses.collect();
    format!(
        "It is {}: {} {}.",
        color(value),
        of.surfaces(),
        clauses.join(", ")
    )
}

struct Mixture<'a> {
    tree: &'a RayTree,
    names: &'a BTreeMap<u64, String>,
    /// Whether all samples see the same.
    is_one: bool,
}

impl Mixture<'_> {
    fn cameras(&self) -> impl Iterator<Item = &TracedRay> {
        self.tree.rays.iter().filter(|ray| ray.parent.is_none())
    }

    /// What is seen, and its own colour.
    fn surfaces(&self) -> String {
        let mut met: BTreeMap<String, (Vec3, f32)> = BTreeMap::new();
        for camera in self.cameras() {
            let of = met.entry(met_name(camera, self.names)).or_default();
            of.0 += camera.hit.map_or(Vec3::ZERO, |hit| hit.diffuse);
            of.1 += 1.0;
        }
        let described = met.into_iter().map(|(name, (diffuse, count))| {
            let share = percent(f64::from(count / self.tree.samples.len() as f32));
            let seen = if self.is_one {
                name
            } else {
                format!("{name} ({share} of the pixel)")
            };
            match diffuse.max_element() > 0.0 {
                true => format!("{seen}, of the colour {},", color(diffuse / count)),
                false => seen,
            }
        });
        described.collect::<Vec<_>>().join(" and ")
    }

    fn clause(&self, part: &Source) -> String {
        let seen_by = |kinds: [RayKind; 2]| {
            let rays = self.tree.rays.iter();
            let rays = rays
                .filter(|ray| self.tree.leaves_first(ray))
                .filter(|ray| kinds.contains(&ray.kind));
            let seen: BTreeSet<String> = rays.map(|ray| met_name(ray, self.names)).collect();
            seen.into_iter().collect::<Vec<_>>().join(" and ")
        };
        match part.cause {
            Cause::Seen => {
                let is_surface = |ray: &TracedRay| ray.hit.is_some() && ray.met_light.is_none();
                let text = match (self.cameras().all(is_surface), self.is_one) {
                    (true, true) => "shines by itself",
                    (true, false) => "shine by themselves",
                    (false, true) => "is seen as it is",
                    (false, false) => "are seen as they are",
                };
                text.into()
            }
            Cause::Light(id) => {
                let is = if self.is_one { "is" } else { "are" };
                format!("{is} lit by {}{}", named(self.names, id), self.tint(id))
            }
            Cause::Reflection => {
                let reflects = if self.is_one { "reflects" } else { "reflect" };
                let seen = seen_by([RayKind::Mirror, RayKind::Gloss]);
                format!("{reflects} {seen}")
            }
            Cause::Transmission => {
                let lets = if self.is_one { "lets" } else { "let" };
                let behind = seen_by([RayKind::Transmission, RayKind::Translucency]);
                format!("{lets} {behind} through")
            }
        }
    }

    /// The colour in which a light arrives, its brightest channel 1; nothing where it is white.
    fn tint(&self, id: u64) -> String {
        let lights = self
            .tree
            .rays
            .iter()
            .filter(|ray| matches!(ray.end, RayEnd::Arrived | RayEnd::Unshadowed))
            .filter(|ray| self.tree.leaves_first(ray));
        let arriving = lights.filter_map(|ray| {
            let light = ray.light.filter(|light| light.id == id)?;
            Some(light.arriving * ray.transmittance)
        });
        let arriving: Vec3 = arriving.sum();
        let most = arriving.max_element();
        if most <= 0.0 || arriving.min_element() >= (1.0 - WHITE) * most {
            return String::new();
        }
        format!(" in the colour {}", color(arriving / most))
    }
}

/// Linear RGB.
fn color(color: Vec3) -> String {
    format!("({})", super::color_text(color).replace(' ', ", "))
}

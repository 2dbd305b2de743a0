//! Where a pixel's value comes from, and where its noise: the same sum of rays, sorted by what they
//! were for.

use super::count::counted;
use super::document::named;
use crate::trace::{RayEnd, RayKind, RayTree, TracedRay};
use glam::{DVec3, Vec3};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// A part of a pixel's value: what one cause adds to each sample at its first hit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Source {
    /// What it is.
    pub cause: Cause,
    /// The mean of what it adds over the samples, linear RGB.
    pub mean: Vec3,
    /// Standard deviation over the samples, root of the mean square over the channels.
    pub deviation: f64,
    /// Its share of the sum of all sources' variances, in [0, 1]. Sources that depend on each other
    /// make this a guide, not a decomposition.
    pub share: f64,
}

/// What adds to a sample at its first hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// What the camera ray itself met: emission, a visible light, the background, kd without shading.
    Seen,
    /// Direct light of this light.
    Light(u64),
    /// What is reflected.
    Reflection,
    /// What shines through.
    Transmission,
}

impl Cause {
    fn of(ray: &TracedRay) -> Self {
        match (ray.kind, ray.light) {
            (_, Some(light)) => Self::Light(light.id),
            (RayKind::Mirror | RayKind::Gloss, _) => Self::Reflection,
            (RayKind::Transmission | RayKind::Translucency, _) => Self::Transmission,
            _ => Self::Seen,
        }
    }

    /// In words.
    pub fn name(self, names: &BTreeMap<u64, String>) -> String {
        match self {
            Self::Seen => "seen directly".into(),
            Self::Light(id) => format!("light {}", named(names, id)),
            Self::Reflection => "reflection".into(),
            Self::Transmission => "transmission".into(),
        }
    }
}

/// What each cause adds to each sample at its first hit, linear RGB: together the samples' values.
pub(super) fn parts(tree: &RayTree) -> BTreeMap<Cause, Vec<DVec3>> {
    let samples = tree.samples.len();
    let mut parts: BTreeMap<Cause, Vec<DVec3>> = BTreeMap::new();
    let mut add = |cause, sample: u32, value: DVec3| {
        parts
            .entry(cause)
            .or_insert_with(|| vec![DVec3::ZERO; samples])[sample as usize] += value;
    };
    for ray in &tree.rays {
        match ray.parent {
            // Nothing is between it and the sample: what it adds is what it met by itself.
            None => add(Cause::Seen, ray.sample, ray.added.as_dvec3()),
            Some(parent) if tree.rays[parent as usize].parent.is_none() => {
                add(Cause::of(ray), ray.sample, ray.carried.as_dvec3());
            }
            Some(_) => {}
        }
    }
    parts
}

/// The parts of a pixel's value, the largest spread first. Their means add up to the value.
pub fn sources(tree: &RayTree) -> Vec<Source> {
    let (samples, parts) = (tree.samples.len(), parts(tree));
    let count = samples.max(1) as f64;
    let mut sources: Vec<Source> = parts
        .into_iter()
        .map(|(cause, values)| {
            let mean = values.iter().sum::<DVec3>() / count;
            let squares: f64 = values.iter().map(|v| (*v - mean).length_squared()).sum();
            Source {
                cause,
                mean: mean.as_vec3(),
                deviation: (squares / count / 3.0).sqrt(),
                share: 0.0,
            }
        })
        .collect();
    let total: f64 = sources.iter().map(|s| s.deviation * s.deviation).sum();
    if total > 0.0 {
        for source in &mut sources {
            source.share = source.deviation * source.deviation / total;
        }
    }
    sources.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
    sources
}

/// A few sentences on why the pixel has its value: what the camera rays met, and what became of each
/// light there.
pub fn explanation(tree: &RayTree, names: &BTreeMap<u64, String>) -> Vec<String> {
    let mut sentences = Vec::new();
    let cameras: Vec<(u32, &TracedRay)> = (0..)
        .zip(&tree.rays)
        .filter(|(_, ray)| ray.parent.is_none())
        .collect();
    let objects: BTreeSet<u64> = cameras
        .iter()
        .filter_map(|(_, r)| Some(r.hit?.object))
        .collect();
    let missed = cameras
        .iter()
        .filter(|(_, r)| r.end == RayEnd::Background)
        .count();
    if !objects.is_empty() {
        let list: Vec<String> = objects.iter().map(|&id| named(names, id)).collect();
        sentences.push(format!("the camera meets {}", list.join(", ")));
    }
    if missed > 0 {
        sentences.push(format!(
            "{missed} of {} camera rays meet nothing",
            cameras.len()
        ));
    }
    let mut lights: BTreeMap<u64, Fate> = BTreeMap::new();
    for ray in &tree.rays {
        if let (true, Some(light)) = (tree.leaves_first(ray), ray.light) {
            lights.entry(light.id).or_default().count(ray);
        }
    }
    for (id, fate) in &lights {
        sentences.push(fate.sentence(&named(names, *id), names));
    }
    if lights.is_empty() && !objects.is_empty() {
        sentences.push(
            "no shadow ray was cast: there is no light, shading is off, or the surface is fully transparent"
                .into(),
        );
    }
    sentences
}

/// What became of the samples of one light at first hits.
#[derive(Default)]
struct Fate {
    samples: u32,
    arrived: u32,
    tinted: u32,
    unlit: u32,
    left_out: u32,
    behind: u32,
    blocked: u32,
    blockers: BTreeSet<u64>,
}

impl Fate {
    fn count(&mut self, ray: &TracedRay) {
        self.samples += 1;
        match ray.end {
            RayEnd::Blocked => {
                self.blocked += 1;
                self.blockers.extend(ray.hit.map(|hit| hit.object));
            }
            RayEnd::Unlit => {
                self.unlit += 1;
                let behind = ray.light.is_some_and(|light| light.n_dot_l <= 0.0);
                self.behind += u32::from(behind);
            }
            RayEnd::LeftOut => self.left_out += 1,
            _ => {
                self.arrived += 1;
                self.tinted += u32::from(ray.transmittance != Vec3::ONE);
            }
        }
    }

    fn sentence(&self, light: &str, names: &BTreeMap<u64, String>) -> String {
        // One sample is not counted.
        let alone = self.samples == 1;
        let mut parts = Vec::new();
        let mut add = |count: u32, one: &str, many: &str| match (alone, count) {
            (_, 0) => {}
            (true, _) => parts.push(one.to_owned()),
            (false, 1) => parts.push(format!("1 {one}")),
            (false, count) => parts.push(format!("{count} {many}")),
        };
        add(self.arrived, "arrives", "arrive");
        let tinted = "through something transparent";
        let of_them = format!("of them {tinted}");
        let one = if alone { tinted } else { of_them.as_str() };
        add(self.tinted, one, &of_them);
        let blockers = self.blockers.iter().map(|&id| named(names, id));
        let blockers = blockers.collect::<Vec<_>>().join(", ");
        add(
            self.blocked,
            &format!("is blocked by {blockers}"),
            &format!("are blocked by {blockers}"),
        );
        add(
            self.behind,
            "comes from behind the surface",
            "come from behind the surface",
        );
        let unlit = "of a colour that the surface does not reflect, or from behind its triangle";
        add(
            self.unlit - self.behind,
            &format!("is {unlit}"),
            &format!("are {unlit}"),
        );
        add(
            self.left_out,
            "is so faint that chance left it out",
            "are so faint that chance left them out",
        );
        let parts = parts.join(", ");
        match alone {
            true => format!("{light}: its sample {parts}"),
            false => format!(
                "{light}: of {} {parts}",
                counted(self.samples.into(), "sample")
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sample_is_told_without_a_number_and_of_several_each_number_agrees() {
        let names = BTreeMap::from([(7, "Block".to_owned())]);
        let sentence = |fate: Fate| fate.sentence("Lamp", &names);
        let blocked = |samples, blocked, arrived| Fate {
            samples,
            arrived,
            blocked,
            blockers: BTreeSet::from([7]),
            ..Fate::default()
        };
        let unlit = |samples, unlit| Fate {
            samples,
            unlit,
            ..Fate::default()
        };
        let tinted = |samples, arrived, tinted| Fate {
            samples,
            arrived,
            tinted,
            ..Fate::default()
        };
        let color = "of a colour that the surface does not reflect, or from behind its triangle";
        for (fate, text) in [
            (blocked(1, 1, 0), "its sample is blocked by Block"),
            (
                blocked(4, 1, 3),
                "of 4 samples 3 arrive, 1 is blocked by Block",
            ),
            (
                blocked(4, 3, 1),
                "of 4 samples 1 arrives, 3 are blocked by Block",
            ),
            (unlit(1, 1), &*format!("its sample is {color}")),
            (unlit(2, 1), &*format!("of 2 samples 1 is {color}")),
            (unlit(2, 2), &*format!("of 2 samples 2 are {color}")),
            (
                tinted(1, 1, 1),
                "its sample arrives, through something transparent",
            ),
            (
                tinted(2, 2, 1),
                "of 2 samples 2 arrive, 1 of them through something transparent",
            ),
        ] {
            assert_eq!(sentence(fate), format!("Lamp: {text}"));
        }
    }
}

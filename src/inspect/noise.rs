//! What a pixel's samples differ in, in one sentence: their variance, split by what goes with it.
//!
//! The value of a sample is the sum of its parts at its first hit, so that the covariances of the parts with the value add
//! up to the variance. Samples that meet different things first are different by that alone: the variance between such
//! groups is an edge's, and the rest, within them, the parts'. What goes with the time of the shutter, or with the place on
//! the lens, is that of motion or of the lens, whatever it looks like.

use super::document::named;
use super::explain::{Cause, parts};
use crate::trace::{RayEnd, RayKind, RayTree, TracedRay};
use glam::{DMat2, DVec2, DVec3};
use std::collections::{BTreeMap, BTreeSet};

/// A spread of less than this part of the mean is not seen.
const LITTLE: f64 = 0.01;
/// Parts of the shutter that samples are sorted into.
const TIMES: usize = 4;
/// Share of the variance from which on time or lens count as what it goes with: with as many samples chance alone reaches it
/// once in some fifty pixels, and with fewer too often.
const GOES_WITH: f64 = 0.4;
const ENOUGH: usize = 16;
/// Share from which on a second cause is named.
const SECOND: f64 = 0.2;

/// Where the noise of a pixel is from; its rays are those of all its samples.
pub(super) fn sentence(tree: &RayTree, names: &BTreeMap<u64, String>) -> String {
    let samples = Samples::of(tree, names);
    let count = samples.values.len();
    if count < 2 {
        return "One sample alone has no noise: ask for all of them.".into();
    }
    let (mean, total) = (mean(&samples.values), variance(&samples.values));
    // Per channel, as the mean's length is.
    let spread = total.sqrt() / mean.length().max(f64::MIN_POSITIVE);
    if total == 0.0 {
        return format!("It has no noise: its {count} samples are equal.");
    }
    let spread_text = format!(
        "its {count} samples spread by {} of their mean",
        percent(spread)
    );
    if spread < LITTLE {
        return format!("It is hardly noisy: {spread_text}.");
    }
    let causes = samples.causes(total);
    let mut clauses = causes
        .iter()
        .take(2)
        .enumerate()
        .filter_map(|(i, (share, what))| {
            let named = i == 0 || *share >= SECOND;
            named.then(|| {
                format!(
                    "{} of the variance is {}",
                    percent(*share),
                    samples.clause(*what)
                )
            })
        });
    let first = clauses.next().unwrap_or_default();
    let second = clauses
        .next()
        .map_or(String::new(), |clause| format!("; {clause}"));
    let spread_text = spread_text.replacen("its", "Its", 1);
    format!("{spread_text}: {first}{second}.")
}

/// What samples differ in.
#[derive(Clone, Copy, PartialEq)]
enum Difference {
    /// When they are taken.
    Time,
    /// Where they pass the lens.
    Lens,
    /// What they meet first.
    Edge,
    /// A part of what they find there.
    Part(Cause),
}

/// The samples of a pixel, in the order of [`RayTree::samples`].
struct Samples<'a> {
    tree: &'a RayTree,
    names: &'a BTreeMap<u64, String>,
    values: Vec<DVec3>,
    cameras: Vec<&'a TracedRay>,
    /// What each meets first, counted from 0.
    groups: Vec<usize>,
    /// Their names, and how many samples meet them.
    met: Vec<(String, usize)>,
}

impl<'a> Samples<'a> {
    fn of(tree: &'a RayTree, names: &'a BTreeMap<u64, String>) -> Self {
        let cameras = tree.rays.iter().filter(|ray| ray.parent.is_none());
        let cameras: Vec<&TracedRay> = cameras.collect();
        let mut met: Vec<(String, usize)> = Vec::new();
        // Two things may have the same name.
        let mut known = Vec::new();
        let mut groups = Vec::with_capacity(cameras.len());
        for camera in &cameras {
            let what = (
                camera.end,
                camera.met_light,
                camera.hit.map(|hit| hit.object),
            );
            let group = match known.iter().position(|known| *known == what) {
                Some(group) => group,
                None => {
                    known.push(what);
                    met.push((met_name(camera, names), 0));
                    met.len() - 1
                }
            };
            met[group].1 += 1;
            groups.push(group);
        }
        Self {
            tree,
            names,
            values: tree.samples.iter().map(|s| s.value.as_dvec3()).collect(),
            cameras,
            groups,
            met,
        }
    }

    /// Shares of the variance, the largest first.
    fn causes(&self, total: f64) -> Vec<(f64, Difference)> {
        let count = self.values.len();
        let mut all = Vec::new();
        let time = among(&self.values, &self.times()) / total;
        let lens = self.explained_by_lens(total);
        for (share, degrees, what) in [
            (time, TIMES - 1, Difference::Time),
            (lens, 2, Difference::Lens),
        ] {
            // What as many degrees of freedom reach by chance is taken off.
            let free = count.saturating_sub(degrees + 1);
            let share = 1.0 - (1.0 - share) * (count - 1) as f64 / free as f64;
            if count >= ENOUGH && share >= GOES_WITH {
                all.push((share, what));
            }
        }
        if all.is_empty() {
            all.push((among(&self.values, &self.groups) / total, Difference::Edge));
            let rest = from_group_means(&self.values, &self.groups);
            for (cause, part) in parts(self.tree) {
                let part = from_group_means(&part, &self.groups);
                let with: f64 = part.iter().zip(&rest).map(|(a, b)| a.dot(*b)).sum();
                all.push((with / count as f64 / total, Difference::Part(cause)));
            }
        }
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        all
    }

    /// Which part of the shutter each is of, as many in each; one for all where none moves.
    fn times(&self) -> Vec<usize> {
        let times = self.cameras.iter().map(|ray| ray.time);
        let mut order: Vec<(f32, usize)> = times.zip(0..).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut bins = vec![0; order.len()];
        if order.first().map(|first| first.0) != order.last().map(|last| last.0) {
            for (place, (_, sample)) in order.iter().enumerate() {
                bins[*sample] = place * TIMES / order.len();
            }
        }
        bins
    }

    /// The share of the variance that a plane over the lens accounts for; 0 without one: then rays start at different places
    /// because they are parallel, or because the camera moves.
    fn explained_by_lens(&self, total: f64) -> f64 {
        if !self.tree.has_lens {
            return 0.0;
        }
        let origins: Vec<DVec3> = self
            .cameras
            .iter()
            .map(|ray| ray.origin.as_dvec3())
            .collect();
        let middle = mean(&origins);
        let arms: Vec<DVec3> = origins.iter().map(|origin| *origin - middle).collect();
        let axis = self
            .cameras
            .iter()
            .map(|ray| ray.direction.as_dvec3())
            .sum::<DVec3>();
        let (u, v) = axis.normalize_or(DVec3::Z).any_orthonormal_pair();
        let places: Vec<DVec2> = arms
            .iter()
            .map(|arm| DVec2::new(arm.dot(u), arm.dot(v)))
            .collect();
        let mut moments = DMat2::ZERO;
        for place in &places {
            moments += DMat2::from_cols(place.x * *place, place.y * *place);
        }
        if moments.determinant() <= 0.0 {
            return 0.0;
        }
        let value = mean(&self.values);
        let inverse = moments.inverse();
        let explained: f64 = (0..3)
            .map(|channel| {
                let with = places.iter().zip(&self.values);
                let with: DVec2 = with
                    .map(|(place, v)| *place * (v[channel] - value[channel]))
                    .sum();
                with.dot(inverse * with)
            })
            .sum();
        explained / self.values.len() as f64 / total
    }

    fn clause(&self, what: Difference) -> String {
        let list = |of: &mut dyn Iterator<Item = String>| of.collect::<Vec<_>>().join(" and ");
        let met = list(&mut self.met.iter().map(|(name, _)| name.clone()));
        let which = match self.met.len() {
            1 => format!("how bright {met} is"),
            _ => format!("which of {met} a sample sees"),
        };
        match what {
            Difference::Time => format!("motion: {which} depends on when it is taken"),
            Difference::Lens => {
                format!("the lens: {which} depends on where it passes the aperture")
            }
            Difference::Edge => {
                let counts = self.met.iter().map(|(name, count)| match count {
                    1 => format!("1 sample sees {name}"),
                    _ => format!("{count} samples see {name}"),
                });
                format!(
                    "an edge within the pixel: {}",
                    list(&mut counts.into_iter())
                )
            }
            Difference::Part(Cause::Seen) => format!("{met} itself: its texture or its own light"),
            Difference::Part(Cause::Light(id)) => self.light(id),
            Difference::Part(Cause::Reflection) => {
                self.seen_by(&[RayKind::Mirror, RayKind::Gloss], "the reflection in")
            }
            Difference::Part(Cause::Transmission) => self.seen_by(
                &[RayKind::Transmission, RayKind::Translucency],
                "what is behind",
            ),
        }
    }

    /// Rays that leave the first surfaces.
    fn seconds(&self) -> impl Iterator<Item = &'a TracedRay> {
        let rays = &self.tree.rays;
        rays.iter().filter(|ray| self.tree.leaves_first(ray))
    }

    fn light(&self, id: u64) -> String {
        let name = named(self.names, id);
        let rays = self
            .seconds()
            .filter(|ray| ray.light.is_some_and(|light| light.id == id) && ray.end.is_traced());
        let (mut all, mut blocked, mut blockers) = (0, 0, BTreeSet::new());
        let mut has_points = false;
        for ray in rays {
            all += 1;
            has_points |= ray.kind == RayKind::LightSample;
            if ray.end == RayEnd::Blocked {
                blocked += 1;
                blockers.extend(ray.hit.map(|hit| hit.object));
            }
        }
        if blocked == 0 || blocked == all {
            return match has_points {
                true => format!(
                    "the light {name}: its points, or the surface's colour and slope, differ"
                ),
                false => {
                    format!("the light {name}: the surface's colour or slope under it differs")
                }
            };
        }
        let shadow = match has_points {
            true => "the soft shadow",
            false => "the edge of the shadow",
        };
        let blockers: Vec<String> = blockers.iter().map(|id| named(self.names, *id)).collect();
        let blockers = blockers.join(" and ");
        format!("{shadow} of {blockers}: {blocked} of {all} rays to {name} are blocked")
    }

    /// What rays of these kinds see that leave the first surfaces.
    fn seen_by(&self, kinds: &[RayKind], what: &str) -> String {
        let rays = self.seconds().filter(|ray| kinds.contains(&ray.kind));
        let (mut from, mut seen, mut is_blurred) = (BTreeSet::new(), BTreeSet::new(), false);
        for ray in rays {
            from.extend(ray.from.map(|id| named(self.names, id)));
            seen.insert(met_name(ray, self.names));
            is_blurred |= matches!(ray.kind, RayKind::Gloss | RayKind::Translucency);
        }
        let join = |names: BTreeSet<String>| names.into_iter().collect::<Vec<_>>().join(" and ");
        let blurred = if is_blurred { "blurred: " } else { "" };
        format!("{what} {}, {blurred}it shows {}", join(from), join(seen))
    }
}

/// What a ray ended at.
pub(super) fn met_name(ray: &TracedRay, names: &BTreeMap<u64, String>) -> String {
    match (ray.end, ray.met_light, ray.hit) {
        (RayEnd::Background, ..) => "the background".into(),
        (_, Some(light), _) => format!("the light {}", named(names, light)),
        (_, _, Some(hit)) => named(names, hit.object),
        _ => "a light".into(),
    }
}

/// A share in whole percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.0} %", share * 100.0)
}

fn mean(values: &[DVec3]) -> DVec3 {
    values.iter().sum::<DVec3>() / values.len().max(1) as f64
}

/// Summed over the channels.
fn variance(values: &[DVec3]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values
        .iter()
        .map(|value| (*value - mean).length_squared())
        .sum();
    squares / values.len().max(1) as f64
}

/// Each value less the mean of its group.
fn from_group_means(values: &[DVec3], groups: &[usize]) -> Vec<DVec3> {
    let last = groups.iter().max().map_or(0, |last| last + 1);
    let mut sums = vec![(DVec3::ZERO, 0.0); last];
    for (value, group) in values.iter().zip(groups) {
        sums[*group].0 += *value;
        sums[*group].1 += 1.0;
    }
    let of = |(value, group): (&DVec3, &usize)| *value - sums[*group].0 / sums[*group].1;
    values.iter().zip(groups).map(of).collect()
}

/// The variance of the groups' means.
fn among(values: &[DVec3], groups: &[usize]) -> f64 {
    let within = from_group_means(values, groups);
    let within: f64 = within.iter().map(|value| value.length_squared()).sum();
    (variance(values) - within / values.len().max(1) as f64).max(0.0)
}

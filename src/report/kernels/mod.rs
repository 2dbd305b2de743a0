//! Which way to find hits is how fast, and how wrong.
//!
//! A [`Kernel`] is a triangle test in a traversal of a tree. All of them get the same triangles (the scene's, baked
//! into the world) and the same rays, on one thread.

mod accuracy;
mod against;
mod arrangements;
mod builders;
mod candidates;
mod closed;
mod embree;
mod embree_eights;
mod exact;
mod moller_trumbore;
mod obvhs_trees;
mod ours;
mod rays;
mod speed;
mod tests_of_triangles;

use super::{Axis, Cell, Dash, Marker, Options, Plot, Section, Series, Subject, Table, Watch};
use super::{pareto, table::digits};
use crate::bvh::Ray;
use candidates::{Candidate, candidates};
use glam::Vec3;
use rays::{CLASSES, RaySets};

/// A hit, as every kernel can tell it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// In lengths of the ray's direction.
    pub t: f32,
    /// Index into the triangles that the kernel was made from.
    pub triangle: u32,
    /// Barycentric weight of the triangle's corner 1.
    pub u: f32,
    /// Barycentric weight of the triangle's corner 2.
    pub v: f32,
}

/// A way to find what rays hit.
pub trait Kernel {
    /// The nearest hit of every ray, in their order. `found` is cleared first.
    fn closest(&self, rays: &[Ray], found: &mut Vec<Option<Found>>);

    /// Whether anything is hit by each ray, in their order. `occluded` is cleared first.
    fn occluded(&self, rays: &[Ray], occluded: &mut Vec<bool>);
}

/// One kernel on one scene.
struct Row {
    candidate: usize,
    /// Million rays a second, of each of [`CLASSES`].
    speeds: [f64; CLASSES.len()],
    errors: accuracy::Errors,
}

impl Row {
    /// The mean over the classes, each counted by its time: what a ray takes if all are as frequent.
    fn speed(&self) -> f64 {
        let measured = self.speeds.iter().filter(|speed| speed.is_finite());
        let (count, time) = measured.fold((0.0, 0.0), |(n, t), speed| (n + 1.0, t + 1.0 / speed));
        count / time
    }
}

/// Leaks of each kernel per million rays.
#[derive(Clone, Copy, Debug, Default)]
struct Leaks {
    edges: f64,
    vertices: f64,
}

/// Why the library that `EMBREE_LIB` names cannot take part; all is well where it names none.
pub fn check_embree() -> Result<(), String> {
    embree::find().map(|_| ())
}

/// Measures all kernels on all scenes.
pub fn measure(subjects: &[Subject], options: &Options, watch: Watch) -> Section {
    let candidates = candidates();
    let leaks = closed::leaks(&candidates, options, watch);
    let mut section = Section {
        title: "Kernels: speed against error".into(),
        method: method(&candidates, options),
        ..Section::default()
    };
    section.tables.push(leak_table(&candidates, &leaks));
    let mut summary = Table::new(
        "kernels",
        "Kernels: million rays a second and relative errors",
        &[
            "scene",
            "traversal",
            "triangle test",
            "primary",
            "mirror",
            "diffuse",
            "shadow",
            "all",
            "t mean",
            "t max",
            "t ulp 99 %",
            "u, v mean",
            "u, v max",
            "missed ppm",
            "leaks ppm",
            "front",
        ],
    );
    let mut standings = Vec::new();
    let mut ratios = Vec::new();
    for subject in subjects {
        let triangles = subject.triangles();
        if triangles.is_empty() {
            section
                .method
                .push(format!("{}: has no triangles.", subject.name));
            continue;
        }
        let rays = RaySets::of(subject, &triangles, options);
        let rows = measure_scene(subject, &triangles, &candidates, &rays, options, watch);
        let points: Vec<(f64, f64)> = (rows.iter())
            .map(|row| (row.speed(), row.errors.t_mean))
            .collect();
        let front = pareto::front(&points);
        for (row, &on_front) in rows.iter().zip(&front) {
            summary.push(cells(subject, &candidates, row, &leaks, on_front));
        }
        section
            .plots
            .push(front_plot(subject, &candidates, &rows, &leaks, &front));
        section
            .findings
            .extend(finding(subject, &candidates, &rows, &leaks));
        standings.extend(standing(&candidates, &rows));
        ratios.extend(against::ratios(subject, &candidates, &rows));
        builders::measure(subject, &triangles, &rays, options, watch, &mut section);
    }
    if subjects.len() > 1 {
        section
            .findings
            .splice(0..0, over_all(&candidates, &leaks, &standings));
    }
    arrangements::measure(options, watch, &mut section);
    section
        .findings
        .splice(0..0, against::embree(&candidates, &ratios));
    section.summary = Some(section.tables.len());
    section.tables.push(summary);
    let ours = leaks.iter().zip(&candidates).filter(|(_, c)| c.is_ours());
    for (leaks, candidate) in ours.filter(|(leaks, _)| leaks.edges + leaks.vertices > 0.0) {
        section
            .failures
            .push(format!("{} leaks: {leaks:?} a million", candidate.name()));
    }
    section
}

fn measure_scene(
    subject: &Subject,
    triangles: &[[Vec3; 3]],
    candidates: &[Candidate],
    rays: &RaySets,
    options: &Options,
    watch: Watch,
) -> Vec<Row> {
    let what = format!("kernels on {}", subject.name);
    watch(&what, 0, 1);
    let kernels: Vec<Box<dyn Kernel>> = (candidates.iter()).map(|c| c.build(triangles)).collect();
    let speeds = speed::speeds(&kernels, rays, options, &|done, all| {
        watch(&what, done, all)
    });
    let errors = accuracy::errors(&kernels, triangles, rays);
    (speeds.into_iter().zip(errors).enumerate())
        .map(|(candidate, (speeds, errors))| Row {
            candidate,
            speeds,
            errors,
        })
        .collect()
}

fn method(candidates: &[Candidate], options: &Options) -> Vec<String> {
    let embree = candidates.iter().find_map(|c| c.library.clone());
    let embree = match embree {
        Some(library) => format!("Embree is {library}."),
        None => {
            "Embree was not found: set EMBREE_LIB to its library, or install it (Debian: libembree3-3).".into()
        }
    };
    vec![
        format!(
            "Every kernel gets the scene's triangles baked into the world, and the same rays, {} of each kind, on one thread, \
             in batches through calls that return t, triangle and barycentrics. Primary rays go through the middles of the \
             camera's pixels; mirror, diffuse (cosine-distributed) and shadow rays (to the lights; without lights, to a point \
             above) start where those hit, and say on which triangle: Glassbox does not test that one; the others have no such \
             question. Kernels take turns; medians of {} rounds. `all` is the harmonic mean of the kinds.",
            rays::count(options),
            speed::rounds(options),
        ),
        "Errors are against f64 arithmetic on the same f32 corners and rays, on the triangle that the kernel found, over all \
         primary and diffuse rays: relative for t, absolute for barycentrics. `t ulp 99 %` is the 99th percentile in units \
         in the last place. `missed` are rays of a million for which another kernel found something nearer that f64 confirms, \
         by more than a thousandth. Leaks are rays of a million from inside closed meshes, aimed at edges and at vertices, \
         that find nothing."
            .into(),
        format!("`wide` is what Glassbox traces with, and what its gizmos and counters show. {embree}"),
    ]
}

fn leak_table(candidates: &[Candidate], leaks: &[Leaks]) -> Table {
    let mut table = Table::new(
        "leaks",
        "Leaks of a million rays from inside closed meshes",
        &[
            "traversal",
            "triangle test",
            "aimed at edges",
            "aimed at vertices",
        ],
    );
    for (candidate, leaks) in candidates.iter().zip(leaks) {
        table.push([
            candidate.traversal.as_str().into(),
            candidate.test.into(),
            leaks.edges.into(),
            leaks.vertices.into(),
        ]);
    }
    table
}

fn cells(
    subject: &Subject,
    candidates: &[Candidate],
    row: &Row,
    leaks: &[Leaks],
    on_front: bool,
) -> [Cell; 16] {
    let candidate = &candidates[row.candidate];
    let leaks = leaks[row.candidate];
    let [primary, mirror, diffuse, shadow] = row.speeds.map(|s| s.is_finite().then_some(s));
    let errors = &row.errors;
    [
        subject.name.as_str().into(),
        candidate.traversal.as_str().into(),
        candidate.test.into(),
        primary.into(),
        mirror.into(),
        diffuse.into(),
        shadow.into(),
        row.speed().into(),
        errors.t_mean.into(),
        errors.t_max.into(),
        errors.t_ulps_99.into(),
        errors.uv_mean.into(),
        errors.uv_max.into(),
        errors.missed.into(),
        (0.5 * (leaks.edges + leaks.vertices)).into(),
        (if on_front { "*" } else { "" }).into(),
    ]
}

/// Speed to the right, error upwards: the best corner is below right.
fn front_plot(
    subject: &Subject,
    candidates: &[Candidate],
    rows: &[Row],
    leaks: &[Leaks],
    front: &[bool],
) -> Plot {
    let mut traversals: Vec<&str> = Vec::new();
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let candidate = &candidates[row.candidate];
        let known = traversals
            .iter()
            .position(|name| *name == candidate.traversal);
        let traversal = known.unwrap_or_else(|| {
            traversals.push(&candidate.traversal);
            traversals.len() - 1
        });
        let number = row.candidate + 1;
        let tight = leaks[row.candidate].edges + leaks[row.candidate].vertices == 0.0;
        let name = format!(
            "{number} {}{}",
            candidate.name(),
            if tight { " *" } else { "" }
        );
        let point = (row.speed(), row.errors.t_mean);
        let mut one =
            Series::new(&name, vec![point]).marked(Marker::ALL[traversal % Marker::ALL.len()]);
        one.labels = vec![number.to_string()];
        series.push(one);
    }
    let mut best: Vec<(f64, f64)> = (rows.iter().zip(front))
        .filter(|(_, on_front)| **on_front)
        .map(|(row, _)| (row.speed(), row.errors.t_mean))
        .collect();
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = Series::new("Pareto front", best).joined(Dash::Short);
    series.insert(0, best.marked(Marker::Halo));
    Plot {
        file: format!("kernels-{}", subject.file()),
        title: format!(
            "{}: kernels, speed against error of t (* no leak)",
            subject.name
        ),
        x: Axis::linear("million rays a second, one thread"),
        y: Axis::logarithmic("mean relative error of t"),
        series,
    }
}

/// Speeds of all kernels on one scene, ours first.
fn standing(candidates: &[Candidate], rows: &[Row]) -> Option<Vec<f64>> {
    let speeds: Vec<f64> = rows.iter().map(Row::speed).collect();
    (speeds.len() == candidates.len()).then_some(speeds)
}

/// Ours against each of the others that come nearest, over all scenes.
fn over_all(candidates: &[Candidate], leaks: &[Leaks], standings: &[Vec<f64>]) -> Option<String> {
    let against = |other: usize| -> f64 {
        let logs = standings
            .iter()
            .map(|speeds| (speeds[0] / speeds[other]).ln());
        let (count, sum) = logs
            .filter(|log| log.is_finite())
            .fold((0.0, 0.0), |(n, s), l| (n + 1.0, s + l));
        (sum / f64::max(count, 1.0)).exp()
    };
    let others = (0..candidates.len()).filter(|&i| !candidates[i].is_ours());
    let mut ratios: Vec<(f64, usize)> = others.map(|i| (against(i), i)).collect();
    ratios.sort_by(|a, b| a.0.total_cmp(&b.0));
    let said: Vec<String> = ratios
        .iter()
        .take(3)
        .map(|&(ratio, i)| {
            let leaks = 0.5 * (leaks[i].edges + leaks[i].vertices);
            let (ratio, leaks) = (digits(ratio, 2), digits(leaks, 2));
            format!(
                "{ratio}x as fast as {} ({leaks} leaks)",
                candidates[i].name()
            )
        })
        .collect();
    let ours = 0.5 * (leaks[0].edges + leaks[0].vertices);
    (!standings.is_empty()).then(|| {
        format!(
            "Over {} scenes (geometric mean, one thread) Glassbox is {}; its own leaks per million rays aimed at edges and \
             vertices: {}.",
            standings.len(),
            said.join("; "),
            digits(ours, 2)
        )
    })
}

fn finding(
    subject: &Subject,
    candidates: &[Candidate],
    rows: &[Row],
    leaks: &[Leaks],
) -> Option<String> {
    let ours = rows
        .iter()
        .find(|row| candidates[row.candidate].is_ours())?;
    let others = (rows.iter()).filter(|row| !candidates[row.candidate].is_ours());
    let fastest = others.max_by(|a, b| a.speed().total_cmp(&b.speed()))?;
    let leak = |row: &Row| 0.5 * (leaks[row.candidate].edges + leaks[row.candidate].vertices);
    Some(format!(
        "On {} Glassbox traces {} million rays/s on one thread, {}x the fastest other kernel ({}); mean relative error of t: \
         {} (other: {}); leaks per million rays aimed at edges and vertices: {} (other: {}).",
        subject.name,
        digits(ours.speed(), 3),
        digits(ours.speed() / fastest.speed(), 3),
        candidates[fastest.candidate].name(),
        digits(ours.errors.t_mean, 2),
        digits(fastest.errors.t_mean, 2),
        digits(leak(ours), 3),
        digits(leak(fastest), 3),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::hard_cases::{meshes, random::Random};

    /// All kernels but Embree, which a test may not need, find the same triangles where none is on an edge.
    #[test]
    fn every_kernel_finds_what_the_others_find() {
        let mesh = meshes::scatter(500, 0.3, 3);
        let triangles: Vec<[Vec3; 3]> = (0..500).map(|i| mesh.corners(i)).collect();
        let mut random = Random::new(4);
        let rays: Vec<Ray> = (0..4_000)
            .map(|_| {
                let origin = random.cube() * 2.0;
                Ray::new(origin, random.cube() - origin)
            })
            .collect();
        let mut expected: Option<Vec<Option<Found>>> = None;
        for candidate in candidates() {
            let kernel = candidate.build(&triangles);
            let (mut found, mut occluded) = (Vec::new(), Vec::new());
            kernel.closest(&rays, &mut found);
            kernel.occluded(&rays, &mut occluded);
            let expected = expected.get_or_insert_with(|| found.clone());
            let hits = expected.iter().flatten().count();
            assert!(hits > 1_500, "only {hits} hits");
            let mut apart = 0;
            for ((a, b), occluded) in found.iter().zip(&*expected).zip(&occluded) {
                let close = match (a, b) {
                    (Some(a), Some(b)) => {
                        a.triangle == b.triangle
                            && (a.t / b.t - 1.0).abs() < 1e-3
                            && (a.u - b.u).abs() < 1e-2
                            && (a.v - b.v).abs() < 1e-2
                    }
                    (a, b) => a.is_none() && b.is_none(),
                };
                apart += usize::from(!close || *occluded != a.is_some());
            }
            assert!(
                apart <= 4,
                "{}: {apart} of 4000 rays differ",
                candidate.name()
            );
        }
    }
}

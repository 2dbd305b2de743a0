//! What a builder's time buys: quality of the tree, and rays a second through it.

use super::ours::{OursWide, aggregate};
use super::rays::RaySets;
use super::{Kernel, ours, speed};
use crate::bvh::{BuildOptions, Builder, Preset, epo};
use crate::report::timing::take_turns;
use crate::report::{Axis, Marker, Options, Plot, Section, Series, Subject, Table, Watch};
use glam::Vec3;

/// Name and options.
fn ways() -> Vec<(&'static str, BuildOptions)> {
    let with = |builder, preset| BuildOptions {
        builder,
        preset,
        ..BuildOptions::default()
    };
    vec![
        ("median", with(Builder::Median, Preset::Medium)),
        ("SAH", with(Builder::Sah, Preset::Medium)),
        ("PLOC fastest", with(Builder::Ploc, Preset::Fastest)),
        ("PLOC fast", with(Builder::Ploc, Preset::Fast)),
        ("PLOC medium", with(Builder::Ploc, Preset::Medium)),
        ("PLOC slow", with(Builder::Ploc, Preset::Slow)),
        ("PLOC very slow", with(Builder::Ploc, Preset::VerySlow)),
    ]
}

/// Adds a table and a plot for a scene.
pub(super) fn measure(
    subject: &Subject,
    triangles: &[[Vec3; 3]],
    rays: &RaySets,
    options: &Options,
    watch: Watch,
    section: &mut Section,
) {
    let ways = ways();
    let what = format!("builders on {}", subject.name);
    watch(&what, 0, 1);
    let build_rounds = if options.quick { 1 } else { 3 };
    let build_seconds = take_turns(ways.len(), build_rounds, |i| {
        std::hint::black_box(ours::aggregate(triangles, &ways[i].1));
    });
    let aggregates: Vec<_> = ways
        .iter()
        .map(|(_, way)| aggregate(triangles, way))
        .collect();
    let mut table = Table::new(
        &format!("builders-{}", subject.file()),
        &format!(
            "Builders on {}: {} triangles",
            subject.name,
            triangles.len()
        ),
        &[
            "builder",
            "build ms",
            "SAH cost",
            "EPO",
            "bytes a triangle",
            "levels",
            "primary",
            "diffuse",
            "shadow",
        ],
    );
    let quality: Vec<_> = aggregates
        .iter()
        .map(|aggregate| {
            let mesh = &aggregate.instances()[0].mesh;
            let corners = |triangle: u32| mesh.triangles().corners(triangle);
            (mesh.stats(), epo(mesh.tree(), corners), mesh.bytes())
        })
        .collect();
    let kernels: Vec<Box<dyn Kernel>> = (aggregates.into_iter())
        .map(|aggregate| Box::new(OursWide::with(aggregate)) as Box<dyn Kernel>)
        .collect();
    let speeds = speed::speeds(&kernels, rays, options, &|done, all| {
        watch(&what, done, all)
    });
    let mut series = Vec::new();
    for (i, ((name, _), (stats, epo, bytes))) in ways.iter().zip(&quality).enumerate() {
        let [primary, _, diffuse, shadow] = speeds[i].map(|s| s.is_finite().then_some(s));
        table.push([
            (*name).into(),
            (1e3 * build_seconds[i]).into(),
            stats.sah_cost.into(),
            (*epo).into(),
            (*bytes as f64 / triangles.len() as f64).into(),
            u64::from(stats.levels).into(),
            primary.into(),
            diffuse.into(),
            shadow.into(),
        ]);
        let marker = Marker::ALL[i % Marker::ALL.len()];
        let point = (
            1e3 * build_seconds[i],
            diffuse.or(primary).unwrap_or(f64::NAN),
        );
        series.push(Series::new(name, vec![point]).marked(marker));
    }
    section.tables.push(table);
    section.plots.push(Plot {
        file: format!("builders-{}", subject.file()),
        title: format!("{}: what a builder's time buys", subject.name),
        x: Axis::logarithmic("milliseconds to build"),
        y: Axis::linear("million diffuse rays a second, one thread"),
        series,
    });
}

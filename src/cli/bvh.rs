//! `glassbox bvh`: what each builder makes of a scene.

use super::Failure;
use super::output::say;
use super::settings::{BuilderArg, builder_name};
use super::stage::{SceneArgs, Stage, with_threads};
use super::stats::{build_time, triangles};
use crate::bvh::{TreeStats, epo};
use crate::scene::Levels;
use crate::trace::World;
use bevy::math::Vec3;
use bevy::platform::collections::HashSet;
use clap::Args;
use serde::Serialize;
use std::sync::Arc;

#[derive(Args)]
pub(super) struct Bvh {
    #[command(flatten)]
    scene: SceneArgs,
    /// Only this builder (default: all four)
    #[arg(long, value_enum)]
    builder: Option<BuilderArg>,
    /// Print JSON with the histograms instead of a table
    #[arg(long)]
    json: bool,
    /// Threads to build on (default: all of the machine's)
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads: Option<u32>,
}

/// The tree over all triangles of a scene, as one builder makes it.
#[derive(Serialize)]
struct Row {
    builder: &'static str,
    triangles: u64,
    levels: u32,
    nodes: usize,
    leaves: usize,
    largest_leaf: u32,
    sah_cost: f64,
    epo: f64,
    /// Of the tree and all that tracing keeps of the triangles.
    bytes: usize,
    bytes_per_triangle: f64,
    build_ms: f64,
    leaf_sizes: Vec<u32>,
    depths: Vec<u32>,
}

pub(super) fn run(args: Bvh) -> Result<(), Failure> {
    let rows = with_threads(args.threads, || rows(&args))?;
    if args.json {
        let text = serde_json::to_string_pretty(&rows)
            .map_err(|error| Failure::System(error.to_string()))?;
        say(text)
    } else {
        say(table(&rows).trim_end())
    }
}

/// One tree over all triangles, whatever the scene's own setting is, so that one row can say it all.
fn rows(args: &Bvh) -> Result<Vec<Row>, Failure> {
    let mut stage = Stage::open(&args.scene, args.json)?;
    let builders = match args.builder {
        Some(builder) => vec![builder],
        None => BuilderArg::ALL.to_vec(),
    };
    let mut rows = Vec::with_capacity(builders.len());
    for builder in builders {
        let tree = &mut stage.settings().tree;
        tree.levels = Levels::One;
        tree.builder = builder.builder();
        let world = stage.sync().world.clone();
        rows.push(row(builder, &world));
    }
    Ok(rows)
}

fn row(builder: BuilderArg, world: &World) -> Row {
    let corners = corners(world);
    let aggregate = &world.aggregate;
    let TreeStats {
        levels,
        nodes,
        leaves,
        largest_leaf,
        leaf_sizes,
        depths,
        sah_cost,
        ..
    } = aggregate.stats();
    let mut seen = HashSet::new();
    let meshes: usize = world
        .objects
        .iter()
        .filter(|object| seen.insert(Arc::as_ptr(&object.mesh)))
        .map(|object| {
            let mesh = &object.mesh;
            mesh.tree.bytes() + size_of_val(&*mesh.normals) + size_of_val(&*mesh.uvs)
        })
        .sum();
    let bytes = meshes + aggregate.bytes();
    let triangles = triangles(world);
    Row {
        builder: builder_name(builder.builder()),
        triangles,
        levels,
        nodes,
        leaves,
        largest_leaf,
        sah_cost,
        epo: epo(aggregate.tree(), |slot| corners[slot as usize]),
        bytes,
        bytes_per_triangle: bytes as f64 / triangles.max(1) as f64,
        build_ms: build_time(world).as_secs_f64() * 1e3,
        leaf_sizes,
        depths,
    }
}

/// Corners in the world of every primitive of a tree over all triangles, in the order in which
/// `Aggregate::build` numbers them: object by object, each in its mesh's leaf order.
fn corners(world: &World) -> Vec<[Vec3; 3]> {
    let instances = world.aggregate.instances().iter();
    instances
        .flat_map(|instance| {
            let mesh = &instance.mesh;
            (0..mesh.traced()).map(move |place| {
                let corners = mesh.triangles().corners(mesh.triangle_at(place));
                corners.map(|corner| instance.to_world_point(corner))
            })
        })
        .collect()
}

fn table(rows: &[Row]) -> String {
    let mut lines = vec![
        [
            "builder",
            "triangles",
            "levels",
            "nodes",
            "leaves",
            "largest leaf",
            "SAH cost",
            "EPO",
            "bytes",
            "bytes/triangle",
            "build ms",
        ]
        .map(String::from),
    ];
    lines.extend(rows.iter().map(|row| {
        [
            row.builder.to_owned(),
            row.triangles.to_string(),
            row.levels.to_string(),
            row.nodes.to_string(),
            row.leaves.to_string(),
            row.largest_leaf.to_string(),
            format!("{:.2}", row.sah_cost),
            format!("{:.3}", row.epo),
            row.bytes.to_string(),
            format!("{:.1}", row.bytes_per_triangle),
            format!("{:.2}", row.build_ms),
        ]
    }));
    let widths: Vec<usize> = (0..lines[0].len())
        .map(|column| {
            lines
                .iter()
                .map(|line| line[column].len())
                .max()
                .unwrap_or(0)
        })
        .collect();
    let mut text = String::new();
    for line in &lines {
        for (i, (cell, &width)) in line.iter().zip(&widths).enumerate() {
            text += &if i == 0 {
                format!("{cell:width$}")
            } else {
                format!("  {cell:>width$}")
            };
        }
        text.push('\n');
    }
    text
}

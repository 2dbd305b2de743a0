//! What each builder makes of a world, in numbers: the panel, the command line and files show these.

use crate::bvh::{
    Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree, Ray, TreeStats, epo,
};
use crate::scene::RenderSettings;
use crate::trace::{Camera, Mesh, Object, RayKind, Samples, World, probe};
use bevy::platform::collections::{HashMap, HashSet};
use glam::{UVec2, Vec3};
use serde::Serialize;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::table::aligned;

/// The tree over all triangles of a world, as one builder makes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BuilderFigures {
    /// `none`, `median`, `sah` or `ploc`.
    pub builder: &'static str,
    /// Of all objects: a mesh that two objects share counts twice.
    pub triangles: u64,
    /// The depth of the deepest leaf; the root's is 0.
    pub levels: u32,
    /// Nodes, leaves included.
    pub nodes: usize,
    /// Leaves.
    pub leaves: usize,
    /// Triangles of the largest leaf.
    pub largest_leaf: u32,
    /// Of a random ray that meets the root's box.
    pub sah_cost: f64,
    /// Effective parent overlap.
    pub epo: f64,
    /// Nodes of the wide form, which unwatched rays walk.
    pub wide_nodes: usize,
    /// Children of such a node on average, of eight.
    pub children_per_wide_node: f64,
    /// Triangles of a block of its leaves on average, of eight.
    pub triangles_per_block: f64,
    /// Of the tree and all that tracing keeps of the triangles.
    pub bytes: usize,
    /// The same for each triangle.
    pub bytes_per_triangle: f64,
    /// Milliseconds.
    pub build_ms: f64,
    /// `leaf_sizes[n]` leaves hold n triangles; the last entry counts larger ones too.
    pub leaf_sizes: Vec<u32>,
    /// `depths[d]` leaves are at depth d.
    pub depths: Vec<u32>,
    /// Speed on a view's own rays, where it was measured.
    pub rates: Option<BuilderRates>,
}

/// Speed on a view's own rays: one thread, the queries that a render makes, with the scene's own
/// levels of trees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BuilderRates {
    /// Million closest hits a second; `None` where the view has no such ray.
    pub closest_mrays_per_s: Option<f64>,
    /// Million occlusion tests a second; `None` where the view has no such ray.
    pub occlusion_mrays_per_s: Option<f64>,
}

impl BuilderFigures {
    /// The figures of a world whose trees have one level.
    pub fn of(world: &World) -> Self {
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
        let wide = aggregate.wide_stats();
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
        let triangles: u64 = world
            .objects
            .iter()
            .map(|object| object.mesh.tree.triangles().len() as u64)
            .sum();
        Self {
            builder: name(aggregate.options().builder),
            triangles,
            levels,
            nodes,
            leaves,
            largest_leaf,
            sah_cost,
            epo: epo(aggregate.tree(), |slot| corners[slot as usize]),
            wide_nodes: wide.nodes,
            children_per_wide_node: wide.children_per_node,
            triangles_per_block: wide.triangles_per_block,
            bytes,
            bytes_per_triangle: bytes as f64 / triangles.max(1) as f64,
            build_ms: build_time(world).as_secs_f64() * 1e3,
            leaf_sizes,
            depths,
            rates: None,
        }
    }
}

/// As tables and statistics call it.
fn name(builder: Builder) -> &'static str {
    match builder {
        Builder::None => "none",
        Builder::Median => "median",
        Builder::Sah => "sah",
        Builder::Ploc => "ploc",
    }
}

/// Time spent on the trees of a world, each counted once.
fn build_time(world: &World) -> Duration {
    let mut seen = HashSet::new();
    let meshes: Duration = world
        .objects
        .iter()
        .filter(|object| seen.insert(Arc::as_ptr(&object.mesh.tree)))
        .map(|object| object.mesh.tree.build_time())
        .sum();
    meshes + world.aggregate.build_time()
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

/// Builds the world's trees with each builder and measures them: the figures on one tree over all
/// triangles, so that one row says it all; with `view` also the speed on that camera's own rays, with
/// the levels that the world has.
pub fn compare_builders(
    world: &World,
    builders: &[Builder],
    view: Option<(&Camera, &RenderSettings)>,
) -> Vec<BuilderFigures> {
    let options = *world.aggregate.options();
    let mut figures: Vec<BuilderFigures> = builders
        .iter()
        .map(|&builder| {
            let options = BuildOptions {
                builder,
                levels: Levels::One,
                ..options
            };
            BuilderFigures::of(&rebuilt(world, &options))
        })
        .collect();
    let Some((camera, settings)) = view else {
        return figures;
    };
    let rays = ViewRays::of(world, camera, settings);
    let mut aggregates: Vec<Arc<Aggregate>> = builders
        .iter()
        .map(|&builder| rebuilt(world, &BuildOptions { builder, ..options }).aggregate)
        .collect();
    let rates = rays.rates(&mut aggregates);
    for (figures, rates) in figures.iter_mut().zip(rates) {
        figures.rates = Some(rates);
    }
    figures
}

/// The same world with other trees.
fn rebuilt(world: &World, options: &BuildOptions) -> World {
    // One tree over all triangles needs none over those of a mesh.
    let mesh_options = match options.levels {
        Levels::One => BuildOptions {
            builder: Builder::None,
            ..*options
        },
        Levels::Two => *options,
    };
    let mut meshes: HashMap<*const Mesh, Arc<Mesh>> = HashMap::default();
    let objects: Vec<Object> = world
        .objects
        .iter()
        .map(|object| {
            let mesh = meshes.entry(Arc::as_ptr(&object.mesh)).or_insert_with(|| {
                let triangles = object.mesh.tree.triangles().clone();
                Arc::new(Mesh {
                    tree: Arc::new(MeshTree::build(triangles, &mesh_options)),
                    normals: object.mesh.normals.clone(),
                    uvs: object.mesh.uvs.clone(),
                })
            });
            Object {
                mesh: mesh.clone(),
                ..object.clone()
            }
        })
        .collect();
    let instances: Vec<Instance> = world
        .aggregate
        .instances()
        .iter()
        .zip(&objects)
        .map(|(instance, object)| {
            let mut instance = instance.clone();
            instance.mesh = object.mesh.tree.clone();
            instance
        })
        .collect();
    World {
        aggregate: Arc::new(Aggregate::build(instances, options)),
        objects: Arc::new(objects),
        ..world.clone()
    }
}

/// Pixels along each side of the grid whose rays are timed.
const GRID: u32 = 24;

/// A measurement takes at least this long, or all rays.
const LEAST: Duration = Duration::from_millis(4);

/// Measurements of each builder, taking turns; the middle one counts.
const ROUNDS: usize = 5;

/// Rays of a view, by the query that a render makes with them.
struct ViewRays {
    closest: Vec<Ray>,
    occlusion: Vec<Ray>,
}

impl ViewRays {
    /// Those of the first sample of a grid of pixels. Straight continuations are left out: their
    /// query is another.
    fn of(world: &World, camera: &Camera, settings: &RenderSettings) -> Self {
        let mut rays = Self {
            closest: Vec::new(),
            occlusion: Vec::new(),
        };
        for i in 0..GRID * GRID {
            let cell = UVec2::new(i % GRID, i / GRID);
            let pixel = (2 * cell + UVec2::ONE) * settings.size / (2 * GRID);
            let Ok(tree) = probe(world, camera, settings, pixel, &Samples::One(0)) else {
                continue;
            };
            for ray in tree.rays.iter().filter(|ray| ray.end.is_traced()) {
                match ray.kind {
                    RayKind::Transmission => {}
                    kind if kind.is_for_light() => rays.occlusion.push(ray.ray()),
                    _ => rays.closest.push(ray.ray()),
                }
            }
        }
        rays
    }

    fn rates(&self, aggregates: &mut [Arc<Aggregate>]) -> Vec<BuilderRates> {
        let mut hits = Vec::new();
        let closest = rates(&self.closest, aggregates, |aggregate, rays| {
            aggregate.closest_hits(rays, &mut hits);
        });
        let mut occluded = Vec::new();
        let occlusion = rates(&self.occlusion, aggregates, |aggregate, rays| {
            aggregate.occlusions(rays, &mut occluded);
        });
        closest
            .into_iter()
            .zip(occlusion)
            .map(
                |(closest_mrays_per_s, occlusion_mrays_per_s)| BuilderRates {
                    closest_mrays_per_s,
                    occlusion_mrays_per_s,
                },
            )
            .collect()
    }
}

/// Million rays a second of each aggregate.
fn rates(
    rays: &[Ray],
    aggregates: &[Arc<Aggregate>],
    mut trace: impl FnMut(&Aggregate, &[Ray]),
) -> Vec<Option<f64>> {
    if rays.is_empty() {
        return vec![None; aggregates.len()];
    }
    let mut seconds = |aggregate: &Aggregate, count: usize| {
        let start = Instant::now();
        let mut left = count;
        while left > 0 {
            let part = left.min(rays.len());
            trace(aggregate, &rays[..part]);
            left -= part;
        }
        start.elapsed()
    };
    // As many rays as take long enough; a power of two times a few.
    let counts: Vec<usize> = aggregates
        .iter()
        .map(|aggregate| {
            let mut count = 16;
            while seconds(aggregate, count) < LEAST && count < 1 << 24 {
                count *= 2;
            }
            count
        })
        .collect();
    let mut measured = vec![Vec::with_capacity(ROUNDS); aggregates.len()];
    for _ in 0..ROUNDS {
        for (i, aggregate) in aggregates.iter().enumerate() {
            let took = seconds(aggregate, counts[i]).as_secs_f64();
            measured[i].push(counts[i] as f64 / took.max(1e-9) / 1e6);
        }
    }
    measured
        .into_iter()
        .map(|mut rates| {
            rates.sort_by(f64::total_cmp);
            Some(rates[ROUNDS / 2])
        })
        .collect()
}

/// Names of the columns.
const COLUMNS: [&str; 16] = [
    "builder",
    "triangles",
    "levels",
    "nodes",
    "leaves",
    "largest leaf",
    "SAH cost",
    "EPO",
    "wide nodes",
    "children each",
    "triangles/block",
    "bytes",
    "bytes/triangle",
    "build ms",
    "closest Mray/s",
    "occlusion Mray/s",
];

impl BuilderFigures {
    fn cells(&self) -> [String; 16] {
        let rate = |rate: Option<f64>| rate.map_or_else(|| "-".into(), |rate| format!("{rate:.3}"));
        [
            self.builder.to_owned(),
            self.triangles.to_string(),
            self.levels.to_string(),
            self.nodes.to_string(),
            self.leaves.to_string(),
            self.largest_leaf.to_string(),
            format!("{:.2}", self.sah_cost),
            format!("{:.3}", self.epo),
            self.wide_nodes.to_string(),
            format!("{:.2}", self.children_per_wide_node),
            format!("{:.2}", self.triangles_per_block),
            self.bytes.to_string(),
            format!("{:.1}", self.bytes_per_triangle),
            format!("{:.2}", self.build_ms),
            rate(self.rates.and_then(|rates| rates.closest_mrays_per_s)),
            rate(self.rates.and_then(|rates| rates.occlusion_mrays_per_s)),
        ]
    }
}

/// Header and rows; without the rates where none was measured.
fn cells(rows: &[BuilderFigures]) -> Vec<Vec<String>> {
    let measured = rows.iter().any(|row| row.rates.is_some());
    let columns = if measured { 16 } else { 14 };
    let header = COLUMNS.map(String::from);
    std::iter::once(header)
        .chain(rows.iter().map(BuilderFigures::cells))
        .map(|line| line[..columns].to_vec())
        .collect()
}

impl BuilderFigures {
    /// A table for a terminal.
    pub fn table(rows: &[Self]) -> String {
        aligned(&cells(rows))
    }
}

/// The table in Markdown, and below it both histograms: a column for each builder.
pub fn markdown(rows: &[BuilderFigures]) -> String {
    let mut text = String::new();
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let table = cells(rows);
    for (i, cells) in table.iter().enumerate() {
        text += &line(cells);
        if i == 0 {
            text += &format!("|---|{}\n", "---:|".repeat(cells.len() - 1));
        }
    }
    for (title, first, histogram) in [
        ("Leaves by their triangles", "triangles", true),
        ("Leaves by their depth", "depth", false),
    ] {
        text += &format!("\n{title}:\n\n");
        let names: Vec<String> = rows.iter().map(|row| row.builder.to_owned()).collect();
        text += &format!("| {first} | {} |\n", names.join(" | "));
        text += &format!("|---:|{}\n", "---:|".repeat(names.len()));
        let of = |row: &BuilderFigures, bin: usize| {
            let bins = if histogram {
                &row.leaf_sizes
            } else {
                &row.depths
            };
            bins.get(bin).copied().unwrap_or(0)
        };
        let most = rows
            .iter()
            .map(|row| row.leaf_sizes.len().max(row.depths.len()))
            .max()
            .unwrap_or(0);
        for bin in 0..most {
            let counts: Vec<u32> = rows.iter().map(|row| of(row, bin)).collect();
            if counts.iter().all(|&count| count == 0) {
                continue;
            }
            let counts: Vec<String> = counts.iter().map(u32::to_string).collect();
            let bin = if histogram && bin == crate::bvh::LARGEST_LEAF_BIN {
                format!("{bin} and more")
            } else {
                bin.to_string()
            };
            text += &format!("| {bin} | {} |\n", counts.join(" | "));
        }
    }
    text
}

/// The table as comma-separated values, the histograms as two more columns of numbers with spaces
/// between them.
pub fn csv(rows: &[BuilderFigures]) -> String {
    let join = |bins: &[u32]| {
        bins.iter()
            .map(u32::to_string)
            .collect::<Vec<_>>()
            .join(" ")
    };
    let mut text = format!(
        "{},leaves by triangles,leaves by depth\n",
        COLUMNS.join(",")
    );
    for row in rows {
        let cells = row.cells().join(",");
        text += &format!("{cells},{},{}\n", join(&row.leaf_sizes), join(&row.depths));
    }
    text
}

//! Instructions of a ray, counted by callgrind: they are repeatable where times are not.
//!
//! The bench runs itself under valgrind, once for each kernel, and has only that kernel's batch
//! counted.

use crate::surfaces::{knot, patch, random};
use glam::{Affine3A, Vec3, vec3};
use glassbox::bvh::{Aggregate, BuildOptions, Builder, Instance, Levels, MeshTree, Ray, Triangles};
use std::env;
use std::hint::black_box;
use std::process::{Command, ExitCode, Stdio};
use std::sync::Arc;

/// The variable that names the kernel to a run under valgrind.
const KERNEL: &str = "GLASSBOX_COUNTED_KERNEL";
/// Of the batch.
const RAYS: usize = 2000;
/// Watching that nobody does may cost at most so much: percent.
const MOST: f64 = 5.0;

/// How the trees hang together.
const LEVELS: [(&str, Levels); 2] = [("one level", Levels::One), ("two levels", Levels::Two)];

/// What is counted: its name, and the function whose calls callgrind collects.
const KERNELS: [(&str, &str); 2] = [
    ("batch", "*count_batch*"),
    ("empty visitor", "*count_watched*"),
];

/// Runs a kernel where this is a run under valgrind; counts all of them where the command line asks
/// for it. `None`: neither.
pub fn main() -> Option<ExitCode> {
    if let Ok(kernel) = env::var(KERNEL) {
        run(&kernel);
        return Some(ExitCode::SUCCESS);
    }
    env::args()
        .any(|argument| argument == "instructions")
        .then(count)
}

/// Counts every kernel, prints a table, and fails where the empty visitor costs more than it may.
fn count() -> ExitCode {
    let mut code = ExitCode::SUCCESS;
    for (levels, _) in LEVELS {
        println!("{levels}: instructions of a ray, {RAYS} rays");
        let mut batch = None;
        for (name, function) in KERNELS {
            let counted = match counted(&format!("{levels}/{name}"), function) {
                Ok(counted) => counted as f64 / RAYS as f64,
                Err(why) => {
                    eprintln!("error: {name}: {why}");
                    return ExitCode::FAILURE;
                }
            };
            let of = *batch.get_or_insert(counted);
            let more = 100.0 * (counted / of - 1.0);
            println!("  {name:14}{counted:10.1}{more:+9.3} %");
            if name == "empty visitor" && more > MOST {
                eprintln!("error: the empty visitor may cost {MOST} %, not {more:.3} %");
                code = ExitCode::FAILURE;
            }
        }
    }
    code
}

/// Instructions of the calls of a function in a run of this program under valgrind.
fn counted(kernel: &str, function: &str) -> Result<u64, String> {
    let program = env::current_exe().map_err(|error| error.to_string())?;
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .arg(format!("--toggle-collect={function}"))
        .arg(program)
        .env(KERNEL, kernel)
        // Trees are built alike in every run.
        .env("RAYON_NUM_THREADS", "1")
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("valgrind: {error}; install it"))?;
    let said = String::from_utf8_lossy(&output.stderr);
    let line = said.lines().find(|line| line.contains("Collected :"));
    let count = line.and_then(|line| line.rsplit(' ').next()?.parse().ok());
    count
        .filter(|&count| count > 0 && output.status.success())
        .ok_or_else(|| format!("valgrind counted nothing:\n{said}"))
}

/// The run under valgrind.
fn run(kernel: &str) {
    let levels = LEVELS.iter().find(|(name, _)| kernel.starts_with(name));
    let (aggregate, rays) = subject(levels.map_or(Levels::Two, |(_, levels)| *levels));
    let hits = match kernel.rsplit('/').next() {
        Some("batch") => count_batch(&aggregate, &rays),
        _ => count_watched(&aggregate, &rays),
    };
    println!("{hits} hits");
}

#[inline(never)]
fn count_watched(aggregate: &Aggregate, rays: &[Ray]) -> usize {
    let hit = |ray: &&Ray| aggregate.closest_hit_with(ray, &mut ()).is_some();
    black_box(rays).iter().filter(hit).count()
}

#[inline(never)]
fn count_batch(aggregate: &Aggregate, rays: &[Ray]) -> usize {
    let mut hits = Vec::new();
    aggregate.closest_hits(black_box(rays), &mut hits);
    hits.iter().flatten().count()
}

/// Two knots, one of them turned, and rays from the first one's surface in all directions.
fn subject(levels: Levels) -> (Aggregate, Vec<Ray>) {
    let corners = patch(16, 15_000, knot);
    let positions = corners.as_flattened().to_vec();
    let indices = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let triangles = Triangles::new(positions, indices.collect()).expect("indices in range");
    let options = BuildOptions {
        builder: Builder::Sah,
        levels,
        ..BuildOptions::default()
    };
    let mesh = Arc::new(MeshTree::build(triangles, &options));
    let places = [
        Affine3A::IDENTITY,
        Affine3A::from_rotation_y(0.7) * Affine3A::from_translation(vec3(1.0, 2.5, 0.5)),
    ];
    let instances = places.map(|place| Instance::new(mesh.clone(), &place).expect("invertible"));
    let mut random = random();
    let rays = (0..RAYS)
        .map(|_| {
            let [a, b, c] = corners[(random() * corners.len() as f32) as usize];
            let direction: Vec3 = vec3(random(), random(), random()) - 0.5;
            let normal = (b - a).cross(c - a).normalize_or_zero();
            Ray::new((a + b + c) / 3.0 + normal * 1e-3, direction)
        })
        .collect();
    (Aggregate::build(instances.to_vec(), &options), rays)
}

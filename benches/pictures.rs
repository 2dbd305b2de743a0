//! How fast whole pictures are, and how much of that is rays.
//!
//! `cargo bench --no-default-features --bench pictures [-- SCENE…]`: for each built-in scene a picture of 256 × 256 pixels and
//! 16 samples each, the least of several renderings; the same rays asked of the trees alone, in batches as large as a render's
//! and in much the same order: tile by tile, and those to one light together; and the seconds to an error of 1 %, of the picture's true error as it falls with the root of
//! the samples. The truth is the mean of other seeds' pictures.
//!
//! One thread, its own time on a processor (Linux: `/proc/self/task`; elsewhere the clock's).
//! `benches/peers.py` renders the same scenes with other renderers.

#[path = "shared/scenes.rs"]
mod scenes;

use glam::UVec2;
use glassbox::bvh::{Order, Ray};
use glassbox::scene::Sampling;
use glassbox::trace::{RayKind, Samples, probe};
use scenes::{Reference, Scene, processor_seconds, scenes};
use std::collections::BTreeMap;
use std::time::Instant;

const SIZE: UVec2 = UVec2::new(256, 256);
const SAMPLES: u32 = 16;
/// Renderings of which the fastest counts.
const RUNS: u32 = 7;
const WANTED: f64 = 0.01;
/// Pixels a side of what a render gives to a packet, and rays that it asks for together.
const BLOCK: u32 = 4;
const BATCH: usize = 512;
/// Times that they are asked: a system counts a thread's time by some milliseconds.
const REPEATED: u32 = 100;
/// Of so many blocks a side one is looked into.
const EVERY: u32 = 3;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("a thread").install(|| {
        println!(
            "| scene | Msamples/s | Mrays/s | of the trees' own | true error at 16 | s to 1 % |"
        );
        println!("|---|---:|---:|---:|---:|---:|");
        scenes(SIZE).for_each(|scene| line(&scene));
    });
}

fn line(scene: &Scene) {
    let runs = (0..RUNS).map(|_| scene.render(1, SAMPLES, Sampling::default()));
    let timed = runs
        .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
        .expect("a run");
    let samples = f64::from(SIZE.element_product() * SAMPLES);
    let rays = timed.rendered.status.rays.total() as f64;
    let alone = seconds_a_ray(scene) * rays;
    let error = Reference::of(scene)
        .error_of(&timed.rendered.picture)
        .sqrt();
    println!(
        "| {} | {:.2} | {:.2} | {:.0} % | {:.2} % | {:.2} |",
        scene.name,
        samples / timed.seconds * 1e-6,
        rays / timed.seconds * 1e-6,
        100.0 * alone / timed.seconds,
        100.0 * error,
        timed.seconds * (error / WANTED).powi(2),
    );
}

/// What the trees take for a ray of the picture, on average: rays of some blocks of its pixels, those of each kind in the
/// order of a render. What lies on shadow rays counts as hiding the light.
fn seconds_a_ray(scene: &Scene) -> f64 {
    let mut camera = Vec::new();
    let mut scattered = Vec::new();
    // A render asks for one light after another.
    let mut shadows: BTreeMap<_, Vec<Ray>> = BTreeMap::new();
    let blocks = SIZE / BLOCK;
    for y in (0..blocks.y).step_by(EVERY as usize) {
        for x in (0..blocks.x).step_by(EVERY as usize) {
            for i in 0..BLOCK * BLOCK {
                let pixel = BLOCK * UVec2::new(x, y) + UVec2::new(i % BLOCK, i / BLOCK);
                let tree = probe(
                    &scene.world,
                    &scene.camera,
                    &scene.settings,
                    pixel,
                    &Samples::One(0),
                );
                for ray in &tree.expect("a pixel of the picture").rays {
                    match (ray.kind, ray.light) {
                        (RayKind::Camera, _) => camera.push(ray.ray()),
                        (_, None) => scattered.push(ray.ray()),
                        // What reflects nothing of a light is not asked of the trees.
                        (_, Some(light)) if ray.end.is_traced() => {
                            shadows.entry(light.id).or_default().push(ray.ray());
                        }
                        _ => {}
                    }
                }
            }
        }
    }
    let aggregate = &scene.world.aggregate;
    let (mut hits, mut occluded) = (Vec::new(), Vec::new());
    let mut ask = || {
        for (order, rays) in [(Order::Tile, &camera), (Order::None, &scattered)] {
            for rays in rays.chunks(BATCH) {
                aggregate.closest_hits_in(order, rays, &mut hits);
            }
        }
        for rays in shadows.values().flat_map(|rays| rays.chunks(BATCH)) {
            aggregate.occlusions_in(Order::Light, rays, &mut occluded);
        }
    };
    let to_lights: usize = shadows.values().map(Vec::len).sum();
    let count = camera.len() + scattered.len() + to_lights;
    ask();
    let taken = seconds(&mut || (0..REPEATED).for_each(|_| ask()));
    taken / f64::from(REPEATED) / count as f64
}

fn seconds(work: &mut impl FnMut()) -> f64 {
    let (clock, before) = (Instant::now(), processor_seconds());
    work();
    match (before, processor_seconds()) {
        (Some(before), Some(after)) => after - before,
        _ => clock.elapsed().as_secs_f64(),
    }
}

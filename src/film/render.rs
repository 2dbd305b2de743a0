use super::tiles::{FilmPixel, Tile};
use super::{Film, Picture, TILE};
use crate::scene::RenderSettings;
use crate::trace::{Camera, RayCounts, SampleId, Workspace, World, radiance, samples_per_pixel};
use glam::Vec3;
use rayon::prelude::*;
use std::cell::RefCell;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A finished picture, and what it took.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Linear, scene-referred.
    pub picture: Picture,
    /// Rays traced, by kind.
    pub rays: RayCounts,
    /// Wall-clock time.
    pub seconds: f64,
}

/// Renders every pixel with as many samples as the scene and its settings ask for
/// ([`samples_per_pixel`]), on the current rayon pool.
///
/// `progress` is told, from any thread, how many samples of how many are done.
pub fn render(
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> Rendered {
    let start = Instant::now();
    let mut film = Film::new(settings.size);
    let rays = add_samples(
        &mut film,
        world,
        camera,
        settings,
        0..u64::from(samples_per_pixel(world, camera, settings)),
        progress,
    );
    Rendered {
        picture: film.picture(),
        rays,
        seconds: start.elapsed().as_secs_f64(),
    }
}

/// Samples of one batch: enough that the trees get long lists of rays, few enough to stay in cache.
const BATCH: usize = 1024;

/// What a thread keeps from tile to tile, so that none allocates.
#[derive(Default)]
struct Scratch {
    samples: Vec<SampleId>,
    values: Vec<Vec3>,
    workspace: Workspace,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Adds the samples with these indices to every pixel of the film.
fn add_samples(
    film: &mut Film,
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    indices: Range<u64>,
    progress: &(dyn Fn(u64, u64) + Sync),
) -> RayCounts {
    let size = film.size();
    let all = u64::from(size.x) * u64::from(size.y) * (indices.end - indices.start);
    let done = AtomicU64::new(0);
    let counts = Mutex::new(RayCounts::default());
    let tiles: Vec<_> = film.tiles_mut().collect();
    tiles.into_par_iter().for_each(|(tile, pixels)| {
        let rays = SCRATCH.with_borrow_mut(|scratch| {
            sample_tile(
                tile,
                pixels,
                world,
                camera,
                settings,
                indices.clone(),
                scratch,
            )
        });
        if let Ok(mut counts) = counts.lock() {
            *counts += rays;
        }
        let samples = u64::from(tile.extent.element_product()) * (indices.end - indices.start);
        progress(done.fetch_add(samples, Ordering::Relaxed) + samples, all);
    });
    counts.into_inner().unwrap_or_default()
}

fn sample_tile(
    tile: Tile,
    pixels: &mut [FilmPixel],
    world: &World,
    camera: &Camera,
    settings: &RenderSettings,
    indices: Range<u64>,
    scratch: &mut Scratch,
) -> RayCounts {
    let mut counts = RayCounts::default();
    let at_once = (BATCH / (TILE * TILE) as usize).max(1) as u64;
    let mut first = indices.start;
    while first < indices.end {
        let chunk = first..(first + at_once).min(indices.end);
        first = chunk.end;
        scratch.samples.clear();
        for index in chunk.clone() {
            scratch
                .samples
                .extend(tile.pixels().map(|(pixel, _)| SampleId { pixel, index }));
        }
        scratch.values.resize(scratch.samples.len(), Vec3::ZERO);
        counts += radiance(
            world,
            camera,
            settings,
            &scratch.samples,
            &mut scratch.values,
            &mut scratch.workspace,
        );
        let mut values = scratch.values.iter();
        for _ in chunk {
            for ((_, place), value) in tile.pixels().zip(values.by_ref()) {
                pixels[place].sum.add(*value);
                pixels[place].count += 1;
            }
        }
    }
    counts
}

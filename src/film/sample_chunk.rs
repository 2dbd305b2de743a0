//! The samples of a chunk: batch by batch, so that a render can stop between two of them.

use super::Sum;
use super::tile_state::{Chunk, TILE_PIXELS};
use super::tiles::Tile;
use crate::scene::RenderSettings;
use crate::trace::{Camera, RayCounts, SampleId, Workspace, World, radiance};
use glam::{UVec2, Vec3};
use std::cell::RefCell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// What samples depend on.
pub(super) struct Subject {
    pub world: World,
    pub camera: Camera,
    pub settings: RenderSettings,
}

/// How many samples go into a batch. Many, so that the trees get long lists of rays; so few that
/// they stay in a core's second-level cache and that a batch takes about 2 ms, since a render stops
/// between batches only. What a sample costs is not known beforehand, so threads adjust it together.
pub(super) struct BatchSize(AtomicUsize);

const LEAST_BATCH: usize = 4;
const LARGEST_BATCH: usize = 1024;
const SHORT: Duration = Duration::from_millis(1);
const LONG: Duration = Duration::from_millis(4);

impl BatchSize {
    pub fn new() -> Self {
        Self(AtomicUsize::new(16))
    }

    pub fn get(&self) -> usize {
        self.0.load(Ordering::Relaxed)
    }

    fn learn(&self, samples: usize, took: Duration) {
        if samples != self.get() {
            return;
        }
        let next = if took < SHORT {
            2 * samples
        } else if took > LONG {
            samples / 2
        } else {
            samples
        };
        self.0
            .store(next.clamp(LEAST_BATCH, LARGEST_BATCH), Ordering::Relaxed);
    }
}

/// What a thread keeps from chunk to chunk, so that none allocates.
#[derive(Default)]
pub(super) struct Scratch {
    places: Vec<(UVec2, usize)>,
    samples: Vec<SampleId>,
    values: Vec<Vec3>,
    workspace: Workspace,
    /// `TILE_PIXELS` for each segment of the chunk.
    pub sums: Vec<Sum>,
}

thread_local! {
    static SCRATCH: RefCell<Scratch> = RefCell::default();
}

/// Gives `work` what this thread keeps.
pub(super) fn with_scratch<R>(work: impl FnOnce(&mut Scratch) -> R) -> R {
    let mut scratch = SCRATCH.take();
    let result = work(&mut scratch);
    SCRATCH.set(scratch);
    result
}

impl Scratch {
    /// Sums the chunk's samples into [`Self::sums`]. `known` are the first samples of pixels that
    /// were evaluated before, by their place in the tile. `None` where `stopped` became true.
    pub fn sum_chunk(
        &mut self,
        subject: &Subject,
        tile: Tile,
        chunk: &Chunk,
        known: &[Option<Vec3>],
        batch: &BatchSize,
        stopped: &dyn Fn() -> bool,
    ) -> Option<RayCounts> {
        let mut rays = RayCounts::default();
        self.sums.clear();
        for segment in chunk.segments() {
            let first = self.sums.len();
            self.sums.resize(first + TILE_PIXELS, Sum::default());
            let mut places = std::mem::take(&mut self.places);
            places.clear();
            places.extend(tile.pixels().filter(|(_, at)| chunk.pixels.has(*at)));
            if segment.start == 0 && !known.is_empty() {
                // The first segment is sample 0 alone.
                for &(_, at) in &places {
                    if let Some(value) = known[at] {
                        self.sums[at].add(value);
                    }
                }
                places.retain(|&(_, at)| known[at].is_none());
            }
            let pixels = places.len() as u64;
            let mut next = segment.start * pixels;
            while next < segment.end * pixels {
                let end = (next + batch.get() as u64).min(segment.end * pixels);
                let place = |i: u64| places[(i % pixels) as usize];
                let ids = (next..end).map(|i| SampleId {
                    pixel: place(i).0,
                    index: i / pixels,
                });
                rays += self.evaluate(subject, ids, batch);
                for (i, value) in (next..end).zip(&self.values) {
                    self.sums[first + place(i).1].add(*value);
                }
                next = end;
                if stopped() {
                    self.places = places;
                    return None;
                }
            }
            self.places = places;
        }
        Some(rays)
    }

    /// The radiance of samples, which stays in `self.values` until the next call.
    pub fn evaluate(
        &mut self,
        subject: &Subject,
        ids: impl Iterator<Item = SampleId>,
        batch: &BatchSize,
    ) -> RayCounts {
        let start = Instant::now();
        self.samples.clear();
        self.samples.extend(ids);
        self.values.resize(self.samples.len(), Vec3::ZERO);
        let rays = radiance(
            &subject.world,
            &subject.camera,
            &subject.settings,
            &self.samples,
            &mut self.values,
            &mut self.workspace,
        );
        batch.learn(self.samples.len(), start.elapsed());
        rays
    }

    /// What the last [`Self::evaluate`] found.
    pub fn values(&self) -> &[Vec3] {
        &self.values
    }
}

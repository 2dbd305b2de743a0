//! The samples of a chunk: batch by batch, so that a render can stop between two of them, and within one that takes long.

use super::kept::Kept;
use super::per_sample::BatchPlaces;
use crate::film::errors::unmet::{NO_OCTAVES, Octaves, count_octave, count_octaves};
use crate::film::planes::tile_state::Chunk;
use crate::film::subject::Subject;
use crate::film::sums::sum_columns::SumColumns;
use crate::film::sums::tiles::{TILE_PIXELS, Tile, pixel_in_tile};
use crate::trace::planes::OWN;
use crate::trace::{
    FEW_LIGHTS, MaterialSet, PlaneSet, RayCounts, SampleId, Untinted, Workspace, radiance_in_planes,
};
use glam::{UVec2, Vec3};
use std::cell::Cell;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// How many samples go into a batch. Many, so that the trees get long lists of rays; so few that
/// they stay in a core's second-level cache and that a batch takes about 1 ms, since a render stops,
/// and lets others have the core, between batches only. What a sample costs is not known beforehand, so
/// threads adjust it together; and it differs from place to place, so there is a limit by the rays that
/// it may take.
pub(in crate::film) struct BatchSize {
    now: AtomicUsize,
    least: AtomicUsize,
    most: AtomicUsize,
}

/// Of many lights each is looked at for a batch: so many samples take hardly longer than one.
const LEAST_OF_MANY_LIGHTS: usize = 32;
const LARGEST_BATCH: usize = 512;
/// Samples of a pixel that stand side by side in a batch, at most: their rays go nearly the same way from nearly the same
/// place, and meet the same triangles. Where too few are asked for to fill packets, each pixel has one in turn.
const DEEPEST: u64 = 64;
const LEAST_DEEP: u64 = 16;
/// Some milliseconds of rays through a large scene.
const RAYS: u64 = 8192;
const SHORT: Duration = Duration::from_micros(400);
const LONG: Duration = Duration::from_micros(1500);

impl BatchSize {
    pub fn new(subject: &Subject) -> Self {
        let size = Self {
            now: AtomicUsize::new(1),
            least: AtomicUsize::new(1),
            most: AtomicUsize::new(1),
        };
        size.suit(subject);
        size
    }

    /// Batches are of another subject from now on.
    pub fn suit(&self, subject: &Subject) {
        let most = RAYS / rays_of_first_hit(subject);
        let least = if subject.light.world.needs.faint > 0.0 {
            LEAST_OF_MANY_LIGHTS
        } else {
            1
        };
        let most = (most as usize).clamp(least, LARGEST_BATCH);
        self.least.store(least, Ordering::Relaxed);
        self.most.store(most, Ordering::Relaxed);
    }

    pub fn get(&self) -> usize {
        let [least, most] = [&self.least, &self.most].map(|n| n.load(Ordering::Relaxed));
        self.now.load(Ordering::Relaxed).max(least).min(most)
    }

    fn learn(&self, samples: usize, took: Duration) {
        let now = self.get();
        if 2 * samples <= now || samples > now {
            // It was fewer that were there, or another thread has learnt from as many.
            return;
        }
        let next = if took < SHORT {
            2 * now
        } else if took > LONG {
            now / 2
        } else {
            now
        };
        let most = self.most.load(Ordering::Relaxed);
        self.now.store(next.clamp(1, most), Ordering::Relaxed);
    }
}

/// Looking how much so many points of lights would add takes as long as a shadow ray.
const FAINT_POINTS_A_RAY: u64 = 8;

/// Rays that a sample sends out where it first hits something, at most.
fn rays_of_first_hit(subject: &Subject) -> u64 {
    let Subject {
        world, settings, ..
    } = subject;
    let features = &settings.features;
    let lamps = world.lamps(settings);
    let points = lamps
        .map(|lamp| u64::from(lamp.samples(settings).unwrap_or(1)))
        .sum::<u64>();
    let mut rays = 1 + if world.needs.faint > 0.0 {
        FEW_LIGHTS as u64 + points / FAINT_POINTS_A_RAY
    } else {
        points
    };
    let materials = &world.materials;
    if features.glossy && materials.iter().any(|m| m.mirror != Vec3::ZERO) {
        rays += u64::from(settings.gloss_samples);
    }
    if features.translucency && world.needs.transparency {
        rays += u64::from(settings.translucency_samples);
    }
    rays
}

/// What a thread keeps from chunk to chunk, so that none allocates.
pub(in crate::film) struct Scratch {
    /// What is worked on.
    pub chunks: Vec<Chunk>,
    /// The places of the chunk's pixels in the tile, and, where they are not all of the tile's, the sums of a segment in
    /// their order.
    places: Vec<usize>,
    columns: SumColumns,
    samples: Vec<SampleId>,
    /// Plane by plane of those that were asked for.
    values: Vec<Vec3>,
    /// The values of the samples, all those planes together, where they are more than what shines by itself.
    folded: Vec<Vec3>,
    workspace: Workspace,
    /// When others last had the core for the asking.
    gave_way: Option<Instant>,
    /// `TILE_PIXELS` for each of the chunk's planes, of each of its segments.
    pub sums: SumColumns,
    /// How bright samples are: added to, chunk by chunk.
    pub octaves: Octaves,
    /// The materials that they met.
    pub met: MaterialSet,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            chunks: Vec::new(),
            places: Vec::new(),
            columns: SumColumns::default(),
            samples: Vec::new(),
            values: Vec::new(),
            folded: Vec::new(),
            workspace: Workspace::default(),
            gave_way: None,
            sums: SumColumns::default(),
            octaves: NO_OCTAVES,
            met: MaterialSet::NONE,
        }
    }
}

thread_local! {
    /// None while it is in use.
    static SCRATCH: Cell<Option<Box<Scratch>>> = const { Cell::new(None) };
}

/// Gives `work` what this thread keeps.
pub(in crate::film) fn with_scratch<R>(work: impl FnOnce(&mut Scratch) -> R) -> R {
    let mut scratch = SCRATCH.take().unwrap_or_default();
    let result = work(&mut scratch);
    SCRATCH.set(Some(scratch));
    result
}

/// What the samples of chunks are taken with.
pub(in crate::film) struct Work<'a> {
    pub subject: &'a Subject,
    pub batch: &'a BatchSize,
    /// What is known of samples from before.
    pub kept: Option<&'a Kept>,
    /// Whether to leave it.
    pub stopped: &'a dyn Fn() -> bool,
}

impl Scratch {
    /// Sums the chunk's samples into [`Self::sums`]. `None` where it was stopped.
    pub fn sum_chunk(&mut self, work: &Work, tile: Tile, chunk: &Chunk) -> Option<RayCounts> {
        let subject = work.subject;
        let mut rays = RayCounts::default();
        self.sums.truncate(0);
        let octaves = self.octaves;
        let mut places = std::mem::take(&mut self.places);
        places.clear();
        places.extend(tile.places(chunk.pixels));
        self.workspace.take_met();
        let rows = chunk.planes.rows(subject.planes());
        let complete = chunk.segments().all(|segment| {
            self.sums.extend(rows * TILE_PIXELS);
            let sampled = self.sum_segment(work, (tile, &places), chunk, segment);
            rays += sampled.unwrap_or_default();
            sampled.is_some()
        });
        self.places = places;
        self.met = self.workspace.take_met();
        if !complete {
            // It is done again.
            self.octaves = octaves;
            return None;
        }
        Some(rays)
    }

    /// Counts the samples of a chunk that are all of this colour, and says which rays that saves.
    pub fn see_nothing(&mut self, color: Vec3, tile: Tile, chunk: &Chunk) -> RayCounts {
        let samples = (chunk.range.end - chunk.range.start) * tile.count(chunk.pixels);
        let is_seen = chunk.planes.has(OWN);
        let value = if is_seen { color } else { Vec3::ZERO };
        count_octave(value, samples, &mut self.octaves);
        RayCounts {
            camera: if is_seen { samples } else { 0 },
            ..RayCounts::default()
        }
    }

    /// Adds these samples of the chunk, whose pixels lie at these places, to the segment's sums, which are the last ones.
    fn sum_segment(
        &mut self,
        work: &Work,
        (tile, places): (Tile, &[usize]),
        chunk: &Chunk,
        segment: Range<u64>,
    ) -> Option<RayCounts> {
        let Work {
            subject,
            batch,
            stopped,
            ..
        } = *work;
        let wanted = chunk.planes;
        let mut rays = RayCounts::default();
        let planes = wanted.of(subject.planes());
        let rows = wanted.rows(subject.planes());
        let first = self.sums.len() - rows * TILE_PIXELS;
        let is_whole = places.len() == TILE_PIXELS;
        if !is_whole {
            self.columns.reset(rows * places.len());
        }
        let whole = is_whole.then_some(first);
        let mut indices = segment.start..segment.start;
        while indices.end < segment.end {
            let left = segment.end - indices.end;
            let by_place = left >= LEAST_DEEP;
            let turns = (batch.get() / places.len().max(1)).max(1) as u64;
            let deep = left.min(if by_place { DEEPEST } else { turns });
            indices = indices.end..indices.end + deep;
            let mut at = 0;
            while at < places.len() {
                let size = batch.get();
                let wide = (size / deep as usize).clamp(1, places.len() - at);
                // Where a sample takes long, those of one pixel are several batches.
                let most = (size / wide).max(1);
                for from in indices.clone().step_by(most) {
                    let of = BatchPlaces {
                        tile: chunk.tile,
                        places: &places[at..at + wide],
                        indices: from..indices.end.min(from + most as u64),
                        by_place,
                    };
                    rays += self.take_samples(work, tile.origin, &of, wanted)?;
                    self.sum_batch(planes.clone(), (places.len(), at), &of, whole);
                    if stopped() {
                        return None;
                    }
                }
                at += wide;
            }
        }
        for row in (0..rows).filter(|_| !is_whole) {
            for (i, at) in places.iter().enumerate() {
                let sum = self.columns.get(row * places.len() + i);
                self.sums.set(first + row * TILE_PIXELS + at, &sum);
            }
        }
        Some(rays)
    }

    /// The radiance of a batch's samples, which stays in `self.values`; `None` where it was stopped.
    fn take_samples(
        &mut self,
        work: &Work,
        origin: UVec2,
        of: &BatchPlaces,
        wanted: PlaneSet,
    ) -> Option<RayCounts> {
        self.samples.clear();
        of.each(|place, index| {
            let pixel = origin + pixel_in_tile(place);
            self.samples.push(SampleId { pixel, index });
        });
        if let Some(kept) = work.kept {
            kept.tell(of, &mut self.workspace.known);
        }
        let taken = self.evaluate_samples(work.subject, wanted, work.batch, work.stopped)?;
        if let Some(kept) = work.kept {
            kept.learn(of, taken, &mut self.workspace.known);
        }
        Some(taken)
    }

    /// Adds the batch's values to the chunk's pixels, which are so many, from the one `at` on; where those are all of a
    /// tile's to the chunk's sums from the `whole` on.
    fn sum_batch(
        &mut self,
        planes: impl Iterator<Item = usize>,
        (pixels, at): (usize, usize),
        of: &BatchPlaces,
        whole: Option<usize>,
    ) {
        let (sums, first) = match whole {
            Some(first) => (&mut self.sums, first),
            None => (&mut self.columns, 0),
        };
        let count = self.samples.len();
        let wide = of.places.len();
        for (row, plane) in planes.enumerate() {
            let values = &self.values[row * count..][..count];
            if plane != OWN && values.iter().all(|value| *value == Vec3::ZERO) {
                // Most batches of many pictures see no light.
                continue;
            }
            let first = first + row * pixels + at;
            if of.by_place {
                sums.add_series(first, count / wide, values);
            } else {
                let turns = values.chunks_exact(wide);
                turns.for_each(|values| sums.add(first, values));
            }
        }
        let values = folded(&self.folded, &self.values, count);
        count_octaves(values, &mut self.octaves);
    }

    /// The radiance of samples, which stays in `self.values` until the next call; `None` where it was stopped.
    pub fn evaluate(
        &mut self,
        subject: &Subject,
        wanted: PlaneSet,
        ids: impl Iterator<Item = SampleId>,
        batch: &BatchSize,
        stopped: &dyn Fn() -> bool,
    ) -> Option<RayCounts> {
        self.samples.clear();
        self.samples.extend(ids);
        self.evaluate_samples(subject, wanted, batch, stopped)
    }

    /// The radiance of `self.samples`.
    fn evaluate_samples(
        &mut self,
        subject: &Subject,
        wanted: PlaneSet,
        batch: &BatchSize,
        stopped: &dyn Fn() -> bool,
    ) -> Option<RayCounts> {
        let start = Instant::now();
        let Untinted {
            world,
            planes,
            tints,
            ..
        } = &subject.light;
        let count = self.samples.len();
        let rows = wanted.rows(planes.count());
        self.values.resize(rows * count, Vec3::ZERO);
        let rays = radiance_in_planes(
            world,
            &subject.camera,
            &subject.settings,
            &self.samples,
            planes,
            wanted,
            &mut self.values,
            &mut self.workspace,
            stopped,
        );
        self.folded.clear();
        let asked = wanted.of(planes.count());
        if asked.clone().any(|plane| plane != OWN) {
            self.folded.resize(count, Vec3::ZERO);
            for (values, plane) in self.values.chunks_exact(count).zip(asked) {
                for (sum, value) in self.folded.iter_mut().zip(values) {
                    *sum += tints[plane] * *value;
                }
            }
        }
        let end = Instant::now();
        batch.learn(self.samples.len(), end - start);
        // Whoever waits for this core, a frame or the thread that develops pictures, has it now and not
        // when the system thinks that it was enough: 4 ms later on Linux, and an edit waits several times.
        // Small batches would ask the system more often than it takes to notice.
        if self.gave_way.is_none_or(|last| end - last > SHORT) {
            std::thread::yield_now();
            self.gave_way = Some(end);
        }
        rays
    }

    /// What the last [`Self::evaluate`] found, all its planes together.
    pub fn folded(&self) -> &[Vec3] {
        folded(&self.folded, &self.values, self.samples.len())
    }
}

/// The values of so many samples, all planes together: those of what shines by itself, where that is all.
fn folded<'a>(folded: &'a [Vec3], values: &'a [Vec3], samples: usize) -> &'a [Vec3] {
    if folded.is_empty() {
        &values[..samples]
    } else {
        folded
    }
}

#[cfg(test)]
mod tests;

//! A render: what it reads, what it has, and the passes that add samples until a rule ends it.

use super::control::{Control, Signal};
use super::error::ErrorEstimate;
use super::preview::{Preview, first_divider, lattice, time_samples};
use super::queue::Queue;
use super::sample_chunk::{BatchSize, Subject, with_scratch};
use super::status::{Ending, State, Status, TrendPoint, seconds_left};
use super::tile_state::{Chunk, TILE_PIXELS, TileState};
use super::tiles::{Tile, TileGrid};
use super::{TILE, lock};
use crate::trace::{RayCounts, SampleId};
use glam::{UVec2, Vec2};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// How a render goes about it. The samples are the same.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Mode {
    /// Someone looks on: coarse pictures come first, then one sample of each pixel, then two.
    pub watched: bool,
    /// Which samples of each pixel.
    pub samples: Range<u64>,
}

/// A render. Its methods may be called from any thread while one thread is in [`Self::run`].
pub(super) struct Engine {
    pub subject: Subject,
    pub mode: Mode,
    pub grid: TileGrid,
    pub tiles: Vec<Mutex<TileState>>,
    pub preview: Mutex<Option<Preview>>,
    queue: Mutex<Queue>,
    batch: BatchSize,
    pub control: Control,
    /// Every pixel has a sample, so that the time limit may end the render.
    covered: AtomicBool,
    progress: Mutex<Progress>,
    done: AtomicU64,
}

/// What the threads report.
#[derive(Clone, Debug, Default)]
struct Progress {
    rays: RayCounts,
    trend: Vec<TrendPoint>,
    ending: Option<Ending>,
}

impl Engine {
    pub fn new(subject: Subject, mode: Mode) -> Self {
        let grid = TileGrid::new(subject.settings.size);
        Self {
            tiles: grid
                .tiles()
                .map(|tile| Mutex::new(TileState::new(tile)))
                .collect(),
            preview: Mutex::default(),
            queue: Mutex::default(),
            batch: BatchSize::new(&subject),
            control: Control::new(),
            covered: AtomicBool::new(false),
            progress: Mutex::default(),
            done: AtomicU64::new(0),
            subject,
            mode,
            grid,
        }
    }

    pub fn size(&self) -> UVec2 {
        self.grid.size
    }

    pub fn pixels(&self) -> f64 {
        self.size().as_dvec2().element_product()
    }

    pub fn set_focus(&self, focus: Vec2) {
        lock(&self.queue).set_focus(focus);
    }

    /// Renders until a rule, or a cancel, ends it. `told` hears of progress, from any thread.
    pub fn run(&self, told: &(dyn Fn(&Self) + Sync)) -> Ending {
        self.control.start_watch();
        let ending = self.run_passes(told);
        self.control.stop_watch();
        lock(&self.progress).ending = Some(ending);
        ending
    }

    fn run_passes(&self, told: &(dyn Fn(&Self) + Sync)) -> Ending {
        if self.mode.watched
            && let Some(ending) = self.start_coarse()
        {
            return ending;
        }
        let mut level = self.mode.samples.start;
        loop {
            let chunks = match self.next_pass(&mut level) {
                Ok(chunks) => chunks,
                Err(ending) => return ending,
            };
            {
                let mut queue = lock(&self.queue);
                chunks.into_iter().for_each(|chunk| queue.push(chunk));
            }
            if let Some(ending) = self.run_queue(told) {
                return ending;
            }
            self.covered.store(true, Ordering::Relaxed);
            *lock(&self.preview) = None;
            self.note_error();
            told(self);
        }
    }

    /// Works on what is queued until nothing is left, or something else ends the render.
    fn run_queue(&self, told: &(dyn Fn(&Self) + Sync)) -> Option<Ending> {
        loop {
            let waiting = lock(&self.queue).len();
            (0..waiting).into_par_iter().with_max_len(1).for_each(|_| {
                if self.must_stop() {
                    return;
                }
                let next = lock(&self.queue).pop(&self.grid);
                if let Some(chunk) = next {
                    if self.run_chunk(&chunk) {
                        told(self);
                    } else {
                        lock(&self.queue).push(chunk);
                    }
                }
            });
            if let Some(ending) = self.interrupted() {
                return Some(ending);
            }
            if lock(&self.queue).len() == 0 {
                return None;
            }
        }
    }

    /// Whether work has to stop, for good or for a while.
    fn must_stop(&self) -> bool {
        self.control.signal() != Signal::Go || self.time_is_up()
    }

    fn time_is_up(&self) -> bool {
        let limit = self.subject.settings.sampling.time;
        limit > 0.0
            && self.covered.load(Ordering::Relaxed)
            && self.control.elapsed() >= Duration::try_from_secs_f32(limit).unwrap_or(Duration::MAX)
    }

    /// Waits out a pause; says what ends the render.
    fn interrupted(&self) -> Option<Ending> {
        if self.control.signal() == Signal::Pause {
            self.control.stop_watch();
            self.control.wait_while_paused();
            self.control.start_watch();
        }
        match self.control.signal() {
            Signal::Cancel => Some(Ending::Cancelled),
            _ if self.time_is_up() => Some(Ending::Time),
            _ => None,
        }
    }

    /// The coarse pictures, as far as they come before the one of full resolution.
    fn start_coarse(&self) -> Option<Ending> {
        let size = self.size();
        let focus = lock(&self.queue).focus();
        let mut preview = Preview::new(size);
        let (seconds, rays) = time_samples(&self.subject, &mut preview, focus, &self.batch);
        let coarsest = first_divider(size, seconds / rayon::current_num_threads() as f64);
        lock(&self.progress).rays += rays;
        *lock(&self.preview) = Some(preview);
        let mut divider = coarsest;
        while divider > 1 {
            let mut squares = lattice_squares(size, divider);
            while !squares.is_empty() {
                // Those that were not done when a pause came are tried again; what they had is kept.
                squares = squares
                    .into_par_iter()
                    .with_max_len(1)
                    .filter(|square| !self.preview_square(*square, divider))
                    .collect();
                if let Some(ending) = self.interrupted() {
                    return Some(ending);
                }
            }
            divider /= 2;
        }
        None
    }

    /// Evaluates what is not known yet of a square of the lattice. False where it had to stop.
    fn preview_square(&self, square: UVec2, divider: u32) -> bool {
        let pixels: Vec<_> = {
            let preview = lock(&self.preview);
            lattice(self.size(), square, TILE, divider)
                .filter(|pixel| preview.as_ref().is_some_and(|p| p.get(*pixel).is_none()))
                .collect()
        };
        let mut rest = &pixels[..];
        while !rest.is_empty() {
            if self.must_stop() {
                return false;
            }
            let (some, others) = rest.split_at(self.batch.get().min(rest.len()));
            rest = others;
            let rays = with_scratch(|scratch| {
                let ids = some.iter().map(|&pixel| SampleId { pixel, index: 0 });
                let rays = scratch.evaluate(&self.subject, ids, &self.batch);
                if let Some(preview) = lock(&self.preview).as_mut() {
                    for (pixel, value) in some.iter().zip(scratch.values()) {
                        preview.set(*pixel, *value);
                    }
                }
                rays
            });
            lock(&self.progress).rays += rays;
        }
        true
    }

    /// Does a chunk. False where it had to stop: then nothing of it counts.
    fn run_chunk(&self, chunk: &Chunk) -> bool {
        let tile = self.grid.tile(chunk.tile);
        let known = if chunk.range.start == 0 {
            self.known(tile)
        } else {
            Vec::new()
        };
        with_scratch(|scratch| {
            let stopped = || self.must_stop();
            let rays = scratch.sum_chunk(&self.subject, tile, chunk, &known, &self.batch, &stopped);
            let Some(rays) = rays else { return false };
            let pixels = {
                let mut state = lock(&self.tiles[chunk.tile as usize]);
                state.absorb(chunk, &scratch.sums, rays.total());
                state
                    .tile
                    .pixels()
                    .filter(|(_, at)| chunk.pixels.has(*at))
                    .count() as u64
            };
            self.done.fetch_add(
                pixels * (chunk.range.end - chunk.range.start),
                Ordering::Relaxed,
            );
            lock(&self.progress).rays += rays;
            true
        })
    }

    /// First samples of the tile's pixels that the preview has.
    fn known(&self, tile: Tile) -> Vec<Option<glam::Vec3>> {
        let preview = lock(&self.preview);
        let Some(preview) = preview.as_ref() else {
            return Vec::new();
        };
        let mut known = vec![None; TILE_PIXELS];
        for (pixel, at) in tile.pixels() {
            known[at] = preview.get(pixel);
        }
        known
    }

    /// How far the film is from the converged one; `None` before there is anything to compare.
    pub fn error(&self) -> Option<ErrorEstimate> {
        if self.mode.samples.start > 0 {
            return None;
        }
        let moves = self.tiles.iter().flat_map(|tile| lock(tile).moves);
        ErrorEstimate::of(moves)
    }

    fn note_error(&self) {
        let Some(error) = self.error() else { return };
        let point = TrendPoint {
            samples: self.samples(),
            seconds: self.control.elapsed().as_secs_f64(),
            error,
        };
        lock(&self.progress).trend.push(point);
    }

    /// Samples of a pixel, on average.
    fn samples(&self) -> f64 {
        let pixels = self.pixels();
        self.done.load(Ordering::Relaxed) as f64 / pixels.max(1.0)
    }

    /// Why it ended, once it has.
    pub fn ending(&self) -> Option<Ending> {
        lock(&self.progress).ending
    }

    pub fn status(&self) -> Status {
        let progress = lock(&self.progress).clone();
        let seconds = self.control.elapsed().as_secs_f64();
        let state = match (progress.ending, self.control.signal()) {
            (Some(ending), _) => State::Ended(ending),
            (None, Signal::Pause) => State::Paused,
            (None, _) => State::Running,
        };
        let mut status = Status {
            state,
            samples: self.samples(),
            samples_wanted: (self.mode.samples.end - self.mode.samples.start) as f64,
            rays: progress.rays,
            seconds,
            trend: progress.trend,
            seconds_left: None,
        };
        status.seconds_left = seconds_left(&status, &self.subject.settings.sampling);
        status
    }
}

fn lattice_squares(size: UVec2, divider: u32) -> Vec<UVec2> {
    let count = size.map(|n| n.div_ceil(divider).div_ceil(TILE));
    (0..count.y)
        .flat_map(|y| (0..count.x).map(move |x| UVec2::new(x, y)))
        .collect()
}
